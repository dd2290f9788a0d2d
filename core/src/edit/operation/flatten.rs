//! Flattening: removes voxels above a plane and fills pits below it from their floor.

use super::EditOperation;
use super::pass::EditPass;
use crate::edit::half_space::HalfSpace;
use crate::limits::SHELL_DEPTH;
use crate::volume::range::Range;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

impl<const N: usize, const K: usize, const W: usize> EditPass<'_, N, K, W>
where
    Grid<N>: Size,
{
    /// Replaces the brush's voxels of layer `y`, which are in the flips' memory, by the flips. Layers come in
    /// ascending order.
    pub(super) fn flatten_layer(&mut self, y: usize, z_range: Range) {
        let EditOperation::Flatten { above, .. } = self.edit.operation else { return };
        self.keep_rows_of_layer(y);
        for z in z_range.first()..z_range.last() + 1 {
            let brush: BitRow<W> = self.scratch.pending[y % (SHELL_DEPTH + 1)][z].word_span(0);
            if brush.is_empty() {
                continue;
            }
            let here: BitRow<W> = self.volume.rows().row(y, z).word_span(self.first_word);
            let above_plane = self.words_above((y, z), above);
            let removed = brush & here & above_plane;
            let removed = self.report.exclude_masked(self.mask, (y, z), self.first_word, removed);
            let filled = self.voxels_in_pits((y, z), above, brush & !here & !above_plane);
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            flips.set_word_span(0, removed | filled);
        }
    }

    /// Returns the voxels of row (y, z) above the plane. In the upper half of a mirrored edit, the mirror
    /// images decide.
    fn words_above(&self, (y, z): RowAddress, above: HalfSpace) -> BitRow<W> {
        let row = above.row::<N>(y, z);
        if !self.edit.mirrored {
            return row.word_span(self.first_word);
        }
        let lower: <Grid<N> as Size>::Row = BitSet::span(0, N / 2 - 1);
        let lower = row & lower;
        (lower | lower.mirrored(N)).word_span(self.first_word)
    }

    /// Returns the empty voxels `among` of a row that lie on the floor of a pit.
    fn voxels_in_pits(&self, (y, z): RowAddress, above: HalfSpace, among: BitRow<W>) -> BitRow<W> {
        if among.is_empty() {
            return among;
        }
        let (axis, points_up) = above.dominant_axis();
        let on_floor = among & self.neighbours_beneath((y, z), axis, points_up);
        if on_floor.is_empty() {
            return on_floor;
        }
        let reach = self.edit.operation.neighbourhood_radius();
        let walls = |other: usize| match other {
            _ if other == axis => BitRow::EMPTY,
            0 => self.walled_along_x((y, z), reach),
            1 => {
                let below =
                    (1..=reach).map(|step| self.row_from_start((y, z), -(step as isize), 0));
                let above = (1..=reach).map(|step| self.row_from_start((y, z), step as isize, 0));
                union(below) & union(above)
            }
            _ => {
                let before =
                    (1..=reach).map(|step| self.row_from_start((y, z), 0, -(step as isize)));
                let behind = (1..=reach).map(|step| self.row_from_start((y, z), 0, step as isize));
                union(before) & union(behind)
            }
        };
        on_floor & (walls(0) | walls(1) | walls(2))
    }

    /// Returns the voxels of a row with an occupied neighbour beneath them. `axis` is the axis nearest to the
    /// plane's normal, which points up along it if `points_up`.
    fn neighbours_beneath(&self, (y, z): RowAddress, axis: usize, points_up: bool) -> BitRow<W> {
        let step = if points_up { -1 } else { 1 };
        match axis {
            0 => {
                let here = self.row_from_start((y, z), 0, 0);
                let [from_below, from_above] = [here.shifted_up(), here.shifted_down()];
                let [lower, upper] =
                    if points_up { [from_below, from_above] } else { [from_above, from_below] };
                if !self.edit.mirrored {
                    return lower;
                }
                let half: <Grid<N> as Size>::Row = BitSet::span(0, N / 2 - 1);
                let half: BitRow<W> = half.word_span(self.first_word);
                lower & half | upper & !half
            }
            1 => self.row_from_start((y, z), step, 0),
            _ => self.row_from_start((y, z), 0, step),
        }
    }

    /// Returns the voxels of a row with occupied voxels on both sides within `reach` along x.
    fn walled_along_x(&self, (y, z): RowAddress, reach: usize) -> BitRow<W> {
        let here = self.row_from_start((y, z), 0, 0);
        let [mut up, mut down] = [here; 2];
        let [mut from_below, mut from_above] = [BitRow::EMPTY; 2];
        for _ in 0..reach {
            (up, down) = (up.shifted_up(), down.shifted_down());
            (from_below, from_above) = (from_below | up, from_above | down);
        }
        from_below & from_above
    }

    /// Returns the row `up` layers above layer `y` and `behind` rows behind row `z`, as it was when the edit
    /// began: full below the ground, empty elsewhere outside the grid.
    fn row_from_start(&self, (y, z): RowAddress, up: isize, behind: isize) -> BitRow<W> {
        let (Some(at_z), at_y) = (z.checked_add_signed(behind), y.checked_add_signed(up)) else {
            return BitRow::EMPTY;
        };
        match at_y {
            None => !BitRow::EMPTY,
            Some(at_y) if at_y >= N || at_z >= N => BitRow::EMPTY,
            Some(at_y) if at_y < y => self.row_at_start((at_y, at_z)),
            Some(at_y) => self.volume.rows().row(at_y, at_z).word_span(self.first_word),
        }
    }
}

fn union<const W: usize>(rows: impl Iterator<Item = BitRow<W>>) -> BitRow<W> {
    rows.fold(BitRow::EMPTY, |all, row| all | row)
}
