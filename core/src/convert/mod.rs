//! Conversion between volumes and meshes: voxelization ([`Baker`](crate::Baker)) and surface extraction
//! for printing ([`Exporter`](crate::Exporter)).
//!
//! Takes triangles, or a volume with its mask and a buffer; gives a volume, or the bytes of an STL file,
//! a bounded piece of work at a time.
//! Doesn't know mesh files, edits, sessions or disks.

pub(crate) mod bake;
pub(crate) mod export;

pub use bake::{
    BakeReport, ColumnWindings, MeshPlacement, NoWindings, OutsideBox, UpAxis, Windings,
};
pub use export::{ExportPhase, ExportProgress, HEIGHT_RANGE_MM, HeightOutOfRange};
