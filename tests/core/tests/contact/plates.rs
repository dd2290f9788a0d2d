//! Tunnelling tests: no bit passes a wall one voxel thick, whatever its inclination.

use glam::{IVec3, Vec3};
use paros_core::edit::Pose;
use paros_core::session::ToolBit;
use paros_models::cases::random_cases;
use paros_models::dense::DenseVolume;
use proptest::prelude::*;

use super::stone::{STONE_64, any_rotations, lock_stone, table_bit};

/// A plate one voxel thick across the grid: the voxels that the plane crosses within their middle third along
/// the normal's longest axis.
#[derive(Clone, Copy, Debug)]
struct Plate {
    normal: Vec3,
    middle: Vec3,
}

impl Plate {
    /// Returns the signed distance of a point from the plate's middle plane.
    fn signed_height(&self, point: Vec3) -> f32 {
        (point - self.middle).dot(self.normal)
    }

    fn to_voxels(self, n: usize) -> DenseVolume {
        let thin = self.normal.abs().max_element() / 2.0;
        DenseVolume::from_fn(n, |voxel| {
            let height = self.signed_height(IVec3::from_array(voxel).as_vec3() + 0.5);
            -thin < height && height <= thin
        })
    }
}

fn any_plates() -> impl Strategy<Value = Plate> {
    let normal = prop_oneof![
        3 => [-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32].prop_map(Vec3::from_array),
        1 => [-1..2i32, -1..2i32, -1..2i32].prop_map(|n| IVec3::from_array(n).as_vec3()),
    ];
    (normal, [28.0..36.0f32, 28.0..36.0f32, 28.0..36.0f32]).prop_map(|(normal, middle)| Plate {
        normal: normal.normalize_or(Vec3::Y),
        middle: Vec3::from_array(middle),
    })
}

/// A strategy for paths across a plate: its inclination, and the path's lengths before and behind it in
/// voxels.
fn any_crossings() -> impl Strategy<Value = (Vec3, f32, f32)> {
    let lengths =
        prop_oneof![Just(30.0f32), Just(45.0), Just(300.0), Just(6000.0), 30.0..3000.0f32];
    let tilt = [-0.7..0.7f32, -0.7..0.7f32, -0.7..0.7f32].prop_map(Vec3::from_array);
    (tilt, lengths.clone(), lengths)
}

proptest! {
    #![proptest_config(random_cases(16))]

    /// Tests every bit of the table at both grid sizes, at any speed, rotating on its path.
    #[test]
    fn nothing_passes_a_plate_one_voxel_thick(
        plate in any_plates(),
        as_mask in any::<bool>(),
        (tilt, before, after) in any_crossings(),
        (start, end) in (any_rotations(), any_rotations()),
    ) {
        let mut stone = lock_stone(&STONE_64);
        let voxels = plate.to_voxels(64).closure();
        stone.set(&voxels, &if as_mask { voxels.clone() } else { DenseVolume::empty(64) });
        let way = (plate.normal + tilt).normalize();
        let way = if way.dot(plate.normal) < 0.3 { plate.normal } else { way };
        let from = Pose { position: plate.middle - way * before, rotation: start };
        let to = Pose { position: plate.middle + way * after, rotation: end };
        for (number, n) in (0..ToolBit::ALL.len() as u8).flat_map(|number| [(number, 128), (number, 256)]) {
            let bit = table_bit(number, n);
            if stone.contact(&bit, &from).overlap != 0 {
                continue;
            }
            let mut frozen = stone.freeze(&bit, &from, &to);
            while !frozen.blocked && frozen.pose != to {
                let last = frozen.pose;
                frozen = stone.freeze(&bit, &last, &to);
                prop_assert!(frozen.blocked || frozen.pose != last);
            }
            let depth = stone.contact(&bit, &frozen.pose).depth;
            let bite = if as_mask { 0 } else { bit.bite };
            prop_assert!(frozen.blocked, "bit {number} at {n} went through");
            prop_assert!(depth <= bite, "bit {number} at {n}: {depth} of {bite}");
            // Outside the grid a slide may lead round the plate's edge.
            let beside = frozen.pose.position - Vec3::splat(32.0);
            if beside.abs().max_element() < 31.0 {
                let height = plate.signed_height(frozen.pose.position);
                prop_assert!(height < 0.0, "bit {number} at {n} is {height} beyond");
            }
        }
    }
}
