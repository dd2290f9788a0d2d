//! Tests if a brush touches a volume, so that a fill with it is connected to the volume.

use crate::edit::brush::{Brush, BrushBounds, BrushPiece};
use crate::volume::bit_grid::BitGrid;
use crate::volume::range::Range;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Returns `true` if a voxel of a brush is occupied, has an occupied six-neighbour or lies on the ground.
pub(crate) fn brush_touches_volume<const N: usize>(brush: &Brush, rows: &BitGrid<N>) -> bool
where
    Grid<N>: Size,
{
    brush.pieces().any(|piece| piece_touches(&piece, rows, |x_range| x_range))
}

/// Returns `true` if [`brush_touches_volume`] holds for the brush's mirror image, x to N - 1 - x.
pub(crate) fn brush_mirror_touches_volume<const N: usize>(brush: &Brush, rows: &BitGrid<N>) -> bool
where
    Grid<N>: Size,
{
    let mirror = |x: Range| Range::new(N - 1 - x.last(), N - 1 - x.first());
    brush.pieces().any(|piece| piece_touches(&piece, rows, mirror))
}

fn piece_touches<const N: usize>(
    piece: &BrushPiece,
    rows: &BitGrid<N>,
    place: impl Fn(Range) -> Range,
) -> bool
where
    Grid<N>: Size,
{
    let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
        return false;
    };
    (lo[1]..hi[1] + 1).any(|y| {
        let layer = piece.layer(y);
        let Some(z_range) = layer.z_range(N) else {
            return false;
        };
        (z_range.first()..z_range.last() + 1).any(|z| {
            layer.x_range(z, N).is_some_and(|x_range| row_touches(place(x_range), (y, z), rows))
        })
    })
}

fn row_touches<const N: usize>(x_range: Range, (y, z): RowAddress, rows: &BitGrid<N>) -> bool
where
    Grid<N>: Size,
{
    type Row<const N: usize> = <Grid<N> as Size>::Row;
    let holds = |y: usize, z: usize, within: Row<N>| {
        y < N && z < N && !(rows.row(y, z) & within).is_empty()
    };
    let (first, last) = (x_range.first(), x_range.last());
    let own: Row<N> = BitSet::span(first, last);
    y == 0
        || holds(y, z, BitSet::span(first.saturating_sub(1), (last + 1).min(N - 1)))
        || holds(y - 1, z, own)
        || holds(y + 1, z, own)
        || holds(y, z.wrapping_sub(1), own)
        || holds(y, z + 1, own)
}
