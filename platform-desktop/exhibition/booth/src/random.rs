//! Random bits, of the system.

use std::io;

/// So many random bytes.
///
/// # Errors
/// That the system has none.
pub(crate) fn random_bytes<const N: usize>() -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes)
}

/// A random number for a record. A column of a database has a sign: it has 63 bits.
///
/// # Errors
/// That the system has no random bits.
pub(crate) fn random_number() -> io::Result<u64> {
    Ok(u64::from_le_bytes(random_bytes()?) >> 1)
}
