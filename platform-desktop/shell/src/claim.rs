//! Claims of session numbers between processes: each of several open windows has its own session file. A
//! claim is a socket bound in Linux's abstract namespace, which the kernel frees with the process.

use std::path::Path;

/// A session number that no other window with the same session folder and size holds. It is freed when this
/// is dropped or the process ends in any way.
#[derive(Debug)]
pub struct SessionClaim {
    number: u32,
    // Held until it is dropped.
    _socket: Option<ClaimSocket>,
}

impl SessionClaim {
    /// Claims the lowest free number, from 1, for a session folder and a grid of `grid_side` voxels a side.
    /// Creates the folder. On systems other than Linux the number is always 1.
    #[must_use]
    pub fn claim_lowest_free_number(sessions_folder: &Path, grid_side: usize) -> Self {
        // Two paths to the same folder must share their claims. A folder that can't be created needs none.
        let _ = std::fs::create_dir_all(sessions_folder);
        let folder = std::fs::canonicalize(sessions_folder)
            .or_else(|_| std::path::absolute(sessions_folder))
            .unwrap_or_else(|_| sessions_folder.to_owned());
        let mut number = 1;
        loop {
            match bind_socket_if_supported(&format!(
                "paros-{grid_side}-{number}-{}",
                folder.display()
            )) {
                Ok(socket) => return SessionClaim { number, _socket: socket },
                Err(NameTaken) => number += 1,
            }
        }
    }

    /// The number claimed, from 1.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.number
    }
}

struct NameTaken;

#[cfg(target_os = "linux")]
type ClaimSocket = std::os::unix::net::UnixDatagram;

/// Binds a datagram socket to an abstract address derived from `name`. Only one socket can have an address,
/// and it leaves no file behind. Returns `None` if the system has no such sockets.
#[cfg(target_os = "linux")]
fn bind_socket_if_supported(name: &str) -> Result<Option<ClaimSocket>, NameTaken> {
    use std::hash::{DefaultHasher, Hash, Hasher};
    use std::io::ErrorKind;
    use std::os::linux::net::SocketAddrExt;
    use std::os::unix::net::SocketAddr;

    // An address has at most 107 bytes.
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    let address = SocketAddr::from_abstract_name(format!("paros-{:016x}", hasher.finish()));
    match address.and_then(|address| ClaimSocket::bind_addr(&address)) {
        Ok(socket) => Ok(Some(socket)),
        Err(error) if error.kind() == ErrorKind::AddrInUse => Err(NameTaken),
        Err(_) => Ok(None),
    }
}

#[cfg(not(target_os = "linux"))]
type ClaimSocket = ();

#[cfg(not(target_os = "linux"))]
fn bind_socket_if_supported(_name: &str) -> Result<Option<ClaimSocket>, NameTaken> {
    Ok(None)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::SessionClaim;

    #[test]
    fn windows_count_while_they_are_open() {
        let folder = std::env::temp_dir().join(format!("paros-claim-{}", std::process::id()));
        let first = SessionClaim::claim_lowest_free_number(&folder, 128);
        let second = SessionClaim::claim_lowest_free_number(&folder, 128);
        assert_eq!((first.number(), second.number()), (1, 2));
        assert_eq!(SessionClaim::claim_lowest_free_number(&folder, 256).number(), 1);
        drop(first);
        assert_eq!(SessionClaim::claim_lowest_free_number(&folder, 128).number(), 1);
        assert_eq!(SessionClaim::claim_lowest_free_number(&folder.join("else"), 128).number(), 1);
        drop(second);
    }
}
