//! `paros export`: a volume becomes a mesh to print.

use std::path::PathBuf;

use paros_core::export::HEIGHTS_MM;
use paros_core::size::{Grid, Size};
use paros_shell::statics::Resident;
use paros_shell::stl;

use super::{progress, volume};
use crate::error::Error;

/// Export a volume as STL, smoothed and watertight, in millimetres.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The volume.
    #[arg(value_name = "V.rmap")]
    volume: PathBuf,
    /// The mesh to write.
    #[arg(short, long, value_name = "M.stl")]
    output: PathBuf,
    /// Height of the print in millimetres.
    #[arg(long, default_value = "120", value_parser = height, allow_hyphen_values = true)]
    height_mm: f32,
}

fn height(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(height) if HEIGHTS_MM.contains(&height) => Ok(height),
        _ => Err(format!("expected {} to {} millimetres", HEIGHTS_MM.start(), HEIGHTS_MM.end())),
    }
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::check_distinct(&args.volume, &args.output)?;
    match volume::size(&args.volume)? {
        128 => export::<128>(args),
        256 => export::<256>(args),
        n => Err(volume::unusable_size(&args.volume, n)),
    }
}

fn export<const N: usize>(args: &Args) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let (mut maps, mut plane) = (Grid::<N>::maps(), Grid::<N>::plane());
    volume::read(&args.volume, &mut maps)?;
    plane.expand(&maps);
    // A volume from a file has no mask.
    maps.clear();
    let writing = progress::bar("exporting", None);
    let sculpture = stl::Sculpture { rows: &plane, mask: &maps };
    let exported =
        stl::write(&args.output, &sculpture, args.height_mm, &mut *Grid::<N>::exporter())?;
    drop(writing);
    Ok(format!(
        "{}: {} triangles, {} bytes, {} mm high\n",
        args.output.display(),
        exported.triangles,
        exported.bytes,
        args.height_mm
    ))
}
