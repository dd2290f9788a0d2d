//! Mesh files: reads OBJ, STL, PLY and glTF into checked vertices and triangles.

mod bake;
mod builder;
mod findings;
mod gltf;
mod obj;
mod outlier;
mod ply;
mod shells;
mod stl;
mod text;

pub use bake::MeshBounds;
pub use findings::MeshFindings;
pub use outlier::Outlier;

use crate::durable;
use paros_core::convert::UpAxis;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The largest coordinate, in mesh units, that a facet may have: the Earth in tenths of a millimetre.
pub const COORDINATE_BOUND: f64 = 1e12;

/// The most triangles of a mesh: 42 for each column of the three maps at 256. Baking that many takes 600 MiB.
pub const MAX_TRIANGLES: usize = 1 << 23;

/// The most bytes of a file, and of a glTF's buffers together: 256 per triangle, as text needs.
pub const MAX_FILE_BYTES: u64 = 256 * MAX_TRIANGLES as u64;

/// The extensions that [`read`] accepts, for messages.
pub const EXTENSIONS: &str = ".obj, .stl, .ply, .gltf or .glb";

/// Triangles, counter-clockwise seen from outside. A mesh from [`read`] has at least one triangle with area,
/// no unused and no duplicate vertices, closed shells turned outwards, and coordinates within
/// [`COORDINATE_BOUND`].
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Mesh {
    /// Vertices, in mesh units from `origin`.
    pub positions: Vec<[f32; 3]>,
    /// Three indices into `positions` each; polygons are split into fans.
    pub triangles: Vec<[u32; 3]>,
    /// The origin of `positions`, in the file's coordinates and mesh units: the middle of a mesh that lies
    /// far from the file's origin, else the file's origin.
    pub origin: [f64; 3],
    /// Faults of the file that were repaired or ignored.
    pub findings: MeshFindings,
}

/// The formats that can be read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshFormat {
    /// Wavefront OBJ: vertices and faces. The format has no length field: a file truncated between two faces
    /// reads as a mesh with a hole.
    Obj,
    /// STL, text or binary.
    Stl,
    /// PLY, text or binary.
    Ply,
    /// glTF 2.0 or its binary form GLB: the triangles of the default scene.
    Gltf,
}

/// The reason why a file can't be read as a mesh.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct MeshError {
    /// The file.
    pub path: PathBuf,
    /// The fault.
    pub fault: MeshFault,
}

/// A fault of a mesh file.
#[derive(Debug, thiserror::Error)]
pub enum MeshFault {
    /// The file can't be read.
    #[error("cannot read: {0}")]
    Unreadable(io::Error),
    /// The extension is none of [`EXTENSIONS`].
    #[error("unknown kind of mesh; expected a name in {known}", known = EXTENSIONS)]
    UnknownKind,
    /// The bytes are malformed: says where, what was found and what was expected.
    #[error("{0}")]
    Malformed(String),
    /// There are more than [`MAX_TRIANGLES`].
    #[error("becomes {count} triangles or more; expected at most {most}", most = MAX_TRIANGLES)]
    TooManyTriangles {
        /// The number of triangles up to the part that was read last.
        count: usize,
    },
    /// There is no triangle.
    #[error("holds no triangle; expected at least one")]
    Empty,
    /// No triangle has area.
    #[error("holds only degenerate triangles; expected at least one with area")]
    NoArea,
}

/// Reads the mesh in a file. The extension determines the format.
///
/// # Errors
/// Returns the file and its fault; see [`MeshFault`].
pub fn read(path: &Path) -> Result<Mesh, MeshError> {
    let read = || {
        let kind = MeshFormat::from_extension(path).ok_or(MeshFault::UnknownKind)?;
        if kind == MeshFormat::Stl
            && let Some(mesh) = read_binary_stl(path)?
        {
            return Ok(mesh);
        }
        let bytes = durable::read_regular_file_up_to(path, MAX_FILE_BYTES)
            .map_err(MeshFault::Unreadable)?;
        Mesh::from_bytes(kind, &bytes, path.parent().unwrap_or(Path::new("")))
    };
    read().map_err(|fault: MeshFault| MeshError { path: path.to_owned(), fault })
}

/// Reads a binary STL block by block, as the file may be larger than the mesh. Returns `None` for any other
/// file.
fn read_binary_stl(path: &Path) -> Result<Option<Mesh>, MeshFault> {
    let mut file = durable::open_regular_file(path).map_err(MeshFault::Unreadable)?;
    let length = file.metadata().map_err(MeshFault::Unreadable)?.len();
    let header = stl::read_header(&mut file).map_err(MeshFault::Unreadable)?;
    let count = header.and_then(|header| stl::find_binary_count(&header, length));
    count.map(|count| stl::parse_binary(file, count)).transpose()
}

impl MeshFault {
    /// Adds the place in the file to a fault of its bytes.
    fn at(self, place: impl FnOnce() -> String) -> Self {
        match self {
            MeshFault::Malformed(what) => MeshFault::Malformed(format!("{}: {what}", place())),
            fault => fault,
        }
    }
}

/// Returns the normal of a facet, with twice the facet's area as its length.
fn area_vector([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    [d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]]
}

fn malformed<T>(what: String) -> Result<T, MeshFault> {
    Err(MeshFault::Malformed(what))
}

impl From<String> for MeshFault {
    fn from(what: String) -> Self {
        MeshFault::Malformed(what)
    }
}

impl MeshFormat {
    /// Returns the format that a file's extension names.
    #[must_use]
    pub fn from_extension(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(MeshFormat::Obj),
            "stl" => Some(MeshFormat::Stl),
            "ply" => Some(MeshFormat::Ply),
            "gltf" | "glb" => Some(MeshFormat::Gltf),
            _ => None,
        }
    }

    /// Returns the axis that points up in most files of the format.
    #[must_use]
    pub fn default_up_axis(self) -> UpAxis {
        if self == MeshFormat::Stl { UpAxis::Z } else { UpAxis::Y }
    }
}

impl Mesh {
    /// Reads the mesh in the bytes of a file. `folder` is the folder of a glTF's buffers.
    ///
    /// # Errors
    /// Returns the fault; see [`MeshFault`].
    pub fn from_bytes(kind: MeshFormat, bytes: &[u8], folder: &Path) -> Result<Self, MeshFault> {
        match kind {
            MeshFormat::Obj => obj::parse(bytes),
            MeshFormat::Stl => stl::parse(bytes),
            MeshFormat::Ply => ply::parse(bytes),
            MeshFormat::Gltf => gltf::parse(bytes, folder),
        }
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MeshFormat::Obj => "OBJ",
            MeshFormat::Stl => "STL",
            MeshFormat::Ply => "PLY",
            MeshFormat::Gltf => "glTF",
        })
    }
}
