//! Islands: grow the supported voxels row by row from ground and mask, then drop what was missed.
//!
//! A pass keeps one plane beside the volume, the voxels *reached* so far, and a set of queued rows,
//! one bit a row, which a cursor sweeps in order and round again. A visit extends what is reached
//! along the row by whole runs and queues the neighbour rows that this touches. Between visits the
//! volume may change: what an edit adds counts as reached at once, what it removes stays reached.
//! So the reached set only grows, a row is queued only by its growth, and every pass ends.
//!
//! In any row that isn't queued no voxel of `volume & !reached` is a six-neighbour of a reached
//! one. Removing voxels from the volume keeps that true, growth of the reached set queues the rows
//! in which it stops being true, and when the queue is empty it says that everything connected to
//! ground or mask is reached. Source: section 3.4 of the paper, which visits voxel by voxel.

use crate::codec::{BadBytes, Reader, Writer};
use crate::maps::{Axis, Column, Maps, Range};
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume, mix};

/// What a finished pass did.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct IslandReport {
    /// Voxels removed.
    pub removed: u32,
    /// Unsupported voxels that stay because the ranges can't leave them out; 0 when they are the
    /// same as after the pass before.
    pub kept: u32,
    /// Neither ground layer nor mask holds a voxel: nothing can be told apart, nothing went.
    pub unsupported: bool,
}

/// What the pass is at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
enum Phase {
    Idle = 0,
    Sweep = 1,
}

/// The search for islands in a volume of N^3 voxels, at most one pass in flight.
#[derive(Debug)]
pub struct Islands<const N: usize>
where
    Grid<N>: Size,
{
    /// Voxels found supported, or added since the pass began.
    reached: Plane<N>,
    /// Rows to visit: bit z of `queued[y]` is row (y, z).
    queued: [<Grid<N> as Size>::Row; N],
    /// Layers that hold queued rows.
    layers: <Grid<N> as Size>::Row,
    /// The sum over the words of `reached`, each times its key.
    reached_sum: u128,
    /// The same for the voxels last reported as kept.
    kept_sum: u128,
    /// The row (y, z) from which the sweep goes on.
    cursor: (u8, u8),
    phase: Phase,
    /// Whether an edit calls for a pass that hasn't begun.
    pending: bool,
}

impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// Idle. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the plane about by value
    pub const fn new() -> Self {
        Islands {
            reached: Plane::new(),
            queued: [<Grid<N> as Size>::Row::EMPTY; N],
            layers: <Grid<N> as Size>::Row::EMPTY,
            reached_sum: 0,
            kept_sum: 0,
            cursor: (0, 0),
            phase: Phase::Idle,
            pending: false,
        }
    }

    /// The volume was edited: a pass must begin after this. One in flight goes on and is followed
    /// by another.
    pub fn edited(&mut self) {
        self.pending = true;
    }

    /// Voxels of row (y, z) are about to be occupied; see [`Journal::added`].
    pub fn added(&mut self, (y, z): (usize, usize), voxels: <Grid<N> as Size>::Row) {
        // Voxels that are reached already have had their neighbours queued: queueing them again
        // would let a visitor who fills and carves one voxel for ever keep the pass from ending.
        let new = voxels & !self.reached.row(y, z);
        if self.phase == Phase::Idle || new.is_empty() {
            return;
        }
        self.reach(y, z, new);
        self.queue(y, z);
        for (y, z) in neighbours::<N>(y, z) {
            self.queue(y, z);
        }
    }

    /// Gives up the pass in flight and forgets the edits that called for one, as the volume was
    /// replaced as a whole.
    pub fn abort(&mut self) {
        self.stop();
        self.pending = false;
    }

    /// Whether a pass is in flight or called for.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending || matches!(self.phase, Phase::Sweep)
    }

    /// Begins a pass if one is called for, and carries it on by at most `budget` row visits. When
    /// it ends, all islands go at once and its report comes back. The removal is left to the next
    /// call if the visits left to this one are fewer than [`removal_visits`].
    ///
    /// `mask` is part of the volume and the same throughout a pass.
    pub fn advance(
        &mut self,
        volume: &mut Volume<N>,
        mask: &Maps<N>,
        budget: u32,
        journal: &mut impl Journal<N>,
    ) -> Option<IslandReport> {
        if self.phase == Phase::Idle {
            if !self.pending {
                return None;
            }
            self.pending = false;
            if unsupported(volume, mask) {
                return Some(IslandReport { unsupported: true, ..Default::default() });
            }
            self.begin(volume.rows(), mask);
        }
        let waited = self.layers.is_empty();
        let left = self.sweep(volume.rows(), budget);
        if !self.layers.is_empty() || (left < removal_visits(N) && !waited) {
            return None;
        }
        let report = if unsupported(volume, mask) {
            IslandReport { unsupported: true, ..Default::default() }
        } else {
            self.remove(volume, journal)
        };
        self.stop();
        Some(report)
    }
}

/// Row visits that the work of a removal is worth at most.
#[must_use]
pub const fn removal_visits(n: usize) -> u32 {
    (n * n / 4) as u32
}

/// The pass.
impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// The ground layer and the mask are reached; their neighbours are queued.
    fn begin(&mut self, rows: &Plane<N>, mask: &Maps<N>) {
        let seeded = if mask.is_empty() {
            self.reached.clear();
            1
        } else {
            self.reached.expand(mask);
            N
        };
        self.reached.layer_mut(0).copy_from_slice(rows.layer(0));
        self.reached_sum = 0;
        self.cursor = (0, 0);
        self.phase = Phase::Sweep;
        for y in 0..seeded {
            for z in 0..N {
                let seeds = self.reached.row(y, z);
                if seeds.is_empty() {
                    continue;
                }
                self.reached_sum = self.reached_sum.wrapping_add(keyed::<N>(y, z, seeds));
                self.wake_neighbours(rows, y, z, seeds);
                if !(rows.row(y, z) & !seeds & (seeds.up() | seeds.down())).is_empty() {
                    self.queue(y, z);
                }
            }
        }
    }

    /// Visits queued rows in order from the cursor and round again; the visits left come back.
    fn sweep(&mut self, rows: &Plane<N>, budget: u32) -> u32 {
        let mut left = budget;
        let (mut y, mut from) = (usize::from(self.cursor.0), usize::from(self.cursor.1));
        while left > 0 {
            let Some(layer) = next(self.layers, y) else { break };
            if layer != y {
                (y, from) = (layer, 0);
            }
            while left > 0
                && let Some(z) = at_or_after(self.queued[y], from)
            {
                self.queued[y].toggle(z);
                self.visit(rows, y, z);
                from = z + 1;
                left -= 1;
            }
            if self.queued[y].is_empty() {
                self.layers.toggle(y);
            }
            if left > 0 {
                (y, from) = ((y + 1) % N, 0);
            }
        }
        self.cursor = (y as u8, (from % N) as u8);
        left
    }

    /// Reaches the runs of row (y, z) that touch what is reached already.
    #[inline]
    fn visit(&mut self, rows: &Plane<N>, y: usize, z: usize) {
        let reached = self.reached.row(y, z);
        let medium = rows.row(y, z) & !reached;
        if medium.is_empty() {
            return;
        }
        let mut seeds = reached.up() | reached.down();
        for (y, z) in neighbours::<N>(y, z) {
            seeds |= self.reached.row(y, z);
        }
        let new = medium.runs_with(seeds);
        if !new.is_empty() {
            self.reach(y, z, new);
            self.wake_neighbours(rows, y, z, new);
        }
    }

    /// Queues the neighbour rows that have something left beside the voxels `new` of row (y, z).
    #[inline]
    fn wake_neighbours(
        &mut self,
        rows: &Plane<N>,
        y: usize,
        z: usize,
        new: <Grid<N> as Size>::Row,
    ) {
        for (y, z) in neighbours::<N>(y, z) {
            if !(rows.row(y, z) & !self.reached.row(y, z) & new).is_empty() {
                self.queue(y, z);
            }
        }
    }

    /// Adds voxels that weren't reached.
    #[inline]
    fn reach(&mut self, y: usize, z: usize, new: <Grid<N> as Size>::Row) {
        *self.reached.row_mut(y, z) |= new;
        self.reached_sum = self.reached_sum.wrapping_add(keyed::<N>(y, z, new));
    }

    #[inline]
    fn queue(&mut self, y: usize, z: usize) {
        self.queued[y].insert(z);
        self.layers.insert(y);
    }

    /// Forgets the pass in flight.
    fn stop(&mut self) {
        self.queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.layers = <Grid<N> as Size>::Row::EMPTY;
        self.reached_sum = 0;
        self.cursor = (0, 0);
        self.phase = Phase::Idle;
    }

    /// The volume becomes the closure of what is reached of it. Uses the queue, which is empty, to
    /// remember which rows lose voxels.
    fn remove(&mut self, volume: &mut Volume<N>, journal: &mut impl Journal<N>) -> IslandReport {
        let mut along_y = [<Grid<N> as Size>::Row::EMPTY; N];
        let mut missed = 0;
        for y in 0..N {
            let mut along_z = <Grid<N> as Size>::Row::EMPTY;
            for z in 0..N {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let islands = here & !reached;
                if islands.is_empty() {
                    continue;
                }
                missed += islands.count();
                along_y[z] |= islands;
                along_z |= islands;
                self.queued[y].insert(z);
                let range = Range::hull(here & reached);
                volume.set_column(Axis::X, (y, z), Column([range]), journal);
            }
            self.tighten_line(volume, Axis::Z, y, along_z, journal);
        }
        if missed == 0 {
            self.kept_sum = 0;
            return IslandReport::default();
        }
        for (z, columns) in along_y.into_iter().enumerate() {
            self.tighten_line(volume, Axis::Y, z, columns, journal);
        }
        let (kept, kept_sum) = self.close(volume, missed);
        let known = kept_sum == self.kept_sum;
        self.kept_sum = kept_sum;
        let removed = missed - kept;
        IslandReport { removed, kept: if known { 0 } else { kept }, unsupported: false }
    }

    /// Tightens columns of a line to what is reached of them.
    fn tighten_line(
        &self,
        volume: &mut Volume<N>,
        axis: Axis,
        line: usize,
        columns: <Grid<N> as Size>::Row,
        journal: &mut impl Journal<N>,
    ) {
        if columns.is_empty() {
            return;
        }
        let mut within = Range::EMPTY;
        for place in columns.ones() {
            within = within.hull_with(volume.maps().column(axis, (line, place)).hull());
        }
        let reached = |i| {
            let (y, z) = if axis == Axis::Y { (i, line) } else { (line, i) };
            volume.rows().row(y, z) & self.reached.row(y, z)
        };
        let (mut lo, mut hi) = ([0; N], [0; N]);
        let empty = first_in(columns, within.lo()..=within.hi(), reached, &mut lo);
        first_in(columns & !empty, (within.lo()..=within.hi()).rev(), reached, &mut hi);
        for place in columns.ones() {
            let range = match empty.contains(place) {
                true => Range::EMPTY,
                false => Range::new(lo[place].into(), hi[place].into()),
            };
            volume.set_column(axis, (line, place), Column([range]), journal);
        }
    }

    /// Makes the rows follow the maps. Counts the voxels that closure keeps, and sums them up.
    fn close(&mut self, volume: &mut Volume<N>, missed: u32) -> (u32, u128) {
        // Voxel by voxel for few, all columns at once for many.
        let many = missed as usize > 4 * N * N;
        if many {
            volume.restore_rows();
        }
        let (mut kept, mut sum) = (0, 0u128);
        for y in 0..N {
            for z in self.queued[y].ones() {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let mut closed = here & !reached;
                if !many {
                    closed = volume.maps().row_among((y, z), closed);
                    *volume.rows_mut().row_mut(y, z) = here & reached | closed;
                }
                kept += closed.count();
                sum = sum.wrapping_add(keyed::<N>(y, z, closed));
            }
        }
        (kept, sum)
    }
}

/// State as bytes, and its digest.
impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// Digest of all that later passes can see. The reached voxels' part is kept up as they grow;
    /// the queue, N x N bits, is added to it here.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest_with(self.reached_sum)
    }

    /// The same, with nothing taken from sums kept up.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut sum = 0u128;
        if self.phase == Phase::Sweep {
            for y in 0..N {
                for (z, row) in self.reached.layer(y).iter().enumerate() {
                    sum = sum.wrapping_add(keyed::<N>(y, z, *row));
                }
            }
        }
        self.digest_with(sum)
    }

    fn digest_with(&self, reached_sum: u128) -> u64 {
        let mut sum = reached_sum;
        if self.phase == Phase::Sweep {
            for (y, row) in self.queued.iter().enumerate() {
                sum = sum.wrapping_add(keyed::<N>(N, y, *row));
            }
        }
        let flags = [self.phase as u8, self.pending.into(), self.cursor.0, self.cursor.1];
        let mut digest = mix(u32::from_le_bytes(flags).into());
        for part in [sum, self.kept_sum] {
            digest = mix(digest ^ part as u64);
            digest = mix(digest ^ (part >> 64) as u64);
        }
        digest
    }

    /// Writes the state: flags, the kept voxels' sum, and in flight the cursor, then for each layer
    /// its queued rows and which rows hold reached voxels, as N bits each, then those rows.
    pub fn save(&self, out: &mut Writer<'_>) {
        out.u8(self.phase as u8 | u8::from(self.pending) << 1);
        out.bytes(&self.kept_sum.to_le_bytes());
        if self.phase == Phase::Idle {
            return;
        }
        out.bytes(&[self.cursor.0, self.cursor.1]);
        for (y, queued) in self.queued.iter().enumerate() {
            let mut held = <Grid<N> as Size>::Row::EMPTY;
            for (z, row) in self.reached.layer(y).iter().enumerate() {
                if !row.is_empty() {
                    held.insert(z);
                }
            }
            write_row(out, *queued);
            write_row(out, held);
            for z in held.ones() {
                write_row(out, self.reached.row(y, z));
            }
        }
    }

    /// Reads what [`Islands::save`] wrote, and goes on exactly from there.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes end early or say what no pass does; no pass is in flight then.
    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.abort();
        self.kept_sum = 0;
        let flags = bytes.u8()?;
        if flags > 3 {
            return Err(bytes.bad("flags of an island pass"));
        }
        let mut sum = [0; 16];
        sum.copy_from_slice(bytes.bytes(16)?);
        if flags & 1 != 0 {
            self.load_pass(bytes).inspect_err(|_| self.stop())?;
            self.phase = Phase::Sweep;
        }
        self.kept_sum = u128::from_le_bytes(sum);
        self.pending = flags & 2 != 0;
        Ok(())
    }

    fn load_pass(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.cursor = (bytes.u8()?, bytes.u8()?);
        if self.cursor.0.max(self.cursor.1) as usize >= N {
            return Err(bytes.bad("a row of the grid"));
        }
        self.reached.clear();
        for y in 0..N {
            self.queued[y] = read_row::<N>(bytes)?;
            if !self.queued[y].is_empty() {
                self.layers.insert(y);
            }
            for z in read_row::<N>(bytes)?.ones() {
                let row = read_row::<N>(bytes)?;
                if row.is_empty() {
                    return Err(bytes.bad("a row that holds voxels"));
                }
                self.reach(y, z, row);
            }
        }
        Ok(())
    }
}

/// Whether no voxel stands on the ground layer and none is masked.
fn unsupported<const N: usize>(volume: &Volume<N>, mask: &Maps<N>) -> bool
where
    Grid<N>: Size,
{
    !volume.touches_ground() && mask.is_empty()
}

/// The rows that share a side with row (y, z).
#[inline]
fn neighbours<const N: usize>(y: usize, z: usize) -> impl Iterator<Item = (usize, usize)> {
    let below = (y > 0).then(|| (y - 1, z));
    let above = (y + 1 < N).then_some((y + 1, z));
    let before = (z > 0).then(|| (y, z - 1));
    let after = (z + 1 < N).then_some((y, z + 1));
    [below, above, before, after].into_iter().flatten()
}

/// The lowest set bit from `from` on.
#[inline]
fn at_or_after<R: Bits>(row: R, from: usize) -> Option<usize> {
    let mut word = from / 64;
    let mut bits = if word < R::WORDS { row.word(word) & u64::MAX << (from % 64) } else { 0 };
    while bits == 0 {
        word += 1;
        if word >= R::WORDS {
            return None;
        }
        bits = row.word(word);
    }
    Some(word * 64 + bits.trailing_zeros() as usize)
}

/// The lowest set bit from `from` on, else the lowest of all.
#[inline]
fn next<R: Bits>(row: R, from: usize) -> Option<usize> {
    at_or_after(row, from).or_else(|| row.first())
}

/// Walks rows in the order given and notes where each of `columns` is first set. Returns those
/// that nowhere are.
#[inline]
fn first_in<R: Bits, const N: usize>(
    mut columns: R,
    order: impl Iterator<Item = usize>,
    row: impl Fn(usize) -> R,
    found_at: &mut [u8; N],
) -> R {
    for i in order {
        if columns.is_empty() {
            break;
        }
        let found = columns & row(i);
        for place in found.ones() {
            found_at[place] = i as u8;
        }
        columns &= !found;
    }
    columns
}

/// The sum of a row's words, each times its own key. Linear in disjoint voxels.
#[inline]
fn keyed<const N: usize>(y: usize, z: usize, row: <Grid<N> as Size>::Row) -> u128
where
    Grid<N>: Size,
{
    let key = mix((y * N + z + 1) as u64);
    let mut sum = 0u128;
    for i in 0..<Grid<N> as Size>::Row::WORDS {
        let key = key.rotate_left(13 * i as u32) | 1;
        sum = sum.wrapping_add(u128::from(row.word(i)) * u128::from(key));
    }
    sum
}

fn write_row<R: Bits>(out: &mut Writer<'_>, row: R) {
    for i in 0..R::WORDS {
        out.u64(row.word(i));
    }
}

fn read_row<const N: usize>(bytes: &mut Reader<'_>) -> Result<<Grid<N> as Size>::Row, BadBytes>
where
    Grid<N>: Size,
{
    let mut row = <Grid<N> as Size>::Row::EMPTY;
    for i in 0..<Grid<N> as Size>::Row::WORDS {
        row.set_word(i, bytes.u64()?);
    }
    if (row & !Grid::<N>::FULL).is_empty() { Ok(row) } else { Err(bytes.bad("bits of the grid")) }
}
