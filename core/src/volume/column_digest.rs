//! Digests of range maps: sums over columns, updated incrementally when single columns change.

use crate::codec::digest::{DIGEST_KEYS, mix_bits};
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};

/// Returns the key of a column's address. A digest multiplies the column's number by it; empty columns have
/// the number 0, so all zero bytes digest to 0. The key is the product of the keys of place and line. Because
/// this is linear, the line's key is multiplied once for all changes in a line.
#[inline]
pub(crate) fn column_key(axis: Axis, (line, place): ColumnAddress) -> u64 {
    DIGEST_KEYS[place].wrapping_mul(line_key(axis, line))
}

/// Returns the factor of a column's key that depends on its line.
#[inline]
pub(crate) fn line_key(axis: Axis, line: usize) -> u64 {
    mix_bits(u64::from_le_bytes([0, line as u8, axis as u8, 1, 0, 0, 0, 0])) | 1
}

/// Returns a column's bytes as a number.
#[inline]
pub(crate) fn column_number<const K: usize>(column: Column<K>) -> u64 {
    let places = column.numbers().iter().enumerate();
    places.fold(0, |sum, (i, number)| sum | u64::from(*number) << (16 * i))
}

/// Computes the digest of range maps from scratch: the sum over all columns of the column's number times the
/// keys of its place and line.
#[must_use]
pub fn maps_digest<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> u64 {
    sum_of_lines::<N>(|axis, line| {
        let keyed = maps.line(axis, line).iter().zip(&DIGEST_KEYS);
        keyed.fold(0, |sum, (column, key)| {
            sum.wrapping_add(key.wrapping_mul(column_number(*column)))
        })
    })
}

/// Copies range maps and returns their [`maps_digest`]. `from` is read once.
pub(crate) fn copy_and_digest_maps<const N: usize, const K: usize>(
    from: &RangeMaps<N, K>,
    to: &mut RangeMaps<N, K>,
) -> u64 {
    sum_of_lines::<N>(|axis, line| {
        let copied = to.line_mut(axis, line).iter_mut().zip(from.line(axis, line));
        copied.zip(&DIGEST_KEYS).fold(0, |sum, ((to, from), key)| {
            *to = *from;
            sum.wrapping_add(key.wrapping_mul(column_number(*from)))
        })
    })
}

/// Returns the sum over all lines of `digest_of_line` times the line's key.
#[inline]
fn sum_of_lines<const N: usize>(mut digest_of_line: impl FnMut(Axis, usize) -> u64) -> u64 {
    let lines = Axis::ALL.into_iter().flat_map(|axis| (0..N).map(move |line| (axis, line)));
    lines.fold(0, |sum, (axis, line)| {
        sum.wrapping_add(digest_of_line(axis, line).wrapping_mul(line_key(axis, line)))
    })
}
