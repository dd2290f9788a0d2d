//! A streaming check of a mesh: is it a valid binary STL, and is it closed? A mesh is closed if each edge of
//! a triangle also occurs in the opposite direction. Takes almost no memory.

use std::hash::{BuildHasher as _, RandomState};

/// The bytes of a binary STL's header, and of each triangle.
const HEAD_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// A check that reads an STL piece by piece.
pub(crate) struct MeshCheck {
    /// Bytes of an incomplete header or triangle.
    rest: Vec<u8>,
    /// The number of triangles in the header; `None` until the header is complete.
    told: Option<u32>,
    seen: u32,
    edges: EdgeSum,
    has_other_numbers: bool,
}

/// The result of a check.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct MeshReport {
    pub(crate) triangles: u32,
    pub(crate) is_closed: bool,
}

/// The sum of a keyed hash of each edge, minus the hash of the same edge reversed. The sum is zero if each
/// edge occurs equally often in both directions; otherwise it is zero with a probability of about 1 in 2^64,
/// as the key is random.
struct EdgeSum {
    hasher: RandomState,
    sum: u64,
}

impl MeshCheck {
    pub(crate) fn new() -> Self {
        MeshCheck {
            rest: Vec::new(),
            told: None,
            seen: 0,
            edges: EdgeSum { hasher: RandomState::new(), sum: 0 },
            has_other_numbers: false,
        }
    }

    /// Reads the next bytes.
    pub(crate) fn look_at(&mut self, bytes: &[u8]) {
        self.rest.extend_from_slice(bytes);
        let mut rest = std::mem::take(&mut self.rest);
        let mut done = 0;
        if self.told.is_none() && rest.len() >= HEAD_BYTES {
            self.told = Some(u32::from_le_bytes([rest[80], rest[81], rest[82], rest[83]]));
            done = HEAD_BYTES;
        }
        if self.told.is_some() {
            let triangles = rest[done..].chunks_exact(TRIANGLE_BYTES);
            done += triangles.len() * TRIANGLE_BYTES;
            triangles.for_each(|triangle| self.look_at_triangle(triangle));
        }
        rest.drain(..done);
        self.rest = rest;
    }

    /// Returns the result, after all bytes have been read.
    ///
    /// # Errors
    /// The reason why the bytes are not a valid STL.
    pub(crate) fn finish(self) -> Result<MeshReport, String> {
        let told = self.told.ok_or("STL: shorter than its head")?;
        if told != self.seen || !self.rest.is_empty() {
            return Err(format!("STL: its head tells {told} triangles, and its length others"));
        }
        if self.has_other_numbers {
            return Err("STL: a corner that is no number".into());
        }
        Ok(MeshReport { triangles: told, is_closed: self.edges.sum == 0 })
    }

    fn look_at_triangle(&mut self, triangle: &[u8]) {
        self.seen = self.seen.saturating_add(1);
        let mut numbers = triangle[..48].chunks_exact(4);
        let is_finite =
            |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]).is_finite();
        self.has_other_numbers |= !numbers.all(is_finite);
        self.edges.walk_around([&triangle[12..24], &triangle[24..36], &triangle[36..48]]);
    }
}

impl EdgeSum {
    /// Adds the edges of a triangle. Corners are equal if all their bits are.
    fn walk_around(&mut self, corners: [&[u8]; 3]) {
        let [a, b, c] = corners.map(|corner| self.hasher.hash_one(corner));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            self.sum = self.sum.wrapping_add(mix(from, to)).wrapping_sub(mix(to, from));
        }
    }
}

/// Mixes two hashes by a folded multiply that depends on their order. SipHash of each edge would take most of
/// the check's time.
const fn mix(from: u64, to: u64) -> u64 {
    // Digits of pi.
    let product = (from ^ 0x243f_6a88_85a3_08d3) as u128 * (to ^ 0x1319_8a2e_0370_7344) as u128;
    product as u64 ^ (product >> 64) as u64
}

#[cfg(test)]
mod tests {
    use super::{MeshCheck, MeshReport};

    /// Makes a mesh of these triangles between four corners.
    fn mesh(triangles: &[[u8; 3]]) -> Vec<u8> {
        let mut stl = vec![0; 80];
        stl.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            stl.extend([0; 12]);
            triangle.iter().for_each(|corner| stl.extend([*corner; 12]));
            stl.extend([0; 2]);
        }
        stl
    }

    fn check(stl: &[u8], piece: usize) -> Result<MeshReport, String> {
        let mut check = MeshCheck::new();
        stl.chunks(piece).for_each(|bytes| check.look_at(bytes));
        check.finish()
    }

    const SIDES: [[u8; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    #[test]
    fn a_tetrahedron_is_closed_and_not_without_a_side_or_with_one_turned() {
        let is_closed = |triangles: &[[u8; 3]]| check(&mesh(triangles), 7).unwrap().is_closed;
        assert!(is_closed(&SIDES));
        assert!(!is_closed(&SIDES[..3]));
        let mut turned = SIDES;
        turned[0].swap(0, 1);
        assert!(!is_closed(&turned));
        // The same triangle twice, in the same direction, doesn't close the mesh.
        assert!(!is_closed(&[SIDES[0], SIDES[0]]));
    }

    #[test]
    fn it_is_the_same_in_pieces_of_any_size() {
        let stl = mesh(&SIDES);
        let expected = MeshReport { triangles: 4, is_closed: true };
        for piece in 1..=stl.len() {
            assert_eq!(check(&stl, piece), Ok(expected));
        }
    }

    #[test]
    fn other_bytes_are_no_stl() {
        let stl = mesh(&SIDES);
        for length in 0..stl.len() {
            assert!(check(&stl[..length], 99).is_err(), "{length} bytes");
        }
        assert!(check(&[&stl[..], &[0]].concat(), 99).is_err());
        assert!(check(&[&stl[..], &[0; 50]].concat(), 99).is_err());
        let mut infinite = stl;
        infinite[84 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert!(check(&infinite, 99).is_err());
    }
}
