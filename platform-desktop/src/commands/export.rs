//! `paros export`: a volume becomes a mesh to print.

use std::path::PathBuf;

use paros_core::{Grid, HEIGHT_RANGE_MM, Size};
use paros_headless::Error;
use paros_shell::durable::WriteTarget;
use paros_shell::print::StlPrinter;
use paros_shell::statics::Resident;
use paros_shell::with_size;

use super::{progress, volume};

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
    #[arg(long, default_value = "120", value_parser = parse_height_mm, allow_hyphen_values = true)]
    height_mm: f32,
}

fn parse_height_mm(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(height) if HEIGHT_RANGE_MM.contains(&height) => Ok(height),
        _ => Err(format!(
            "expected {} to {} millimetres",
            HEIGHT_RANGE_MM.start(),
            HEIGHT_RANGE_MM.end()
        )),
    }
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::check_distinct(&args.volume, &args.output)?;
    volume::check_ending(&args.output, "stl")?;
    let size = volume::read_size(&args.volume)?;
    with_size!(size, N => export_volume::<N>(args), else Err(volume::unusable_size(&args.volume, size)))
}

fn export_volume<const N: usize>(args: &Args) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let (mut maps, mut plane) = (Grid::<N>::lock_range_maps(), Grid::<N>::lock_bit_grid());
    volume::read_nonempty(&args.volume, &mut maps)?;
    plane.set_from_maps(&maps);
    // A volume from a file has no mask.
    maps.clear();
    let target = WriteTarget::resolve_writable(&args.output)?;
    let exporting = progress::show_progress("exporting", None);
    let mut press = Grid::<N>::lock_print_buffers();
    let mut printer = StlPrinter::new(&mut press, args.height_mm)?;
    printer.begin_print(&plane, &maps);
    let print = volume::require_print(printer.finish_print(), &args.volume)?;
    drop(exporting);
    target.write_file(&print.stl)?;
    Ok(format!(
        "{}: {} triangles, {} bytes, {} mm high\n",
        args.output.display(),
        print.triangle_count,
        print.stl.len(),
        args.height_mm
    ))
}
