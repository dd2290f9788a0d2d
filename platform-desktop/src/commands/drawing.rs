//! Renderer choice of the commands: the CPU or a Vulkan device, with one of two render paths.

use clap::ValueEnum;
use paros_core::RangeMaps;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headless::{BACKDROP, Error, HeadlessRenderer, PictureFormat, SculptureView};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{FrameRequest, PaperVariant, RenderPath, RenderStyle};
use paros_shaders::scene::{LatestInput, SKY, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shaders::{
    Camera, Image, LitRoom, PORTRAIT_SIZE, RenderOptions, lit_studio, portrait_camera,
    render_image, render_image_in_room, render_portrait_png,
};
use paros_shell::statics::Resident;

/// Samples for each pixel on a Vulkan device.
const SAMPLES: u32 = 4;

/// Options of the renderer.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct DrawingOptions {
    /// Renderer: this machine's processors, or the best Vulkan device.
    #[arg(long, value_enum, default_value = "cpu")]
    renderer: RendererChoice,
    /// Render path of the sculpture: `paper` draws as in the paper, `fast` draws smoothly.
    #[arg(long, value_enum, default_value = "fast")]
    path: PathChoice,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
enum RendererChoice {
    Cpu,
    Vulkan,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
enum PathChoice {
    Paper,
    Fast,
}

/// A renderer of pictures of a fixed size.
pub(super) enum PictureRenderer<const N: usize, const K: usize> {
    Cpu(RenderOptions, Option<Box<LitRoom>>),
    Vulkan {
        renderer: Box<HeadlessRenderer>,
        field: Box<DensityField<N, K>>,
        size: [u32; 2],
        path: RenderPath,
        surroundings: DrawingBackground,
    },
}

/// The surroundings of the sculpture in a picture.
pub(super) enum DrawingBackground {
    /// A grey backdrop; on the CPU a bare stool.
    Backdrop,
    /// The studio's room, in its light.
    Room(Box<SceneAssembler>),
}

/// Returns the room with all tools in their places.
pub(super) fn assemble_room<const N: usize, const K: usize>() -> Box<SceneAssembler>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut room = Box::new(SceneAssembler::new());
    room.assemble_frame(&Grid::<N>::lock_world().world, &LatestInput::default());
    room
}

/// Draws a sculpture in the studio, 720 pixels a side, and returns the bytes of a PNG file. Uses the best
/// Vulkan device; if that fails the CPU, which is ten times as slow as a software driver.
pub(super) fn draw_portrait_png<const N: usize>(
    maps: &RangeMaps<N, INTERVALS>,
) -> Result<Vec<u8>, String> {
    let Ok(image) = draw_portrait(maps) else { return render_portrait_png(maps) };
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(|error| error.to_string())?;
    Ok(png)
}

fn draw_portrait<const N: usize>(maps: &RangeMaps<N, INTERVALS>) -> Result<Image, Error> {
    let options = DrawingOptions { renderer: RendererChoice::Vulkan, path: PathChoice::Fast };
    // The session holds the lock of its own world. This world also has all tools in their places.
    let room = DrawingBackground::Room(assemble_room::<128, 1>());
    options.make_renderer(PORTRAIT_SIZE, 1, room)?.draw_volume(maps, &portrait_camera(), &|_| {})
}

impl DrawingOptions {
    /// Creates a renderer of pictures of `[width, height]` pixels. On the CPU, each pixel gets
    /// `rays_along_pixel_side` rays along each side.
    pub(super) fn make_renderer<const N: usize, const K: usize>(
        &self,
        [width, height]: [usize; 2],
        rays_along_pixel_side: usize,
        surroundings: DrawingBackground,
    ) -> Result<PictureRenderer<N, K>, Error> {
        if self.renderer == RendererChoice::Cpu {
            let options = match self.path {
                PathChoice::Paper => RenderOptions::paper_path(),
                PathChoice::Fast => RenderOptions::default(),
            };
            let options =
                RenderOptions { width, height, samples: rays_along_pixel_side, ..options };
            let room = match surroundings {
                DrawingBackground::Backdrop => None,
                DrawingBackground::Room(_) => Some(Box::new(lit_studio())),
            };
            return Ok(PictureRenderer::Cpu(options, room));
        }
        let size = [width, height].map(|side| side as u32);
        let canvas = PictureFormat { size, eyes: 1, samples: SAMPLES };
        let (gpu, volume) = (paros_headless::open_gpu(None)?, VolumeFormat::of::<N, K>());
        let renderer = Box::new(HeadlessRenderer::new(&gpu, volume, canvas, &[])?);
        let path = match self.path {
            PathChoice::Paper => RenderPath::Paper(PaperVariant::Whole),
            PathChoice::Fast => RenderPath::Fast,
        };
        let field = Box::new(DensityField::new());
        Ok(PictureRenderer::Vulkan { renderer, field, size, path, surroundings })
    }
}

impl<const N: usize, const K: usize> PictureRenderer<N, K> {
    /// Draws a volume. `on_fraction_done` gets the fraction done, 0 to 1.
    pub(super) fn draw_volume(
        &mut self,
        maps: &RangeMaps<N, K>,
        camera: &Camera,
        on_fraction_done: &(dyn Fn(f32) + Sync),
    ) -> Result<Image, Error> {
        match self {
            PictureRenderer::Cpu(options, None) => {
                Ok(render_image(maps, camera, options, on_fraction_done))
            }
            PictureRenderer::Cpu(options, Some(room)) => {
                Ok(render_image_in_room(maps, camera, options, room, on_fraction_done))
            }
            PictureRenderer::Vulkan { renderer, field, size, path, surroundings } => {
                field.rebuild_from(maps);
                renderer.load_field(field)?;
                let view = paros_headless::view_of_camera(camera, *size);
                let (SculptureView { eye, placement }, style, backdrop, scene) = match surroundings
                {
                    DrawingBackground::Backdrop => {
                        let style = RenderStyle { path: *path, ..RenderStyle::default() };
                        (view, style, BACKDROP, None)
                    }
                    DrawingBackground::Room(room) => {
                        let view = view.moved_onto(&room.sculpture_placement());
                        (view, RenderStyle::in_studio(*path), SKY, Some(room.draw_list()))
                    }
                };
                let request =
                    FrameRequest { eyes: &[eye], placement, style, backdrop, scene, panels: &[] };
                renderer.draw_frame(&request, &vec![])?;
                renderer.read_image(0)
            }
        }
    }
}
