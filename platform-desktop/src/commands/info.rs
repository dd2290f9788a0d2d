//! `paros info`: describes the contents of a file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_headless::Error;
use paros_shell::mesh::{self, MeshFormat};
use paros_shell::rmap::{self, RmapHeader};
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::{with_intervals, with_size};
use serde::Serialize;

use super::volume;

/// Describe a volume or a mesh.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// File to describe: a volume (.rmap) or a mesh (OBJ, STL, PLY, glTF or GLB).
    file: PathBuf,
    /// Write the result as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Info {
    Volume(VolumeInfo),
    Mesh(MeshInfo),
}

#[derive(Debug, Serialize)]
struct VolumeInfo {
    version: u16,
    size: usize,
    layers: usize,
    bytes: usize,
    /// CRC-32 of the file, in hexadecimal.
    checksum: String,
    voxels: u64,
    /// Voxels in the layer y = 0.
    ground: u64,
    /// First and last occupied voxel along x, y and z; `None` for an empty volume.
    bounds: Option<[[usize; 3]; 2]>,
}

#[derive(Debug, Serialize)]
struct MeshInfo {
    vertices: usize,
    triangles: usize,
    /// Lowest and highest coordinates of the triangles, in the file's units and axes.
    bounds: Option<([f32; 3], [f32; 3])>,
    /// Number of directed edges that more than one triangle uses; 0 for consistent winding.
    winding_faults: usize,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let info = if MeshFormat::from_extension(&args.file).is_some() {
        Info::Mesh(mesh_info(&args.file)?)
    } else {
        let header = volume::read_header(&args.file)?;
        Info::Volume(with_size!(header.grid_side, N => with_intervals!(
            header.intervals_per_column,
            K => volume_info::<N, K>(&args.file, &header),
        ))?)
    };
    if args.json {
        let json = serde_json::to_string_pretty(&info).map_err(Error::failure)?;
        return Ok(json + "\n");
    }
    Ok(match info {
        Info::Volume(info) => volume_lines(&args.file, &info),
        Info::Mesh(info) => mesh_lines(&args.file, &info),
    })
}

fn volume_info<const N: usize, const K: usize>(
    path: &Path,
    header: &RmapHeader,
) -> Result<VolumeInfo, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    let mut bit_grid = Grid::<N>::lock_bit_grid();
    rmap::read(path, &mut *maps).map_err(Error::input)?;
    bit_grid.set_from_maps(&maps);
    Ok(VolumeInfo {
        version: header.version,
        size: header.grid_side,
        layers: header.intervals_per_column,
        bytes: header.file_length(),
        checksum: format!("{:08x}", rmap::volume_checksum(&maps)),
        voxels: bit_grid.count_voxels(),
        ground: bit_grid.layer(0).iter().map(|row| u64::from(row.count_ones())).sum(),
        bounds: voxel_bounds(&bit_grid).map(|bounds| [bounds.first, bounds.last]),
    })
}

/// The smallest and largest coordinates of a volume's occupied voxels.
struct VoxelBounds {
    first: [usize; 3],
    last: [usize; 3],
}

/// Returns the bounds of the occupied voxels; `None` for an empty volume.
fn voxel_bounds<const N: usize>(bit_grid: &BitGrid<N>) -> Option<VoxelBounds>
where
    Grid<N>: Size,
{
    let mut bounds: Option<VoxelBounds> = None;
    for y in 0..N {
        for z in 0..N {
            let row = bit_grid.row(y, z);
            let (Some(first), Some(last)) = (row.first(), row.last()) else {
                continue;
            };
            let VoxelBounds { first: lo, last: hi } =
                bounds.unwrap_or(VoxelBounds { first: [first, y, z], last: [last, y, z] });
            bounds = Some(VoxelBounds {
                first: [lo[0].min(first), lo[1].min(y), lo[2].min(z)],
                last: [hi[0].max(last), hi[1].max(y), hi[2].max(z)],
            });
        }
    }
    bounds
}

fn volume_lines(path: &Path, info: &VolumeInfo) -> String {
    let mut lines = format!("{}: a volume of {}^3 voxels\n", path.display(), info.size);
    let _ = writeln!(lines, "voxels    {} ({} on the ground)", info.voxels, info.ground);
    if let Some([lo, hi]) = info.bounds {
        let [x, y, z] = [0, 1, 2].map(|axis| format!("{}..={}", lo[axis], hi[axis]));
        let _ = writeln!(lines, "bounds    x {x}, y {y}, z {z}");
    }
    let _ = writeln!(lines, "checksum  {}", info.checksum);
    let intervals = if info.layers == 1 { "interval" } else { "intervals" };
    let _ = writeln!(
        lines,
        "file      version {}, {} {intervals} a column, {} bytes",
        info.version, info.layers, info.bytes
    );
    lines
}

fn mesh_info(path: &Path) -> Result<MeshInfo, Error> {
    let mesh = mesh::read(path).map_err(Error::input)?;
    Ok(MeshInfo {
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        bounds: mesh.bounding_box().map(|bounds| (bounds.min, bounds.max)),
        winding_faults: mesh.findings.winding_faults,
    })
}

fn mesh_lines(path: &Path, info: &MeshInfo) -> String {
    let mut lines = format!("{}: a mesh\n", path.display());
    let _ = writeln!(lines, "triangles {} over {} vertices", info.triangles, info.vertices);
    if let Some((low, high)) = info.bounds {
        let [x, y, z] = [0, 1, 2].map(|axis| format!("{} to {}", low[axis], high[axis]));
        let _ = writeln!(lines, "bounds    x {x}, y {y}, z {z}");
    }
    let winding = match info.winding_faults {
        0 => "consistent".into(),
        faults => format!("inconsistent: {faults} edges run the same way twice"),
    };
    let _ = writeln!(lines, "winding   {winding}");
    lines
}
