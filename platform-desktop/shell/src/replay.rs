//! Replays of a trace without a display. The same ticks lead to the same digests on every machine.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::durable::{self, WriteTarget};
use crate::statics::Resident;
use crate::tick_runner;
use crate::trace::{ReplayDivergence, Trace, TraceError};
use crate::{with_intervals, with_size};
use paros_core::volume::{Grid, Size};

/// The reason why a replay wrote no digests. The text names the file.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file is no trace.
    #[error(transparent)]
    Trace(TraceError),
    /// The replay differs from the recording.
    #[error("{path}: {1}", path = .0.display())]
    ReplayDivergence(PathBuf, ReplayDivergence),
    /// The digests can't be written.
    #[error(transparent)]
    Write(durable::WriteError),
}

/// Replays a trace file and writes the digest of every tick to another file, 16 hexadecimal digits per line.
///
/// # Errors
/// Returns an error if the file is no trace, a tick differs, or the digests can't be written. Then nothing is
/// written.
pub fn write_replay_digests(trace_path: &Path, digests_path: &Path) -> Result<(), ReplayError> {
    let target =
        WriteTarget::resolve_and_check_writable(digests_path).map_err(ReplayError::Write)?;
    let read = Trace::read(trace_path).map_err(ReplayError::Trace)?;
    let header = read.header();
    let played = with_size!(header.side, N => with_intervals!(
        usize::from(header.intervals),
        K => replay_digests::<N, K>(&read),
        else Err(ReplayDivergence::no_world_of_intervals(&header)),
    ));
    let played =
        played.map_err(|diverged| ReplayError::ReplayDivergence(trace_path.into(), diverged))?;
    target.write_file(played.as_bytes()).map_err(ReplayError::Write)
}

/// Returns the digests of all ticks in the file's format.
fn replay_digests<const N: usize, const K: usize>(trace: &Trace) -> Result<String, ReplayDivergence>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut digests = String::with_capacity(17 * trace.records().len());
    tick_runner::with_fresh_world::<N, K, _>(|mut runner| {
        runner.replay_on_same_start(trace, |tick| {
            // Writing to a `String` can't fail.
            let _ = writeln!(digests, "{:016x}", tick.world.digest());
        })
    })?;
    Ok(digests)
}
