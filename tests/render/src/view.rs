//! Renders a square picture of a volume ray by ray: by an exact voxel traversal and by the fast path.

use std::path::PathBuf;

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::Range;
use paros_shaders::field::DensityField;
use paros_shaders::surface::SurfacePoint;
use paros_shaders::{Image, Ray, fast};
use rayon::prelude::*;

use paros_models::dense::DenseVolume;
use paros_models::layers::LayeredVolume;
use paros_models::voxel_traversal::{self, VoxelEntry};

/// A pinhole camera outside the grid, with lengths in voxels.
#[derive(Clone, Copy, Debug)]
pub struct PinholeView {
    /// The camera's position.
    pub eye: Vec3,
    /// Unit vectors to the picture's right, its top and into it.
    pub axes: [Vec3; 3],
    /// The size in pixels of a voxel at a distance of one voxel.
    pub focal: f32,
    /// Number of pixels along a side.
    pub side: usize,
}

impl PinholeView {
    /// Creates a camera that looks at `target` from a direction and a distance; `width_at_target` voxels fill
    /// the picture's width there.
    pub fn new(
        target: Vec3,
        towards_eye: [f32; 3],
        [distance, width_at_target]: [f32; 2],
        side_pixels: usize,
    ) -> Self {
        let ahead = -Vec3::from_array(towards_eye).normalize();
        let right = ahead.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        let axes = [right, right.cross(ahead), ahead];
        PinholeView {
            eye: target - ahead * distance,
            axes,
            focal: side_pixels as f32 * distance / width_at_target,
            side: side_pixels,
        }
    }

    /// Returns the ray through a pixel's centre; pixels are counted row by row from the upper left.
    pub fn ray_through(&self, pixel: usize) -> Ray {
        let middle = self.side as f32 / 2.0 - 0.5;
        let (x, y) = ((pixel % self.side) as f32 - middle, middle - (pixel / self.side) as f32);
        let [right, up, ahead] = self.axes;
        self.ray_towards(self.eye + right * x + up * y + ahead * self.focal)
    }

    /// Returns the ray through a point.
    pub fn ray_towards(&self, point: Vec3) -> Ray {
        Ray { origin: self.eye, direction: (point - self.eye).normalize() }
    }

    /// Returns every pixel within a radius of a place, both in pixels.
    pub fn pixels_within(
        &self,
        [x, y]: [f32; 2],
        radius: f32,
    ) -> impl Iterator<Item = usize> + use<> {
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

/// The hits of each pixel of a view.
#[derive(Debug)]
pub struct TracedPicture {
    /// The camera.
    pub view: PinholeView,
    /// Hits of the exact traversal.
    pub exact: Vec<Option<VoxelEntry>>,
    /// Hits of the fast path.
    pub fast: Vec<Option<SurfacePoint>>,
}

impl TracedPicture {
    /// Traces both pictures of a volume and its textures.
    pub fn new<const N: usize, const K: usize>(
        dense: &DenseVolume,
        field: &DensityField<N, K>,
        view: PinholeView,
    ) -> Self {
        let pixels = (0..view.side * view.side).into_par_iter();
        // Rays that miss the bounding box have no hit; this avoids the slow exact traversal.
        let bounds = dense.bounding_box().ranges();
        let both = |pixel| {
            let ray = view.ray_through(pixel);
            let [origin, direction] =
                [ray.origin, ray.direction].map(|v| v.to_array().map(f64::from));
            let exact = meets_box(&bounds, origin, direction)
                .then(|| voxel_traversal::find_first_occupied(dense, origin, direction));
            (exact.flatten(), fast::find_surface(field, &ray))
        };
        let (exact, fast) = pixels.map(both).unzip();
        TracedPicture { view, exact, fast }
    }

    /// Returns the exact traversal's hit of a pixel, in voxels.
    pub fn exact_point(&self, pixel: usize) -> Option<Vec3> {
        Some(self.view.ray_through(pixel).at(self.exact[pixel]?.distance as f32))
    }

    /// Writes a picture of the exact distances, with some pixels in red, to the temporary folder.
    ///
    /// # Panics
    /// The folder doesn't exist.
    pub fn write_png(&self, name: &str, red: &[usize]) -> PathBuf {
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

/// Returns `true` if a ray meets a box of voxels or passes at less than a thousandth of a voxel.
fn meets_box(bounds: &[Range; 3], origin: [f64; 3], direction: [f64; 3]) -> bool {
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let ends = [bounds[axis].first() as f64 - 1e-3, bounds[axis].last() as f64 + 1.001];
        let [a, b] = ends.map(|end| (end - origin[axis]) / direction[axis]);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    near <= far
}

/// Returns the maps and the density field of a volume that is its own closure in columns of one interval.
///
/// # Panics
/// The volume isn't its own closure.
pub fn build_maps_and_field<const N: usize>(
    dense: &DenseVolume,
) -> (Box<RangeMaps<N>>, Box<DensityField<N>>) {
    let mut maps = Box::new(RangeMaps::new());
    dense.write_maps(&mut maps);
    assert!(DenseVolume::from_maps(&maps) == *dense, "not a closed shape");
    let mut field = Box::new(DensityField::new());
    field.rebuild_from(&maps);
    (maps, field)
}

/// Returns the maps and the density field of a volume that is its own closure in columns of K intervals, some
/// of which have gaps.
///
/// # Panics
/// The volume isn't its own closure, or no column has a gap.
pub fn build_layered_maps_and_field<const N: usize, const K: usize>(
    dense: &DenseVolume,
) -> (Box<RangeMaps<N, K>>, Box<DensityField<N, K>>) {
    let mut maps = Box::new(RangeMaps::new());
    LayeredVolume::new(dense, K).write_maps(&mut maps);
    assert!(DenseVolume::from_maps(&maps) == *dense, "not a closed shape");
    assert!(dense.closure() != *dense, "one interval a column would do");
    let mut field = Box::new(DensityField::new());
    field.rebuild_from(&maps);
    (maps, field)
}
