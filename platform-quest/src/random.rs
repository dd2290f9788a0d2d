//! Random bits for badges.

use crate::boot_clock::read_since_boot;

/// 32 bits from the operating system. Where it has none, as no headset's system does, those of the clock: a badge is
/// given all the same.
pub(crate) fn random_bits() -> u32 {
    getrandom::u32().unwrap_or_else(|_| read_since_boot().subsec_nanos())
}

#[cfg(test)]
mod tests {
    use super::random_bits;

    #[test]
    fn bits_differ() {
        let drawn: std::collections::HashSet<u32> = (0..100).map(|_| random_bits()).collect();
        // Two alike among a hundred are one in a million.
        assert!(drawn.len() >= 99, "{drawn:?}");
        let both = |bit: u32| {
            [0, 1].iter().all(|wanted| drawn.iter().any(|bits| bits >> bit & 1 == *wanted))
        };
        assert!((0..32).all(both));
    }
}
