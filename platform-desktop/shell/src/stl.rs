//! A sculpture as an STL file: the core's exporter, drained into a durable file.

use std::path::Path;

use paros_core::export::{Exporter, Stage};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};

use crate::durable::{self, Target};

/// Work units between two looks at the buffer.
const BUDGET: u32 = 4096;

/// What is exported: the voxels and the mask that supports some of them (empty for none).
#[derive(Debug)]
pub struct Sculpture<'a, const N: usize>
where
    Grid<N>: Size,
{
    /// The voxels.
    pub rows: &'a Plane<N>,
    /// The mask.
    pub mask: &'a Maps<N>,
}

/// What was written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Exported {
    /// Triangles in the file.
    pub triangles: u32,
    /// Length of the file.
    pub bytes: u64,
}

/// Why there is no file.
#[derive(Debug)]
pub enum Error {
    /// A height outside [`paros_core::export::HEIGHTS_MM`].
    Height(f32),
    /// The volume is empty.
    Empty,
    /// The folder or the disk refused.
    File(durable::Error),
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Error::Height(height) => write!(f, "no model can be {height} mm high"),
            Error::Empty => write!(f, "the volume is empty: nothing to export"),
            Error::File(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::File(error) => Some(error),
            Error::Height(_) | Error::Empty => None,
        }
    }
}

/// Writes the model, `height_mm` high, whole or not at all.
///
/// # Errors
/// See [`Error`].
pub fn write<const N: usize>(
    path: &Path,
    sculpture: &Sculpture<'_, N>,
    height_mm: f32,
    exporter: &mut Exporter<N>,
) -> Result<Exported, Error>
where
    Grid<N>: Size,
{
    exporter.start(height_mm).map_err(|error| Error::Height(error.0))?;
    let target = Target::tried(path).map_err(Error::File)?;
    let mut buffer = vec![0; Exporter::<N>::MIN_BUFFER];
    let mut file = Vec::new();
    loop {
        let progress = exporter.advance(sculpture.rows, sculpture.mask, BUDGET, &mut buffer);
        if exporter.triangles() == Some(0) {
            return Err(Error::Empty);
        }
        file.extend_from_slice(&buffer[..progress.written]);
        if progress.stage == Stage::Done {
            break;
        }
    }
    target.write(&file).map_err(Error::File)?;
    Ok(Exported { triangles: exporter.triangles().unwrap_or(0), bytes: file.len() as u64 })
}
