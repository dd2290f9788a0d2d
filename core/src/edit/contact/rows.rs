//! Intersection tests of brushes and bits with the volume's bit rows.

use core::iter;

use glam::IVec3;

use super::Obstacle;
use crate::edit::brush::{Brush, BrushBounds, BrushLayer, BrushPiece, voxel_centre_subunits};
use crate::edit::grid_bit::GridBit;
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range_maps::{Axis, RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The occupied voxels that an intersection test looks for.
#[derive(Clone, Copy)]
pub(super) enum TestedVoxels<'a, const N: usize, const K: usize> {
    /// All voxels of the volume.
    AllOccupied,
    /// Voxels that belong to a mask.
    OfMask(&'a RangeMaps<N, K>),
}

/// A piece's slice at one y.
#[derive(Clone, Copy)]
struct PieceLayers<'a> {
    piece: &'a BrushLayer<'a>,
    /// The slice of its bounding ball, which is tested first as it is cheaper.
    bounding_ball: Option<&'a BrushLayer<'a>>,
}

impl<const N: usize, const K: usize> Obstacle<'_, N, K>
where
    Grid<N>: Size,
{
    /// Returns `true` if a mask voxel lies in the bit or within half a voxel of it, where the mask stops a
    /// bit whatever its last step.
    pub(super) fn is_within_half_voxel_of_mask(&self, bit: &GridBit, pose: &Pose) -> bool {
        let (Some(mask), Some(piece)) =
            (self.mask, bit.piece_deeper_than(-SUBUNITS_PER_VOXEL / 2, pose))
        else {
            return false;
        };
        self.piece_overlaps(&piece, TestedVoxels::OfMask(mask))
    }

    /// Returns `true` if a brush holds one of the tested voxels.
    pub(super) fn brush_overlaps(&self, brush: &Brush, tested: TestedVoxels<'_, N, K>) -> bool {
        brush.pieces().any(|piece| self.piece_overlaps(&piece, tested))
    }

    /// Returns `true` if a piece holds one of the tested voxels.
    pub(super) fn piece_overlaps(
        &self,
        piece: &BrushPiece,
        tested: TestedVoxels<'_, N, K>,
    ) -> bool {
        let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
            return false;
        };
        let within: <Grid<N> as Size>::Row = BitSet::span(lo[0], hi[0]);
        let of_disc = self.find_row_of_disc(piece, (lo, hi), |(y, z), layer, (first, last)| {
            let layers = PieceLayers { piece: layer, bounding_ball: None };
            let candidates = self.rows.row(y, z) & BitSet::span(first, last);
            self.row_overlaps(layers, (y, z), candidates, tested)
        });
        if let Some(overlaps) = of_disc {
            return overlaps;
        }
        let ball = piece.bounding_ball_of_capsule();
        let (first_word, words) = (lo[0] / 64, lo[0] / 64 + 1..hi[0] / 64 + 1);
        let is_near = |row: &<Grid<N> as Size>::Row, i: usize| row.word(i) & within.word(i) != 0;
        (lo[1]..hi[1] + 1).any(|y| {
            let layer = piece.layer(y);
            let ball_layer = ball.as_ref().map(|ball| ball.layer(y));
            let layers = PieceLayers { piece: &layer, bounding_ball: ball_layer.as_ref() };
            let Some(z_range) = layer.z_range(N) else {
                return false;
            };
            let z_range = z_range.first()..z_range.last() + 1;
            let rows = iter::zip(z_range.start.., &self.rows.layer(y)[z_range.clone()]);
            // Early exit: most rows have no voxel within the bounds.
            match tested {
                TestedVoxels::AllOccupied => rows.into_iter().any(|(z, row)| {
                    (is_near(row, first_word) || words.clone().any(|i| is_near(row, i)))
                        && self.row_overlaps(layers, (y, z), *row & within, tested)
                }),
                TestedVoxels::OfMask(mask) => {
                    iter::zip(rows, &mask.line(Axis::X, y)[z_range]).any(|((z, row), held)| {
                        let held = held.hull();
                        held.first() <= hi[0]
                            && held.last() >= lo[0]
                            && self.row_overlaps(layers, (y, z), *row & within, tested)
                    })
                }
            }
        })
    }

    /// Returns `true` if `is_found` does for a row of a disc that has many short rows. Most of these have no
    /// voxel between the disc's planes and are skipped; `is_found` gets the others with their first and last
    /// voxel, which may be one voxel off. Returns `None` for discs without such rows, and for other pieces.
    fn find_row_of_disc(
        &self,
        piece: &BrushPiece,
        (lo, hi): ([usize; 3], [usize; 3]),
        mut is_found: impl FnMut(RowAddress, &BrushLayer<'_>, (usize, usize)) -> bool,
    ) -> Option<bool> {
        let BrushPiece::Disc(disc) = piece else {
            return None;
        };
        if !disc.has_slab_rows() {
            return None;
        }
        let within @ (first_x, last_x) = (lo[0], hi[0]);
        Some((lo[1]..hi[1] + 1).any(|y| {
            let layer = piece.layer(y);
            let Some(z_range) = layer.z_range(N) else {
                return false;
            };
            let Some(slab) = disc.slab_rows(voxel_centre_subunits(y), z_range.first()) else {
                return false;
            };
            let rows = &self.rows.layer(y)[z_range.first()..z_range.last() + 1];
            slab.find_row_holding(rows, within, |i, (first, last)| {
                let first = usize::try_from(first).map_or(first_x, |first| first.max(first_x));
                let voxels = (first, last_x.min(last as usize));
                is_found((y, z_range.first() + i), &layer, voxels)
            })
        }))
    }

    /// Returns `true` if a piece holds one of the tested voxels among the occupied voxels `candidates` of row
    /// (y, z).
    fn row_overlaps(
        &self,
        layers: PieceLayers<'_>,
        (y, z): RowAddress,
        candidates: <Grid<N> as Size>::Row,
        tested: TestedVoxels<'_, N, K>,
    ) -> bool {
        let near = match tested {
            TestedVoxels::AllOccupied => candidates,
            TestedVoxels::OfMask(mask) => {
                let held = mask.column(Axis::X, (y, z));
                if held.range(0).is_empty() {
                    return false;
                }
                candidates & held.to_row()
            }
        };
        let within = |near: <Grid<N> as Size>::Row, layer: &BrushLayer<'_>| match near.is_empty() {
            true => near,
            false => layer.x_range_among(z, &near, N).map_or(BitSet::EMPTY, |x_range| {
                near & BitSet::span(x_range.first(), x_range.last())
            }),
        };
        let near = layers.bounding_ball.map_or(near, |ball| within(near, ball));
        let inside = within(near, layers.piece);
        !inside.is_empty()
            && match tested {
                TestedVoxels::AllOccupied => true,
                TestedVoxels::OfMask(mask) => !mask.occupied_among((y, z), inside).is_empty(),
            }
    }

    /// Calls `visit` with the address and the occupied voxels of each row of a piece that holds any.
    pub(super) fn visit_occupied_rows(
        &self,
        piece: &BrushPiece,
        mut visit: impl FnMut(RowAddress, <Grid<N> as Size>::Row),
    ) {
        let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
            return;
        };
        let mut visit_near =
            |(y, z): RowAddress, layer: &BrushLayer<'_>, near: <Grid<N> as Size>::Row| {
                if let Some(x_range) = layer.x_range_among(z, &near, N) {
                    let inside = near & BitSet::span(x_range.first(), x_range.last());
                    let inside = self.holding_among((y, z), inside);
                    if !inside.is_empty() {
                        visit((y, z), inside);
                    }
                }
            };
        let of_disc = self.find_row_of_disc(piece, (lo, hi), |(y, z), layer, (first, last)| {
            visit_near((y, z), layer, self.rows.row(y, z) & BitSet::span(first, last));
            false
        });
        if of_disc.is_some() {
            return;
        }
        let within: <Grid<N> as Size>::Row = BitSet::span(lo[0], hi[0]);
        for y in lo[1]..hi[1] + 1 {
            let layer = piece.layer(y);
            let Some(z_range) = layer.z_range(N) else {
                continue;
            };
            let rows = &self.rows.layer(y)[z_range.first()..z_range.last() + 1];
            for (z, row) in iter::zip(z_range.first().., rows) {
                let near = *row & within;
                if !near.is_empty() {
                    visit_near((y, z), &layer, near);
                }
            }
        }
    }

    /// Returns the voxels of row (y, z) that the bit can collide with.
    fn holding_among(
        &self,
        (y, z): RowAddress,
        among: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        match self.is_mask_alone {
            false => among & self.rows.row(y, z),
            true => self.mask.map_or(BitSet::EMPTY, |mask| mask.occupied_among((y, z), among)),
        }
    }

    /// Returns the sum of the directions from voxels of row (y, z) to their empty six-neighbours.
    pub(super) fn sum_directions_to_empty(
        &self,
        (y, z): RowAddress,
        voxels: <Grid<N> as Size>::Row,
    ) -> IVec3 {
        // Inside stone there are none; testing for that is faster than counting.
        let empty = |row: <Grid<N> as Size>::Row| match voxels & !row {
            none if none.is_empty() => 0,
            some => some.count_ones() as i32,
        };
        let beside = |y: usize, z: usize| match y < N && z < N {
            true => empty(self.holding_among((y, z), voxels)),
            false => voxels.count_ones() as i32,
        };
        let here = self.holding_among((y, z), voxels.shifted_up() | voxels.shifted_down());
        IVec3::new(
            empty(here.shifted_down()) - empty(here.shifted_up()),
            beside(y + 1, z) - beside(y.wrapping_sub(1), z),
            beside(y, z + 1) - beside(y, z.wrapping_sub(1)),
        )
    }
}
