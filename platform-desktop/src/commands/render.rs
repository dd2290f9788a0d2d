//! `paros render`: draws a picture of a volume, or a turntable.

use std::path::{Path, PathBuf};

use paros_core::RangeMaps;
use paros_core::volume::{Grid, Size};
use paros_headless::{Error, parse_width_x_height, show_progress};
use paros_shaders::Camera;
use paros_shaders::image::{Animation, PngWriter};
use paros_shell::durable::WriteTarget;
use paros_shell::figures::Figure;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::{with_intervals, with_size};

use super::drawing::{DrawingBackground, DrawingOptions, PictureRenderer, assemble_room};
use super::volume;

/// Maximum number of frames of a turntable: one for each degree.
const MOST_FRAMES: i64 = 360;
/// Maximum number of pixels in all frames: the file is built in memory.
const MOST_PIXELS: usize = 1 << 29;
/// Duration of a turntable's full turn.
const ROUND_SECONDS: u16 = 6;

/// Render a picture of a volume, or of a figure.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Volume, or a figure (lump, owl, cat, amphora, dolphin, toy) with 128 voxels along an edge.
    #[arg(value_name = "V.rmap")]
    volume: PathBuf,
    /// PNG file to write.
    #[arg(short, long, value_name = "P.png")]
    output: PathBuf,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x480",
        value_parser = parse_width_x_height, allow_hyphen_values = true)]
    size: [usize; 2],
    /// View direction in degrees: azimuth (0 shows the front, 90 the right side) and elevation.
    #[arg(long, value_name = "AZ,EL", default_value = "25,15", value_parser = parse_view_degrees,
          allow_hyphen_values = true)]
    view: ViewDegrees,
    /// Write a turntable of N frames: an animated PNG that turns once in six seconds, in an endless loop.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=MOST_FRAMES),
          allow_hyphen_values = true)]
    turn: Option<u16>,
    /// Leave out the lit room around the sculpture.
    #[arg(long)]
    plain: bool,
    /// Describe the written file as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    layers: volume::LayersOption,
    #[command(flatten)]
    drawing: DrawingOptions,
}

/// Report of what was written, for `--json`.
#[derive(serde::Serialize)]
struct Written<'a> {
    picture: &'a Path,
    width: usize,
    height: usize,
    frames: u16,
    /// Report of the voxels that had no room in a column and were filled; may be empty.
    #[serde(skip_serializing_if = "str::is_empty")]
    note: &'a str,
}

impl Args {
    /// Returns the figure to draw, by its name in `bench`. A file with such a name is given as `./owl`.
    fn figure(&self) -> Option<Figure> {
        Figure::from_name(self.volume.to_str()?)
    }
}

/// Voxels along an edge of a figure.
const FIGURE_SIDE: usize = 128;

/// Rays along each side of a pixel.
const SAMPLES: usize = 2;

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
    let ([width, height], frames) = (args.size, args.turn.unwrap_or(1));
    if width * height * usize::from(frames) > MOST_PIXELS {
        let message = format!("--turn: {frames} frames of {width}x{height} are too many pixels");
        return Err(Error::Input(message));
    }
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
    // Check before the work, so that an invalid target is reported at once.
    let target = WriteTarget::resolve_and_check_writable(&args.output)?;
    let surroundings = match args.plain {
        true => DrawingBackground::Backdrop,
        false => DrawingBackground::Room(assemble_room::<N, K>()),
    };
    let mut renderer = args.drawing.make_renderer::<N, K>(args.size, SAMPLES, surroundings)?;
    let png = draw_png(args, &mut renderer, &maps)?;
    target.write_file(&png)?;
    let ([width, height], frames) = (args.size, args.turn.unwrap_or(1));
    if args.json {
        let written =
            Written { picture: &args.output, width, height, frames, note: filled.trim_end() };
        return serde_json::to_string_pretty(&written).map(|s| s + "\n").map_err(Error::failure);
    }
    let picture = args.output.display();
    Ok(match args.turn {
        None => format!("{filled}{picture}: {width}x{height} pixels\n"),
        Some(_) => format!("{filled}{picture}: {frames} frames of {width}x{height} pixels\n"),
    })
}

/// Returns the bytes of the picture, or of the turntable that starts with it.
fn draw_png<const N: usize, const K: usize>(
    args: &Args,
    renderer: &mut PictureRenderer<N, K>,
    maps: &RangeMaps<N, K>,
) -> Result<Vec<u8>, Error> {
    let ([width, height], frames) = (args.size, args.turn.unwrap_or(1));
    let ViewDegrees { azimuth, elevation } = args.view;
    let rendering = show_progress("rendering", Some(height as u64 * u64::from(frames)));
    let mut png = Vec::new();
    let animation = args.turn.map(|frames| Animation { frames, seconds: ROUND_SECONDS });
    let mut writer =
        PngWriter::new(&mut png, [width, height], animation).map_err(Error::failure)?;
    for frame in 0..frames {
        let turned = azimuth + 360.0 * f32::from(frame) / f32::from(frames);
        let camera = Camera::orbiting(turned.to_radians(), elevation.to_radians());
        let image = renderer.draw_volume(maps, &camera, &|done| {
            rendering.set_steps_done(((f32::from(frame) + done) * height as f32) as u64);
        })?;
        writer.write_image(&image).map_err(Error::failure)?;
    }
    writer.finish().map_err(Error::failure)?;
    Ok(png)
}
