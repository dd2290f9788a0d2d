//! Sequences of edits, island passes, undo and redo in volumes of K intervals a column, K = 1 to 4, against
//! the model of the closure rule: every voxel, column and count is compared.

use glam::{IVec3, Quat, Vec3};
use paros_core::edit::{EditOperation, EditReport, EditScratch, Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{
    ColumnAddress, IslandSearch, RemovalJournal, RowAddress, StrokeJournal, UndoHistory,
    maps_digest,
};
use paros_core::limits::max_island_row_visits_per_tick;
use paros_core::volume::{
    Axis, BitGrid, BitSet, Column, DirtyRects, Grid, Journal, Range, Size, VoxelBox,
};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use paros_models::cases::random_cases;
use paros_models::dense::{DenseVolume, MaskedVolume, any_voxels, closed_volumes_with_inner_mask};
use paros_models::edit::{assert_edit_invariants, exact_edit};
use paros_models::layers::LayeredVolume;
use proptest::prelude::*;

use super::harness::{BrushSpec, Stroke, any_strokes};
use super::voxels_by_rows;

/// A volume under test beside its model.
struct LayerHarness<const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N, K>,
    mask: RangeMaps<N, K>,
    before: RangeMaps<N, K>,
    scratch: EditScratch<N>,
    islands: IslandSearch<N>,
    undo: UndoHistory<N, K>,
    dirty: DirtyRects,
    rows: BitGrid<N>,
    model: LayeredVolume,
    dense_mask: DenseVolume,
    /// The volumes that undo and redo lead to, the next one last.
    undoable: Vec<LayeredVolume>,
    redoable: Vec<LayeredVolume>,
}

impl<const N: usize, const K: usize> LayerHarness<N, K>
where
    Grid<N>: Size,
{
    fn new(MaskedVolume { volume, mask }: &MaskedVolume) -> Box<Self> {
        let mut harness = Box::new(LayerHarness {
            volume: Volume::new(),
            mask: RangeMaps::new(),
            before: RangeMaps::new(),
            scratch: EditScratch::new(),
            islands: IslandSearch::new(),
            undo: UndoHistory::new(),
            dirty: DirtyRects::new(),
            rows: BitGrid::new(),
            model: LayeredVolume::new(volume, K),
            dense_mask: mask.clone(),
            undoable: Vec::new(),
            redoable: Vec::new(),
        });
        mask.insert_into_empty_bits(&mut harness.rows);
        harness.rows.write_closure(&mut harness.mask);
        harness.volume.set_voxels(|bits| volume.insert_into_empty_bits(bits));
        harness.assert_follows_model();
        harness
    }

    /// Applies a stroke and returns its report, or `None` if the brush is too large to smooth.
    fn apply_stroke(&mut self, stroke: &Stroke) -> Option<EditReport> {
        let Stroke { shape, operation, mirrored } = stroke;
        let brush = shape.to_brush();
        let edit = Edit { brush: &brush, operation: *operation, mirrored: *mirrored };
        self.before.copy_from(self.volume.maps());
        self.undo.begin_stroke();
        let mut journal = JournalNotes::of(StrokeJournal {
            undo: &mut self.undo,
            dirty: &mut self.dirty,
            islands: &mut self.islands,
        });
        let done = apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut journal);
        let columns = journal.columns;
        let Ok(report) = done else {
            assert!(columns.is_empty() && self.volume.maps() == &self.before);
            return None;
        };
        let model_before = self.model.clone();
        let (before, mask) = (model_before.voxels(), &self.dense_mask);
        let brush = voxels_by_rows::<N>(&brush);
        let expected = exact_edit(before, mask, &brush, *operation, *mirrored);
        self.model.become_closure_of(&expected.exact);
        let after = self.model.voxels();
        assert_eq!(report, expected.expected_report(before, after));
        assert!(expected.exact.is_within(after), "a voxel of the exact result is lost");
        assert_edit_invariants(before, mask, &brush, *operation, *mirrored, after);
        self.assert_follows_model();
        self.assert_changes_were_told(&columns);
        if !columns.is_empty() {
            self.undoable.push(model_before);
            self.redoable.clear();
            self.clear_islands();
        }
        Some(report)
    }

    /// Runs an island pass, and a second pass that must change nothing.
    fn clear_islands(&mut self) {
        let before = self.model.voxels().clone();
        if before.occupied().all(|[_, y, _]| y > 0) && self.dense_mask.is_empty() {
            return;
        }
        let supported = before.supported_by_ground_or(&self.dense_mask);
        self.model.become_closure_of(&supported);
        let after = self.model.voxels().clone();
        for expected in [(&before, &after), (&after, &after)] {
            let report = self.run_pass();
            assert_eq!(report.0, expected.0.difference(expected.1).count(), "removed");
            assert!(!report.1, "supported");
            self.assert_follows_model();
            assert!(after.supported_by_ground_or(&self.dense_mask) == supported);
        }
    }

    /// Runs a pass. Returns the number of removed voxels, and `true` if there was no support.
    fn run_pass(&mut self) -> (u32, bool) {
        self.islands.request_pass();
        loop {
            self.before.copy_from(self.volume.maps());
            let mut journal =
                JournalNotes::of(RemovalJournal { undo: &mut self.undo, dirty: &mut self.dirty });
            let visits = max_island_row_visits_per_tick(N);
            let (volume, mask) = (&mut self.volume, &self.mask);
            let report = self.islands.advance_pass(volume, mask, visits, &mut journal);
            assert!(!journal.has_additions, "an island pass adds nothing");
            let columns = journal.columns;
            self.assert_changes_were_told(&columns);
            if let Some(report) = report {
                return (report.removed, report.unsupported);
            }
        }
    }

    fn undo_and_redo(&mut self) {
        let mut dirty = DirtyRects::new();
        while let Some(earlier) = self.undoable.pop() {
            if !self.undo.try_undo(&mut self.volume, &mut dirty) {
                assert_eq!(self.undo.undo_counts().undoable, 0);
                self.undoable.clear();
                break;
            }
            self.redoable.push(std::mem::replace(&mut self.model, earlier));
            self.assert_follows_model();
            assert_eq!(self.undo.digest(), self.undo.recompute_digest());
        }
        while let Some(later) = self.redoable.pop() {
            assert!(self.undo.try_redo(&mut self.volume, &mut dirty));
            self.model = later;
            self.assert_follows_model();
        }
        assert!(!self.undo.try_redo(&mut self.volume, &mut dirty));
    }

    fn assert_follows_model(&mut self) {
        for axis in Axis::ALL {
            for at in (0..N * N).map(|at| (at / N, at % N)) {
                let column = self.volume.maps().column(axis, at);
                let intervals = column.intervals();
                let intervals: Vec<_> = intervals.map(|r| (r.first(), r.last())).collect();
                assert_eq!(&intervals, self.model.column(axis, at), "{axis:?} {at:?}");
            }
        }
        assert!(&DenseVolume::from_bits(self.volume.rows()) == self.model.voxels(), "voxels");
        self.rows.set_from_maps(self.volume.maps());
        assert!(self.volume.rows() == &self.rows, "rows are the intersection of the maps");
        assert_eq!(self.volume.digest(), maps_digest(self.volume.maps()));
        assert!(self.volume.are_ranges_tight() && self.volume.is_saturated());
        self.model.assert_tight_and_saturated();
    }

    /// Asserts that exactly the changed columns were journalled, once each, with their old values.
    fn assert_changes_were_told(&self, columns: &[ChangedColumn<K>]) {
        for (i, &(axis, at, old)) in columns.iter().enumerate() {
            assert_eq!(self.before.column(axis, at), old, "{axis:?} {at:?}");
            let again = columns[..i].iter().any(|other| (other.0, other.1) == (axis, at));
            assert!(!again, "{axis:?} {at:?} told twice");
        }
        let changed = |axis| {
            let at = (0..N * N).map(|at| (at / N, at % N));
            at.filter(|&at| self.before.column(axis, at) != self.volume.maps().column(axis, at))
                .count()
        };
        assert_eq!(columns.len(), Axis::ALL.into_iter().map(changed).sum::<usize>());
    }
}

type ChangedColumn<const K: usize> = (Axis, ColumnAddress, Column<K>);

/// A core journal that also records its calls.
struct JournalNotes<J, const K: usize> {
    journal: J,
    columns: Vec<ChangedColumn<K>>,
    has_additions: bool,
}

impl<J, const K: usize> JournalNotes<J, K> {
    fn of(journal: J) -> Self {
        JournalNotes { journal, columns: Vec::new(), has_additions: false }
    }
}

impl<J: Journal<N, K>, const N: usize, const K: usize> Journal<N, K> for JournalNotes<J, K>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, new): (&[Column<K>; N], &[Column<K>; N]),
    ) {
        self.journal.record_columns(axis, line, places, (old, new));
        self.columns.extend(places.iter_ones().map(|place| (axis, (line, place), old[place])));
    }

    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.journal.record_added(row, voxels);
        self.has_additions = true;
    }
}

/// A strategy for volumes and masks, half of which aren't closed.
fn any_starts(n: usize) -> impl Strategy<Value = MaskedVolume> {
    let open =
        any_voxels(n).prop_map(move |volume| MaskedVolume { volume, mask: DenseVolume::empty(n) });
    prop_oneof![open, closed_volumes_with_inner_mask(n)]
}

fn check_sequence<const N: usize, const K: usize>(start: &MaskedVolume, strokes: &[Stroke])
where
    Grid<N>: Size,
{
    let mut harness = LayerHarness::<N, K>::new(start);
    for stroke in strokes {
        harness.apply_stroke(stroke);
    }
    harness.undo_and_redo();
}

/// Drills 12 holes of radius 4 and depth 25 into a ball of radius 56, from directions all round. Returns the
/// number of voxels within the bits, and how many of those are still there.
fn drill_holes<const K: usize>() -> (u32, u32) {
    let mut volume = Box::new(Volume::<128, K>::new());
    let mut scratch = Box::new(EditScratch::<128>::new());
    let no_mask = Box::new(RangeMaps::<128, K>::new());
    let ball = |[x, y, z]: [i32; 3]| {
        [x, y, z].map(|i| (2 * i - 127).pow(2)).into_iter().sum::<i32>() <= 4 * 56 * 56
    };
    let ball = DenseVolume::from_fn(128, ball);
    volume.set_voxels(|bits| ball.insert_into_empty_bits(bits));
    let (mut within, mut left) = (0, 0);
    for i in 0..12 {
        // A Fibonacci spiral over the sphere.
        let (height, turn) = (1.0 - (i as f32 + 0.5) / 6.0, i as f32 * 2.399_963);
        let across = (1.0 - height * height).sqrt();
        let out = Vec3::new(across * turn.cos(), height, across * turn.sin());
        let subunits = |p: Vec3| (p * SUBUNITS_PER_VOXEL as f32).as_ivec3();
        let middle = Vec3::splat(64.0);
        let brush = Brush::capsule(
            subunits(middle + out * 60.0),
            subunits(middle + out * (56.0 - 25.0)),
            4 * SUBUNITS_PER_VOXEL,
        );
        let bit = voxels_by_rows::<128>(&brush);
        within += bit.intersection(&DenseVolume::from_bits(volume.rows())).count();
        let operation = EditOperation::Carve { depth: 4 };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        while apply_edit(&mut volume, &no_mask, &edit, &mut scratch, &mut ())
            .unwrap()
            .changed_volume()
        {}
        left += bit.intersection(&DenseVolume::from_bits(volume.rows())).count();
    }
    (within, left)
}

/// Builds a stone whose middle columns hold as many gaps as they can, each three voxels long and one apart,
/// and carves a cube of two voxels in the middle. Asserts that closure restores the cube and that the report
/// gives its place.
fn check_box_of_what_came_back<const K: usize>() {
    let cavity = |along: i32| {
        along < 14 && (0..K as i32 - 1).any(|i| (10 - 4 * i..13 - 4 * i).contains(&along))
    };
    let is_middle = |across: i32| (12..19).contains(&across);
    let stone = DenseVolume::from_fn(32, |[x, y, z]| {
        let hollow = |along, a, b| cavity(along) && is_middle(a) && is_middle(b);
        !(hollow(x, y, z) || hollow(y, z, x) || hollow(z, x, y))
    });
    let start = MaskedVolume { volume: stone, mask: DenseVolume::empty(32) };
    let pose = Pose { position: Vec3::new(15.0, 15.0, 16.0), rotation: Quat::IDENTITY };
    let shape = BrushSpec::Box(IVec3::splat(SUBUNITS_PER_VOXEL), pose);
    for (mirrored, x) in [(false, Range::new(14, 15)), (true, Range::new(14, 17))] {
        let mut harness = LayerHarness::<32, K>::new(&start);
        let operation = EditOperation::Carve { depth: 4 };
        let report =
            harness.apply_stroke(&Stroke { shape: shape.clone(), operation, mirrored }).unwrap();
        let [y, z] = [Range::new(14, 15), Range::new(15, 16)];
        assert_eq!(report.closure_box, VoxelBox::new([x, y, z]));
        let back = if mirrored { 16 } else { 8 };
        assert_eq!((report.removed, report.refused_by_closure), (0, back));
    }
}

#[test]
fn what_came_back_has_a_box() {
    check_box_of_what_came_back::<2>();
    check_box_of_what_came_back::<3>();
    check_box_of_what_came_back::<4>();
}

/// With a second interval, columns keep holes that one interval can't represent.
#[test]
fn drilled_holes_stay_with_two_intervals() {
    let [one, two] = [drill_holes::<1>(), drill_holes::<2>()];
    println!("refused with one interval {} of {}, with two {} of {}", one.1, one.0, two.1, two.0);
    assert!(3 * one.1 > one.0, "{one:?}");
    assert_eq!(two.1, 0, "{two:?}");
}

proptest! {
    #![proptest_config(random_cases(40))]

    #[test]
    fn one_interval_follows_the_rule(start in any_starts(16), strokes in any_strokes(16, 5)) {
        check_sequence::<16, 1>(&start, &strokes);
    }

    #[test]
    fn two_intervals_follow_the_rule(start in any_starts(16), strokes in any_strokes(16, 5)) {
        check_sequence::<16, 2>(&start, &strokes);
    }

    #[test]
    fn three_intervals_follow_the_rule(start in any_starts(16), strokes in any_strokes(16, 5)) {
        check_sequence::<16, 3>(&start, &strokes);
    }

    #[test]
    fn four_intervals_follow_the_rule(start in any_starts(16), strokes in any_strokes(16, 5)) {
        check_sequence::<16, 4>(&start, &strokes);
    }
}
