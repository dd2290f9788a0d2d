//! A small picture of a sculpture, drawn by the CPU version of the renderer.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{ExportState, Sculpture};
use paros_core::RangeMaps;
use paros_core::volume::{Grid, Size};
use paros_shaders::twin::camera::Camera;
use paros_shaders::twin::render::{RenderOptions, render_image};
use paros_shell::rmap;
use paros_shell::statics::Resident;
use paros_shell::{with_intervals, with_size};

/// Pixels along a side.
const SIDE: usize = 192;

/// The view of the pictures, in radians: the direction from which the sculpture is seen, and the height above
/// the horizon.
pub(crate) const PICTURE_AZIMUTH: f32 = 0.45;
pub(crate) const PICTURE_ELEVATION: f32 = 0.3;

/// The placeholder for a picture that isn't made yet, or can't be made: an empty stool.
const BLANK: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 192 192\">\
    <rect width=\"192\" height=\"192\" fill=\"#e7e3db\"/><g fill=\"none\" stroke=\"#8d877c\" stroke-width=\"4\" \
    stroke-linecap=\"round\"><ellipse cx=\"96\" cy=\"132\" rx=\"52\" ry=\"14\"/>\
    <path d=\"M44 132v12a52 14 0 0 0 104 0v-12\"/><path d=\"M72 124V70q24-26 48 0v54\" stroke-dasharray=\"3 9\"/></g></svg>";

/// Responds with a sculpture's picture, or with the placeholder if there is none, so that no page shows a
/// broken image.
pub(crate) fn send_picture(png: Option<Vec<u8>>) -> Response {
    match png {
        Some(png) => ([(header::CONTENT_TYPE, "image/png")], png).into_response(),
        None => ([(header::CONTENT_TYPE, "image/svg+xml")], BLANK).into_response(),
    }
}

/// Returns the image element for the sculpture whose page has the address `at`. The picture's address changes
/// once the picture is made, so that browsers load it again.
pub(crate) fn draw_picture(at: &str, sculpture: &Sculpture, label: &str) -> Markup {
    let made = if sculpture.export == ExportState::Queued { "" } else { "?made" };
    html! {
        img src={ (at) "/picture.png" (made) } alt=(label) width="192" height="192" loading="lazy";
    }
}

/// Draws the volume in the bytes of an `.rmap` file. Returns a PNG.
///
/// # Errors
/// A description of what is wrong with the bytes.
pub(crate) fn draw_volume(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let header = rmap::parse_header(bytes).map_err(|fault| fault.to_string())?;
    let other = || Err("a size that is unknown here".to_owned());
    with_size!(header.grid_side, N => with_intervals!(
        header.intervals_per_column, K => draw::<N, K>(bytes), else other(),
    ), else other())
}

fn draw<const N: usize, const K: usize>(bytes: &[u8]) -> Result<Vec<u8>, String>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    rmap::decode(bytes, &mut maps).map_err(|fault| fault.to_string())?;
    encode(&maps).map_err(|error| error.to_string())
}

fn encode<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> std::io::Result<Vec<u8>>
where
    Grid<N>: Size,
{
    let options = RenderOptions { width: SIDE, height: SIDE, ..RenderOptions::default() };
    let image = render_image(
        maps,
        &Camera::orbiting(PICTURE_AZIMUTH, PICTURE_ELEVATION),
        &options,
        &|_| {},
    );
    let mut png = Vec::new();
    image.write_png(&mut png)?;
    Ok(png)
}
