//! Conversion between volumes and meshes: voxelization ([`Baker`](crate::Baker)) and surface extraction
//! for printing ([`Exporter`](crate::Exporter)).
//!
//! Inputs: triangles, or a volume with its mask and a buffer. Outputs: a volume, or the bytes of an STL file,
//! in bounded pieces of work. Independent of mesh files, edits, sessions and disks.

pub(crate) mod bake;
pub(crate) mod export;

pub use bake::{
    BakeReport, ColumnWindings, MeshPlacement, NoWindings, OutsideBox, UpAxis, Windings,
};
pub use export::{ExportPhase, ExportProgress, HEIGHT_RANGE_MM, HeightOutOfRange};
