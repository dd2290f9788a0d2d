//! A square picture of a volume, ray by ray: what an exact walk meets and what the fast path shows.

use std::path::PathBuf;

use glam::Vec3;
use paros_core::maps::Maps;
use paros_shaders::field::Field;
use paros_shaders::surface::Surface;
use paros_shaders::{Image, Ray, fast};
use rayon::prelude::*;

use super::dense::Dense;
use super::exact::{self, Entry};

/// A pinhole eye outside of the grid, lengths in voxels.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Where it is.
    pub eye: Vec3,
    /// Unit vectors to the picture's right, up and into it.
    pub axes: [Vec3; 3],
    /// Pixels that a voxel takes at a distance of one voxel.
    pub focal: f32,
    /// Pixels along a side.
    pub side: usize,
}

impl View {
    /// Looks at a point against the direction `way`, from a distance at which so many voxels fill
    /// the picture from side to side.
    pub fn new(at: Vec3, way: [f32; 3], [distance, across]: [f32; 2], side: usize) -> Self {
        let ahead = -Vec3::from_array(way).normalize();
        let right = ahead.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        let axes = [right, right.cross(ahead), ahead];
        View { eye: at - ahead * distance, axes, focal: side as f32 * distance / across, side }
    }

    /// The ray through a pixel's middle, counted row by row from the upper left one.
    pub fn ray(&self, pixel: usize) -> Ray {
        let middle = self.side as f32 / 2.0 - 0.5;
        let (x, y) = ((pixel % self.side) as f32 - middle, middle - (pixel / self.side) as f32);
        let [right, up, ahead] = self.axes;
        self.towards(self.eye + right * x + up * y + ahead * self.focal)
    }

    /// The ray through a point.
    pub fn towards(&self, point: Vec3) -> Ray {
        Ray { origin: self.eye, direction: (point - self.eye).normalize() }
    }

    /// Every pixel at most so many pixels from a place in pixels.
    pub fn near(&self, [x, y]: [f32; 2], radius: f32) -> impl Iterator<Item = usize> + use<> {
        let side = self.side;
        let span = move |c: f32| {
            (c - radius).ceil().max(0.0) as usize..((c + radius) as usize + 1).min(side)
        };
        let inside = move |i: &usize| {
            let (dx, dy) = ((i % side) as f32 - x, (i / side) as f32 - y);
            dx * dx + dy * dy <= radius * radius
        };
        span(y).flat_map(move |row| span(x).map(move |column| row * side + column)).filter(inside)
    }
}

/// What each pixel of a view shows.
#[derive(Debug)]
pub struct Picture {
    /// Whence.
    pub view: View,
    /// By the exact walk.
    pub exact: Vec<Option<Entry>>,
    /// On the fast path.
    pub fast: Vec<Option<Surface>>,
}

impl Picture {
    /// Of a volume and its textures.
    pub fn new<const N: usize>(dense: &Dense, field: &Field<N>, view: View) -> Self {
        let pixels = (0..view.side * view.side).into_par_iter();
        let both = |pixel| {
            let ray = view.ray(pixel);
            let [origin, direction] =
                [ray.origin, ray.direction].map(|v| v.to_array().map(f64::from));
            (exact::first(dense, origin, direction), fast::surface(field, &ray))
        };
        let (exact, fast) = pixels.map(both).unzip();
        Picture { view, exact, fast }
    }

    /// Where the exact walk of a pixel ends.
    pub fn place(&self, pixel: usize) -> Option<Vec3> {
        Some(self.view.ray(pixel).at(self.exact[pixel]?.distance as f32))
    }

    /// Writes a picture of the exact distances, some pixels red, into the temporary folder.
    ///
    /// # Panics
    /// There is no such folder.
    pub fn write(&self, name: &str, red: &[usize]) -> PathBuf {
        let hits = || self.exact.iter().flatten().map(|entry| entry.distance);
        let (near, far) = (hits().fold(f64::MAX, f64::min), hits().fold(0.0, f64::max));
        let mut image = Image::filled(self.view.side, self.view.side, [0; 3]);
        for (pixel, entry) in image.pixels.chunks_exact_mut(3).zip(&self.exact) {
            if let Some(entry) = entry {
                pixel.fill((240.0 - 180.0 * (entry.distance - near) / (far - near + 1.0)) as u8);
            }
        }
        for pixel in red {
            image.pixels[3 * pixel..3 * pixel + 3].copy_from_slice(&[255, 0, 0]);
        }
        let path = std::env::temp_dir().join(format!("paros-{name}.png"));
        let file = std::fs::File::create(&path).expect("a temporary folder");
        image.write_png(file).expect("a temporary folder");
        path
    }
}

/// The maps and textures of a volume that is its own closure.
///
/// # Panics
/// It is not.
pub fn textures<const N: usize>(dense: &Dense) -> (Box<Maps<N>>, Box<Field<N>>) {
    let mut maps = Box::new(Maps::new());
    dense.write_maps(&mut maps);
    assert!(Dense::from_maps(&maps) == *dense, "not a closed shape");
    let mut field = Box::new(Field::new());
    field.rebuild(&maps);
    (maps, field)
}
