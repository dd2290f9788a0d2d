//! `paros bake`: converts a mesh to a volume.

use std::fmt::Write;
use std::path::PathBuf;

use clap::ValueEnum;
use paros_core::convert::UpAxis;
use paros_core::volume::{Grid, Size};
use paros_headless::{Error, show_progress};
use paros_shell::mesh::{self, Mesh, MeshFormat};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::{with_intervals, with_size};

use super::volume;

/// Convert a mesh into a volume.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Mesh to convert: OBJ, STL, PLY, glTF or GLB.
    mesh: PathBuf,
    /// Volume to write.
    #[arg(short, long, value_name = "V.rmap")]
    output: PathBuf,
    /// Voxels along an edge.
    #[arg(long, default_value = "128", value_parser = volume::grid_side_parser())]
    size: usize,
    /// Intervals per column. One interval can't represent a shape that is hollow along an axis.
    #[arg(long, value_name = "K", default_value = "2", value_parser = volume::interval_count_parser())]
    layers: usize,
    /// Axis of the mesh that points up. By default z for STL files, y for the others.
    #[arg(long, value_name = "AXIS", value_enum)]
    up: Option<MeshAxis>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshAxis {
    Y,
    Z,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::check_output_is_not_input(&args.mesh, &args.output)?;
    volume::refuse_other_extension(&args.output, "rmap")?;
    if MeshFormat::from_extension(&args.mesh).is_none() && volume::has_volume_header(&args.mesh) {
        let what = args.mesh.display();
        return Err(Error::Input(format!("{what}: is a volume already; expected a mesh")));
    }
    let reading = show_progress("reading", None);
    let mesh = mesh::read(&args.mesh).map_err(Error::input)?;
    drop(reading);
    with_size!(args.size, N => with_intervals!(args.layers, K => bake_mesh::<N, K>(args, &mesh)))
}

fn bake_mesh<const N: usize, const K: usize>(args: &Args, mesh: &Mesh) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let (mut maps, mut bit_grid) = (Grid::<N>::lock_range_maps(), Grid::<N>::lock_bit_grid());
    let baking = show_progress("baking", None);
    let up = match args.up {
        Some(MeshAxis::Y) => UpAxis::Y,
        Some(MeshAxis::Z) => UpAxis::Z,
        // The mesh has been read, so its extension is known.
        None => {
            MeshFormat::from_extension(&args.mesh).map_or(UpAxis::Y, MeshFormat::default_up_axis)
        }
    };
    let report = mesh
        .bake_into_maps(up, &mut *Grid::<N>::lock_baker(), &mut *maps, &mut *bit_grid)
        .ok_or_else(|| Error::Input(format!("{}: the mesh has no extent", args.mesh.display())))?;
    let faults = mesh.findings.winding_faults;
    drop(baking);
    rmap::write(&args.output, &maps)?;

    let mut lines = String::new();
    let (triangles, output) = (report.triangles, args.output.display());
    let _ = writeln!(
        lines,
        "{output}: {} voxels of {N}^3 from {triangles} triangles",
        bit_grid.count_voxels()
    );
    if report.degenerate > 0 {
        let _ = writeln!(lines, "{} triangles have no area at this size", report.degenerate);
    }
    if report.flipped {
        let _ = writeln!(lines, "the mesh is inside out; baked as if it were not");
    }
    if faults > 0 {
        let _ =
            writeln!(lines, "the winding is inconsistent: {faults} edges run the same way twice");
    }
    if report.opened_columns > 0 {
        let _ = writeln!(
            lines,
            "the mesh has holes; {} columns ran through them",
            report.opened_columns
        );
    }
    Ok(lines)
}
