//! The contents of the app's package (APK) that both its build and the headset's shell refer to.
//!
//! They are start volumes as assets, so that a headset need not generate them, the operator's own hidden
//! figures, settings, a fleet file, and Khronos' OpenXR loader.

use crate::figures::check_own_figure_names;
use crate::rmap::{self, RmapFaultAt};
use crate::settings;
use crate::start_volume_store::{StartVolume, StartVolumeStore};
use paros_core::RangeMaps;
use paros_core::volume::{Grid, Size};

/// The file name of Khronos' OpenXR loader in the package, beside the shell's own library.
pub const OPENXR_LOADER: &str = "libopenxr_loader.so";

/// The name of the asset that holds the package's settings file.
pub const SETTINGS_ASSET: &str = settings::FILE_NAME;

/// The name of the asset that holds the fleet file, with which headsets enrol at a booth.
pub const FLEET_ASSET: &str = "fleet.toml";

/// The name of the asset that lists the operator's own figures, one name per line.
pub const FIGURES_ASSET: &str = "figures.txt";

/// The folder of the assets of the operator's own figures.
pub const FIGURES_FOLDER: &str = "figures/";

/// The reason why the start volumes of a package can't be used.
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// The package lacks the asset of this name.
    #[error("{0}: missing in the package")]
    Missing(String),
    /// The asset of this name is damaged at a byte.
    #[error("{0}: byte {at}: {fault}", at = .1.offset, fault = .1.fault)]
    Damaged(String, RmapFaultAt),
    /// The list of the operator's own figures is invalid, with the reason.
    #[error("{file}: {0}", file = FIGURES_ASSET)]
    BadList(String),
}

/// Returns the name of the `.rmap` asset that holds a start volume of a size.
#[must_use]
pub fn start_volume_asset<const N: usize>(volume: StartVolume) -> String {
    format!("starts/{N}/{}.rmap", volume.name())
}

/// Returns the names of the two `.rmap` assets that hold one of the operator's own figures and its stone, at
/// a size.
#[must_use]
pub fn own_figure_assets<const N: usize>(name: &str) -> [String; 2] {
    ["", "-stone"].map(|part| format!("{FIGURES_FOLDER}{N}/{name}{part}.rmap"))
}

/// Returns the names of the operator's own figures in a package; an empty list if the package has no list.
///
/// # Errors
/// Returns an error if [`check_own_figure_names`] rejects the list.
pub fn read_own_figure_names(
    open_asset: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<Vec<String>, AssetError> {
    let Some(bytes) = open_asset(FIGURES_ASSET) else { return Ok(Vec::new()) };
    let names = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect::<Vec<_>>();
    check_own_figure_names(&names).map_err(AssetError::BadList)?;
    Ok(names)
}

/// Loads the operator's own figures of these names from a package.
///
/// # Errors
/// Returns an error if an asset is missing or damaged. The store then has none of these figures.
pub fn load_own_figures<const N: usize, const K: usize>(
    names: &[String],
    volumes: &mut StartVolumeStore<N, K>,
    open_asset: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(), AssetError>
where
    Grid<N>: Size,
{
    volumes.load_own_figures(names, |name, figure, stone| {
        let [figure_name, stone_name] = own_figure_assets::<N>(name);
        load_asset(figure_name, figure, &open_asset)?;
        load_asset(stone_name, stone, &open_asset)
    })
}

/// Loads the start volumes from a package. `open_asset` returns the bytes of an asset by its name.
///
/// # Errors
/// Returns an error if an asset is missing or damaged. The volumes must then be generated.
pub fn load_start_volumes<const N: usize, const K: usize>(
    volumes: &mut StartVolumeStore<N, K>,
    open_asset: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(), AssetError>
where
    Grid<N>: Size,
{
    volumes.load(|volume, maps| load_asset(start_volume_asset::<N>(volume), maps, &open_asset))
}

fn load_asset<const N: usize, const K: usize>(
    name: String,
    maps: &mut RangeMaps<N, K>,
    open_asset: &impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(), AssetError>
where
    Grid<N>: Size,
{
    let Some(bytes) = open_asset(&name) else { return Err(AssetError::Missing(name)) };
    rmap::decode(&bytes, maps).map_err(|found| AssetError::Damaged(name, found))
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use crate::rmap;
    use crate::start_volume_store::{StartVolume, StartVolumeStore};
    use paros_core::limits::INTERVALS;
    use paros_core::volume::BitGrid;

    use super::{
        AssetError, FIGURES_ASSET, load_own_figures, load_start_volumes, read_own_figure_names,
        start_volume_asset,
    };
    use crate::figures::Figure;

    /// Returns a store on the heap; several would exceed a test's stack.
    #[inline(never)]
    fn new_store() -> Box<StartVolumeStore<64, INTERVALS>> {
        Box::new(const { StartVolumeStore::new() })
    }

    #[test]
    fn own_figures_follow_the_others_and_one_that_is_damaged_leaves_none() {
        let [mut taken, mut made] = [(); 2].map(|()| new_store());
        made.generate_once(&mut BitGrid::new(), |_| {});
        let [cat, lump] =
            [Figure::Cat, Figure::Lump].map(|figure| rmap::encode(made.figure(figure)));
        let open = |name: &str| match name {
            FIGURES_ASSET => Some(b"lion\nhand\n".to_vec()),
            "figures/64/lion.rmap" | "figures/64/hand.rmap" => Some(cat.clone()),
            "figures/64/lion-stone.rmap" | "figures/64/hand-stone.rmap" => Some(lump.clone()),
            _ => None,
        };
        let names = read_own_figure_names(open).expect("a list");
        assert_eq!(names, ["lion", "hand"]);
        let built_in = taken.hidden_figures().len();
        load_own_figures(&names, &mut taken, open).expect("all are there");
        let hidden = taken.hidden_figures();
        assert_eq!(hidden.len(), built_in + 2);
        assert!(rmap::encode(hidden[built_in + 1].figure) == cat);
        assert!(rmap::encode(hidden[built_in + 1].stone) == lump);
        let name = |number: usize| taken.hidden_figure_name(number as u8);
        assert_eq!(
            [name(built_in + 1), name(built_in + 2), name(9)],
            [Some("hand"), None, Some("cat")]
        );

        let cut = |name: &str| open(name).filter(|_| name != "figures/64/hand-stone.rmap");
        let why = load_own_figures(&names, &mut taken, cut).expect_err("one is missing");
        assert_eq!(why.to_string(), "figures/64/hand-stone.rmap: missing in the package");
        assert_eq!(taken.hidden_figures().len(), built_in);
        assert_eq!(read_own_figure_names(|_| None).expect("no list"), [""; 0]);
        let bad = read_own_figure_names(|_| Some(b"owl".to_vec())).expect_err("a name of another");
        assert!(bad.to_string().starts_with("figures.txt: owl: "), "{bad}");
    }

    #[test]
    fn packaged_volumes_are_the_ones_that_would_be_made() {
        let [mut made, mut taken, mut broken] = [(); 3].map(|()| new_store());
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
        // They are not generated again.
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
