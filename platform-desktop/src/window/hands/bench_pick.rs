//! Picking of the workbench's items by ray casting against their drawn meshes.

use glam::Vec3;
use paros_core::World;
use paros_core::internals::{BENCH_ITEMS, RoomPose};
use paros_core::limits::INTERVALS;
use paros_core::session::BenchItem;
use paros_core::volume::{Grid, Size};
use paros_shaders::Ray;
use paros_shaders::scene::MeshId;
use paros_shaders::scene::placing::{bit_pose, display_pose_unless_held_or_mounted};

use super::bit_guide::ray_from_room_to_grid;
use super::{MouseHands, RIGHT};
use crate::window::raycast;

/// Largest distance from a ray to a body at which the body is still picked, in metres.
const SLACK_M: f32 = 0.006;

impl<const N: usize> MouseHands<N>
where
    Grid<N>: Size,
{
    /// Returns the item on the workbench under the cursor; `None` while the mouse is busy.
    #[must_use]
    pub(in crate::window) fn pointed_item(&self, world: &World<N, INTERVALS>) -> Option<BenchItem> {
        let is_busy = self.running && !self.is_released || self.orbiting || self.dragging_stool;
        let cursor = self.cursor.filter(|_| !is_busy)?;
        let room_ray = self.orbit.room_ray_through_pixel(cursor, self.size);
        pick_unoccluded_item(&room_ray, world)
    }

    /// Takes an item. Before a bit it takes the bit's tool, unless that is already in hand.
    pub(super) fn take_item_with_its_tool(&mut self, item: BenchItem, world: &World<N, INTERVALS>) {
        if let BenchItem::Bit(bit) = item {
            let tool = bit.spec().tool;
            if world.held_tool(RIGHT).is_none_or(|(held, _)| held != tool) {
                self.take_item(BenchItem::Tool(tool));
            }
        }
        self.take_item(item);
    }
}

/// Picks the item on the workbench whose drawn body a ray in the room hits first, else the one that it passes
/// within [`SLACK_M`]. Items that the sculpture occludes are ignored.
fn pick_unoccluded_item<const N: usize>(
    room_ray: &Ray,
    world: &World<N, INTERVALS>,
) -> Option<BenchItem>
where
    Grid<N>: Size,
{
    let items = (0..BENCH_ITEMS).filter_map(BenchItem::from_number);
    let passed: Vec<_> =
        items.filter_map(|item| Some((pass_item(room_ray, world, item)?, item))).collect();
    // A body that the ray hits comes before one that it only passes.
    let key = |pass: &Pass| (pass.aside, pass.along);
    let nearest =
        passed.iter().min_by(|(a, _), (b, _)| key(a).partial_cmp(&key(b)).expect("finite"));
    let (pass, item) = nearest?;
    let grid_ray = ray_from_room_to_grid(room_ray, world);
    let occluded = raycast::cast_ray(world.volume().maps(), &grid_ray)
        .is_some_and(|hit| hit.distance_voxels * world.stool_frame().voxel_metres() < pass.along);
    (!occluded).then_some(*item)
}

/// Returns the vertices of an item's drawn body in the room, in metres; empty for an item that is held or
/// mounted.
pub(in crate::window) fn body_vertices<const N: usize>(
    world: &World<N, INTERVALS>,
    item: BenchItem,
) -> Vec<Vec3>
where
    Grid<N>: Size,
{
    let meshes = drawn_meshes(world, item);
    let place = |(mesh, (position, rotation)): (MeshId, RoomPose)| {
        let vertices = mesh.vertices().iter();
        vertices.map(move |vertex| position + rotation * Vec3::from_array(vertex.position))
    };
    meshes.into_iter().flatten().flat_map(place).collect()
}

/// The closest approach of a ray to a body: the distance along the ray and beside it, in metres. `aside` is 0
/// for a hit.
#[derive(Clone, Copy)]
struct Pass {
    along: f32,
    aside: f32,
}

/// Returns the meshes that an item is drawn with, and their poses: a tool and its mounted bit.
fn drawn_meshes<const N: usize>(
    world: &World<N, INTERVALS>,
    item: BenchItem,
) -> [Option<(MeshId, RoomPose)>; 2]
where
    Grid<N>: Size,
{
    let bench = world.workbench();
    let Some(pose) = display_pose_unless_held_or_mounted(bench, item) else { return [None; 2] };
    match item {
        BenchItem::Tool(tool) => {
            let bit = MeshId::of_bit(bench.mounted_bit(tool));
            [Some((MeshId::of_tool(tool), pose)), Some((bit, bit_pose(pose, tool)))]
        }
        BenchItem::Bit(bit) => [Some((MeshId::of_bit(bit), pose)), None],
    }
}

/// Returns a ray's closest approach to an item; `None` beyond [`SLACK_M`], behind the ray's origin, or for an
/// absent item.
fn pass_item<const N: usize>(
    ray: &Ray,
    world: &World<N, INTERVALS>,
    item: BenchItem,
) -> Option<Pass>
where
    Grid<N>: Size,
{
    let passes = drawn_meshes(world, item).into_iter().flatten().filter_map(|(mesh, pose)| {
        let (position, rotation) = pose;
        let unturned = rotation.conjugate();
        let ray =
            Ray { origin: unturned * (ray.origin - position), direction: unturned * ray.direction };
        pass_mesh(&ray, mesh)
    });
    passes.min_by(|a, b| a.aside.total_cmp(&b.aside).then(a.along.total_cmp(&b.along)))
}

/// Returns a ray's closest approach to a mesh, in the mesh's own space.
fn pass_mesh(ray: &Ray, mesh: MeshId) -> Option<Pass> {
    let aside_of = |point: Vec3| (point - ray.origin).cross(ray.direction).length();
    if aside_of(Vec3::ZERO) > mesh.range().radius + SLACK_M {
        return None;
    }
    let vertices = mesh.vertices();
    let corner = |index: u16| Vec3::from_array(vertices[usize::from(index)].position);
    let met = mesh.indices().chunks_exact(3).filter_map(|triangle| {
        meet_triangle(ray, [corner(triangle[0]), corner(triangle[1]), corner(triangle[2])])
    });
    if let Some(along) = met.min_by(f32::total_cmp) {
        return Some(Pass { along, aside: 0.0 });
    }
    let points = vertices.iter().map(|vertex| Vec3::from_array(vertex.position));
    let passes = points.map(|point| Pass {
        along: (point - ray.origin).dot(ray.direction),
        aside: aside_of(point),
    });
    passes
        .filter(|pass| pass.along > 0.0 && pass.aside < SLACK_M)
        .min_by(|a, b| a.aside.total_cmp(&b.aside))
}

/// Returns the distance at which a ray hits a triangle, from either side (Moeller and Trumbore, 1997).
fn meet_triangle(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (along_b, along_c) = (b - a, c - a);
    let across = ray.direction.cross(along_c);
    let determinant = along_b.dot(across);
    if determinant.abs() < 1e-12 {
        return None;
    }
    let from_a = ray.origin - a;
    let u = from_a.dot(across) / determinant;
    let turned = from_a.cross(along_b);
    let v = ray.direction.dot(turned) / determinant;
    let distance = along_c.dot(turned) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_triangle_within_its_edges_alone() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let met = |x, y| {
            let ray = Ray { origin: Vec3::new(x, y, 2.0), direction: Vec3::NEG_Z };
            meet_triangle(&ray, triangle)
        };
        assert_eq!(met(0.25, 0.25), Some(2.0));
        for (x, y) in [(-0.1, 0.5), (0.5, -0.1), (0.6, 0.6)] {
            assert_eq!(met(x, y), None, "{x} {y}");
        }
        let behind = Ray { origin: Vec3::new(0.25, 0.25, -2.0), direction: Vec3::NEG_Z };
        assert_eq!(meet_triangle(&behind, triangle), None);
    }
}
