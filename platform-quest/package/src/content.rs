//! The operator's content of a package: settings for all its headsets, the fleet file by which they enrol at
//! a booth, and hidden figures. All of it is checked before anything is built.

use std::path::{Path, PathBuf};

use paros_core::RangeMaps;
use paros_core::convert::UpAxis;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::durable;
use paros_shell::figures::{check_own_figure_names, coat_margin, write_coat_into};
use paros_shell::headset::package::{
    FIGURES_ASSET, FLEET_ASSET, SETTINGS_ASSET, own_figure_assets,
};
use paros_shell::mesh::{self, Mesh, MeshFormat};
use paros_shell::rmap;
use paros_shell::settings::{LoadedSettings, MAX_BYTES, SettingsLayer};
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_upload::enrolment::FleetFile;

use crate::error::PackageError;

/// The operator's content, read and checked.
#[derive(Debug)]
pub(crate) struct OperatorContent {
    settings: Option<Vec<u8>>,
    fleet: Option<Vec<u8>>,
    names: Vec<String>,
    /// The figures, in the order of their names.
    figures: Vec<OwnMesh>,
}

/// A figure's mesh.
#[derive(Debug)]
struct OwnMesh {
    path: PathBuf,
    mesh: Mesh,
    up: UpAxis,
}

impl OperatorContent {
    /// Reads and checks the content.
    ///
    /// # Errors
    /// All faults of the settings, or the fault of the fleet file or of a figure, with the expected value.
    pub(crate) fn read(
        settings: Option<&Path>,
        fleet: Option<&Path>,
        meshes: &[PathBuf],
    ) -> Result<Self, PackageError> {
        let names: Vec<_> = meshes.iter().map(|path| figure_name(path)).collect();
        check_own_figure_names(&names)
            .map_err(|why| PackageError::Input(format!("--figure: {why}")))?;
        let settings = settings.map(|path| read_settings(path, &names)).transpose()?;
        let fleet = fleet.map(read_fleet_file).transpose()?;
        let figures = meshes.iter().map(|path| OwnMesh::read(path)).collect::<Result<_, _>>()?;
        Ok(OperatorContent { settings, fleet, names, figures })
    }

    /// Returns the names of the figures.
    pub(crate) fn figure_names(&self) -> &[String] {
        &self.names
    }

    /// Converts the content to assets, with their names.
    ///
    /// # Errors
    /// A figure that is empty after it is baked.
    pub(crate) fn into_assets(self) -> Result<Vec<(String, Vec<u8>)>, PackageError> {
        let mut assets = Vec::new();
        assets.extend(self.settings.map(|bytes| (SETTINGS_ASSET.to_owned(), bytes)));
        assets.extend(self.fleet.map(|bytes| (FLEET_ASSET.to_owned(), bytes)));
        if !self.names.is_empty() {
            let list = self.names.join("\n") + "\n";
            assets.push((FIGURES_ASSET.to_owned(), list.into_bytes()));
        }
        for (name, own) in self.names.iter().zip(&self.figures) {
            eprintln!("figure {name}");
            assets.extend(own.bake::<128>(name)?);
            assets.extend(own.bake::<256>(name)?);
        }
        Ok(assets)
    }
}

impl OwnMesh {
    fn read(path: &Path) -> Result<Self, PackageError> {
        let mesh = mesh::read(path).map_err(PackageError::input)?;
        let up = MeshFormat::from_extension(path).map_or(UpAxis::Y, MeshFormat::default_up_axis);
        Ok(OwnMesh { path: path.to_owned(), mesh, up })
    }

    /// Bakes the figure and its stone at a size.
    fn bake<const N: usize>(&self, name: &str) -> Result<[(String, Vec<u8>); 2], PackageError>
    where
        Grid<N>: Size + Resident<N, INTERVALS>,
    {
        let mut figure: Box<RangeMaps<N, INTERVALS>> = Box::new(RangeMaps::new());
        let (mut baker, mut bits) = (Grid::<N>::lock_baker(), Grid::<N>::lock_bit_grid());
        let baked = self.mesh.bake_with_margin_into_maps(
            coat_margin(N),
            self.up,
            &mut *baker,
            &mut *figure,
            &mut *bits,
        );
        if baked.is_none() || figure.is_empty() {
            let path = self.path.display();
            return Err(PackageError::Input(format!("{path}: the mesh has no extent")));
        }
        let mut stone = Grid::<N>::lock_range_maps();
        let mut scratch = Box::new(paros_core::volume::BitGrid::<N>::new());
        write_coat_into(&bits, &mut *stone, &mut scratch);
        let [figure_name, stone_name] = own_figure_assets::<N>(name);
        Ok([(figure_name, rmap::encode(&*figure)), (stone_name, rmap::encode(&*stone))])
    }
}

/// Returns the name of a figure, which is also that of its mode: the file's name without the extension.
fn figure_name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads the bytes of a settings file that has no faults.
fn read_settings(path: &Path, own_figures: &[String]) -> Result<Vec<u8>, PackageError> {
    let shown = path.display().to_string();
    let bytes = durable::read_regular_file_up_to(path, MAX_BYTES)
        .map_err(|error| PackageError::Input(format!("{shown}: {error}")))?;
    let mut layer = SettingsLayer::parse_bytes(&shown, &bytes, own_figures);
    layer.faults.extend(layer.find_contradictions());
    let mut faults: Vec<_> = layer.faults.iter().map(|fault| fault.describe(&shown)).collect();
    let settings = LoadedSettings::merge(&[layer]).settings;
    let contradiction = settings.find_contradiction(own_figures);
    faults.extend(contradiction.map(|why| format!("{shown}: record: {why}")));
    if faults.is_empty() { Ok(bytes) } else { Err(PackageError::Input(faults.join("\n"))) }
}

/// Reads the bytes of a fleet file that has no faults.
fn read_fleet_file(path: &Path) -> Result<Vec<u8>, PackageError> {
    FleetFile::read(path).map_err(PackageError::input)?;
    let bytes = durable::read_regular_file(path);
    bytes.map_err(|error| PackageError::Input(format!("{}: {error}", path.display())))
}
