//! A mesh or a volume from a file.

use std::path::Path;

use paros_core::bake::Up;
use paros_core::size::{Grid, Size};
use paros_shell::rmap;
use paros_shell::statics::Resident;

use crate::mesh::{self, ENDINGS, Kind};

/// Whether a file's name says that it can be opened.
#[must_use]
pub(super) fn is_known(path: &Path) -> bool {
    is_volume(path) || Kind::of(path).is_some()
}

fn is_volume(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("rmap"))
}

/// Reads a file into the resident maps: an `.rmap` of N voxels a side, or a mesh.
///
/// # Errors
/// Why it can't be sculpted in.
pub(super) fn load<const N: usize>(path: &Path) -> Result<(), String>
where
    Grid<N>: Size + Resident<N>,
{
    let mut maps = Grid::<N>::maps();
    if is_volume(path) {
        let header = rmap::peek(path).map_err(|error| error.to_string())?;
        if header.n != N {
            let (path, n) = (path.display(), header.n);
            return Err(format!("{path}: is a volume of {n}, this studio takes {N}"));
        }
        rmap::read(path, &mut maps).map_err(|error| error.to_string())?;
    } else if !is_known(path) {
        let path = path.display();
        return Err(format!("{path}: no mesh or volume; expected a name in .rmap, {ENDINGS}"));
    } else {
        let mesh = mesh::read(path).map_err(|error| error.to_string())?;
        let up = Kind::of(path).map_or(Up::Y, Kind::up);
        let (mut baker, mut plane) = (Grid::<N>::baker(), Grid::<N>::plane());
        mesh.bake(up, &mut baker, &mut maps, &mut plane)
            .ok_or_else(|| format!("{}: the mesh has no extent", path.display()))?;
    }
    match maps.is_empty() {
        true => Err(format!("{}: the volume is empty", path.display())),
        false => Ok(()),
    }
}
