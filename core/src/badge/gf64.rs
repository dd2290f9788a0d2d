//! The field of 64 elements, GF(64): polynomials over GF(2) modulo x^6 + x + 1, six bits each.
//!
//! Sums are exclusive ors. The powers of x are all 63 non-zero elements, so products are sums of logarithms.

/// An element: bit i is the coefficient of x^i.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Gf64(u8);

/// x^6 + x + 1, an irreducible polynomial with x as a primitive element.
const MODULUS: u8 = 0b100_0011;

/// x^0 to x^62, followed by x^0 again.
const POWERS: [u8; 64] = list_powers();

/// The logarithm to base x of each element; the entry for zero is never read.
const LOGARITHMS: [u8; 64] = list_logarithms();

impl Gf64 {
    /// The neutral element of addition.
    pub(crate) const ZERO: Gf64 = Gf64(0);

    /// Creates an element from the lower six bits.
    pub(crate) const fn new(bits: u8) -> Self {
        Gf64(bits & 63)
    }

    /// Returns its six bits.
    pub(crate) const fn bits(self) -> u8 {
        self.0
    }

    /// Returns the sum, which equals the difference.
    pub(crate) const fn plus(self, other: Gf64) -> Self {
        Gf64(self.0 ^ other.0)
    }

    /// Returns the product.
    pub(crate) const fn times(self, other: Gf64) -> Self {
        if self.0 == 0 || other.0 == 0 {
            return Gf64::ZERO;
        }
        let exponent = LOGARITHMS[self.0 as usize] + LOGARITHMS[other.0 as usize];
        Gf64(POWERS[(exponent % 63) as usize])
    }

    /// Returns the quotient, or zero if `divisor` is zero, which never happens here.
    pub(crate) const fn over(self, divisor: Gf64) -> Self {
        if divisor.0 == 0 {
            return Gf64::ZERO;
        }
        self.times(Gf64(POWERS[63 - LOGARITHMS[divisor.0 as usize] as usize]))
    }
}

/// Returns the sum of `factors[i] * elements[i]`.
pub(crate) fn dot<const N: usize>(factors: &[u8; N], elements: &[Gf64; N]) -> Gf64 {
    let products = factors.iter().zip(elements).map(|(f, e)| Gf64::new(*f).times(*e));
    products.fold(Gf64::ZERO, Gf64::plus)
}

const fn list_powers() -> [u8; 64] {
    let mut powers = [1; 64];
    let mut i = 1;
    while i < 64 {
        let shifted = powers[i - 1] << 1;
        powers[i] = if shifted & 64 != 0 { shifted ^ MODULUS } else { shifted };
        i += 1;
    }
    powers
}

const fn list_logarithms() -> [u8; 64] {
    let mut logarithms = [0; 64];
    let mut i = 0;
    while i < 63 {
        logarithms[POWERS[i] as usize] = i as u8;
        i += 1;
    }
    logarithms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_field() {
        let all = || (0..64).map(Gf64::new);
        for a in all() {
            assert_eq!(a.times(Gf64::new(1)), a);
            for b in all() {
                assert_eq!(a.times(b), b.times(a));
                if b != Gf64::ZERO {
                    assert_eq!(a.over(b).times(b), a, "{a:?} / {b:?}");
                }
                for c in all() {
                    assert_eq!(a.times(b.plus(c)), a.times(b).plus(a.times(c)));
                    assert_eq!(a.times(b).times(c), a.times(b.times(c)));
                }
            }
        }
    }
}
