//! `bench field`: the cost of keeping the fast path's textures up to date in a frame, in instructions and in
//! bytes for the device.
//!
//! A frame takes in a tick's changes, computes as much as its budget allows and copies that to staging
//! memory. Each kind of change is played to its end; the worst frame is reported. The same changes are also
//! played in columns of two intervals.

use std::hint::black_box;
use std::path::Path;

use paros_core::RangeMaps;
use paros_core::limits::max_island_row_visits_per_tick;
use paros_core::volume::{DirtyRects, Grid, Size};
use paros_headless::Error;
use paros_shaders::field::{Budget, DensityField};
use paros_shell::{rmap, with_size};

use super::callgrind::{ScratchFolder, count_instructions_per_call};
use super::edit::{CARVE, RADIUS, sample_surface_voxels, try_edit_sphere_at};
use super::fixture::{Fixture, HasFixture, restore_start_volume};
use super::islands::{Fraction, advance_pass, cut_gap};
use super::row::{Measured, ReportRow};
use super::subject::BenchSubject;

/// A kind of change to the volume.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FieldChange {
    Stroke,
    Undo,
    Load,
    Fall,
}

impl FieldChange {
    const ALL: [FieldChange; 4] =
        [FieldChange::Stroke, FieldChange::Undo, FieldChange::Load, FieldChange::Fall];

    fn name(self) -> String {
        match self {
            FieldChange::Stroke => format!("a stroke of radius {RADIUS}, a bite a frame all over"),
            FieldChange::Undo => "that stroke is taken back at once".into(),
            FieldChange::Load => "a load".into(),
            FieldChange::Fall => "the upper half falls".into(),
        }
    }
}

/// Returns the worst frame of each change.
pub(super) fn measure_rows<const N: usize>(subject: &BenchSubject) -> Result<Measured, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    let folder = ScratchFolder::new()?;
    let volume = folder.0.join("volume.rmap");
    rmap::write(&volume, &fixture.start).map_err(Error::failure)?;
    let frames = play_changes_of_both(fixture)?;
    let mut counted = count_instructions_per_call(COUNTED, &volume, &folder, &|_| {});
    if let Ok(counts) = &counted
        && counts.len() != frames.len()
    {
        counted = Err(format!("{} of {} frames were counted", counts.len(), frames.len()));
    }
    let row = |(intervals, change): (usize, FieldChange)| {
        let is_of = |frame: &PlayedFrame| (frame.intervals, frame.change) == (intervals, change);
        let of_change = || frames.iter().enumerate().filter(|(_, frame)| is_of(frame));
        let bytes = of_change().map(|(_, frame)| frame.bytes as u64).max();
        let instructions = |counts: &Vec<u64>| of_change().map(|(i, _)| counts[i]).max();
        let intervals = if intervals == 1 { "" } else { ", two intervals" };
        let count = of_change().count();
        let against = format!("worst of {count} frames: {}{intervals}", change.name());
        ReportRow {
            instructions: counted.as_ref().ok().and_then(instructions),
            bytes,
            ..ReportRow::new("field", subject.name(), N, against)
        }
    };
    let why = counted.as_ref().err().map(|why| format!("instructions of a frame: {why}"));
    let rows = [1, 2].into_iter().flat_map(|k| FieldChange::ALL.map(|change| (k, change)));
    Ok(Measured { rows: rows.map(row).collect(), skipped: why })
}

/// Plays the changes on a volume's file: the part of the child process that is counted.
///
/// # Errors
/// The file differs from what the measuring run wrote.
pub(super) fn replay_changes(volume_path: &Path) -> Result<(), Error> {
    let subject = BenchSubject::from_name_or_path(volume_path)?;
    with_size!(subject.grid_sides()[0], N => replay_changes_at::<N>(&subject))
}

fn replay_changes_at<const N: usize>(subject: &BenchSubject) -> Result<(), Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    play_changes_of_both(fixture).map(|_| ())
}

/// Plays the changes in columns of one interval, then of two. The fixture holds the voxels.
fn play_changes_of_both<const N: usize>(fixture: &mut Fixture<N>) -> Result<Vec<PlayedFrame>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let two = &mut *Grid::<N>::lock_fixture_of_two();
    fixture.bit_grid.write_closure(&mut two.start);
    two.bit_grid.set_from_maps(&two.start);
    let mut frames = play_changes(fixture)?;
    frames.extend(play_changes(two)?);
    Ok(frames)
}

/// A played frame: its kind of change, and the bytes for the device.
struct PlayedFrame {
    intervals: usize,
    change: FieldChange,
    bytes: usize,
}

/// The fast path's textures, updated from a volume.
struct FieldFollower<const N: usize, const K: usize> {
    field: Box<DensityField<N, K>>,
    staging: Vec<u8>,
    frames: Vec<PlayedFrame>,
}

impl<const N: usize, const K: usize> FieldFollower<N, K> {
    fn play_frame(
        &mut self,
        change: FieldChange,
        changed: Option<(&RangeMaps<N, K>, &DirtyRects)>,
    ) {
        let bytes = stage_frame_and_count_bytes(&mut self.field, changed, &mut self.staging);
        self.frames.push(PlayedFrame { intervals: K, change, bytes });
    }

    /// Plays frames until no work is pending.
    fn play_until_settled(&mut self, change: FieldChange) {
        while self.field.has_pending() {
            self.play_frame(change, None);
        }
    }
}

fn play_changes<const N: usize, const K: usize>(
    fixture: &mut Fixture<N, K>,
) -> Result<Vec<PlayedFrame>, Error>
where
    Grid<N>: Size,
{
    let staging = vec![0; Budget::per_frame(N).bytes];
    let mut follower =
        FieldFollower { field: Box::new(DensityField::new()), staging, frames: vec![] };
    restore_start_volume(fixture);
    fixture.dirty.mark_all(N);
    follower.play_frame(FieldChange::Load, Some((fixture.volume.maps(), &fixture.dirty)));
    follower.play_until_settled(FieldChange::Load);
    fixture.undo.begin_stroke();
    for place in sample_surface_voxels(&fixture.bit_grid) {
        try_edit_sphere_at(fixture, place, CARVE);
        follower.play_frame(FieldChange::Stroke, Some((fixture.volume.maps(), &fixture.dirty)));
    }
    follower.play_until_settled(FieldChange::Stroke);
    fixture.dirty.clear();
    if !fixture.undo.try_undo(&mut fixture.volume, &mut fixture.dirty) {
        return Err(Error::Failure(format!("at {N}: no stroke can be taken back")));
    }
    follower.play_frame(FieldChange::Undo, Some((fixture.volume.maps(), &fixture.dirty)));
    follower.play_until_settled(FieldChange::Undo);
    let half = Fraction { numerator: 1, denominator: 2 };
    cut_gap(&mut fixture.start, &mut fixture.bit_grid, half);
    restore_start_volume(fixture);
    follower.field.rebuild_from(&fixture.start);
    fixture.islands.request_pass();
    let mut removed = 0;
    while fixture.islands.is_busy() {
        fixture.dirty.clear();
        removed += advance_pass(fixture, max_island_row_visits_per_tick(N))
            .map_or(0, |report| report.removed);
        follower.play_frame(FieldChange::Fall, Some((fixture.volume.maps(), &fixture.dirty)));
    }
    follower.play_until_settled(FieldChange::Fall);
    if removed == 0 {
        return Err(Error::Failure(format!("at {N}: no island came loose")));
    }
    Ok(follower.frames)
}

const COUNTED: &str = concat!(module_path!(), "::stage_frame_and_count_bytes");

/// Updates the textures for one frame. Callgrind counts this function by its name. Returns the bytes staged.
#[inline(never)]
fn stage_frame_and_count_bytes<const N: usize, const K: usize>(
    field: &mut DensityField<N, K>,
    changed: Option<(&RangeMaps<N, K>, &DirtyRects)>,
    staging: &mut [u8],
) -> usize {
    if let Some((maps, dirty)) = changed {
        field.note_dirty_columns(maps, black_box(dirty));
    }
    let mut used = 0;
    field.update_textures(Budget::per_frame(N), &mut |_, bytes| {
        staging[used..used + bytes.len()].copy_from_slice(bytes);
        used += bytes.len();
    });
    black_box(staging);
    black_box(used)
}
