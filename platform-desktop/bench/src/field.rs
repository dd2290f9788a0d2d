//! `bench field`: what a frame spends on keeping the fast path's textures up to date, in
//! instructions and in bytes for the device.
//!
//! A frame takes in a tick's changes, computes as much as its budget allows and copies that to
//! staging memory. Each kind of change is played to its end; the worst frame is reported.

use std::hint::black_box;
use std::path::Path;

use paros_core::limits::island_row_visits;
use paros_core::{DirtyRects, Grid, RangeMaps, Size};
use paros_headless::Error;
use paros_shaders::field::{Budget, DensityField};
use paros_shell::{rmap, with_size};

use super::callgrind::{ScratchFolder, count_instructions};
use super::edit::{CARVE, RADIUS, edit_sphere_at, surface_voxels};
use super::fixture::{Fixture, HasFixture, reset_fixture};
use super::islands::{cut_loose, run_pass};
use super::row::ReportRow;
use super::subject::Subject;

/// What changes the volume.
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

/// The worst frame of each change, and why instructions were not counted if they were not.
pub(super) fn measure_rows<const N: usize>(
    subject: &Subject,
) -> Result<(Vec<ReportRow>, Option<String>), Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.plane)?;
    let folder = ScratchFolder::new()?;
    let volume = folder.0.join("volume.rmap");
    rmap::write(&volume, &fixture.start).map_err(Error::failure)?;
    let frames = play_changes(fixture)?;
    let mut counted = count_instructions(COUNTED, &volume, &folder, &|_| {});
    if let Ok(counts) = &counted
        && counts.len() != frames.len()
    {
        counted = Err(format!("{} of {} frames were counted", counts.len(), frames.len()));
    }
    let row = |change: FieldChange| {
        let of_change = || frames.iter().enumerate().filter(|(_, frame)| frame.change == change);
        let bytes = of_change().map(|(_, frame)| frame.bytes as u64).max();
        let instructions = |counts: &Vec<u64>| of_change().map(|(i, _)| counts[i]).max();
        let against = format!("worst of {} frames: {}", of_change().count(), change.name());
        ReportRow {
            instructions: counted.as_ref().ok().and_then(instructions),
            bytes,
            ..ReportRow::new("field", subject.name(), N, against)
        }
    };
    let why = counted.as_ref().err().map(|why| format!("instructions of a frame: {why}"));
    Ok((FieldChange::ALL.map(row).into(), why))
}

/// Plays the cases on a volume's file: the part of the child that is counted.
///
/// # Errors
/// A file that is not as the measuring run left it.
pub(super) fn replay_changes(volume: &Path) -> Result<(), Error> {
    let subject = Subject::from_name(volume)?;
    with_size!(subject.sizes()[0], N => replay_at::<N>(&subject))
}

fn replay_at<const N: usize>(subject: &Subject) -> Result<(), Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.plane)?;
    play_changes(fixture).map(|_| ())
}

/// A played frame: its change, and the bytes for the device.
struct PlayedFrame {
    change: FieldChange,
    bytes: usize,
}

/// The textures as they follow a volume.
struct FieldFollower<const N: usize> {
    field: Box<DensityField<N>>,
    staged: Vec<u8>,
    frames: Vec<PlayedFrame>,
}

impl<const N: usize> FieldFollower<N> {
    fn play_frame(&mut self, change: FieldChange, noted: Option<(&RangeMaps<N>, &DirtyRects)>) {
        let bytes = counted_frame(&mut self.field, noted, &mut self.staged);
        self.frames.push(PlayedFrame { change, bytes });
    }

    /// Plays frames until no work is pending.
    fn play_until_settled(&mut self, change: FieldChange) {
        while self.field.has_pending() {
            self.play_frame(change, None);
        }
    }
}

fn play_changes<const N: usize>(fixture: &mut Fixture<N>) -> Result<Vec<PlayedFrame>, Error>
where
    Grid<N>: Size,
{
    let staged = vec![0; Budget::per_frame(N).bytes];
    let mut follower =
        FieldFollower { field: Box::new(DensityField::new()), staged, frames: vec![] };
    reset_fixture(fixture);
    fixture.dirty.mark_all(N);
    follower.play_frame(FieldChange::Load, Some((fixture.volume.maps(), &fixture.dirty)));
    follower.play_until_settled(FieldChange::Load);
    fixture.undo.begin_stroke();
    for place in surface_voxels(&fixture.plane) {
        edit_sphere_at(fixture, place, CARVE);
        follower.play_frame(FieldChange::Stroke, Some((fixture.volume.maps(), &fixture.dirty)));
    }
    follower.play_until_settled(FieldChange::Stroke);
    fixture.dirty.clear();
    if !fixture.undo.undo(&mut fixture.volume, &mut fixture.dirty) {
        return Err(Error::Failure(format!("at {N}: no stroke can be taken back")));
    }
    follower.play_frame(FieldChange::Undo, Some((fixture.volume.maps(), &fixture.dirty)));
    follower.play_until_settled(FieldChange::Undo);
    cut_loose(&mut fixture.plane, &mut fixture.start, [1, 2]);
    reset_fixture(fixture);
    follower.field.rebuild_from(&fixture.start);
    fixture.islands.request_pass();
    let mut removed = 0;
    while fixture.islands.is_busy() {
        fixture.dirty.clear();
        removed += run_pass(fixture, island_row_visits(N)).map_or(0, |report| report.removed);
        follower.play_frame(FieldChange::Fall, Some((fixture.volume.maps(), &fixture.dirty)));
    }
    follower.play_until_settled(FieldChange::Fall);
    if removed == 0 {
        return Err(Error::Failure(format!("at {N}: no island came loose")));
    }
    Ok(follower.frames)
}

const COUNTED: &str = concat!(module_path!(), "::counted_frame");

/// One frame's upkeep, the function that Callgrind counts by this name; the bytes staged.
#[inline(never)]
fn counted_frame<const N: usize>(
    field: &mut DensityField<N>,
    noted: Option<(&RangeMaps<N>, &DirtyRects)>,
    staged: &mut [u8],
) -> usize {
    if let Some((maps, dirty)) = noted {
        field.note_changes(maps, black_box(dirty));
    }
    let mut used = 0;
    field.update_textures(Budget::per_frame(N), &mut |_, bytes| {
        staged[used..used + bytes.len()].copy_from_slice(bytes);
        used += bytes.len();
    });
    black_box(staged);
    black_box(used)
}
