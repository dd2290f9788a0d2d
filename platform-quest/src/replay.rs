//! A trace played again without a session: the same ticks lead to the same digests on every machine.

use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

use paros_core::size::{Grid, Size};
use paros_shell::durable::{self, Target};
use paros_shell::stage;
use paros_shell::statics::Resident;
use paros_shell::trace::{Diverged, Trace, TraceError};

/// Why a replay left no digests. It names the file.
#[derive(Debug)]
pub enum Error {
    /// The file is no trace.
    Trace(TraceError),
    /// The trace's ticks lead elsewhere here.
    Diverged(PathBuf, Diverged),
    /// The digests can't be written.
    Write(durable::Error),
}

/// Plays a trace and writes every tick's digest to a file, 16 hexadecimal digits a line.
///
/// # Errors
/// A file that is no trace, the first tick that differs, or a place where no file can be. Then
/// nothing is written.
pub fn replay(trace: &Path, digests: &Path) -> Result<(), Error> {
    let target = Target::tried(digests).map_err(Error::Write)?;
    let read = Trace::read(trace).map_err(Error::Trace)?;
    let played = match read.header().size {
        256 => play::<256>(&read),
        _ => play::<128>(&read),
    };
    let played = played.map_err(|diverged| Error::Diverged(trace.into(), diverged))?;
    target.write(played.as_bytes()).map_err(Error::Write)
}

fn play<const N: usize>(trace: &Trace) -> Result<String, Diverged>
where
    Grid<N>: Size + Resident<N>,
{
    let mut digests = String::with_capacity(17 * trace.records().len());
    stage::fresh::<N, _>(|mut stage| {
        stage.replay(trace, |_, world| {
            // A String takes everything.
            let _ = writeln!(digests, "{:016x}", world.digest());
        })
    })?;
    Ok(digests)
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Trace(error) => error.fmt(f),
            Error::Diverged(path, diverged) => write!(f, "{}: {diverged}", path.display()),
            Error::Write(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {}
