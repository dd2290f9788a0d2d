//! Exit search and slide: how a bit leaves stone that an undo or a fill has put around it.

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::session::ToolBit;
use paros_models::dense::DenseVolume;

use super::stone::{STONE_64, lock_stone, table_bit, voxel_micrometres};

/// A bit whose centre is in the stone can't move. It stays until its hand is at a place that is free for the
/// bit, and then jumps there.
#[test]
fn a_buried_bit_stands_until_its_hand_is_free() {
    let mut stone = lock_stone(&STONE_64);
    stone.set(&DenseVolume::from_fn(64, |[_, y, _]| y < 40), &DenseVolume::empty(64));
    for number in 0..ToolBit::ALL.len() as u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        for (from, to) in [(39.0, 20.0), (39.0, 39.5), (20.0, 39.0), (20.0, -4.0)] {
            let held = stone.freeze(&bit, &at(from), &at(to));
            let is_free = stone.contact(&bit, &at(to)).depth <= bit.bite;
            let expected = if is_free { to } else { from };
            assert_eq!((held.pose, held.jumped), (at(expected), is_free), "bit {number}");
            assert_eq!((held.blocked, held.ran_out), (!is_free, false), "bit {number}");
        }
        // The distance doesn't matter, even across the stone.
        for to in [60.0, 500.0, -30.0] {
            let up = stone.freeze(&bit, &at(20.0), &at(to));
            assert_eq!((up.pose, up.blocked, up.jumped), (at(to), false, true), "bit {number}");
        }
    }
}

/// Between the buried bit and its hand lies a cavity that would be free. The path to it leads through stone.
#[test]
fn no_way_leads_through_stone() {
    let mut stone = lock_stone(&STONE_64);
    stone.set(
        &DenseVolume::from_fn(64, |[_, y, _]| !(10..52).contains(&y)),
        &DenseVolume::empty(64),
    );
    for number in 0..ToolBit::ALL.len() as u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        assert!(stone.contact(&bit, &at(31.0)).depth <= bit.bite, "bit {number} fits the hollow");
        let held = stone.freeze(&bit, &at(4.0), &at(58.0));
        assert_eq!((held.pose, held.blocked), (at(4.0), true), "bit {number}");
    }
}

/// A bit slides along the floor below a beam. Its path is free, but the chord, which the edit sweeps and the
/// next tick starts from, leads through the beam, so the bit doesn't slide.
#[test]
fn no_slide_cuts_a_corner_of_stone() {
    let mut stone = lock_stone(&STONE_64);
    let bit = ToolBit::SmallBall.to_grid_bit(voxel_micrometres(128));
    let at = |x: f32, y: f32| Pose { position: Vec3::new(x, y, 32.0), rotation: Quat::IDENTITY };
    for (with_beam, least) in [(false, 43.0), (true, 0.0)] {
        let beam = |x: i32, y: i32| with_beam && (36..40).contains(&x) && (25..29).contains(&y);
        stone.set(
            &DenseVolume::from_fn(64, |[x, y, _]| y < 20 || beam(x, y)),
            &DenseVolume::empty(64),
        );
        // One tick's steps don't cover the whole path.
        let mut slid = stone.freeze(&bit, &at(30.0, 30.0), &at(44.0, -22.5));
        if slid.ran_out {
            slid = stone.freeze(&bit, &slid.pose, &at(44.0, -22.5));
        }
        let Vec3 { x, y, .. } = slid.pose.position;
        assert!(slid.blocked && !slid.ran_out && y < 23.0, "{slid:?}");
        assert_eq!((x > least, x < 34.0), (true, with_beam), "{slid:?}");
    }
}

/// The situation after an undo: the bit is in a slot narrower than itself, whose walls penetrate it on both sides.
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
            // The bit doesn't pass through the wall.
            let aside = Pose { position: Vec3::new(62.0, 20.1, 32.3), rotation };
            let held = stone.freeze(&bit, &at(20.1), &aside);
            assert!(
                held.jumped || held.pose.position.x < x + width as f32,
                "bit {number}: {held:?}"
            );
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

/// A hand presses its bit deep into the figure and moves half around it: the bit follows on the surface, over
/// every voxel step, and stays where the figure is nearest to the hand.
#[test]
fn a_bit_goes_around_a_figure_with_a_hand_that_presses_deep() {
    let mut stone = lock_stone(&STONE_64);
    let middle = Vec3::splat(32.0);
    let radius = 18.0;
    let figure = DenseVolume::from_fn(64, |at| {
        (Vec3::from_array(at.map(|i| i as f32 + 0.5)) - middle).length() < radius
    });
    stone.set(&figure, &figure);
    for bit in [ToolBit::SmallBall, ToolBit::MediumBall, ToolBit::LargeBall] {
        let ball = bit.to_grid_bit(voxel_micrometres(128));
        let touching = radius + ball.inscribed_radius_subunits() as f32 / SUBUNITS_PER_VOXEL as f32;
        for tilt in [0.0_f32, 0.4, 1.1] {
            let around = |degrees: f32| {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                Quat::from_rotation_z(tilt) * Vec3::new(sine, 0.3, cosine).normalize()
            };
            let at = |degrees: f32, from_middle: f32| Pose {
                position: middle + around(degrees) * from_middle,
                rotation: Quat::IDENTITY,
            };
            let mut pose = at(0.0, touching + 1.0);
            // 2 voxels a tick, as for a hand at 0.5 m/s, and 6 voxels deep.
            for degrees in (0..180).step_by(5) {
                pose = stone.freeze(&ball, &pose, &at(degrees as f32, touching - 6.0)).pose;
                let behind = (pose.position - middle).normalize().dot(around(degrees as f32));
                let degrees_behind = behind.clamp(-1.0, 1.0).acos().to_degrees();
                assert!(degrees_behind < 20.0, "{bit:?}, {tilt}: {degrees_behind} at {degrees}");
            }
        }
    }
}
