//! Frames of a sculpture that are timed by the device's own clock, from a ring of views.

use std::collections::BTreeMap;
use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec3};
use paros_core::maps::{Axis, Maps};
use paros_core::size::{Grid, Size};
use paros_shaders::field::Field;
use paros_shaders::gpu::{Eye, Fov, Gpu, Look, Parts, Path, Picture, Stand, Times};

use super::rig::{Rig, Rigged};
use super::subject::Subject;
use crate::error::Error;
use crate::headless::{self, Canvas, Easel, Uploads};

/// Views of a ring.
pub(super) const VIEWS: usize = 8;
/// How far above the horizon they look from, in radians.
const ELEVATION: f32 = 0.3;
/// Half the vertical angle of view, in radians; the horizontal one follows from the pixels.
const HALF_ANGLE: f32 = TAU / 8.0;
/// Half of the narrowest one.
const NARROWEST: f32 = TAU / 80.0;
/// Between two eyes, in metres; a side of the cube is one.
const EYES_APART: f32 = 0.064;

/// The part of the image that a sculpture is to fill, over the ring.
const FILLED: f32 = 0.25;
/// From how near, in sides of the cube: just outside of the cube. For what is too slender the angle
/// of view is narrowed there.
const NEAREST: f32 = 0.8;
const FARTHEST: f32 = 8.0;
/// Halvings of what lies between two limits.
const HALVINGS: usize = 12;
/// The longest side of the pictures in which that is counted.
const LONGEST_COUNTED: u32 = 400;
/// Nothing is lit like this.
const NOTHING: [f32; 3] = [0.0, 1.0, 0.0];
const NOTHING_SHOWN: [u8; 3] = [0, 255, 0];

/// Eyes and samples of a frame.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Kind {
    pub(super) eyes: u32,
    pub(super) samples: u32,
}

impl Kind {
    pub(super) const ALL: [Kind; 4] = [
        Kind { eyes: 1, samples: 1 },
        Kind { eyes: 1, samples: 4 },
        Kind { eyes: 2, samples: 1 },
        Kind { eyes: 2, samples: 4 },
    ];
    /// A headset's frame.
    pub(super) const HEADSET: Kind = Kind { eyes: 2, samples: 4 };

    pub(super) fn name(self) -> String {
        let eyes = if self.eyes == 2 { "stereo" } else { "mono" };
        let plural = if self.samples == 1 { "" } else { "s" };
        format!("{eyes}, {} sample{plural}", self.samples)
    }
}

/// From where the volume of a size is seen.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Framing {
    pub(super) size: usize,
    /// From the point looked at, in sides of the cube.
    distance: f32,
    /// Of the point looked at, in sides of the cube.
    height: f32,
    /// Half the vertical angle of view, in radians.
    half_angle: f32,
    /// The part of the image that it fills.
    pub(super) filled: f32,
}

/// A way to draw a volume that hangs in the studio.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    pub(super) framing: Framing,
    pub(super) path: Path,
}

impl Shot {
    /// Nanoseconds of its sculpture's pass, with all that the path needs before.
    const fn cost(&self, times: &Times) -> u64 {
        match self.path {
            Path::Fast => times.tiles + times.sculpture,
            Path::Paper(_) => times.sculpture,
        }
    }
}

/// A device with an easel for each size and kind of frame.
pub(super) struct Studio {
    gpu: Arc<Gpu>,
    canvas: [u32; 2],
    easels: BTreeMap<(usize, Kind), Easel>,
    /// For counting pixels.
    sketches: BTreeMap<usize, Easel>,
    cache: Vec<u8>,
}

impl Studio {
    /// A studio on the device of that name, or else the best one.
    ///
    /// # Errors
    /// There is none, or it has no clock.
    pub(super) fn open(device: Option<&str>, canvas: [u32; 2]) -> Result<Self, Error> {
        let gpu = headless::open(device)?;
        if gpu.needs.timestamp_period == 0 {
            return Err(Error::Failure(format!("{}: has no timestamps", gpu.name)));
        }
        let (easels, sketches) = (BTreeMap::new(), BTreeMap::new());
        Ok(Studio { gpu, canvas, easels, sketches, cache: vec![] })
    }

    /// The device's name.
    pub(super) fn device(&self) -> &str {
        &self.gpu.name
    }

    /// Whether it draws on this machine's processors.
    pub(super) fn is_software(&self) -> bool {
        self.gpu.is_software()
    }

    /// Puts a subject on all easels of a size, and looks from where it fills the image as it should.
    pub(super) fn hang<const N: usize>(
        &mut self,
        subject: &Subject,
        kinds: &[Kind],
        rig: &mut Rig<N>,
    ) -> Result<Framing, Error>
    where
        Grid<N>: Size + Rigged<N>,
    {
        subject.load(&mut rig.start, &mut rig.plane)?;
        let mut field = Box::new(Field::<N>::new());
        field.rebuild(&rig.start);
        let full = self.canvas;
        let shrunk = full[0].max(full[1]).div_ceil(LONGEST_COUNTED);
        let small = full.map(|side| (side / shrunk).max(1));
        let sketch = Canvas { size: small, eyes: 1, samples: 1 };
        self.provide(N, kinds, full)?;
        if !self.sketches.contains_key(&N) {
            self.sketches.insert(N, Easel::new(&self.gpu, N, sketch, &self.cache)?);
        }
        for kind in kinds {
            self.easel(N, *kind)?.load(&field)?;
        }
        let easel = self.sketches.get_mut(&N).ok_or_else(|| no_easel(N))?;
        easel.load(&field)?;
        frame(easel, small, N, middle(&rig.start))
    }

    /// Milliseconds of each shot's pass, the mean over the ring of the best of `runs`. The shots
    /// take turns.
    pub(super) fn time(
        &mut self,
        shots: &[Shot],
        kind: Kind,
        runs: usize,
    ) -> Result<Vec<f64>, Error> {
        // A driver may put off work to a pipeline's first frame.
        for shot in shots {
            self.draw(shot, kind, 0, &vec![])?;
        }
        let mut best = vec![[u64::MAX; VIEWS]; shots.len()];
        for _ in 0..runs {
            for view in 0..VIEWS {
                for (shot, best) in shots.iter().zip(&mut best) {
                    let times = self.draw(shot, kind, view, &vec![])?;
                    best[view] = best[view].min(shot.cost(&times));
                }
            }
        }
        Ok(best.iter().map(mean_ms).collect())
    }

    /// Draws one frame of the ring after some uploads.
    pub(super) fn draw(
        &mut self,
        shot: &Shot,
        kind: Kind,
        view: usize,
        uploads: &Uploads,
    ) -> Result<Times, Error> {
        let (canvas, framing) = (self.canvas, shot.framing);
        let (eyes, stand) = seen(&framing, view, canvas);
        let both = [-0.5, 0.5]
            .map(|side| Eye { position: eyes.position + Vec3::X * (EYES_APART * side), ..eyes });
        let eyes = if kind.eyes == 2 { &both[..] } else { &[eyes] };
        let look = Look { path: shot.path, ..Look::default() };
        let picture = Picture { eyes, stand, look, backdrop: headless::BACKDROP };
        self.easel(framing.size, kind)?.draw(&picture, uploads)
    }

    /// The easel of a size and kind.
    pub(super) fn easel(&mut self, n: usize, kind: Kind) -> Result<&mut Easel, Error> {
        self.easels.get_mut(&(n, kind)).ok_or_else(|| no_easel(n))
    }

    fn provide(&mut self, n: usize, kinds: &[Kind], size: [u32; 2]) -> Result<(), Error> {
        for &kind in kinds {
            if !self.easels.contains_key(&(n, kind)) {
                let canvas = Canvas { size, eyes: kind.eyes, samples: kind.samples };
                let easel = Easel::new(&self.gpu, n, canvas, &self.cache)?;
                self.cache = easel.cache()?;
                self.easels.insert((n, kind), easel);
            }
        }
        Ok(())
    }
}

fn no_easel(n: usize) -> Error {
    Error::Failure(format!("no volume of size {n} hangs in the studio"))
}

/// Nanoseconds of the views as the milliseconds of one.
pub(super) fn mean_ms(views: &[u64; VIEWS]) -> f64 {
    views.iter().map(|&ns| ns as f64).sum::<f64>() / VIEWS as f64 * 1e-6
}

/// A view of the ring: the eye stands still, and the stool turns before it.
fn seen(framing: &Framing, view: usize, [width, height]: [u32; 2]) -> (Eye, Stand) {
    let (sin, cos) = ELEVATION.sin_cos();
    let up = framing.half_angle;
    let right = (up.tan() * width as f32 / height as f32).atan();
    let eye = Eye {
        position: Vec3::new(0.0, sin, cos) * framing.distance + Vec3::Y * framing.height,
        rotation: Quat::from_rotation_x(-ELEVATION),
        fov: Fov { left: -right, right, up, down: -up },
    };
    let turn = view as f32 * (TAU / VIEWS as f32);
    (eye, Stand { foot: Vec3::ZERO, side: 1.0, turn })
}

/// Half way up a volume, in sides of the cube.
fn middle<const N: usize>(maps: &Maps<N>) -> f32 {
    let heights = (0..N).flat_map(|line| maps.line(Axis::Y, line)).map(|column| column.hull());
    let (lo, hi) = heights
        .filter(|range| !range.is_empty())
        .fold((N, 0), |(lo, hi), range| (range.lo().min(lo), range.hi().max(hi)));
    (lo + hi + 1) as f32 / (2 * N) as f32
}

/// Comes nearer until the sculpture fills the image as it should. It is the exact voxels that count.
fn frame(sketch: &mut Easel, pixels: [u32; 2], size: usize, height: f32) -> Result<Framing, Error> {
    let nearest = Framing { size, distance: NEAREST, height, half_angle: HALF_ANGLE, filled: 0.0 };
    if filled(sketch, pixels, &nearest)? < FILLED {
        let narrowed = |half_angle| Framing { half_angle, ..nearest };
        halve(sketch, pixels, [NARROWEST, HALF_ANGLE], narrowed)
    } else {
        let away = |distance| Framing { distance, ..nearest };
        halve(sketch, pixels, [NEAREST, FARTHEST], away)
    }
}

/// Halves the way between a value with which more is filled and one with which less is.
fn halve(
    sketch: &mut Easel,
    pixels: [u32; 2],
    [mut more, mut less]: [f32; 2],
    framing: impl Fn(f32) -> Framing,
) -> Result<Framing, Error> {
    let mut best = framing(more);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (more + less);
        best = framing(middle);
        best.filled = filled(sketch, pixels, &best)?;
        *(if best.filled > FILLED { &mut more } else { &mut less }) = middle;
    }
    Ok(best)
}

/// The part of the image that is not empty, over the ring.
fn filled(sketch: &mut Easel, size: [u32; 2], framing: &Framing) -> Result<f32, Error> {
    let look = Look { path: Path::Paper(Parts::Whole), ..Look::default() };
    let mut sum = 0;
    for view in 0..VIEWS {
        let (eye, stand) = seen(framing, view, size);
        sketch.draw(&Picture { eyes: &[eye], stand, look, backdrop: NOTHING }, &vec![])?;
        let image = sketch.image(0)?;
        sum += image.pixels.chunks_exact(3).filter(|pixel| **pixel != NOTHING_SHOWN).count();
    }
    Ok(sum as f32 / (size[0] as usize * size[1] as usize * VIEWS) as f32)
}
