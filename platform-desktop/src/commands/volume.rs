//! Checks of volume files that the commands share.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use paros_core::RangeMaps;
use paros_core::codec::trace;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shell::mesh::{EXTENSIONS, MeshFormat};
use paros_shell::rmap::{self, RmapFault, RmapHeader};
use paros_shell::sizes::{
    GRID_SIDE_NAMES, INTERVAL_COUNT_NAMES, grid_side_or_default, interval_count_or_default,
};
use paros_shell::stl_export::FinishedStl;

/// Number of bytes read to guess the kind of a file.
const FIRST_BYTES: u64 = 512;

/// Reads a volume file's header.
pub(super) fn read_header(path: &Path) -> Result<RmapHeader, Error> {
    rmap::read_sculpture_header(path).map_err(|error| match error {
        rmap::RmapError::Bad { fault: RmapFault::Magic(trace::MAGIC), .. } => {
            Error::Input(format!("{}: is a trace, not a volume; use `paros play`", path.display()))
        }
        rmap::RmapError::Bad { fault: RmapFault::Magic(_), .. }
            if MeshFormat::from_extension(path).is_some() =>
        {
            let path = path.display();
            Error::Input(format!("{path}: is a mesh, not a volume; `paros bake` makes one of it"))
        }
        rmap::RmapError::Bad { .. } if !has_known_kind(path) => Error::Input(unknown_kind(path)),
        error => Error::input(error),
    })
}

/// Returns `true` if a file's name or first bytes are those of a volume.
fn has_known_kind(path: &Path) -> bool {
    path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("rmap"))
        || read_first_bytes(path).starts_with(&rmap::MAGIC)
}

/// Returns a message that lists the supported kinds of file, and the likely kind of this one.
fn unknown_kind(path: &Path) -> String {
    let seems = guess_kind(&read_first_bytes(path));
    format!(
        "{}: neither a volume (.rmap) nor a mesh ({EXTENSIONS}) nor a trace; it seems to be {seems}",
        path.display()
    )
}

/// Reads a file's first bytes, as far as possible.
fn read_first_bytes(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let file = File::open(path).map(|file| file.take(FIRST_BYTES));
    // Bytes read before an error are enough for a guess.
    let _ = file.and_then(|mut file| file.read_to_end(&mut bytes));
    bytes
}

/// Guesses the kind of a file by its first bytes.
fn guess_kind(bytes: &[u8]) -> &'static str {
    let known: [(&[u8], &str); 9] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"%PDF", "a PDF document"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "packed by gzip"),
        (b"\x7fELF", "a program"),
        (b"glTF", "a glTF mesh, of another name"),
        (b"ply\n", "a PLY mesh, of another name"),
        (b"solid ", "an STL mesh, of another name"),
    ];
    let text_ends_in_a_character = |error: std::str::Utf8Error| error.error_len().is_none();
    let is_text = std::str::from_utf8(bytes).map_or_else(text_ends_in_a_character, |_| true)
        && !bytes.contains(&0);
    match known.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        Some((_, kind)) => kind,
        None if bytes.is_empty() => "empty",
        None if is_text => "text",
        None => "other binary data",
    }
}

/// Returns the command-line parser of a grid side.
pub(super) fn grid_side_parser() -> impl TypedValueParser<Value = usize> {
    PossibleValuesParser::new(GRID_SIDE_NAMES).map(|name| grid_side_or_default(&name))
}

/// Returns the command-line parser of the number of intervals in a column.
pub(super) fn interval_count_parser() -> impl TypedValueParser<Value = usize> {
    PossibleValuesParser::new(INTERVAL_COUNT_NAMES).map(|name| interval_count_or_default(&name))
}

/// Returns `true` if a file has a volume's header.
pub(super) fn has_volume_header(path: &Path) -> bool {
    rmap::read_header(path).is_ok()
}

/// The number of intervals per column with which a command opens a volume.
#[derive(Debug, clap::Args)]
pub(super) struct LayersOption {
    /// Intervals per column to open the volume with. Gaps that need more are filled, and reported.
    #[arg(long, value_name = "K", value_parser = interval_count_parser(), requires = "volume")]
    layers: Option<usize>,
}

impl LayersOption {
    /// Returns the number of intervals, K.
    pub(super) fn interval_count(&self) -> usize {
        self.layers.unwrap_or(INTERVALS)
    }

    /// Returns an error if the requested number of intervals differs from the file's.
    pub(super) fn check_intervals_of(&self, path: &Path, intervals: usize) -> Result<(), Error> {
        match self.layers {
            Some(asked) if asked != intervals => Err(Error::Input(format!(
                "{}: is of {}, not of {asked}",
                path.display(),
                name_interval_count(intervals)
            ))),
            _ => Ok(()),
        }
    }

    /// Reads a volume. An empty volume is an error, and so is one with more than K intervals a column, unless
    /// K was requested: then returns a line with the number of voxels filled.
    pub(super) fn read_nonempty_volume<const N: usize, const K: usize>(
        &self,
        path: &Path,
        maps: &mut RangeMaps<N, K>,
    ) -> Result<String, Error>
    where
        Grid<N>: Size,
    {
        if self.layers.is_none() || read_header(path)?.intervals_per_column <= K {
            return read_nonempty_volume(path, maps).map(|()| String::new());
        }
        let filled = rmap::read_closed(path, maps).map_err(Error::input)?;
        refuse_empty(path, maps)?;
        let (path, left) = (path.display(), name_interval_count(K));
        Ok(format!("{path}: {filled} voxels filled to leave {left}\n"))
    }
}

fn name_interval_count(intervals: usize) -> String {
    format!("{intervals} {} a column", if intervals == 1 { "interval" } else { "intervals" })
}

/// Reads a volume; an empty one is an error.
pub(super) fn read_nonempty_volume<const N: usize, const K: usize>(
    path: &Path,
    maps: &mut RangeMaps<N, K>,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    rmap::read(path, maps).map_err(Error::input)?;
    refuse_empty(path, maps)
}

fn refuse_empty<const N: usize, const K: usize>(
    path: &Path,
    maps: &RangeMaps<N, K>,
) -> Result<(), Error> {
    if maps.is_empty() {
        return Err(Error::Input(format!("{}: the volume is empty", path.display())));
    }
    Ok(())
}

/// Returns the STL file, or an error if the file `source` leaves nothing to print.
pub(super) fn require_nonempty_stl(
    stl: Option<FinishedStl>,
    source: &Path,
) -> Result<FinishedStl, Error> {
    stl.filter(|stl| stl.triangle_count > 0)
        .ok_or_else(|| Error::Input(format!("{}: nothing is left to print", source.display())))
}

/// Returns an error for a name whose extension is not `expected`. A name without an extension is accepted.
pub(super) fn refuse_other_extension(output: &Path, expected: &str) -> Result<(), Error> {
    match output.extension() {
        Some(ending) if !ending.eq_ignore_ascii_case(expected) => {
            let output = output.display();
            Err(Error::Input(format!("{output}: expected a name in .{expected}, which is written")))
        }
        _ => Ok(()),
    }
}

/// Returns an error if the output would overwrite the input.
pub(super) fn check_output_is_not_input(input: &Path, output: &Path) -> Result<(), Error> {
    match (input.canonicalize(), output.canonicalize()) {
        (Ok(a), Ok(b)) if a == b => {
            Err(Error::Input(format!("{}: is both input and output", output.display())))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::guess_kind;

    #[test]
    fn a_kind_is_guessed_by_the_first_bytes() {
        assert_eq!(guess_kind(b""), "empty");
        assert_eq!(guess_kind(b"# Paros\n"), "text");
        assert_eq!(guess_kind("cut within an \u{e9}".as_bytes().split_last().unwrap().1), "text");
        assert_eq!(guess_kind(b"\x89PNG\r\n"), "a PNG picture");
        assert_eq!(guess_kind(b"ply\nformat"), "a PLY mesh, of another name");
        assert_eq!(guess_kind(b"\xff\x00\x12"), "other binary data");
    }
}
