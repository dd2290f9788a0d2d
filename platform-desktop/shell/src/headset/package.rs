//! The contents of the app's package (APK) that both its maker and the headset's shell name: start
//! volumes as assets, so that a headset need not make them, and Khronos' OpenXR loader.

use crate::rmap::{self, RmapFaultAt};
use crate::start_volume_store::{StartVolume, StartVolumeStore};
use paros_core::RangeMaps;
use paros_core::volume::{Grid, Size};

/// The file name of Khronos' OpenXR loader in the package, beside the shell's own library.
pub const OPENXR_LOADER: &str = "libopenxr_loader.so";

/// Why the start volumes of a package can't be used.
#[derive(Debug)]
pub enum AssetError {
    /// The package lacks the asset of this name.
    Missing(String),
    /// The asset of this name is damaged at a byte.
    Damaged(String, RmapFaultAt),
}

/// The name of the asset that holds a start volume of a size: an `.rmap`.
#[must_use]
pub fn start_volume_asset<const N: usize>(volume: StartVolume) -> String {
    format!("starts/{N}/{}.rmap", volume.name())
}

/// Loads the start volumes from a package, where `open_asset` gives the bytes of an asset by its name.
///
/// # Errors
/// An asset is missing or damaged. Then the volumes are still to be made.
pub fn load_start_volumes<const N: usize, const K: usize>(
    volumes: &mut StartVolumeStore<N, K>,
    open_asset: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(), AssetError>
where
    Grid<N>: Size,
{
    volumes.load(|volume, maps: &mut RangeMaps<N, K>| {
        let name = start_volume_asset::<N>(volume);
        let Some(bytes) = open_asset(&name) else { return Err(AssetError::Missing(name)) };
        rmap::decode(&bytes, maps).map_err(|found| AssetError::Damaged(name, found))
    })
}

impl std::fmt::Display for AssetError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AssetError::Missing(name) => write!(f, "{name}: missing in the package"),
            AssetError::Damaged(name, RmapFaultAt { offset, fault }) => {
                write!(f, "{name}: byte {offset}: {fault}")
            }
        }
    }
}

impl std::error::Error for AssetError {}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use crate::rmap;
    use crate::start_volume_store::{StartVolume, StartVolumeStore};
    use paros_core::limits::INTERVALS;
    use paros_core::volume::BitGrid;

    use super::{AssetError, load_start_volumes, start_volume_asset};

    #[test]
    fn packaged_volumes_are_the_ones_that_would_be_made() {
        let [mut made, mut taken, mut broken] =
            [const { StartVolumeStore::<64, INTERVALS>::new() }; 3].map(Box::new);
        made.generate_once(&mut BitGrid::new(), |_| {});
        let made = &made;
        let bytes_of = |name: &str| {
            let named = |volume: &StartVolume| name == start_volume_asset::<64>(*volume);
            Some(rmap::encode(made.volume(StartVolume::all().find(named)?)))
        };
        let asked = Cell::new(0);
        let open = |name: &str| {
            asked.set(asked.get() + 1);
            bytes_of(name)
        };
        load_start_volumes(&mut taken, open).expect("all are there");
        assert_eq!(asked.get(), StartVolume::all().count());
        for volume in StartVolume::all() {
            assert_eq!(rmap::encode(taken.volume(volume)), rmap::encode(made.volume(volume)));
        }
        // They need not be made any more.
        taken.generate_once(&mut BitGrid::new(), |_| panic!("made again"));

        let without = |name: &str| bytes_of(name).filter(|_| !name.contains("cat.rmap"));
        let why = load_start_volumes(&mut broken, without).expect_err("one is missing");
        assert!(matches!(&why, AssetError::Missing(name) if name == "starts/64/cat.rmap"));
        let cut = |name: &str| bytes_of(name).map(|bytes| bytes[..bytes.len() - 1].to_vec());
        let why = load_start_volumes(&mut broken, cut).expect_err("all are short");
        assert!(matches!(why, AssetError::Damaged(..)), "{why}");
        let again = Cell::new(0);
        broken.generate_once(&mut BitGrid::new(), |_| again.set(again.get() + 1));
        assert_eq!(again.get(), StartVolume::all().count());
    }
}
