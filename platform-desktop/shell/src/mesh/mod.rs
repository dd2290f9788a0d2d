//! Mesh files: reads OBJ, STL, PLY and glTF into checked vertices and triangles, or an error.

mod bake;
mod gltf;
mod obj;
mod ply;
mod stl;

pub use bake::MeshBounds;

use crate::durable;
use paros_core::convert::UpAxis;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The largest coordinate, in mesh units, that a file may hold.
pub const COORDINATE_BOUND: f32 = 1e9;

/// The most triangles that a file may become: 42 for each column of the three maps at 256. Baking so many
/// takes 600 MiB.
pub const MAX_TRIANGLES: usize = 1 << 23;

/// The most vertices that a file may become: half as many as triangles, as in a closed surface. STL, in
/// which each triangle has its own, is bounded by its triangles alone.
pub const MAX_VERTICES: usize = MAX_TRIANGLES / 2;

/// The most bytes that a file may have, and a glTF's buffers together: 256 a triangle, which text takes.
pub const MAX_FILE_BYTES: u64 = 256 * MAX_TRIANGLES as u64;

/// The extensions that [`read`] knows, for messages.
pub const EXTENSIONS: &str = ".obj, .stl, .ply, .gltf or .glb";

/// Triangles, counter-clockwise seen from outside. What [`read`] gives has a triangle with area,
/// no vertex without a triangle, and coordinates inside [`COORDINATE_BOUND`].
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Mesh {
    /// Vertices, in mesh units.
    pub positions: Vec<[f32; 3]>,
    /// Three indices into `positions` each; polygons are split into fans.
    pub triangles: Vec<[u32; 3]>,
}

/// The kinds of file that are read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshFormat {
    /// Wavefront OBJ; materials are not looked at. It tells no length: cut between two lines of
    /// its faces, it reads as a mesh with a hole.
    Obj,
    /// STL, text or binary.
    Stl,
    /// PLY, text or binary.
    Ply,
    /// glTF 2.0 or its binary form GLB: the triangles of the default scene.
    Gltf,
}

/// Why a file gives no mesh.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct MeshError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: MeshFault,
}

/// What is wrong with a mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshFault {
    /// The file can't be read.
    #[error("cannot read: {0}")]
    Unreadable(io::Error),
    /// The name ends in none of [`EXTENSIONS`].
    #[error("unknown kind of mesh; expected a name in {known}", known = EXTENSIONS)]
    UnknownKind,
    /// The bytes are not what the kind asks for.
    #[error("not a whole {kind} file: {what}")]
    Malformed {
        /// The kind that the name says.
        kind: MeshFormat,
        /// Where, what was found and what was expected.
        what: String,
    },
    /// There are more than [`MAX_TRIANGLES`] or [`MAX_VERTICES`].
    #[error("becomes {count} {what} or more; expected at most {most}")]
    TooLarge {
        /// What there are too many of.
        what: &'static str,
        /// How many there are, or would be with the part that was read last.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// No triangle.
    #[error("holds no triangle; expected at least one")]
    Empty,
    /// No triangle has area.
    #[error("holds only degenerate triangles; expected at least one with area")]
    NoArea,
    /// A coordinate is not a number, infinite, or outside [`COORDINATE_BOUND`].
    #[error("vertex {vertex} has the coordinate {value}; expected a number of at most {bound:e} either way", bound = COORDINATE_BOUND)]
    Coordinate {
        /// Index of the vertex.
        vertex: usize,
        /// The coordinate.
        value: f32,
    },
    /// A triangle names a vertex that isn't there.
    #[error(
        "triangle {triangle} names vertex {index}; expected less than {vertices}, the number of vertices"
    )]
    Index {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
}

/// Reads the mesh in a file. Its extension tells the format.
///
/// # Errors
/// The file and what is wrong with it; see [`MeshFault`].
pub fn read(path: &Path) -> Result<Mesh, MeshError> {
    let read = || {
        let kind = MeshFormat::from_extension(path).ok_or(MeshFault::UnknownKind)?;
        let bytes = durable::read_regular_file_up_to(path, MAX_FILE_BYTES)
            .map_err(MeshFault::Unreadable)?;
        Mesh::from_bytes(kind, &bytes, path.parent().unwrap_or(Path::new("")))
    };
    read().map_err(|fault| MeshError { path: path.to_owned(), fault })
}

impl MeshFormat {
    /// The format that a file's extension names.
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

    /// The axis that points up in most files of the format.
    #[must_use]
    pub fn default_up_axis(self) -> UpAxis {
        if self == MeshFormat::Stl { UpAxis::Z } else { UpAxis::Y }
    }
}

impl Mesh {
    /// The mesh in the bytes of a file. `folder` is where a glTF's buffers lie.
    ///
    /// # Errors
    /// As [`read`].
    pub fn from_bytes(kind: MeshFormat, bytes: &[u8], folder: &Path) -> Result<Self, MeshFault> {
        let mesh = match kind {
            MeshFormat::Obj => obj::parse(bytes),
            MeshFormat::Stl => stl::parse(bytes),
            MeshFormat::Ply => ply::parse(bytes),
            MeshFormat::Gltf => gltf::parse(bytes, folder),
        };
        let mut mesh = mesh.map_err(|stop| match stop {
            ParseStop::Malformed(what) => MeshFault::Malformed { kind, what },
            ParseStop::TooLarge { what, count, most } => MeshFault::TooLarge { what, count, most },
        })?;
        mesh.check_coordinates_and_triangles()?;
        mesh.drop_unused_vertices();
        Ok(mesh)
    }

    /// Appends a polygon as a triangle fan.
    fn push_polygon(&mut self, corners: &[u32]) -> Result<(), ParseStop> {
        self.check_room_for_triangles(corners.len().saturating_sub(2))?;
        for pair in corners.windows(2).skip(1) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    /// Refuses `more` triangles if they would be too many. To be asked before any memory is.
    fn check_room_for_triangles(&self, more: usize) -> Result<(), ParseStop> {
        check_count("triangles", self.triangles.len().saturating_add(more), MAX_TRIANGLES)
    }

    /// The same for vertices.
    fn check_room_for_vertices(&self, more: usize) -> Result<(), ParseStop> {
        check_count("vertices", self.positions.len().saturating_add(more), MAX_VERTICES)
    }

    fn check_coordinates_and_triangles(&self) -> Result<(), MeshFault> {
        for (vertex, position) in self.positions.iter().enumerate() {
            for &value in position {
                if !value.is_finite() || value.abs() > COORDINATE_BOUND {
                    return Err(MeshFault::Coordinate { vertex, value });
                }
            }
        }
        let vertices = self.positions.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for &index in corners {
                if index as usize >= vertices {
                    return Err(MeshFault::Index { triangle, index, vertices });
                }
            }
        }
        if self.triangles.is_empty() {
            return Err(MeshFault::Empty);
        }
        if !self.triangles.iter().any(|t| self.has_area(t)) {
            return Err(MeshFault::NoArea);
        }
        Ok(())
    }

    /// Removes vertices that no triangle uses.
    fn drop_unused_vertices(&mut self) {
        let mut used = vec![false; self.positions.len()];
        for &i in self.triangles.as_flattened() {
            used[i as usize] = true;
        }
        let mut renamed = vec![0; used.len()];
        let kept = renamed.iter_mut().zip(&used).filter(|(_, used)| **used);
        for (name, (renamed, _)) in (0..).zip(kept) {
            *renamed = name;
        }
        for i in self.triangles.as_flattened_mut() {
            *i = renamed[*i as usize];
        }
        let mut used = used.into_iter();
        self.positions.retain(|_| used.next() == Some(true));
    }

    fn has_area(&self, triangle: &[u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|i| self.positions[i as usize].map(f64::from));
        let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        (0..3).any(|k| {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            d[u] * e[v] != d[v] * e[u]
        })
    }
}

/// Why a parser stopped.
enum ParseStop {
    /// As [`MeshFault::Malformed`].
    Malformed(String),
    /// As [`MeshFault::TooLarge`].
    TooLarge { what: &'static str, count: usize, most: usize },
}

impl From<String> for ParseStop {
    fn from(what: String) -> Self {
        ParseStop::Malformed(what)
    }
}

fn malformed<T>(what: String) -> Result<T, ParseStop> {
    Err(ParseStop::Malformed(what))
}

fn check_count(what: &'static str, count: usize, most: usize) -> Result<(), ParseStop> {
    if count <= most { Ok(()) } else { Err(ParseStop::TooLarge { what, count, most }) }
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
