//! 64-bit hashes, not cryptographic: the bit mixer, a hash of bytes, and the parts of a world's digest.
//!
//! A digest is either a hash of bytes in order ([`checksum`]), or a sum of values times [`DIGEST_KEYS`],
//! which can be updated incrementally when single values change. Every factor of such a sum is odd, also
//! after rotation and multiplication, so that no bit of a value vanishes.

/// Names of the state's parts that have a digest of their own.
pub const DIGEST_PARTS: [&str; 4] = ["hands, bench and session", "volume", "undo", "islands"];

/// Scrambles 64 bits (the finaliser of MurmurHash3, Appleby 2011).
#[must_use]
#[inline]
pub const fn mix_bits(mut h: u64) -> u64 {
    h ^= h >> 33;
    h = h.wrapping_mul(0xff51_afd7_ed55_8ccd);
    h ^= h >> 33;
    h = h.wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    h ^ h >> 33
}

/// Odd pseudorandom factors of digest sums.
pub(crate) const DIGEST_KEYS: [u64; 257] = {
    let mut keys = [0; 257];
    let mut i = 0;
    while i < keys.len() {
        keys[i] = mix_bits(i as u64 + 1) | 1;
        i += 1;
    }
    keys
};

/// Returns the hash of a sequence of bytes, eight at a time.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    let mut sum = bytes.len() as u64;
    for chunk in bytes.chunks(8) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        sum = mix_bits(sum ^ u64::from_le_bytes(word)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    }
    sum
}

/// Combines the digests of a world's parts, in the order of [`DIGEST_PARTS`], into the world's digest.
#[must_use]
pub fn combine_digests(part_digests: [u64; DIGEST_PARTS.len()]) -> u64 {
    part_digests.into_iter().fold(0, |sum, part| mix_bits(sum.rotate_left(17) ^ part))
}
