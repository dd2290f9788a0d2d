//! Camera placement before a sculpture, over a ring of views, so that the sculpture fills a given fraction of
//! the image.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use paros_core::RangeMaps;
use paros_core::volume::Axis;
use paros_headless::{Error, HeadlessRenderer, SculptureView};
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, PaperVariant, RenderPath, RenderStyle, SculpturePlacement,
};
use paros_shaders::upload::VolumeFormat;
use paros_shell::with_size;

/// Number of views in a ring.
pub(super) const VIEWS: usize = 8;
/// Elevation of the eye above the horizon, in radians.
const ELEVATION: f32 = 0.3;
/// Half the vertical angle of view, in radians; the horizontal one follows from the pixels.
const HALF_ANGLE: f32 = TAU / 8.0;
/// Half of the narrowest vertical angle, in radians.
const NARROWEST: f32 = TAU / 80.0;

/// Target fraction of the image, averaged over the ring, for a sculpture that is looked at.
const QUARTER: f32 = 0.25;
/// Target fraction for a sculpture that is worked on.
pub(super) const FILLING: f32 = 0.85;
/// Smallest eye distance, just outside the cube, and the largest, in sides of the cube. For a slender
/// sculpture the angle of view is narrowed at the smallest distance.
const NEAREST: f32 = 0.8;
const FARTHEST: f32 = 8.0;
/// Number of bisection steps.
const HALVINGS: usize = 12;
/// Backdrop colour that no shaded surface has.
const NOTHING: [f32; 3] = [0.0, 1.0, 0.0];
const NOTHING_SHOWN: [u8; 3] = [0, 255, 0];

/// Camera placement for a volume of one format.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Framing {
    /// Format of the volume in view.
    pub(super) volume: VolumeFormat,
    /// Distance from the point looked at, in sides of the cube.
    distance: f32,
    /// Height of the point looked at, in sides of the cube.
    height: f32,
    /// Half the vertical angle of view, in radians.
    half_angle: f32,
    /// Fraction of the image that the volume fills, 0 to 1.
    pub(super) filled: f32,
    /// Target of `filled`.
    aim: f32,
}

impl Framing {
    /// Returns the nearest placement, which aims at a quarter of the image.
    pub(super) const fn nearest(volume: VolumeFormat, height: f32) -> Self {
        let (distance, half_angle) = (NEAREST, HALF_ANGLE);
        Framing { volume, distance, height, half_angle, filled: 0.0, aim: QUARTER }
    }

    /// Returns the nearest placement before the same volume, with another target fraction.
    pub(super) const fn aiming_at(&self, aim: f32) -> Self {
        Framing { aim, ..Framing::nearest(self.volume, self.height) }
    }

    /// Returns the same placement for the same voxels in columns of two intervals.
    pub(super) fn of_two_intervals(&self) -> Self {
        let volume = with_size!(self.volume.grid_side(), N => VolumeFormat::of::<N, 2>());
        Framing { volume, ..*self }
    }
}

/// Returns a view of the ring. The eye is fixed; the stool turns.
pub(super) fn ring_view(
    framing: &Framing,
    view: usize,
    [width, height]: [u32; 2],
) -> SculptureView {
    let (sin, cos) = ELEVATION.sin_cos();
    let up = framing.half_angle;
    let right = (up.tan() * width as f32 / height as f32).atan();
    let eye = Eye {
        position: Vec3::new(0.0, sin, cos) * framing.distance + Vec3::Y * framing.height,
        rotation: Quat::from_rotation_x(-ELEVATION),
        fov: Fov { left: -right, right, up, down: -up },
    };
    let turn = view as f32 * (TAU / VIEWS as f32);
    let placement = SculpturePlacement { foot: Vec3::ZERO, side: 1.0, turn_radians: turn };
    SculptureView { eye, placement }
}

/// Returns the mean of the lowest and highest occupied height, in sides of the cube.
pub(super) fn middle_height_sides<const N: usize>(maps: &RangeMaps<N>) -> f32 {
    let heights = (0..N).flat_map(|line| maps.line(Axis::Y, line)).map(|column| column.hull());
    let (lo, hi) = heights
        .filter(|range| !range.is_empty())
        .fold((N, 0), |(lo, hi), range| (range.first().min(lo), range.last().max(hi)));
    (lo + hi + 1) as f32 / (2 * N) as f32
}

/// Finds the distance, or the angle of view, at which the sculpture fills the target fraction. Pixels are
/// counted by the paper's path, which draws the exact voxels.
pub(super) fn fit_framing(
    small_renderer: &mut HeadlessRenderer,
    image_size: [u32; 2],
    nearest: &Framing,
) -> Result<Framing, Error> {
    if filled_fraction(small_renderer, image_size, nearest)? < nearest.aim {
        let narrowed = |half_angle| Framing { half_angle, ..*nearest };
        bisect_framing(small_renderer, image_size, [NARROWEST, HALF_ANGLE], narrowed)
    } else {
        let away = |distance| Framing { distance, ..*nearest };
        bisect_framing(small_renderer, image_size, [NEAREST, FARTHEST], away)
    }
}

/// Bisects between a value whose framing fills more than the target and one whose framing fills less.
fn bisect_framing(
    small_renderer: &mut HeadlessRenderer,
    image_size: [u32; 2],
    [mut filling_more, mut filling_less]: [f32; 2],
    make_framing: impl Fn(f32) -> Framing,
) -> Result<Framing, Error> {
    let mut best = make_framing(filling_more);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (filling_more + filling_less);
        best = make_framing(middle);
        best.filled = filled_fraction(small_renderer, image_size, &best)?;
        *(if best.filled > best.aim { &mut filling_more } else { &mut filling_less }) = middle;
    }
    Ok(best)
}

/// Returns the fraction of the image that is not backdrop, averaged over the ring.
fn filled_fraction(
    small_renderer: &mut HeadlessRenderer,
    image_size: [u32; 2],
    framing: &Framing,
) -> Result<f32, Error> {
    let look =
        RenderStyle { path: RenderPath::Paper(PaperVariant::Whole), ..RenderStyle::default() };
    let mut sum = 0;
    for view in 0..VIEWS {
        let SculptureView { eye, placement } = ring_view(framing, view, image_size);
        small_renderer.draw_frame(
            &FrameRequest {
                eyes: &[eye],
                placement,
                style: look,
                backdrop: NOTHING,
                scene: None,
                panels: &[],
            },
            &vec![],
        )?;
        let image = small_renderer.read_image(0)?;
        sum += image.pixels.chunks_exact(3).filter(|pixel| **pixel != NOTHING_SHOWN).count();
    }
    Ok(sum as f32 / (image_size[0] as usize * image_size[1] as usize * VIEWS) as f32)
}
