//! The columns of a file, of F intervals each, and their conversion into maps of K intervals per column.

use std::array;

use paros_core::RangeMaps;
use paros_core::internals::HoleScan;
use paros_core::volume::{Axis, BitSet, Column, Grid, Range, Size};

use super::{HEADER_BYTES, RmapFault, RmapFaultAt};

/// The columns of a file, F intervals each.
pub(super) struct FileColumns<const N: usize, const F: usize> {
    /// The columns in the order of axis, line and place.
    columns: Vec<Column<F>>,
}

impl<const N: usize, const F: usize> FileColumns<N, F>
where
    Grid<N>: Size,
{
    /// Decodes and checks the bytes of the columns, and writes them into maps of K intervals. Returns the
    /// number of empty voxels that this fills; it is 0 if K is at least F. On a fault `maps` is unchanged.
    pub(super) fn decode_into<const K: usize>(
        bytes: &[u8],
        maps: &mut RangeMaps<N, K>,
    ) -> Result<u64, RmapFaultAt> {
        let file = Self::decode(bytes)?;
        file.check_tightness()?;
        // Maps of one interval per column are always saturated; with as many intervals as the file, columns
        // are copied unchanged.
        let voxels = (F > 1 || F != K).then(|| file.voxels());
        if let Some(voxels) = &voxels {
            file.check_saturation(voxels)?;
        }
        for (axis, address) in column_addresses::<N>() {
            maps.set_column(axis, address, file.column_or_hull(axis, address));
        }
        if let Some(voxels) = voxels.filter(|_| F != K) {
            voxels.visit_columns_with_holes(|axis, address, occupied| {
                let held = if F < K { file.column_or_hull(axis, address) } else { Column::EMPTY };
                maps.set_column(axis, address, Column::closed_over(occupied, &held));
            });
            if F > K {
                return Ok(count_voxels(maps) - voxels.count());
            }
        }
        Ok(0)
    }

    /// Decodes the columns, and checks each by itself.
    fn decode(bytes: &[u8]) -> Result<Self, RmapFaultAt> {
        let (columns, _) = bytes.as_chunks::<2>().0.as_chunks::<F>();
        let columns = column_addresses::<N>()
            .zip(columns)
            .map(|((axis, address), bytes)| Self::decode_column(axis, address, *bytes))
            .collect::<Result<_, _>>()?;
        Ok(FileColumns { columns })
    }

    fn decode_column(
        axis: Axis,
        address: (usize, usize),
        bytes: [[u8; 2]; F],
    ) -> Result<Column<F>, RmapFaultAt> {
        let mut column = Column::EMPTY;
        for (i, bytes) in bytes.into_iter().enumerate() {
            let bad = |fault| RmapFaultAt { offset: Self::file_offset(axis, address, i), fault };
            let found = Range::from_bytes(bytes, N)
                .ok_or_else(|| bad(RmapFault::Range { axis, address, bytes }))?;
            if i > 0 && !found.is_empty() {
                let below = column.range(i - 1);
                if below.is_empty() || found.first() <= below.last() + 1 {
                    return Err(bad(RmapFault::Order { axis, address, below, found }));
                }
            }
            column.set_range(i, found);
        }
        Ok(column)
    }

    /// Returns the offset of a column's interval from the start of the file.
    fn file_offset(axis: Axis, (line, place): (usize, usize), interval: usize) -> usize {
        HEADER_BYTES + 2 * (F * ((axis as usize * N + line) * N + place) + interval)
    }

    fn column(&self, axis: Axis, (line, place): (usize, usize)) -> &Column<F> {
        &self.columns[(axis as usize * N + line) * N + place]
    }

    /// Returns a column in K intervals, or its hull if K is less than F.
    fn column_or_hull<const K: usize>(&self, axis: Axis, address: (usize, usize)) -> Column<K> {
        let column = self.column(axis, address);
        if F > K {
            return Column::from_range(column.hull());
        }
        Column::new(array::from_fn(|i| if i < F { column.range(i) } else { Range::EMPTY }))
    }

    /// Checks that every range is tight: both its ends are occupied. No voxel outside it can be.
    fn check_tightness(&self) -> Result<(), RmapFaultAt> {
        for (axis, address) in column_addresses::<N>() {
            for (interval, range) in self.column(axis, address).intervals().enumerate() {
                for (byte, end) in [range.first(), range.last()].into_iter().enumerate() {
                    let voxel = axis.voxel_at(address, end);
                    if let Some(missing) = self.first_axis_not_holding(voxel) {
                        let fault = RmapFault::Loose { axis, voxel, missing };
                        let offset = Self::file_offset(axis, address, interval) + byte;
                        return Err(RmapFaultAt { offset, fault });
                    }
                }
            }
        }
        Ok(())
    }

    /// Returns the first axis along which the column through a voxel does not hold the voxel.
    fn first_axis_not_holding(&self, voxel: [usize; 3]) -> Option<Axis> {
        let holds = |axis: Axis| {
            self.column(axis, axis.column_address(voxel)).contains(voxel[axis as usize])
        };
        Axis::ALL.into_iter().find(|&axis| !holds(axis))
    }

    /// Checks that a column with room for another gap has no other empty voxel inside its hull.
    fn check_saturation(&self, voxels: &FileVoxels<N>) -> Result<(), RmapFaultAt> {
        let mut found = Ok(());
        voxels.visit_columns_with_holes(|axis, address, occupied| {
            let column = self.column(axis, address);
            let empty = column.to_row::<<Grid<N> as Size>::Row>() & !occupied;
            if let Some(hole) = empty.first()
                && F > 1
                && column.range(F - 1).is_empty()
                && found.is_ok()
            {
                let fault = RmapFault::Unsaturated { axis, voxel: axis.voxel_at(address, hole) };
                found = Err(RmapFaultAt { offset: Self::file_offset(axis, address, 0), fault });
            }
        });
        found
    }

    /// Returns the voxels that all three columns hold. Scan conversion by parity: each range toggles its
    /// column's bit at its first voxel and after its last.
    fn voxels(&self) -> FileVoxels<N> {
        let x_columns = self.columns[..N * N].iter();
        let mut voxels = FileVoxels { rows: x_columns.map(Column::to_row).collect() };
        let mut toggles = vec![<Grid<N> as Size>::Row::EMPTY; N + 1];
        for (axis, line) in [Axis::Y, Axis::Z].into_iter().flat_map(|a| (0..N).map(move |l| (a, l)))
        {
            toggles.fill(BitSet::EMPTY);
            for place in 0..N {
                for range in self.column(axis, (line, place)).intervals() {
                    toggles[range.first()].toggle(place);
                    toggles[range.last() + 1].toggle(place);
                }
            }
            let mut places = <Grid<N> as Size>::Row::EMPTY;
            for (i, toggled) in toggles[..N].iter().enumerate() {
                places ^= *toggled;
                voxels.rows[FileVoxels::<N>::row_index(axis, line, i)] &= places;
            }
        }
        voxels
    }
}

/// Returns the addresses of all columns, in the order of the file.
fn column_addresses<const N: usize>() -> impl Iterator<Item = (Axis, (usize, usize))> {
    Axis::ALL.into_iter().flat_map(|axis| (0..N * N).map(move |i| (axis, (i / N, i % N))))
}

fn count_voxels<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> u64
where
    Grid<N>: Size,
{
    let occupied = |i| maps.occupied_among((i / N, i % N), Grid::<N>::FULL);
    (0..N * N).map(|i| u64::from(occupied(i).count_ones())).sum()
}

/// The voxels of a file: bit rows along x, by y and z.
struct FileVoxels<const N: usize>
where
    Grid<N>: Size,
{
    rows: Vec<<Grid<N> as Size>::Row>,
}

impl<const N: usize> FileVoxels<N>
where
    Grid<N>: Size,
{
    /// Returns the index of the row across a line of columns along y or z, at voxel `i` of each.
    const fn row_index(axis: Axis, line: usize, i: usize) -> usize {
        if matches!(axis, Axis::Y) { i * N + line } else { line * N + i }
    }

    fn count(&self) -> u64 {
        self.rows.iter().map(|row| u64::from(row.count_ones())).sum()
    }

    /// Visits the columns that have empty voxels inside their hull, with their occupied voxels, in the order
    /// of the file.
    fn visit_columns_with_holes(
        &self,
        mut visit: impl FnMut(Axis, (usize, usize), <Grid<N> as Size>::Row),
    ) {
        for (i, row) in self.rows.iter().enumerate() {
            if Range::hull_of(*row).to_row::<<Grid<N> as Size>::Row>() != *row {
                visit(Axis::X, (i / N, i % N), *row);
            }
        }
        for axis in [Axis::Y, Axis::Z] {
            for line in 0..N {
                let row = |i| self.rows[Self::row_index(axis, line, i)];
                let mut holes = HoleScan::NONE;
                (0..N).for_each(|i| holes.pass(row(i)));
                for place in holes.found.iter_ones() {
                    let mut occupied = <Grid<N> as Size>::Row::EMPTY;
                    (0..N).for_each(|i| occupied.insert_if(row(i).contains(place), i));
                    visit(axis, (line, place), occupied);
                }
            }
        }
    }
}
