//! GPU frame times of a sculpture, by timestamp queries, over a ring of views.

use std::collections::BTreeMap;
use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec3};
use paros_core::RangeMaps;
use paros_core::volume::{Axis, BitGrid, Grid, Size};
use paros_headless::Error;
use paros_headless::{FetchCounts, HeadlessRenderer, PictureFormat, SculptureView, Uploads};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Drawn, Eye, Fov, FrameRequest, FrameTimes, Gpu, PaperVariant, RenderPath, RenderStyle,
    SculpturePlacement,
};
use paros_shaders::upload::VolumeFormat;
use paros_shell::with_size;

use super::fixture::{Fixture, HasFixture};
use super::subject::Subject;

/// Views of a ring.
pub(super) const VIEWS: usize = 8;
/// Elevation of the eye above the horizon, in radians.
const ELEVATION: f32 = 0.3;
/// Half the vertical angle of view, in radians; the horizontal one follows from the pixels.
const HALF_ANGLE: f32 = TAU / 8.0;
/// Half of the narrowest vertical angle, in radians.
const NARROWEST: f32 = TAU / 80.0;
/// Distance between the eyes, in metres; a side of the cube is 1 m.
const EYES_APART: f32 = 0.064;

/// Target fraction of the image that a sculpture fills, averaged over the ring: as from where one looks at it.
const QUARTER: f32 = 0.25;
/// The same from where one works on it.
pub(super) const FILLING: f32 = 0.85;
/// Smallest eye distance in sides of the cube: just outside it. For a slender sculpture the angle of
/// view is narrowed at this distance.
const NEAREST: f32 = 0.8;
const FARTHEST: f32 = 8.0;
/// Bisection steps.
const HALVINGS: usize = 12;
/// Longest side in pixels of the pictures in which filled pixels are counted.
const LONGEST_COUNTED: u32 = 400;
/// Backdrop colour that no shaded surface has.
const NOTHING: [f32; 3] = [0.0, 1.0, 0.0];
const NOTHING_SHOWN: [u8; 3] = [0, 255, 0];

/// Eyes and samples of a frame.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct FrameFormat {
    pub(super) eyes: u32,
    pub(super) samples: u32,
}

impl FrameFormat {
    pub(super) const ALL: [FrameFormat; 4] = [
        FrameFormat { eyes: 1, samples: 1 },
        FrameFormat { eyes: 1, samples: 4 },
        FrameFormat { eyes: 2, samples: 1 },
        FrameFormat { eyes: 2, samples: 4 },
    ];
    /// A headset's frame.
    pub(super) const HEADSET: FrameFormat = FrameFormat { eyes: 2, samples: 4 };

    pub(super) fn name(self) -> String {
        let eyes = if self.eyes == 2 { "stereo" } else { "mono" };
        let plural = if self.samples == 1 { "" } else { "s" };
        format!("{eyes}, {} sample{plural}", self.samples)
    }
}

/// Camera placement for a volume of one format.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Framing {
    /// What is looked at.
    pub(super) volume: VolumeFormat,
    /// Distance from the point looked at, in sides of the cube.
    distance: f32,
    /// Height of the point looked at, in sides of the cube.
    height: f32,
    /// Half the vertical angle of view, in radians.
    half_angle: f32,
    /// Fraction of the image that the volume fills, 0 to 1.
    pub(super) filled: f32,
    /// That aimed at.
    aim: f32,
}

impl Framing {
    /// The same camera before the same voxels in columns of two intervals.
    pub(super) fn of_two_intervals(&self) -> Self {
        let volume = with_size!(self.volume.grid_side(), N => VolumeFormat::of::<N, 2>());
        Framing { volume, ..*self }
    }
}

/// A camera placement and a render path: what is timed.
#[derive(Clone, Copy, Debug)]
pub(super) struct RenderSetup {
    pub(super) framing: Framing,
    pub(super) path: RenderPath,
    pub(super) drawn: Drawn,
}

impl RenderSetup {
    /// The picture of a path.
    pub(super) const fn picture(framing: Framing, path: RenderPath) -> Self {
        RenderSetup { framing, path, drawn: Drawn::Picture }
    }

    /// Nanoseconds of its sculpture's pass, with all that the path needs before.
    fn sculpture_pass_ns(&self, times: &FrameTimes) -> u64 {
        let sculpture_ns = times.sculpture_ns.unwrap_or(times.pass_ns);
        match self.path {
            RenderPath::Fast => times.tiles_ns + sculpture_ns,
            RenderPath::Paper(_) => sculpture_ns,
        }
    }
}

/// A Vulkan device with an offscreen renderer for each volume and frame format.
pub(super) struct FrameTimer {
    gpu: Arc<Gpu>,
    canvas: [u32; 2],
    renderers: BTreeMap<(VolumeFormat, FrameFormat), HeadlessRenderer>,
    /// Small renderers in which filled pixels are counted, by grid size.
    small_renderers: BTreeMap<usize, HeadlessRenderer>,
    cache: Vec<u8>,
}

impl FrameTimer {
    /// Opens the best device, or the best of those whose names contain `name_part`.
    ///
    /// # Errors
    /// No such device, or it has no timestamps.
    pub(super) fn open_device(name_part: Option<&str>, canvas: [u32; 2]) -> Result<Self, Error> {
        let gpu = paros_headless::open_gpu(name_part)?;
        if gpu.features.timestamp_period_fs == 0 {
            return Err(Error::Failure(format!("{}: has no timestamps", gpu.name)));
        }
        let (renderers, small_renderers) = (BTreeMap::new(), BTreeMap::new());
        Ok(FrameTimer { gpu, canvas, renderers, small_renderers, cache: vec![] })
    }

    /// The device's name.
    pub(super) fn device_name(&self) -> &str {
        &self.gpu.name
    }

    /// Whether it draws on this machine's processors.
    pub(super) fn is_software(&self) -> bool {
        self.gpu.is_software()
    }

    /// Loads a subject into the renderers of a size, and finds the framing that fills the target
    /// fraction of the image.
    pub(super) fn load_and_fit_framing<const N: usize>(
        &mut self,
        subject: &Subject,
        formats: &[FrameFormat],
        fixture: &mut Fixture<N>,
    ) -> Result<Framing, Error>
    where
        Grid<N>: Size + HasFixture<N>,
    {
        subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
        let mut field = Box::new(DensityField::<N>::new());
        field.rebuild_from(&fixture.start);
        let volume = VolumeFormat::of::<N, 1>();
        let small = self.small_size();
        let small_renderer = PictureFormat { size: small, eyes: 1, samples: 1 };
        if !self.small_renderers.contains_key(&N) {
            self.small_renderers
                .insert(N, HeadlessRenderer::new(&self.gpu, volume, small_renderer, &self.cache)?);
        }
        self.load_field(&field, formats)?;
        let renderer = self.small_renderers.get_mut(&N).ok_or_else(|| no_renderer(N))?;
        renderer.load_field(&field)?;
        let nearest = Framing {
            volume,
            distance: NEAREST,
            height: middle_height_sides(&fixture.start),
            half_angle: HALF_ANGLE,
            filled: 0.0,
            aim: QUARTER,
        };
        fit_framing(renderer, small, &nearest)
    }

    /// The framing of the same subject, the last one loaded, that fills another fraction of the image.
    pub(super) fn refit_framing(&mut self, framing: &Framing, aim: f32) -> Result<Framing, Error> {
        let grid_side = framing.volume.grid_side();
        let small = self.small_size();
        let renderer =
            self.small_renderers.get_mut(&grid_side).ok_or_else(|| no_renderer(grid_side))?;
        let nearest = Framing { distance: NEAREST, half_angle: HALF_ANGLE, aim, ..*framing };
        fit_framing(renderer, small, &nearest)
    }

    /// Size of the pictures in which filled pixels are counted.
    fn small_size(&self) -> [u32; 2] {
        let shrunk = self.canvas[0].max(self.canvas[1]).div_ceil(LONGEST_COUNTED);
        self.canvas.map(|side| (side / shrunk).max(1))
    }

    /// Loads the same voxels in columns of two intervals into renderers of their own.
    pub(super) fn load_two_intervals<const N: usize>(
        &mut self,
        formats: &[FrameFormat],
        bit_grid: &BitGrid<N>,
    ) -> Result<(), Error>
    where
        Grid<N>: Size,
    {
        let mut maps = Box::new(RangeMaps::<N, 2>::new());
        bit_grid.write_closure(&mut maps);
        let mut field = Box::new(DensityField::new());
        field.rebuild_from(&maps);
        self.load_field(&field, formats)
    }

    fn load_field<const N: usize, const K: usize>(
        &mut self,
        field: &DensityField<N, K>,
        formats: &[FrameFormat],
    ) -> Result<(), Error> {
        let volume = VolumeFormat::of::<N, K>();
        self.ensure_renderers(volume, formats, self.canvas)?;
        for format in formats {
            self.renderer_for(volume, *format)?.load_field(field)?;
        }
        Ok(())
    }

    /// Milliseconds of each setup's pass: the mean over the ring of each view's best of `runs`.
    /// The setups alternate.
    pub(super) fn mean_of_best_ms_per_setup(
        &mut self,
        setups: &[RenderSetup],
        format: FrameFormat,
        runs: usize,
    ) -> Result<Vec<f64>, Error> {
        // A driver may put off work to a pipeline's first frame.
        for setup in setups {
            self.draw_view(setup, format, 0, &vec![])?;
        }
        let mut best = vec![[u64::MAX; VIEWS]; setups.len()];
        for _ in 0..runs {
            for view in 0..VIEWS {
                for (setup, best) in setups.iter().zip(&mut best) {
                    let times = self.draw_view(setup, format, view, &vec![])?;
                    best[view] = best[view].min(setup.sculpture_pass_ns(&times));
                }
            }
        }
        Ok(best.iter().map(mean_ms).collect())
    }

    /// Draws one frame of the ring after some uploads.
    pub(super) fn draw_view(
        &mut self,
        setup: &RenderSetup,
        format: FrameFormat,
        view: usize,
        uploads: &Uploads,
    ) -> Result<FrameTimes, Error> {
        let (eyes, placement) = self.eyes_of_view(setup, format, view);
        let request = request_frame(setup, &eyes, placement);
        self.renderer_for(setup.framing.volume, format)?.draw_frame(&request, uploads)
    }

    /// What the fragments of all frames of the ring fetch.
    pub(super) fn count_fetches(
        &mut self,
        setup: &RenderSetup,
        format: FrameFormat,
    ) -> Result<FetchCounts, Error> {
        let mut sum = FetchCounts::default();
        for view in 0..VIEWS {
            let (eyes, placement) = self.eyes_of_view(setup, format, view);
            let request = request_frame(setup, &eyes, placement);
            let of_one = FrameFormat { samples: 1, ..format };
            let renderer = self.renderer_for(setup.framing.volume, of_one)?;
            sum = sum.and(renderer.count_fetches(&request, format.samples)?);
        }
        Ok(sum)
    }

    fn eyes_of_view(
        &self,
        setup: &RenderSetup,
        format: FrameFormat,
        view: usize,
    ) -> (Vec<Eye>, SculpturePlacement) {
        let SculptureView { eye, placement } = ring_view(&setup.framing, view, self.canvas);
        let aside =
            |side: f32| Eye { position: eye.position + Vec3::X * (EYES_APART * side), ..eye };
        let eyes = if format.eyes == 2 { vec![aside(-0.5), aside(0.5)] } else { vec![eye] };
        (eyes, placement)
    }

    /// The renderer of a volume and frame format.
    ///
    /// # Errors
    /// No subject of that format was loaded.
    pub(super) fn renderer_for(
        &mut self,
        volume: VolumeFormat,
        format: FrameFormat,
    ) -> Result<&mut HeadlessRenderer, Error> {
        let missing = || no_renderer(volume.grid_side());
        self.renderers.get_mut(&(volume, format)).ok_or_else(missing)
    }

    fn ensure_renderers(
        &mut self,
        volume: VolumeFormat,
        formats: &[FrameFormat],
        image_size: [u32; 2],
    ) -> Result<(), Error> {
        for &format in formats {
            if !self.renderers.contains_key(&(volume, format)) {
                let canvas =
                    PictureFormat { size: image_size, eyes: format.eyes, samples: format.samples };
                let renderer = HeadlessRenderer::new(&self.gpu, volume, canvas, &self.cache)?;
                self.cache = renderer.pipeline_cache()?;
                self.renderers.insert((volume, format), renderer);
            }
        }
        Ok(())
    }
}

fn no_renderer(grid_side: usize) -> Error {
    Error::Failure(format!("no volume of size {grid_side} hangs in the studio"))
}

/// Mean of the views' nanoseconds, in milliseconds.
pub(super) fn mean_ms(views_ns: &[u64; VIEWS]) -> f64 {
    views_ns.iter().map(|&ns| ns as f64).sum::<f64>() / VIEWS as f64 * 1e-6
}

fn request_frame<'a>(
    setup: &RenderSetup,
    eyes: &'a [Eye],
    placement: SculpturePlacement,
) -> FrameRequest<'a> {
    let RenderSetup { path, drawn, .. } = *setup;
    let style = RenderStyle { path, drawn, ..RenderStyle::default() };
    FrameRequest { eyes, placement, style, backdrop: paros_headless::BACKDROP, scene: None }
}

/// A view of the ring. The eye is fixed; the stool turns.
fn ring_view(framing: &Framing, view: usize, [width, height]: [u32; 2]) -> SculptureView {
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

/// Mean of the lowest and highest occupied height, in sides of the cube.
fn middle_height_sides<const N: usize>(maps: &RangeMaps<N>) -> f32 {
    let heights = (0..N).flat_map(|line| maps.line(Axis::Y, line)).map(|column| column.hull());
    let (lo, hi) = heights
        .filter(|range| !range.is_empty())
        .fold((N, 0), |(lo, hi), range| (range.first().min(lo), range.last().max(hi)));
    (lo + hi + 1) as f32 / (2 * N) as f32
}

/// Finds the distance, or the angle of view, at which the sculpture fills the fraction aimed at. Pixels
/// are counted by the paper's path, which draws the exact voxels.
fn fit_framing(
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

/// Bisection between a value whose framing fills more than the target and one whose fills less.
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

/// The fraction of the image that is not backdrop, averaged over the ring.
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
            &FrameRequest { eyes: &[eye], placement, style: look, backdrop: NOTHING, scene: None },
            &vec![],
        )?;
        let image = small_renderer.read_image(0)?;
        sum += image.pixels.chunks_exact(3).filter(|pixel| **pixel != NOTHING_SHOWN).count();
    }
    Ok(sum as f32 / (image_size[0] as usize * image_size[1] as usize * VIEWS) as f32)
}
