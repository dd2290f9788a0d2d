//! What is measured on: meshes, volumes from files, and the project's own figures.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use paros_core::bake::Up;
use paros_core::export::{Exporter, Stage};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_shell::figures::Figure;
use paros_shell::print::HEIGHT_MM;
use paros_shell::rmap;
use paros_shell::statics::Resident;

use crate::error::Error;
use crate::mesh::{self, ENDINGS, Kind, Mesh};

/// One thing to measure on.
#[derive(Debug)]
pub struct Subject {
    name: String,
    source: Source,
}

#[derive(Debug)]
enum Source {
    Figure(Figure),
    Mesh(Mesh, Up),
    /// A volume file of that size.
    Volume(PathBuf, usize),
}

impl Subject {
    /// The project's own, for when nothing is named.
    #[must_use]
    pub fn own() -> Vec<Self> {
        let own = [Figure::Owl, Figure::Cat]
            .map(|figure| Subject { name: figure.name().into(), source: Source::Figure(figure) });
        own.into()
    }

    /// The one meant on the command line: a figure's name, a volume (.rmap) or a mesh.
    ///
    /// # Errors
    /// The file, and why it can't be measured on.
    pub fn named(what: &Path) -> Result<Self, Error> {
        let text = what.to_string_lossy();
        if let Some(figure) = Figure::named(&text) {
            let source = Source::Figure(figure);
            return Ok(Subject { name: text.into(), source });
        }
        let name = what.file_stem().map_or(text, |stem| stem.to_string_lossy()).into();
        if what.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("rmap")) {
            let size = match rmap::peek(what).map_err(Error::input)?.n {
                size @ (128 | 256) => size,
                n => {
                    let what = what.display();
                    return Err(Error::Input(format!(
                        "{what}: expected a volume of size 128 or 256, found {n}"
                    )));
                }
            };
            let source = Source::Volume(what.into(), size);
            return Ok(Subject { name, source });
        }
        let kind = Kind::of(what).ok_or_else(|| unknown(what))?;
        let (mesh, up) = (mesh::read(what).map_err(Error::input)?, kind.up());
        Ok(Subject { name, source: Source::Mesh(mesh, up) })
    }

    /// What it is called in a row.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sizes it can be had at.
    #[must_use]
    pub fn sizes(&self) -> &[usize] {
        match &self.source {
            Source::Volume(_, size) => std::slice::from_ref(size),
            _ => &[128, 256],
        }
    }

    /// Writes its tight maps, and their voxels to `plane`.
    ///
    /// # Errors
    /// The file doesn't hold a volume, or an empty one.
    pub(super) fn load<const N: usize>(
        &self,
        maps: &mut Maps<N>,
        plane: &mut Plane<N>,
    ) -> Result<(), Error>
    where
        Grid<N>: Size + Resident<N>,
    {
        match &self.source {
            Source::Figure(figure) => figure.carve_into(plane, maps),
            Source::Mesh(mesh, up) => {
                mesh.bake(*up, &mut *Grid::<N>::baker(), maps, plane).ok_or_else(|| {
                    Error::Input(format!("{}: the mesh has no extent", self.name))
                })?;
            }
            Source::Volume(path, _) => {
                rmap::read(path, &mut *maps).map_err(Error::input)?;
                plane.expand(maps);
            }
        }
        if maps.is_empty() {
            return Err(Error::Input(format!("{}: the volume is empty", self.name)));
        }
        Ok(())
    }

    /// Its triangles: those of the mesh, or those of the print.
    ///
    /// # Errors
    /// As [`Subject::load`].
    pub(super) fn triangles<const N: usize>(
        &self,
        maps: &mut Maps<N>,
        plane: &mut Plane<N>,
    ) -> Result<(Cow<'_, Mesh>, Up), Error>
    where
        Grid<N>: Size + Resident<N>,
    {
        if let Source::Mesh(mesh, up) = &self.source {
            return Ok((Cow::Borrowed(mesh), *up));
        }
        self.load(maps, plane)?;
        maps.clear();
        let stl = print(plane, maps, &mut Grid::<N>::press().exporter);
        let mesh = Mesh::from_bytes(Kind::Stl, &stl, Path::new(""))
            .map_err(|fault| Error::Failure(format!("{}: its print: {fault:?}", self.name)))?;
        Ok((Cow::Owned(mesh), Kind::Stl.up()))
    }
}

fn unknown(what: &Path) -> Error {
    let (what, figures) = (what.display(), Figure::ALL.map(Figure::name).join(", "));
    Error::Input(format!(
        "{what}: nothing to measure on; expected a figure ({figures}), or a name in .rmap, {ENDINGS}"
    ))
}

/// The STL file of a plane, in memory.
pub(super) fn print<const N: usize>(
    plane: &Plane<N>,
    mask: &Maps<N>,
    exporter: &mut Exporter<N>,
) -> Vec<u8>
where
    Grid<N>: Size,
{
    exporter.start(HEIGHT_MM).expect("a usual height");
    let (mut file, mut buffer) = (vec![], vec![0; Exporter::<N>::MIN_BUFFER]);
    loop {
        let progress = exporter.advance(plane, mask, u32::MAX, &mut buffer);
        file.extend_from_slice(&buffer[..progress.written]);
        if progress.stage == Stage::Done {
            return file;
        }
    }
}
