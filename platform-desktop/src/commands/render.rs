//! `paros render`: a picture of a volume.

use std::path::PathBuf;

use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::Camera;
use paros_shell::durable::WriteTarget;
use paros_shell::figures::Figure;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::{with_intervals, with_size};

use super::drawing::DrawingOptions;
use super::{progress, volume};

/// The longest side of a picture in pixels.
const LONGEST: usize = 8192;

/// Render a picture of a volume, or of a figure.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The volume, or a figure (lump, owl, cat, amphora, dolphin, toy) at 128.
    #[arg(value_name = "V.rmap")]
    volume: PathBuf,
    /// The picture to write.
    #[arg(short, long, value_name = "P.png")]
    output: PathBuf,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x480",
        value_parser = parse_width_x_height, allow_hyphen_values = true)]
    size: [usize; 2],
    /// Azimuth (0 looks at the front, 90 at the right) and elevation of the view, in degrees.
    #[arg(long, value_name = "AZ,EL", default_value = "25,15", value_parser = parse_view_degrees,
          allow_hyphen_values = true)]
    view: ViewDegrees,
    #[command(flatten)]
    layers: volume::LayersOption,
    #[command(flatten)]
    drawing: DrawingOptions,
}

impl Args {
    /// The figure that is drawn, as `bench` names it; a file of that name is `./owl`.
    fn figure(&self) -> Option<Figure> {
        Figure::from_name(self.volume.to_str()?)
    }
}

/// Voxels along an edge of a figure.
const FIGURE_SIDE: usize = 128;

/// Rays along a side of each pixel.
const SAMPLES: usize = 2;

/// Parses `WxH`, in pixels.
pub(super) fn parse_width_x_height(text: &str) -> Result<[usize; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=LONGEST).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("expected WxH, each 1 to {LONGEST}"))
}

/// The direction of a view, in degrees.
#[derive(Clone, Copy, Debug)]
struct ViewDegrees {
    azimuth: f32,
    elevation: f32,
}

/// Parses `AZ,EL`.
fn parse_view_degrees(text: &str) -> Result<ViewDegrees, String> {
    let angle = |text: &str, most: f32| text.parse().ok().filter(|a: &f32| a.abs() <= most);
    text.split_once(',')
        .and_then(|(azimuth, elevation)| {
            let (azimuth, elevation) = (angle(azimuth, 360.0)?, angle(elevation, 90.0)?);
            Some(ViewDegrees { azimuth, elevation })
        })
        .ok_or_else(|| "expected AZ,EL in degrees, at most 360 and 90 either way".into())
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::check_output_is_not_input(&args.volume, &args.output)?;
    volume::refuse_other_extension(&args.output, "png")?;
    let size = match args.figure() {
        Some(_) => FIGURE_SIDE,
        None => volume::read_header(&args.volume)?.grid_side,
    };
    let layers = args.layers.interval_count();
    with_size!(size, N => with_intervals!(layers, K => render_volume::<N, K>(args)))
}

fn render_volume<const N: usize, const K: usize>(args: &Args) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    let mut filled = String::new();
    match args.figure() {
        Some(figure) => figure.rasterize_into(&mut maps, &mut Grid::<N>::lock_bit_grid()),
        None => filled = args.layers.read_nonempty_volume(&args.volume, &mut maps)?,
    }
    // Tried before the work: a place where no file can be is told at once.
    let target = WriteTarget::resolve_and_check_writable(&args.output)?;
    let ViewDegrees { azimuth, elevation } = args.view;
    let camera = Camera::orbiting(azimuth.to_radians(), elevation.to_radians());
    let [width, height] = args.size;
    let mut renderer = args.drawing.make_renderer::<N, K>(args.size, SAMPLES)?;
    let rendering = progress::show_progress("rendering", Some(height as u64));
    let image = renderer.draw_volume(&maps, &camera, &|done| {
        rendering.set_steps_done((done * height as f32) as u64);
    })?;
    drop(rendering);
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(Error::failure)?;
    target.write_file(&png)?;
    Ok(format!("{filled}{}: {width}x{height} pixels\n", args.output.display()))
}
