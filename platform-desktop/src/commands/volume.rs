//! What the commands share about volumes in files.

use std::path::Path;

use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_core::trace;
use paros_shell::print::Print;
use paros_shell::rmap::{self, Fault};

use crate::error::Error;
use crate::mesh::Kind;

/// The size N of the volume in a file.
pub(super) fn size(path: &Path) -> Result<usize, Error> {
    rmap::peek(path).map(|header| header.n).map_err(|error| match error {
        rmap::Error::Bad { fault: Fault::Magic(trace::MAGIC), .. } => {
            Error::Input(format!("{}: is a trace, not a volume; use `paros play`", path.display()))
        }
        rmap::Error::Bad { fault: Fault::Magic(_), .. } if Kind::of(path).is_some() => {
            let path = path.display();
            Error::Input(format!("{path}: is a mesh, not a volume; `paros bake` makes one of it"))
        }
        error => Error::input(error),
    })
}

/// Whether a file begins as a volume does.
pub(super) fn is_one(path: &Path) -> bool {
    rmap::peek(path).is_ok()
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

/// Refuses a name that says another kind of file than is written. One without an ending says none.
pub(super) fn check_ending(output: &Path, expected: &str) -> Result<(), Error> {
    match output.extension() {
        Some(ending) if !ending.eq_ignore_ascii_case(expected) => {
            let output = output.display();
            Err(Error::Input(format!("{output}: expected a name in .{expected}, which is written")))
        }
        _ => Ok(()),
    }
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
