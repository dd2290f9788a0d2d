//! Exit search and slide: how a bit leaves the stone that an undo or a fill has put around it.

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::FreezeResult;
use paros_core::limits::{deep_step_cost_in_steps, max_bit_steps_per_tick};
use paros_core::session::ToolBit;
use paros_models::dense::DenseVolume;

use crate::stone::{STONE_64, lock_stone, table_bit, voxel_micrometres};

/// A bit deep in the stone moves outwards, and never deeper.
#[test]
fn a_buried_bit_can_only_come_out() {
    let mut stone = lock_stone(&STONE_64);
    stone.set(&DenseVolume::from_fn(64, |[_, y, _]| y < 40), &DenseVolume::empty(64));
    for number in 0..9u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        let sits = stone.contact(&bit, &at(39.0)).depth;
        assert!(sits > bit.bite, "bit {number} is buried");
        let down = stone.freeze(&bit, &at(39.0), &at(20.0));
        assert!(stone.contact(&bit, &down.pose).depth <= sits, "bit {number}: {down:?}");
        let mut up = FreezeResult { pose: at(39.0), blocked: false, steps: 0 };
        for _ in 0..21 * 4 * deep_step_cost_in_steps(64) / max_bit_steps_per_tick(64) + 1 {
            up = stone.freeze(&bit, &up.pose, &at(60.0));
        }
        assert_eq!((up.pose, up.blocked), (at(60.0), false), "bit {number}");
        // Half way out counts: what was gained is not given back.
        let half = stone.freeze(&bit, &at(39.0), &at(41.0)).pose;
        let again = stone.freeze(&bit, &half, &at(39.0)).pose;
        assert!(
            stone.contact(&bit, &again).depth <= stone.contact(&bit, &half).depth.max(bit.bite)
        );
    }
}

/// From any depth, as the hand's target is far outside.
#[test]
fn a_bit_comes_out_of_the_middle_of_a_block() {
    let mut stone = lock_stone(&STONE_64);
    stone.set(&DenseVolume::from_fn(64, |[_, y, _]| y < 60), &DenseVolume::empty(64));
    for number in 0..9u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        let mut pose = at(20.0);
        for _ in 0..20 {
            pose = stone.freeze(&bit, &pose, &at(120.0)).pose;
        }
        assert_eq!(pose, at(120.0), "bit {number}");
    }
}

/// As after an undo: in a slot narrower than the bit, whose walls penetrate it on both sides.
#[test]
fn a_bit_comes_out_of_a_slot() {
    let mut stone = lock_stone(&STONE_64);
    for width in 1..12 {
        let in_wall = |x: i32| (26..32).contains(&x) || (32 + width..38 + width).contains(&x);
        stone.set(
            &DenseVolume::from_fn(64, |[x, y, _]| y < 40 && in_wall(x)),
            &DenseVolume::empty(64),
        );
        let x = 32.0 + width as f32 / 2.0;
        for (number, turn) in (0..9u8).flat_map(|number| [(number, 0.0), (number, 0.3)]) {
            let bit = table_bit(number, 128);
            let rotation = Quat::from_rotation_y(turn);
            let at = |y: f32| Pose { position: Vec3::new(x, y, 32.3), rotation };
            let mut pose = at(20.1);
            for _ in 0..20 {
                pose = stone.freeze(&bit, &pose, &at(80.0)).pose;
            }
            assert_eq!(pose, at(80.0), "bit {number}, turned by {turn}, {width} voxels");
            // Not through the wall.
            let aside = Pose { position: Vec3::new(62.0, 20.1, 32.3), rotation };
            let held = stone.freeze(&bit, &at(20.1), &aside).pose;
            let is_buried =
                stone.contact(&bit, &at(20.1)).depth > bit.inscribed_radius_subunits() - 222;
            assert!(is_buried || held.position.x < x + width as f32, "bit {number}: {held:?}");
        }
    }
}

/// A bit that is pushed obliquely into a floor slides along it.
#[test]
fn a_blocked_bit_slides() {
    let mut stone = lock_stone(&STONE_64);
    stone.set(&DenseVolume::from_fn(64, |[_, y, _]| y < 20), &DenseVolume::empty(64));
    let bit = ToolBit::MediumBall.to_grid_bit(voxel_micrometres(128));
    let at = |x: f32, y: f32| Pose { position: Vec3::new(x, y, 32.0), rotation: Quat::IDENTITY };
    let mut frozen = stone.freeze(&bit, &at(20.0, 30.0), &at(40.0, 10.0));
    for _ in 0..2 {
        frozen = stone.freeze(&bit, &frozen.pose, &at(40.0, 10.0));
    }
    let rest =
        20.0 + (bit.inscribed_radius_subunits() - bit.bite) as f32 / SUBUNITS_PER_VOXEL as f32;
    let position = frozen.pose.position;
    assert!(frozen.blocked && (position.x - 40.0).abs() < 0.3, "{position}");
    assert!((position.y - rest).abs() < 0.8, "{position}, {rest}");
}
