//! A small picture of a sculpture, by the renderer's CPU twin.

use paros_core::RangeMaps;
use paros_core::volume::{Grid, Size};
use paros_shaders::twin::camera::Camera;
use paros_shaders::twin::render::{RenderOptions, render_image};
use paros_shell::rmap;
use paros_shell::statics::Resident;
use paros_shell::{with_intervals, with_size};

/// Pixels along a side.
const SIDE: usize = 192;

/// The PNG of the volume of an `.rmap` file's bytes.
///
/// # Errors
/// What is wrong with them.
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
    let image = render_image(maps, &Camera::orbiting(0.45, 0.3), &options, &|_| {});
    let mut png = Vec::new();
    image.write_png(&mut png)?;
    Ok(png)
}
