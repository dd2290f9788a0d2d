//! Random bits from the operating system.

use std::io;

/// Returns `N` random bytes.
///
/// # Errors
/// The system has no random bits.
pub(crate) fn random_bytes<const N: usize>() -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes)
}

/// Returns a random number for a record. It has 63 bits, as database columns are signed.
///
/// # Errors
/// The system has no random bits.
pub(crate) fn random_number() -> io::Result<u64> {
    Ok(u64::from_le_bytes(random_bytes()?) >> 1)
}
