//! Loading of a mesh or a volume as the stone to carve.

use std::path::Path;

use paros_core::convert::UpAxis;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::mesh::{self, EXTENSIONS, MeshFormat};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};

/// Returns `true` if a file has the extension of a mesh or a volume.
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
/// A text that names the file and the reason.
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

#[cfg(test)]
mod tests {
    use std::fs;

    use paros_core::RangeMaps;
    use paros_core::volume::{Axis, BitSet};

    use super::*;

    /// Encodes a block with a slot from above, in columns of K intervals.
    fn encode_slotted_block<const K: usize>() -> Vec<u8> {
        let (mut bits, mut maps) =
            (Grid::<128>::lock_bit_grid(), Box::new(RangeMaps::<128, K>::new()));
        bits.clear();
        for y in 0..80 {
            for z in 20..100 {
                let slotted = y < 40 || !(50..60).contains(&z);
                (20..100).for_each(|x| bits.row_mut(y, z).insert_if(slotted, x));
            }
        }
        bits.write_closure(&mut maps);
        rmap::encode(&maps)
    }

    #[test]
    fn volumes_of_one_interval_a_column_open_as_they_are_and_of_three_not() {
        let folder = std::env::temp_dir().join(format!("paros-opening-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("v.rmap");
        let open = |bytes| {
            fs::write(&path, bytes).unwrap();
            read_into_resident_maps::<128>(&path)
        };
        let opened = || <Grid<128> as Resident<128, INTERVALS>>::lock_range_maps();
        let of_two = encode_slotted_block::<2>();
        assert_eq!(open(encode_slotted_block::<1>()), Ok(()));
        assert!(opened().column(Axis::Z, (60, 30)).has_gaps());
        assert!(rmap::encode(&*opened()) == of_two, "as if it had been written with two");
        let refused = open(encode_slotted_block::<3>()).unwrap_err();
        assert!(refused.contains("at most 2 intervals, found 3"), "{refused}");
        assert!(rmap::encode(&*opened()) == of_two, "it leaves the maps alone");
        fs::remove_dir_all(&folder).unwrap();
    }
}
