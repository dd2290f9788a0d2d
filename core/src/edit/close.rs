//! Closure after an edit: what all three ranges hold is occupied.

use super::pass::{Pass, span, voxels};
use super::{Line, Operation};
use crate::brush::Bounds;
use crate::maps::Axis;
use crate::row::{Bits, Row};
use crate::size::{Grid, Size};
use crate::volume::Journal;

impl<const N: usize, const W: usize, J: Journal<N>> Pass<'_, N, W, J>
where
    Grid<N>: Size,
{
    /// Brings back what was removed but all three ranges hold. It lies where columns along y and z
    /// that lost voxels cross.
    pub(super) fn close_holes(&mut self) {
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let Line { flipped, between, .. } = self.scratch.along_z[y];
            for z in voxels(between) {
                let along_x = self.volume.maps().column(Axis::X, (y, z)).hull();
                let among: Row<W> = span(self.first, along_x.lo(), along_x.hi())
                    & !self.volume.rows().row(y, z).part(self.first)
                    & flipped.part(0)
                    & self.scratch.along_y[z].flipped.part(0);
                if among.is_empty() {
                    continue;
                }
                let along_y = &self.volume.maps().line(Axis::Y, z)[64 * self.first..];
                let along_z = &self.volume.maps().line(Axis::Z, y)[64 * self.first..];
                let mut holes = Row::<W>::EMPTY;
                for x in among.ones() {
                    holes.insert_if(along_y[x].contains(y) & along_z[x].contains(z), x);
                }
                if !holes.is_empty() {
                    self.close_row(y, z, Bits::of_part(self.first, holes));
                }
            }
        }
    }

    /// Occupies what columns that grew brought into all three ranges.
    pub(super) fn close_beams(&mut self) {
        let Bounds { lo, hi } = self.bounds;
        for y in lo[1]..=hi[1] {
            for z in self.scratch.grown_x[y].ones() {
                self.close_row(y, z, Grid::<N>::FULL);
            }
            let Line { grown, growth, .. } = self.scratch.along_z[y];
            for z in voxels(growth) {
                self.close_row(y, z, grown);
            }
        }
        for z in lo[2]..=hi[2] {
            let Line { grown, growth, .. } = self.scratch.along_y[z];
            for y in voxels(growth) {
                self.close_row(y, z, grown);
            }
        }
    }

    #[inline]
    fn close_row(&mut self, y: usize, z: usize, window: <Grid<N> as Size>::Row) {
        let here = self.volume.rows().row(y, z);
        let among = window & !here;
        if among.is_empty() {
            return;
        }
        let missing = self.volume.maps().row_among((y, z), among);
        if missing.is_empty() {
            return;
        }
        let back = missing & self.at_start(y, z);
        let closed = missing & !back;
        self.report.removed -= back.count();
        self.report.refused_by_closure += back.count();
        self.report.closed += closed.count();
        if !closed.is_empty() {
            self.journal.added((y, z), closed);
        }
        *self.volume.rows_mut().row_mut(y, z) = here | missing;
    }

    /// Row (y, z) when the edit began, as far as closure can bring voxels back to it: a carve adds
    /// nothing, so all that comes back was there; a fill removes nothing, so none was; smoothing
    /// removed some only between the row's first flip and last.
    fn at_start(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        let flipped = || {
            (self.bounds.lo[1]..=self.bounds.hi[1]).contains(&y)
                && self.scratch.along_z[y].between.contains(z)
        };
        match self.edit.operation {
            Operation::Carve { .. } => Grid::<N>::FULL,
            Operation::Smooth if flipped() => {
                let start = self.scratch.start.as_flattened()[self.start_index(y, z)];
                Bits::of_part(self.first, start.part::<W>(0))
            }
            _ => <Grid<N> as Size>::Row::EMPTY,
        }
    }
}
