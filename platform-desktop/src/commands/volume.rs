//! What the commands share about volumes in files.

use std::path::Path;

use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_core::trace;
use paros_shell::print::Print;
use paros_shell::rmap::{self, Fault};

use crate::error::Error;

/// The size N of the volume in a file.
pub(super) fn size(path: &Path) -> Result<usize, Error> {
    rmap::peek(path).map(|header| header.n).map_err(|error| match error {
        rmap::Error::Bad { fault: Fault::Magic(trace::MAGIC), .. } => {
            Error::Input(format!("{}: is a trace, not a volume; use `paros play`", path.display()))
        }
        error => Error::input(error),
    })
}

/// Reads a volume that holds something.
pub(super) fn read<const N: usize>(path: &Path, maps: &mut Maps<N>) -> Result<(), Error>
where
    Grid<N>: Size,
{
    rmap::read(path, maps).map_err(Error::input)?;
    if maps.is_empty() {
        return Err(Error::Input(format!("{}: the volume is empty", path.display())));
    }
    Ok(())
}

/// The error for a size that is none of a sculpture's.
pub(super) fn unusable_size(path: &Path, n: usize) -> Error {
    Error::Input(format!("{}: expected a volume of size 128 or 256, found {n}", path.display()))
}

/// The print of what a file holds, unless that is nothing.
pub(super) fn printed(print: Option<Print>, of: &Path) -> Result<Print, Error> {
    print
        .filter(|print| print.triangles > 0)
        .ok_or_else(|| Error::Input(format!("{}: nothing is left to print", of.display())))
}

/// Refuses to write over the file that is read.
pub(super) fn check_distinct(input: &Path, output: &Path) -> Result<(), Error> {
    match (input.canonicalize(), output.canonicalize()) {
        (Ok(a), Ok(b)) if a == b => {
            Err(Error::Input(format!("{}: is both input and output", output.display())))
        }
        _ => Ok(()),
    }
}
