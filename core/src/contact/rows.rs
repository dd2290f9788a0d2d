//! The rows of a volume that a bit meets.

use core::iter;

use glam::IVec3;

use super::Obstacle;
use crate::brush::{Bounds, Brush, Layer, Piece};
use crate::maps::{Axis, Maps};
use crate::pose::{Pose, SUB};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::tools::GridBit;

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    pub(super) fn near_mask(&self, bit: &GridBit, pose: &Pose) -> bool {
        let (Some(mask), Some(piece)) = (self.mask, bit.deeper_than(-SUB, pose)) else {
            return false;
        };
        self.hits(&piece, Some(mask))
    }

    /// Whether a brush holds an occupied voxel, of `mask` if one is given.
    pub(super) fn touches(&self, brush: &Brush, mask: Option<&Maps<N>>) -> bool {
        brush.pieces().any(|piece| self.hits(&piece, mask))
    }

    /// Whether a piece holds an occupied voxel, of `mask` if one is given.
    pub(super) fn hits(&self, piece: &Piece, mask: Option<&Maps<N>>) -> bool {
        let Some(Bounds { lo, hi }) = piece.bounds(N) else {
            return false;
        };
        let within: <Grid<N> as Size>::Row = Bits::span(lo[0], hi[0]);
        let ball = piece.ball();
        let (first_word, words) = (lo[0] / 64, lo[0] / 64 + 1..hi[0] / 64 + 1);
        let is_near = |row: &<Grid<N> as Size>::Row, i: usize| row.word(i) & within.word(i) != 0;
        (lo[1]..hi[1] + 1).any(|y| {
            let layer = piece.layer(y);
            let ball = ball.as_ref().map(|ball| ball.layer(y));
            let Some((first, last)) = layer.rows(N) else {
                return false;
            };
            let rows = &self.rows.layer(y)[first..last + 1];
            iter::zip(first.., rows).any(|(z, row)| {
                // Most rows end here.
                (is_near(row, first_word) || words.clone().any(|i| is_near(row, i)))
                    && self.row_hits((&layer, ball.as_ref()), (y, z), *row & within, mask)
            })
        })
    }

    fn row_hits(
        &self,
        (layer, ball): (&Layer<'_>, Option<&Layer<'_>>),
        (y, z): (usize, usize),
        near: <Grid<N> as Size>::Row,
        mask: Option<&Maps<N>>,
    ) -> bool {
        let near = mask.map_or(near, |mask| near & mask.column(Axis::X, (y, z)).row());
        let within = |near: <Grid<N> as Size>::Row, layer: &Layer<'_>| match near.is_empty() {
            true => near,
            false => layer
                .span(z, N)
                .map_or(<Grid<N> as Size>::Row::EMPTY, |(lo, hi)| near & Bits::span(lo, hi)),
        };
        let inside = within(ball.map_or(near, |ball| within(near, ball)), layer);
        !inside.is_empty() && mask.is_none_or(|mask| !mask.row_among((y, z), inside).is_empty())
    }

    /// Calls `each` with the occupied voxels of a piece, row by row.
    pub(super) fn each_row(
        &self,
        piece: &Piece,
        mut each: impl FnMut(usize, usize, <Grid<N> as Size>::Row),
    ) {
        let Some(Bounds { lo, hi }) = piece.bounds(N) else {
            return;
        };
        let within: <Grid<N> as Size>::Row = Bits::span(lo[0], hi[0]);
        for y in lo[1]..hi[1] + 1 {
            let layer = piece.layer(y);
            let Some((first, last)) = layer.rows(N) else {
                continue;
            };
            for (z, row) in iter::zip(first.., &self.rows.layer(y)[first..last + 1]) {
                let near = *row & within;
                if near.is_empty() {
                    continue;
                }
                if let Some((lo, hi)) = layer.span(z, N) {
                    let inside = near & Bits::span(lo, hi);
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
            Some(row) => (of & !row).count() as i32,
            None => of.count() as i32,
        };
        let row = |y: usize, z: usize| (y < N && z < N).then(|| self.rows.row(y, z));
        let here = self.rows.row(y, z);
        IVec3::new(
            empty(Some(here.down())) - empty(Some(here.up())),
            empty(row(y + 1, z)) - empty(row(y.wrapping_sub(1), z)),
            empty(row(y, z + 1)) - empty(row(y, z.wrapping_sub(1))),
        )
    }
}
