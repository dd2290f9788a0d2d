//! What draws a command's pictures: the processor or a Vulkan device, by one of two paths.

use clap::ValueEnum;
use paros_core::maps::Maps;
use paros_shaders::field::Field;
use paros_shaders::gpu::{Look, Parts, Path, Picture};
use paros_shaders::{Camera, Image, RenderOptions, render};

use crate::error::Error;
use crate::headless::{self, BACKDROP, Canvas, Easel};

/// Samples of a pixel on a Vulkan device.
const SAMPLES: u32 = 4;

/// How pictures are to be drawn.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Drawing {
    /// What draws: this machine's processors, or the best Vulkan device, which leaves the studio
    /// around the sculpture out.
    #[arg(long, value_enum, default_value = "cpu")]
    renderer: Means,
    /// How the sculpture is drawn: as in the paper, or smooth.
    #[arg(long, value_enum, default_value = "fast")]
    path: Way,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
enum Means {
    Cpu,
    Vulkan,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
enum Way {
    Paper,
    Fast,
}

/// Draws pictures of one size.
pub(super) enum Painter<const N: usize> {
    Cpu(RenderOptions),
    Vulkan { easel: Box<Easel>, field: Box<Field<N>>, size: [u32; 2], path: Path },
}

impl Drawing {
    /// What draws pictures of a size; on the processor with so many rays along a pixel's side.
    pub(super) fn painter<const N: usize>(
        &self,
        [width, height]: [usize; 2],
        samples: usize,
    ) -> Result<Painter<N>, Error> {
        if self.renderer == Means::Cpu {
            let options = match self.path {
                Way::Paper => RenderOptions::paper(),
                Way::Fast => RenderOptions::default(),
            };
            return Ok(Painter::Cpu(RenderOptions { width, height, samples, ..options }));
        }
        let size = [width, height].map(|side| side as u32);
        let canvas = Canvas { size, eyes: 1, samples: SAMPLES };
        let easel = Box::new(Easel::new(&headless::open(None)?, N, canvas, &[])?);
        let path = match self.path {
            Way::Paper => Path::Paper(Parts::Whole),
            Way::Fast => Path::Fast,
        };
        Ok(Painter::Vulkan { easel, field: Box::new(Field::new()), size, path })
    }
}

impl<const N: usize> Painter<N> {
    /// A picture of a volume. `progress` hears the part done, 0 to 1.
    pub(super) fn paint(
        &mut self,
        maps: &Maps<N>,
        camera: &Camera,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Image, Error> {
        match self {
            Painter::Cpu(options) => Ok(render(maps, camera, options, progress)),
            Painter::Vulkan { easel, field, size, path } => {
                field.rebuild(maps);
                easel.load(field)?;
                let (eye, stand) = headless::seen_by(camera, *size);
                let look = Look { path: *path, ..Look::default() };
                let picture = Picture { eyes: &[eye], stand, look, backdrop: BACKDROP };
                easel.draw(&picture, &vec![])?;
                easel.image(0)
            }
        }
    }
}
