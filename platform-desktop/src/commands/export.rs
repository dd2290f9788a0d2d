//! `paros export`: converts a volume to a mesh for printing.

use std::path::PathBuf;

use paros_core::convert::HEIGHT_RANGE_MM;
use paros_core::volume::{Grid, Size};
use paros_headless::{Error, show_progress};
use paros_shell::durable::WriteTarget;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::stl_export::StlExporter;
use paros_shell::{with_intervals, with_size};

use super::volume;

/// Export a volume as a smoothed, watertight STL file in millimetres.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Volume to export.
    #[arg(value_name = "V.rmap")]
    volume: PathBuf,
    /// STL file to write.
    #[arg(short, long, value_name = "M.stl")]
    output: PathBuf,
    /// Height of the print in millimetres.
    #[arg(long, default_value = "120", value_parser = parse_height_mm, allow_hyphen_values = true)]
    height_mm: f32,
    #[command(flatten)]
    layers: volume::LayersOption,
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
    volume::check_output_is_not_input(&args.volume, &args.output)?;
    volume::refuse_other_extension(&args.output, "stl")?;
    let size = volume::read_header(&args.volume)?.grid_side;
    let layers = args.layers.interval_count();
    with_size!(size, N => with_intervals!(layers, K => export_volume::<N, K>(args)))
}

fn export_volume<const N: usize, const K: usize>(args: &Args) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    let mut bit_grid = Grid::<N>::lock_bit_grid();
    let filled = args.layers.read_nonempty_volume(&args.volume, &mut maps)?;
    bit_grid.set_from_maps(&maps);
    // A volume from a file has no mask.
    maps.clear();
    let target = WriteTarget::resolve_and_check_writable(&args.output)?;
    let exporting = show_progress("exporting", None);
    let mut stl_buffers = Grid::<N>::lock_stl_buffers();
    let mut stl_exporter = StlExporter::new(&mut stl_buffers, args.height_mm)?;
    stl_exporter.begin_export(&bit_grid, &maps);
    let stl = volume::require_nonempty_stl(stl_exporter.run_export_to_end(), &args.volume)?;
    drop(exporting);
    target.write_file(&stl.bytes)?;
    Ok(format!(
        "{filled}{}: {} triangles, {} bytes, {} mm high\n",
        args.output.display(),
        stl.triangle_count,
        stl.bytes.len(),
        args.height_mm
    ))
}
