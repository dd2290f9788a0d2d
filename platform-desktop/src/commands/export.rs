//! `paros export`: a volume becomes a mesh to print.

use std::path::PathBuf;

use paros_core::export::HEIGHTS_MM;
use paros_core::size::{Grid, Size};
use paros_shell::durable::Target;
use paros_shell::print::Printer;
use paros_shell::statics::Resident;

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
    volume::check_ending(&args.output, "stl")?;
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
    let target = Target::tried(&args.output)?;
    let exporting = progress::bar("exporting", None);
    let mut press = Grid::<N>::press();
    let mut printer = Printer::new(&mut press, args.height_mm)?;
    printer.begin(&plane, &maps);
    let print = volume::printed(printer.complete(), &args.volume)?;
    drop(exporting);
    target.write(&print.stl)?;
    Ok(format!(
        "{}: {} triangles, {} bytes, {} mm high\n",
        args.output.display(),
        print.triangles,
        print.stl.len(),
        args.height_mm
    ))
}
