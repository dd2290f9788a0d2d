//! Replays of a trace without a display: the same ticks lead to the same digests on every machine.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::durable::{self, WriteTarget};
use crate::statics::Resident;
use crate::tick_runner;
use crate::trace::{ReplayDivergence, Trace, TraceError};
use crate::{with_intervals, with_size};
use paros_core::volume::{Grid, Size};

/// Why a replay wrote no digests. Its text names the file.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file is no trace.
    #[error(transparent)]
    Trace(TraceError),
    /// The replay differs from what was recorded.
    #[error("{path}: {1}", path = .0.display())]
    ReplayDivergence(PathBuf, ReplayDivergence),
    /// The digests can't be written.
    #[error(transparent)]
    Write(durable::WriteError),
}

/// Replays a trace from a file and writes every tick's digest to another, 16 hexadecimal digits a line.
///
/// # Errors
/// A file that is no trace, the first tick that differs, or a place where no file can be. Then
/// nothing is written.
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

/// The digests of all ticks, as the file has them.
fn replay_digests<const N: usize, const K: usize>(trace: &Trace) -> Result<String, ReplayDivergence>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut digests = String::with_capacity(17 * trace.records().len());
    tick_runner::with_fresh_world::<N, K, _>(|mut runner| {
        runner.replay_on_same_start(trace, |tick| {
            // A String takes everything.
            let _ = writeln!(digests, "{:016x}", tick.world.digest());
        })
    })?;
    Ok(digests)
}
