//! Intersection tests of brushes and bits with the volume's bit rows.

use core::iter;

use glam::IVec3;

use super::Obstacle;
use crate::edit::brush::{Brush, BrushBounds, BrushLayer, BrushPiece};
use crate::edit::grid_bit::GridBit;
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range_maps::{Axis, RangeMaps};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// Whether a mask voxel lies in the bit or within a voxel of it.
    pub(super) fn is_near_mask(&self, bit: &GridBit, pose: &Pose) -> bool {
        let (Some(mask), Some(piece)) =
            (self.mask, bit.piece_deeper_than(-SUBUNITS_PER_VOXEL, pose))
        else {
            return false;
        };
        self.piece_hits(&piece, Some(mask))
    }

    /// Whether a brush holds an occupied voxel, of `mask` if one is given.
    pub(super) fn brush_hits(&self, brush: &Brush, mask: Option<&RangeMaps<N>>) -> bool {
        brush.pieces().any(|piece| self.piece_hits(&piece, mask))
    }

    /// Whether a piece holds an occupied voxel, of `mask` if one is given.
    pub(super) fn piece_hits(&self, piece: &BrushPiece, mask: Option<&RangeMaps<N>>) -> bool {
        let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
            return false;
        };
        let within: <Grid<N> as Size>::Row = BitSet::span(lo[0], hi[0]);
        let ball = piece.bounding_ball();
        let (first_word, words) = (lo[0] / 64, lo[0] / 64 + 1..hi[0] / 64 + 1);
        let is_near = |row: &<Grid<N> as Size>::Row, i: usize| row.word(i) & within.word(i) != 0;
        (lo[1]..hi[1] + 1).any(|y| {
            let layer = piece.layer(y);
            let ball = ball.as_ref().map(|ball| ball.layer(y));
            let Some((first, last)) = layer.row_range(N) else {
                return false;
            };
            let rows = &self.rows.layer(y)[first..last + 1];
            iter::zip(first.., rows).any(|(z, row)| {
                // Early out: most rows hold no voxel within the bounds.
                (is_near(row, first_word) || words.clone().any(|i| is_near(row, i)))
                    && self.row_hits((&layer, ball.as_ref()), (y, z), *row & within, mask)
            })
        })
    }

    /// Whether row (y, z) of a piece holds one of the voxels `near`, of `mask` if one is given. `ball`
    /// is a layer of the piece's bounding ball, tested first as it is cheaper.
    fn row_hits(
        &self,
        (layer, ball): (&BrushLayer<'_>, Option<&BrushLayer<'_>>),
        (y, z): (usize, usize),
        near: <Grid<N> as Size>::Row,
        mask: Option<&RangeMaps<N>>,
    ) -> bool {
        let near = mask.map_or(near, |mask| near & mask.column(Axis::X, (y, z)).to_row());
        let within = |near: <Grid<N> as Size>::Row, layer: &BrushLayer<'_>| match near.is_empty() {
            true => near,
            false => layer
                .voxel_span(z, N)
                .map_or(<Grid<N> as Size>::Row::EMPTY, |(lo, hi)| near & BitSet::span(lo, hi)),
        };
        let inside = within(ball.map_or(near, |ball| within(near, ball)), layer);
        !inside.is_empty()
            && mask.is_none_or(|mask| !mask.occupied_among((y, z), inside).is_empty())
    }

    /// Calls `each` with y, z and the occupied voxels of each row of a piece that holds any.
    pub(super) fn for_each_row(
        &self,
        piece: &BrushPiece,
        mut each: impl FnMut(usize, usize, <Grid<N> as Size>::Row),
    ) {
        let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
            return;
        };
        let within: <Grid<N> as Size>::Row = BitSet::span(lo[0], hi[0]);
        for y in lo[1]..hi[1] + 1 {
            let layer = piece.layer(y);
            let Some((first, last)) = layer.row_range(N) else {
                continue;
            };
            for (z, row) in iter::zip(first.., &self.rows.layer(y)[first..last + 1]) {
                let near = *row & within;
                if near.is_empty() {
                    continue;
                }
                if let Some((lo, hi)) = layer.voxel_span(z, N) {
                    let inside = near & BitSet::span(lo, hi);
                    if !inside.is_empty() {
                        each(y, z, inside);
                    }
                }
            }
        }
    }

    /// The sum of the directions from voxels of a row to their empty six-neighbours.
    pub(super) fn empty_directions(&self, y: usize, z: usize, of: <Grid<N> as Size>::Row) -> IVec3 {
        let empty = |row: Option<<Grid<N> as Size>::Row>| match row {
            Some(row) => (of & !row).count_ones() as i32,
            None => of.count_ones() as i32,
        };
        let row = |y: usize, z: usize| (y < N && z < N).then(|| self.rows.row(y, z));
        let here = self.rows.row(y, z);
        IVec3::new(
            empty(Some(here.shifted_down())) - empty(Some(here.shifted_up())),
            empty(row(y + 1, z)) - empty(row(y.wrapping_sub(1), z)),
            empty(row(y, z + 1)) - empty(row(y, z.wrapping_sub(1))),
        )
    }
}
