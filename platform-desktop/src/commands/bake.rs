//! `paros bake`: a mesh becomes a volume.

use std::fmt::Write;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use paros_core::bake::Up;
use paros_core::size::{Grid, Size};
use paros_shell::rmap;
use paros_shell::statics::Resident;

use super::{progress, volume};
use crate::error::Error;
use crate::mesh::{self, Kind, Mesh};

/// Bake a mesh into a volume.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The mesh: OBJ, STL, PLY, glTF or GLB.
    mesh: PathBuf,
    /// The volume to write.
    #[arg(short, long, value_name = "V.rmap")]
    output: PathBuf,
    /// Voxels along an edge.
    #[arg(long, default_value = "128", value_parser = sizes())]
    size: usize,
}

fn sizes() -> impl TypedValueParser<Value = usize> {
    PossibleValuesParser::new(["128", "256"]).map(|size| if size == "256" { 256 } else { 128 })
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::check_distinct(&args.mesh, &args.output)?;
    volume::check_ending(&args.output, "rmap")?;
    if Kind::of(&args.mesh).is_none() && volume::is_one(&args.mesh) {
        let what = args.mesh.display();
        return Err(Error::Input(format!("{what}: is a volume already; expected a mesh")));
    }
    let reading = progress::bar("reading", None);
    let mesh = mesh::read(&args.mesh).map_err(Error::input)?;
    drop(reading);
    match args.size {
        256 => bake::<256>(args, &mesh),
        _ => bake::<128>(args, &mesh),
    }
}

fn bake<const N: usize>(args: &Args, mesh: &Mesh) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let (mut maps, mut plane) = (Grid::<N>::maps(), Grid::<N>::plane());
    let baking = progress::bar("baking", None);
    // The mesh has been read, so its name has a kind.
    let up = Kind::of(&args.mesh).map_or(Up::Y, Kind::up);
    let report = mesh
        .bake(up, &mut *Grid::<N>::baker(), &mut *maps, &mut *plane)
        .ok_or_else(|| Error::Input(format!("{}: the mesh has no extent", args.mesh.display())))?;
    let faults = mesh.winding_faults();
    drop(baking);
    rmap::write(&args.output, &maps)?;

    let mut lines = String::new();
    let (triangles, output) = (report.triangles, args.output.display());
    let _ =
        writeln!(lines, "{output}: {} voxels of {N}^3 from {triangles} triangles", plane.count());
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
    if report.opened > 0 {
        let _ = writeln!(lines, "the mesh has holes; {} columns ran through them", report.opened);
    }
    Ok(lines)
}
