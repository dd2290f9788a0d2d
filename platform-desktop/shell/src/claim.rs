//! Claims of session numbers between processes: each window open at once has a session file of its
//! own. A claim is a bound socket of Linux's abstract namespace, which the kernel frees with the process.

use std::path::Path;

/// A session number held by this window alone, among those with the same session folder and size.
/// It is free again once this is dropped or the process ends in any way.
#[derive(Debug)]
pub(crate) struct SessionClaim {
    number: u32,
    // Held for its drop.
    _token: Option<ClaimToken>,
}

impl SessionClaim {
    /// Claims the lowest free number, from 1, for a session folder and a grid of `side` voxels a side. The
    /// folder is created. On systems other than Linux the number is always 1.
    #[must_use]
    pub(crate) fn take_lowest_free(folder: &Path, side: usize) -> Self {
        // Two names of one folder must give one claim. A folder that can't be created needs none.
        let _ = std::fs::create_dir_all(folder);
        let folder = std::fs::canonicalize(folder)
            .or_else(|_| std::path::absolute(folder))
            .unwrap_or_else(|_| folder.to_owned());
        let mut number = 1;
        loop {
            match bind_token(&format!("paros-{side}-{number}-{}", folder.display())) {
                Ok(token) => return SessionClaim { number, _token: token },
                Err(TokenTaken) => number += 1,
            }
        }
    }

    /// The number claimed, from 1.
    #[must_use]
    pub(crate) const fn number(&self) -> u32 {
        self.number
    }
}

struct TokenTaken;

#[cfg(target_os = "linux")]
type ClaimToken = std::os::unix::net::UnixDatagram;

/// Binds a datagram socket to an abstract address derived from `name`: only one socket can have it,
/// and it leaves no file behind. `None` where the system has no such sockets.
#[cfg(target_os = "linux")]
fn bind_token(name: &str) -> Result<Option<ClaimToken>, TokenTaken> {
    use std::hash::{DefaultHasher, Hash, Hasher};
    use std::io::ErrorKind;
    use std::os::linux::net::SocketAddrExt;
    use std::os::unix::net::SocketAddr;

    // A name may be 107 bytes long.
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    let address = SocketAddr::from_abstract_name(format!("paros-{:016x}", hasher.finish()));
    match address.and_then(|address| ClaimToken::bind_addr(&address)) {
        Ok(token) => Ok(Some(token)),
        Err(error) if error.kind() == ErrorKind::AddrInUse => Err(TokenTaken),
        Err(_) => Ok(None),
    }
}

#[cfg(not(target_os = "linux"))]
type ClaimToken = ();

#[cfg(not(target_os = "linux"))]
fn bind_token(_name: &str) -> Result<Option<ClaimToken>, TokenTaken> {
    Ok(None)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::SessionClaim;

    #[test]
    fn windows_count_while_they_are_open() {
        let folder = std::env::temp_dir().join(format!("paros-claim-{}", std::process::id()));
        let first = SessionClaim::take_lowest_free(&folder, 128);
        let second = SessionClaim::take_lowest_free(&folder, 128);
        assert_eq!((first.number(), second.number()), (1, 2));
        assert_eq!(SessionClaim::take_lowest_free(&folder, 256).number(), 1);
        drop(first);
        assert_eq!(SessionClaim::take_lowest_free(&folder, 128).number(), 1);
        assert_eq!(SessionClaim::take_lowest_free(&folder.join("else"), 128).number(), 1);
        drop(second);
    }
}
