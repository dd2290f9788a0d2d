//! `bench field`: what a frame spends on keeping the fast path's textures up to date, in
//! instructions and in bytes for the device.
//!
//! A frame takes in a tick's changes, computes as much as its budget allows and copies that to
//! staging memory. Each of the cases is played to its end; the worst frame is told.

use std::hint::black_box;
use std::path::Path;

use paros_core::dirty::Dirty;
use paros_core::limits::row_visits;
use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_shaders::field::{Budget, Field};
use paros_shell::rmap;

use super::callgrind::{Folder, counts};
use super::edit::{CARVE, RADIUS, edit, surface};
use super::islands::{cut_loose, pass};
use super::rig::{Rig, Rigged, reset};
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

/// What changes the volume.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Case {
    Stroke,
    Undo,
    Load,
    Fall,
}

impl Case {
    const ALL: [Case; 4] = [Case::Stroke, Case::Undo, Case::Load, Case::Fall];

    fn name(self) -> String {
        match self {
            Case::Stroke => format!("a stroke of radius {RADIUS}, a bite a frame all over"),
            Case::Undo => "that stroke is taken back at once".into(),
            Case::Load => "a load".into(),
            Case::Fall => "the upper half falls".into(),
        }
    }
}

/// Worst frames of each case, and why their instructions are missing if they are.
pub(super) fn rows<const N: usize>(subject: &Subject) -> Result<(Vec<Row>, Option<String>), Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    subject.load(&mut rig.start, &mut rig.plane)?;
    let folder = Folder::new()?;
    let volume = folder.0.join("volume.rmap");
    rmap::write(&volume, &rig.start).map_err(Error::failure)?;
    let frames = play(rig)?;
    let mut counted = counts(COUNTED, &volume, &folder, &|_| {});
    if let Ok(counts) = &counted
        && counts.len() != frames.len()
    {
        counted = Err(format!("{} of {} frames were counted", counts.len(), frames.len()));
    }
    let row = |case: Case| {
        let of_case = || frames.iter().enumerate().filter(|(_, frame)| frame.case == case);
        let bytes = of_case().map(|(_, frame)| frame.bytes as u64).max();
        let instructions = |counts: &Vec<u64>| of_case().map(|(i, _)| counts[i]).max();
        let against = format!("worst of {} frames: {}", of_case().count(), case.name());
        Row {
            instructions: counted.as_ref().ok().and_then(instructions),
            bytes,
            ..Row::new("field", subject.name(), N, against)
        }
    };
    let why = counted.as_ref().err().map(|why| format!("instructions of a frame: {why}"));
    Ok((Case::ALL.map(row).into(), why))
}

/// Plays the cases on a volume's file: the part of the child that is counted.
///
/// # Errors
/// A file that is not as the measuring run left it.
pub(super) fn replay(volume: &Path) -> Result<(), Error> {
    let subject = Subject::named(volume)?;
    match subject.sizes() {
        [256] => replay_at::<256>(&subject),
        _ => replay_at::<128>(&subject),
    }
}

fn replay_at<const N: usize>(subject: &Subject) -> Result<(), Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    subject.load(&mut rig.start, &mut rig.plane)?;
    play(rig).map(|_| ())
}

/// A frame that was played.
struct Frame {
    case: Case,
    bytes: usize,
}

/// The textures as they follow a volume.
struct Follower<const N: usize> {
    field: Box<Field<N>>,
    staged: Vec<u8>,
    frames: Vec<Frame>,
}

impl<const N: usize> Follower<N> {
    fn frame(&mut self, case: Case, noted: Option<(&Maps<N>, &Dirty)>) {
        let bytes = counted_frame(&mut self.field, noted, &mut self.staged);
        self.frames.push(Frame { case, bytes });
    }

    /// Frames until nothing is left to do.
    fn settle(&mut self, case: Case) {
        while self.field.pending() {
            self.frame(case, None);
        }
    }
}

fn play<const N: usize>(rig: &mut Rig<N>) -> Result<Vec<Frame>, Error>
where
    Grid<N>: Size,
{
    let staged = vec![0; Budget::frame(N).bytes];
    let mut follower = Follower { field: Box::new(Field::new()), staged, frames: vec![] };
    reset(rig);
    rig.dirty.note_all(N);
    follower.frame(Case::Load, Some((rig.volume.maps(), &rig.dirty)));
    follower.settle(Case::Load);
    rig.undo.begin_stroke();
    for place in surface(&rig.plane) {
        edit(rig, place, CARVE);
        follower.frame(Case::Stroke, Some((rig.volume.maps(), &rig.dirty)));
    }
    follower.settle(Case::Stroke);
    rig.dirty.clear();
    if !rig.undo.undo(&mut rig.volume, &mut rig.dirty) {
        return Err(Error::Failure(format!("at {N}: no stroke can be taken back")));
    }
    follower.frame(Case::Undo, Some((rig.volume.maps(), &rig.dirty)));
    follower.settle(Case::Undo);
    cut_loose(&mut rig.plane, &mut rig.start, [1, 2]);
    reset(rig);
    follower.field.rebuild(&rig.start);
    rig.islands.edited();
    let mut removed = 0;
    while rig.islands.is_busy() {
        rig.dirty.clear();
        removed += pass(rig, row_visits(N)).map_or(0, |report| report.removed);
        follower.frame(Case::Fall, Some((rig.volume.maps(), &rig.dirty)));
    }
    follower.settle(Case::Fall);
    if removed == 0 {
        return Err(Error::Failure(format!("at {N}: no island came loose")));
    }
    Ok(follower.frames)
}

const COUNTED: &str = concat!(module_path!(), "::counted_frame");

/// A frame with a dump of its own, found by this name; the bytes that it hands out.
#[inline(never)]
fn counted_frame<const N: usize>(
    field: &mut Field<N>,
    noted: Option<(&Maps<N>, &Dirty)>,
    staged: &mut [u8],
) -> usize {
    if let Some((maps, dirty)) = noted {
        field.note(maps, black_box(dirty));
    }
    let mut used = 0;
    field.advance(Budget::frame(N), &mut |_, bytes| {
        staged[used..used + bytes.len()].copy_from_slice(bytes);
        used += bytes.len();
    });
    black_box(staged);
    black_box(used)
}
