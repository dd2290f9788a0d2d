//! Undo and redo against whole copies of the maps, with island removals in between.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::codec::{Reader, Writer};
use paros_core::dirty::Dirty;
use paros_core::edit::{self, Edit, EditScratch, Operation};
use paros_core::islands::Islands;
use paros_core::limits::UNDO_ENTRIES;
use paros_core::maps::{Axis, Column, Maps};
use paros_core::plane::Plane;
use paros_core::pose::SUB;
use paros_core::size::{Grid, Size};
use paros_core::undo::Undo;
use paros_core::volume::{Journal, Volume, maps_digest};
use paros_tests::models::undo::History;
use proptest::prelude::*;

struct Bench<const N: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N>,
    none: Maps<N>,
    islands: Islands<N>,
    scratch: EditScratch<N>,
    undo: Undo<N>,
    spare: Undo<N>,
    plane: Plane<N>,
    stale: Maps<N>,
}

/// Records an edit in the ring, or adds a removal to its newest entry.
struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    undo: &'a mut Undo<N>,
    late: bool,
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn column(&mut self, axis: Axis, at: (usize, usize), old: Column) {
        match self.late {
            true => self.undo.amend(axis, at, old),
            false => self.undo.record(axis, at, old),
        }
    }

    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        columns: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        assert!(self.late, "edits tell of single columns");
        self.undo.amend_line(axis, line, columns, old);
    }

    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}

impl<const N: usize> Bench<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Bench {
            volume: Volume::new(),
            none: Maps::new(),
            islands: Islands::new(),
            scratch: EditScratch::new(),
            undo: Undo::new(),
            spare: Undo::new(),
            plane: Plane::new(),
            stale: Maps::new(),
        }
    }

    /// A block on the ground, and no history.
    fn reset(&mut self) -> History<N> {
        self.volume.set_voxels(|plane| {
            for y in 0..N * 3 / 4 {
                plane.layer_mut(y)[2..N - 2].fill(Grid::<N>::FULL);
            }
        });
        self.undo.clear();
        self.islands.abort();
        History::new(self.volume.maps())
    }

    /// Whether the volume changed.
    fn edit(&mut self, brush: &Brush, operation: Operation) -> bool {
        let edit = Edit { brush, operation, mirrored: false };
        let mut log = Log { undo: &mut self.undo, late: false };
        let scratch = &mut self.scratch;
        let report = edit::apply(&mut self.volume, &self.none, &edit, scratch, &mut log);
        report.is_ok_and(|report| report.changed())
    }

    /// Whether islands went.
    fn clear_islands(&mut self) -> bool {
        self.islands.edited();
        let mut log = Log { undo: &mut self.undo, late: true };
        let report = self.islands.advance(&mut self.volume, &self.none, u32::MAX, &mut log);
        report.is_some_and(|report| report.removed > 0)
    }

    /// The volume is exactly that of `maps`, and all that is kept up beside it is right.
    fn check(&mut self, maps: &Maps<N>) -> Result<(), TestCaseError> {
        prop_assert!(self.volume.maps() == maps, "the maps differ");
        self.plane.expand(maps);
        prop_assert!(self.volume.rows() == &self.plane, "the rows differ");
        prop_assert_eq!(self.volume.digest(), maps_digest(maps));
        Ok(())
    }

    /// Saved, read into another ring and saved again: the same bytes and digest.
    fn check_saved(&mut self) -> Result<(), TestCaseError> {
        prop_assert_eq!(self.undo.digest(), self.undo.recompute_digest());
        let bytes = saved(&self.undo);
        let mut reader = Reader::new(&bytes);
        prop_assert_eq!(self.spare.load(&mut reader), Ok(()));
        prop_assert_eq!(reader.end(), Ok(()));
        prop_assert_eq!(self.spare.digest(), self.undo.digest());
        prop_assert_eq!(saved(&self.spare), bytes);
        std::mem::swap(&mut self.undo, &mut self.spare);
        Ok(())
    }

    /// Undoes or redoes; the dirty rectangles must turn the old maps into the new ones.
    fn step(&mut self, back: bool) -> Result<bool, TestCaseError> {
        let mut dirty = Dirty::new();
        self.stale.copy_from(self.volume.maps());
        let stepped = match back {
            true => self.undo.undo(&mut self.volume, &mut dirty),
            false => self.undo.redo(&mut self.volume, &mut dirty),
        };
        for axis in Axis::ALL {
            for rect in dirty.rects(axis) {
                for line in rect.lo.0..=rect.hi.0 {
                    for place in rect.lo.1..=rect.hi.1 {
                        let at = (line.into(), place.into());
                        self.stale.set_column(axis, at, self.volume.maps().column(axis, at));
                    }
                }
            }
        }
        prop_assert!(self.stale == *self.volume.maps(), "a dirty rectangle is missing");
        prop_assert!(stepped || dirty.is_empty());
        Ok(stepped)
    }
}

fn saved<const N: usize>(undo: &Undo<N>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let mut sizing = Writer::new(&mut []);
    undo.save(&mut sizing);
    let mut bytes = vec![0; sizing.len()];
    let mut writer = Writer::new(&mut bytes);
    undo.save(&mut writer);
    assert!(writer.fits());
    bytes
}

#[derive(Clone, Debug)]
enum Step {
    /// A stroke: edits, with islands cleared after some of them, perhaps after the next began.
    Stroke {
        edits: Vec<Touch>,
        clear: Clear,
    },
    Undo,
    Redo,
    Save,
}

#[derive(Clone, Copy, Debug)]
enum Clear {
    Never,
    AtEnd,
    /// When the next stroke has begun, but not changed anything.
    Late,
}

#[derive(Clone, Debug)]
struct Touch {
    at: [i32; 3],
    radius: i32,
    fill: bool,
}

impl Touch {
    fn brush(&self) -> Brush {
        let centre = self.at.map(|i| i * SUB + SUB / 2);
        Brush::sphere(IVec3::from_array(centre), self.radius * SUB / 2)
    }

    fn operation(&self) -> Operation {
        if self.fill { Operation::Fill { depth: 3 } } else { Operation::Carve { depth: 4 } }
    }
}

fn steps(n: i32, most: usize) -> impl Strategy<Value = Vec<Step>> {
    let touch = ([0..n, 0..n, 0..n], 0..n, any::<bool>()).prop_map(|(at, radius, fill)| Touch {
        at,
        radius,
        fill,
    });
    let clear = prop_oneof![Just(Clear::Never), Just(Clear::AtEnd), Just(Clear::Late)];
    let stroke = (proptest::collection::vec(touch, 0..5), clear)
        .prop_map(|(edits, clear)| Step::Stroke { edits, clear });
    let step = prop_oneof![6 => stroke, 3 => Just(Step::Undo), 2 => Just(Step::Redo), 1 => Just(Step::Save)];
    proptest::collection::vec(step, 1..most)
}

fn check_steps<const N: usize>(bench: &Mutex<Bench<N>>, steps: &[Step]) -> Result<(), TestCaseError>
where
    Grid<N>: Size,
{
    let mut bench = bench.lock().unwrap_or_else(|e| e.into_inner());
    let mut history = bench.reset();
    for step in steps {
        match step {
            Step::Stroke { edits, clear } => stroke(&mut bench, &mut history, edits, *clear),
            Step::Undo => prop_assert_eq!(bench.step(true)?, history.undo().is_some()),
            Step::Redo => prop_assert_eq!(bench.step(false)?, history.redo().is_some()),
            Step::Save => bench.check_saved()?,
        }
        let (undoable, redoable) = bench.undo.counts();
        prop_assert!(undoable >= history.counts().0.min(2), "two entries always fit");
        prop_assert!(undoable <= history.counts().0);
        history.forget(undoable);
        prop_assert_eq!(redoable, history.counts().1);
        prop_assert_eq!(bench.undo.digest(), bench.undo.recompute_digest());
    }
    while let Some(maps) = history.undo() {
        prop_assert!(bench.step(true)?);
        bench.check(maps)?;
    }
    prop_assert!(!bench.step(true)?);
    while let Some(maps) = history.redo() {
        prop_assert!(bench.step(false)?);
        bench.check(maps)?;
    }
    prop_assert!(!bench.step(false)?);
    bench.check_saved()
}

fn stroke<const N: usize>(
    bench: &mut Bench<N>,
    history: &mut History<N>,
    edits: &[Touch],
    clear: Clear,
) where
    Grid<N>: Size,
{
    bench.undo.begin_stroke();
    let mut changed = false;
    for touch in edits {
        changed |= bench.edit(&touch.brush(), touch.operation());
    }
    if changed {
        match clear {
            Clear::Never => {}
            Clear::AtEnd => _ = bench.clear_islands(),
            Clear::Late => {
                bench.undo.begin_stroke();
                bench.clear_islands();
            }
        }
        history.push(bench.volume.maps());
    }
}

static STEPS_16: Mutex<Bench<16>> = Mutex::new(Bench::new());
static STEPS_32: Mutex<Bench<32>> = Mutex::new(Bench::new());
static STEPS_128: Mutex<Bench<128>> = Mutex::new(Bench::new());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn strokes_16(steps in steps(16, 40)) {
        check_steps(&STEPS_16, &steps)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn strokes_32(steps in steps(32, 60)) {
        check_steps(&STEPS_32, &steps)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]
    #[test]
    fn strokes_128(steps in steps(128, 12)) {
        check_steps(&STEPS_128, &steps)?;
    }
}

/// Each stroke changes every column. Two are always there to be undone.
fn worst_case<const N: usize>(bench: &Mutex<Bench<N>>)
where
    Grid<N>: Size,
{
    let mut bench = bench.lock().unwrap();
    let everywhere = Brush::sphere(IVec3::splat(N as i32 * SUB / 2), N as i32 * SUB);
    bench.volume.set_voxels(|plane| (0..N).for_each(|y| plane.layer_mut(y).fill(Grid::<N>::FULL)));
    let full = bench.volume.maps().clone();
    for _ in 0..4 {
        for operation in [Operation::Carve { depth: 1 }, Operation::Fill { depth: 4 }] {
            bench.undo.begin_stroke();
            assert!(bench.edit(&everywhere, operation));
        }
        assert!(bench.volume.maps() == &full, "filled up again");
    }
    assert!(bench.undo.counts().0 >= 2);
    assert!(bench.undo.counts().0 < 8, "every column is in every entry");
    bench.check_saved().unwrap();
    assert!(bench.step(true).unwrap() && bench.step(true).unwrap());
    bench.check(&full).unwrap();
    assert!(bench.step(false).unwrap() && bench.step(false).unwrap());
    bench.check(&full).unwrap();
}

#[test]
fn worst_case_16() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

#[test]
fn worst_case_128() {
    static BENCH: Mutex<Bench<128>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

#[test]
fn worst_case_256() {
    static BENCH: Mutex<Bench<256>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

/// Usual strokes, a dent each: dozens can be undone, and never more than the table holds.
#[test]
fn dents() {
    static BENCH: Mutex<Bench<128>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..300 {
        let touch = Touch { at: [i * 7 % 128, 96, 4 + i * 11 % 120], radius: 14, fill: i % 3 == 0 };
        stroke(&mut bench, &mut history, &[touch], Clear::AtEnd);
    }
    let (undoable, _) = bench.undo.counts();
    assert!((48..=UNDO_ENTRIES + 1).contains(&undoable), "{undoable} dents");
    history.forget(undoable);
    while let Some(maps) = history.undo() {
        assert!(bench.step(true).unwrap());
        bench.check(maps).unwrap();
    }
}

/// Single voxels: the table's length is the limit.
#[test]
fn full_table() {
    static BENCH: Mutex<Bench<32>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..(UNDO_ENTRIES as i32 + 50) {
        let touch = Touch { at: [i % 32, 23, 2 + i / 32], radius: 0, fill: false };
        stroke(&mut bench, &mut history, &[touch], Clear::Never);
    }
    assert!(bench.undo.counts().0 <= UNDO_ENTRIES + 1);
    assert!(bench.undo.counts().0 > 20);
    bench.check_saved().unwrap();
}

/// A stroke that changes nothing leaves no entry, and doesn't drop what was undone.
#[test]
fn idle_stroke() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    let dent = Touch { at: [8, 11, 8], radius: 5, fill: false };
    stroke(&mut bench, &mut history, std::slice::from_ref(&dent), Clear::Never);
    assert!(bench.step(true).unwrap());
    stroke(
        &mut bench,
        &mut history,
        &[Touch { at: [8, 15, 8], radius: 1, fill: false }],
        Clear::Never,
    );
    assert_eq!(bench.undo.counts(), (0, 1));
    stroke(&mut bench, &mut history, &[dent], Clear::Never);
    assert_eq!(bench.undo.counts(), (1, 0));
}

/// Cut short or with bytes changed: an error and no entries, or a ring that can be walked.
#[test]
fn bad_bytes() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..5 {
        let touch = Touch { at: [3 * i, 10, 8], radius: 4, fill: i == 3 };
        stroke(&mut bench, &mut history, &[touch], Clear::AtEnd);
    }
    let bytes = saved(&bench.undo);
    for len in 0..bytes.len() {
        assert!(bench.undo.load(&mut Reader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert_eq!(bench.undo.counts(), (0, 0));
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 8, 64, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match bench.undo.load(&mut Reader::new(&bytes)) {
                Ok(()) => {
                    assert_eq!(bench.undo.digest(), bench.undo.recompute_digest());
                    while bench.step(true).unwrap() {}
                    while bench.step(false).unwrap() {}
                }
                Err(error) => {
                    assert!(error.offset <= bytes.len());
                    assert_eq!(bench.undo.counts(), (0, 0));
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "most flips are refused, not {refused}");
}
