//! GPU frame times of a sculpture, by timestamp queries, over a ring of views.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_headless::Error;
use paros_headless::{FetchCounts, HeadlessRenderer, PictureFormat, SculptureView, Uploads};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Drawn, Eye, FrameRequest, FrameTimes, Gpu, RenderPath, RenderStyle, SculpturePlacement,
};
use paros_shaders::upload::VolumeFormat;

use super::fixture::{Fixture, HasFixture};
use super::framing::{Framing, VIEWS, fit_framing, middle_height_sides, ring_view};
use super::subject::BenchSubject;

/// Distance between the eyes, in metres; the side of the cube is 1 m.
const EYES_APART: f32 = 0.064;

/// Longest side in pixels of the pictures used to count filled pixels.
const LONGEST_COUNTED: u32 = 400;
/// Number of eyes and of samples in a frame.
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
    /// The format of a headset's frame.
    pub(super) const HEADSET: FrameFormat = FrameFormat { eyes: 2, samples: 4 };

    pub(super) fn name(self) -> String {
        let eyes = if self.eyes == 2 { "stereo" } else { "mono" };
        let plural = if self.samples == 1 { "" } else { "s" };
        format!("{eyes}, {} sample{plural}", self.samples)
    }
}

/// The case to time: a camera placement and a render path.
#[derive(Clone, Copy, Debug)]
pub(super) struct RenderSetup {
    pub(super) framing: Framing,
    pub(super) path: RenderPath,
    pub(super) drawn: Drawn,
}

impl RenderSetup {
    /// Returns the setup of a path's ordinary picture.
    pub(super) const fn picture(framing: Framing, path: RenderPath) -> Self {
        RenderSetup { framing, path, drawn: Drawn::Picture }
    }

    /// Returns the nanoseconds of the sculpture's pass, with the passes that the path needs before it.
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
    /// Small renderers for counting filled pixels, by grid size.
    small_renderers: BTreeMap<usize, HeadlessRenderer>,
    cache: Vec<u8>,
}

impl FrameTimer {
    /// Opens the best device, or the best one whose name contains `name_part`.
    ///
    /// # Errors
    /// There is no such device, or it has no timestamps.
    pub(super) fn open_device(name_part: Option<&str>, canvas: [u32; 2]) -> Result<Self, Error> {
        let gpu = paros_headless::open_gpu(name_part)?;
        if gpu.features.timestamp_period_fs == 0 {
            return Err(Error::Failure(format!("{}: has no timestamps", gpu.name)));
        }
        let (renderers, small_renderers) = (BTreeMap::new(), BTreeMap::new());
        Ok(FrameTimer { gpu, canvas, renderers, small_renderers, cache: vec![] })
    }

    /// Returns the device's name.
    pub(super) fn device_name(&self) -> &str {
        &self.gpu.name
    }

    /// Returns `true` if the device renders on the CPU.
    pub(super) fn is_software(&self) -> bool {
        self.gpu.is_software()
    }

    /// Loads a subject into the renderers of a size, and finds the framing that fills the target fraction of
    /// the image.
    pub(super) fn load_and_fit_framing<const N: usize>(
        &mut self,
        subject: &BenchSubject,
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
        let nearest = Framing::nearest(volume, middle_height_sides(&fixture.start));
        fit_framing(renderer, small, &nearest)
    }

    /// Finds the framing of the subject loaded last that fills the fraction `aim` of the image.
    pub(super) fn refit_framing(&mut self, framing: &Framing, aim: f32) -> Result<Framing, Error> {
        let grid_side = framing.volume.grid_side();
        let small = self.small_size();
        let renderer =
            self.small_renderers.get_mut(&grid_side).ok_or_else(|| no_renderer(grid_side))?;
        fit_framing(renderer, small, &framing.aiming_at(aim))
    }

    /// Returns the size of the pictures used to count filled pixels.
    fn small_size(&self) -> [u32; 2] {
        let shrunk = self.canvas[0].max(self.canvas[1]).div_ceil(LONGEST_COUNTED);
        self.canvas.map(|side| (side / shrunk).max(1))
    }

    /// Loads the same voxels in columns of two intervals into separate renderers.
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

    /// Returns the milliseconds of each setup's pass: the mean over the ring of each view's best of `runs`.
    /// The setups alternate.
    pub(super) fn mean_of_best_ms_per_setup(
        &mut self,
        setups: &[RenderSetup],
        format: FrameFormat,
        runs: usize,
    ) -> Result<Vec<f64>, Error> {
        // Drivers may defer work to a pipeline's first frame.
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

    /// Counts the texels that the fragments of all frames of the ring fetch.
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

    /// Returns the renderer of a volume and frame format.
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

/// Returns the mean of the views' nanoseconds, in milliseconds.
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
    FrameRequest {
        eyes,
        placement,
        style,
        backdrop: paros_headless::BACKDROP,
        scene: None,
        panels: &[],
    }
}
