//! Which of the windows open at once this one is: each has a session file of its own.

use std::path::Path;

/// A number that no other window has which keeps its sessions in the same folder; free again once
/// this is dropped, or the process ends in any way.
#[derive(Debug)]
pub(crate) struct Claim {
    number: u32,
    // Held, that is all.
    _token: Option<Token>,
}

impl Claim {
    /// The lowest number that is free, from 1, for a folder and a size. Where the system has no
    /// such tokens it is 1.
    #[must_use]
    pub(crate) fn new(folder: &Path, n: usize) -> Self {
        // The same folder by another name is the same; one that can't be made is no one's.
        let _ = std::fs::create_dir_all(folder);
        let folder = std::fs::canonicalize(folder)
            .or_else(|_| std::path::absolute(folder))
            .unwrap_or_else(|_| folder.to_owned());
        let mut number = 1;
        loop {
            match token(&format!("paros-{n}-{number}-{}", folder.display())) {
                Ok(token) => return Claim { number, _token: token },
                Err(Taken) => number += 1,
            }
        }
    }

    /// The number.
    #[must_use]
    pub(crate) const fn number(&self) -> u32 {
        self.number
    }
}

struct Taken;

#[cfg(target_os = "linux")]
type Token = std::os::unix::net::UnixDatagram;

/// An address that only one socket can have, and that leaves no file behind.
#[cfg(target_os = "linux")]
fn token(name: &str) -> Result<Option<Token>, Taken> {
    use std::hash::{DefaultHasher, Hash, Hasher};
    use std::io::ErrorKind;
    use std::os::linux::net::SocketAddrExt;
    use std::os::unix::net::SocketAddr;

    // A name may be 107 bytes long.
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    let address = SocketAddr::from_abstract_name(format!("paros-{:016x}", hasher.finish()));
    match address.and_then(|address| Token::bind_addr(&address)) {
        Ok(token) => Ok(Some(token)),
        Err(error) if error.kind() == ErrorKind::AddrInUse => Err(Taken),
        Err(_) => Ok(None),
    }
}

#[cfg(not(target_os = "linux"))]
type Token = ();

#[cfg(not(target_os = "linux"))]
fn token(_name: &str) -> Result<Option<Token>, Taken> {
    Ok(None)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::Claim;

    #[test]
    fn windows_count_while_they_are_open() {
        let folder = std::env::temp_dir().join(format!("paros-claim-{}", std::process::id()));
        let first = Claim::new(&folder, 128);
        let second = Claim::new(&folder, 128);
        assert_eq!((first.number(), second.number()), (1, 2));
        assert_eq!(Claim::new(&folder, 256).number(), 1);
        drop(first);
        assert_eq!(Claim::new(&folder, 128).number(), 1);
        assert_eq!(Claim::new(&folder.join("else"), 128).number(), 1);
        drop(second);
    }
}
