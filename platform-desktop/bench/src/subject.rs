//! Benchmark inputs: meshes, volumes from files, and the project's own figures.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use paros_core::convert::{ExportPhase, UpAxis};
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Exporter, RangeMaps};
use paros_headless::Error;
use paros_shell::figures::Figure;
use paros_shell::mesh::{self, EXTENSIONS, Mesh, MeshFormat};
use paros_shell::rmap::{self, RmapHeader};
use paros_shell::sizes::GRID_SIDES;
use paros_shell::statics::Resident;
use paros_shell::stl_export::DEFAULT_HEIGHT_MM;
use paros_shell::with_size;

/// A benchmark input.
#[derive(Debug)]
pub struct BenchSubject {
    name: String,
    source: Source,
}

#[derive(Debug)]
enum Source {
    Figure(Figure),
    Mesh(Mesh, UpAxis),
    Volume(PathBuf, RmapHeader),
}

impl BenchSubject {
    /// Returns the default inputs: the project's own figures.
    #[must_use]
    pub fn default_figures() -> Vec<Self> {
        let figures = [Figure::Owl, Figure::Cat].map(|figure| BenchSubject {
            name: figure.name().into(),
            source: Source::Figure(figure),
        });
        figures.into()
    }

    /// Returns the input that a command-line argument names: a figure, a volume (.rmap) or a mesh.
    ///
    /// # Errors
    /// Names the file, and the reason why it can't be measured.
    pub fn from_name_or_path(name_or_path: &Path) -> Result<Self, Error> {
        let text = name_or_path.to_string_lossy();
        if let Some(figure) = Figure::from_name(&text) {
            let source = Source::Figure(figure);
            return Ok(BenchSubject { name: text.into(), source });
        }
        let name = name_or_path.file_stem().map_or(text, |stem| stem.to_string_lossy()).into();
        if name_or_path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("rmap")) {
            let header = rmap::read_sculpture_header(name_or_path).map_err(Error::input)?;
            let source = Source::Volume(name_or_path.into(), header);
            return Ok(BenchSubject { name, source });
        }
        let kind = MeshFormat::from_extension(name_or_path)
            .ok_or_else(|| unknown_subject(name_or_path))?;
        let (mesh, up) = (mesh::read(name_or_path).map_err(Error::input)?, kind.default_up_axis());
        Ok(BenchSubject { name, source: Source::Mesh(mesh, up) })
    }

    /// Returns the subject's name in rows.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the grid sides at which the subject is available.
    #[must_use]
    pub fn grid_sides(&self) -> &[usize] {
        match &self.source {
            Source::Volume(_, header) => std::slice::from_ref(&header.grid_side),
            _ => &GRID_SIDES,
        }
    }

    /// Describes how many voxels are filled to leave one interval a column, for a volume with more: the
    /// rivals have one interval, and two are compared on the same voxels.
    ///
    /// # Errors
    /// The file doesn't contain a volume.
    pub(super) fn describe_closing_to_one(&self) -> Result<Option<String>, Error> {
        let Source::Volume(path, header) = &self.source else { return Ok(None) };
        if header.intervals_per_column == 1 {
            return Ok(None);
        }
        let filled = with_size!(header.grid_side, N => {
            rmap::read_closed(path, &mut *<Grid<N> as Resident<N, 1>>::lock_range_maps())
        });
        let (path, filled) = (path.display(), filled.map_err(Error::input)?);
        Ok(Some(format!("{path}: {filled} voxels filled to leave 1 interval a column")))
    }

    /// Writes the subject's tight maps, and its voxels to `bit_grid`. A volume with more intervals a column
    /// is closed to one.
    ///
    /// # Errors
    /// The file contains no volume, or an empty one.
    pub(super) fn load_into<const N: usize>(
        &self,
        maps: &mut RangeMaps<N>,
        bit_grid: &mut BitGrid<N>,
    ) -> Result<(), Error>
    where
        Grid<N>: Size + Resident<N, 1>,
    {
        match &self.source {
            Source::Figure(figure) => figure.rasterize_into(maps, bit_grid),
            Source::Mesh(mesh, up) => {
                mesh.bake_into_maps(*up, &mut *Grid::<N>::lock_baker(), maps, bit_grid)
                    .ok_or_else(|| {
                        Error::Input(format!("{}: the mesh has no extent", self.name))
                    })?;
            }
            Source::Volume(path, _) => {
                rmap::read_closed(path, &mut *maps).map_err(Error::input)?;
                bit_grid.set_from_maps(maps);
            }
        }
        if maps.is_empty() {
            return Err(Error::Input(format!("{}: the volume is empty", self.name)));
        }
        Ok(())
    }

    /// Converts the subject to triangles, with their up axis: the mesh itself, or the STL export of the
    /// volume. `maps` and `bit_grid` are scratch space.
    ///
    /// # Errors
    /// The same as for [`BenchSubject::load_into`].
    pub(super) fn to_mesh<const N: usize>(
        &self,
        maps: &mut RangeMaps<N>,
        bit_grid: &mut BitGrid<N>,
    ) -> Result<(Cow<'_, Mesh>, UpAxis), Error>
    where
        Grid<N>: Size + Resident<N, 1>,
    {
        if let Source::Mesh(mesh, up) = &self.source {
            return Ok((Cow::Borrowed(mesh), *up));
        }
        self.load_into(maps, bit_grid)?;
        maps.clear();
        let stl = export_stl(bit_grid, maps, &mut Grid::<N>::lock_stl_buffers().exporter);
        let mesh = Mesh::from_bytes(MeshFormat::Stl, &stl, Path::new(""))
            .map_err(|fault| Error::Failure(format!("{}: its print: {fault:?}", self.name)))?;
        Ok((Cow::Owned(mesh), MeshFormat::Stl.default_up_axis()))
    }
}

fn unknown_subject(what: &Path) -> Error {
    let (what, figures) = (what.display(), Figure::ALL.map(Figure::name).join(", "));
    Error::Input(format!(
        "{what}: nothing to measure on; expected a figure ({figures}), or a name in .rmap, {EXTENSIONS}"
    ))
}

/// Exports bit rows to STL bytes in memory, at the default height.
pub(super) fn export_stl<const N: usize, const K: usize>(
    bit_grid: &BitGrid<N>,
    mask: &RangeMaps<N, K>,
    exporter: &mut Exporter<N>,
) -> Vec<u8>
where
    Grid<N>: Size,
{
    exporter.start_export(DEFAULT_HEIGHT_MM).expect("a usual height");
    let (mut file, mut buffer) = (vec![], vec![0; Exporter::<N>::MIN_BUFFER]);
    loop {
        let progress = exporter.advance_export(bit_grid, mask, u32::MAX, &mut buffer);
        file.extend_from_slice(&buffer[..progress.written]);
        if progress.phase == ExportPhase::Done {
            return file;
        }
    }
}
