//! Loading of a mesh or a volume as the stone to carve.

use std::path::Path;

use paros_core::convert::UpAxis;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::mesh::{self, EXTENSIONS, MeshFormat};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};

/// Whether a file's extension is that of a mesh or a volume.
#[must_use]
pub(super) fn has_known_extension(path: &Path) -> bool {
    has_volume_extension(path) || MeshFormat::from_extension(path).is_some()
}

fn has_volume_extension(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("rmap"))
}

/// Reads a file into the resident maps: an `.rmap` of N voxels a side, or a mesh.
///
/// # Errors
/// A text: the file, and why it can't be carved.
pub(super) fn read_into_resident_maps<const N: usize>(path: &Path) -> Result<(), String>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let mut maps = Grid::<N>::lock_range_maps();
    if has_volume_extension(path) {
        let header = rmap::read_header(path).map_err(|error| error.to_string())?;
        if header.grid_side != N {
            let (path, n) = (path.display(), header.grid_side);
            return Err(format!("{path}: is a volume of {n}, this studio takes {N}"));
        }
        rmap::read(path, &mut maps).map_err(|error| error.to_string())?;
    } else if !has_known_extension(path) {
        let path = path.display();
        return Err(format!("{path}: no mesh or volume; expected a name in .rmap, {EXTENSIONS}"));
    } else {
        let mesh = mesh::read(path).map_err(|error| error.to_string())?;
        let up = MeshFormat::from_extension(path).map_or(UpAxis::Y, MeshFormat::default_up_axis);
        let (mut baker, mut bit_grid) = (Grid::<N>::lock_baker(), Grid::<N>::lock_bit_grid());
        mesh.bake_into_maps(up, &mut baker, &mut maps, &mut bit_grid)
            .ok_or_else(|| format!("{}: the mesh has no extent", path.display()))?;
    }
    match maps.is_empty() {
        true => Err(format!("{}: the volume is empty", path.display())),
        false => Ok(()),
    }
}
