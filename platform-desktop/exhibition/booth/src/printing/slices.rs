//! The slicing thread: slices one print after the other, and finds the size that fits a print time.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use paros_booth_rules::records::WorkKind;
use paros_booth_rules::{Booth, PrintJob, Refusal, SizeSearch, SliceOutcome, Sliced};
use tracing::{info, warn};

use super::gcode::Estimate;
use super::slicer::{SliceFault, Slicer};
use crate::clock::booth_time;
use crate::models::exporter::make_stl;
use crate::server::work_keeper::keep_work;

/// The poll interval for work without a notification, such as work left over from before a restart.
const LOOK_AGAIN: Duration = Duration::from_secs(30);

/// Slices the next print, if there is one. Returns the time until the next look for work.
pub(crate) fn slice_next(booth: &Booth, slicer: &Arc<Slicer>) -> Duration {
    let sliced = booth.next_slice(booth_time()).and_then(|job| {
        let Some(job) = job else { return Ok(LOOK_AGAIN) };
        let subject = job.order.order.to_le_bytes();
        let outcome = keep_work(booth, WorkKind::Slice, &subject, || slice(booth, slicer, &job));
        let Some(outcome) = outcome.transpose() else {
            booth.leave_work(WorkKind::Slice, &subject)?;
            return Ok(LOOK_AGAIN);
        };
        let outcome = outcome.inspect_err(|_| {
            // If this fails too, the lease expires by itself.
            let _ = booth.leave_work(WorkKind::Slice, &subject);
        })?;
        info!(order = job.order.order, ?outcome, "print sliced");
        booth.note_slice(job.order.order, &outcome, booth_time())?;
        Ok(Duration::ZERO)
    });
    sliced.unwrap_or_else(|error| {
        // Retry later: the error of the disk or the database may be temporary.
        warn!(%error, "a print could not be sliced");
        LOOK_AGAIN
    })
}

/// Slices a print, and returns its estimate. Returns `None` if the program is ending.
fn slice(booth: &Booth, slicer: &Slicer, job: &PrintJob) -> Result<Option<SliceOutcome>, Refusal> {
    let unknown = |why: &str| Ok(Some(SliceOutcome::Unknown(why.to_owned())));
    let stl = match make_stl(&booth.read_kept(&job.sculpture)?) {
        Ok(stl) => stl,
        Err(why) => return unknown(&why),
    };
    let Some(model_mm) = height_of(&stl) else { return unknown("it has no height") };
    let slice_at = |height: u32| {
        let scale = f64::from(height) / 10.0 / model_mm;
        slicer.slice(&stl, scale, None).map(|sliced| sliced.estimate)
    };
    let height = job.order.height_tenths_mm;
    let found = match job.order.most_minutes {
        None => slice_at(height).map(|estimate| (height, estimate)),
        Some(most) => find_size(most, (10.0 * model_mm) as u32, slice_at),
    };
    match found {
        Ok((height, Estimate { minutes, tenths_gram })) => {
            Ok(Some(SliceOutcome::Known { height, minutes, tenths_gram }))
        }
        Err(SliceFault::Over) => Ok(None),
        Err(SliceFault::Disk(why)) => Err(Refusal::Files(io::Error::other(why))),
        Err(SliceFault::TooLarge) => unknown("it is larger than the printer"),
        Err(SliceFault::Failed(why)) => unknown(&why),
    }
}

/// Finds the greatest height whose print takes at most `most` minutes. Returns it with its estimate.
fn find_size(
    most: u32,
    first: u32,
    slice_at: impl Fn(u32) -> Result<Estimate, SliceFault>,
) -> Result<(u32, Estimate), SliceFault> {
    let (mut search, mut best) = (SizeSearch::new(most, first), None);
    while let Some(height) = search.next_height() {
        let minutes = match slice_at(height) {
            Ok(estimate) => {
                if estimate.minutes <= most && best.is_none_or(|(known, _)| height > known) {
                    best = Some((height, estimate));
                }
                estimate.minutes
            }
            // A print that is larger than the printer counts as longer than any time.
            Err(SliceFault::TooLarge) => u32::MAX,
            Err(fault) => return Err(fault),
        };
        search.note(Sliced { height, minutes });
    }
    best.ok_or_else(|| SliceFault::Failed("no size was found that fits the time".into()))
}

/// Returns the height of the model of a binary STL, in millimetres; `None` if it has no height.
pub(crate) fn height_of(stl: &[u8]) -> Option<f64> {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for triangle in stl.get(84..)?.chunks_exact(50) {
        for corner in triangle[12..48].chunks_exact(12) {
            let z = f32::from_le_bytes([corner[8], corner[9], corner[10], corner[11]]);
            (low, high) = (low.min(z), high.max(z));
        }
    }
    let height = f64::from(high) - f64::from(low);
    (height.is_finite() && height > 0.0).then_some(height)
}
