//! Collision detection and freeze against the model, which walks over plain voxels, and against walls of
//! every inclination.

mod exits;
mod plates;
mod stone;

use std::sync::{Arc, Mutex};

use glam::{IVec3, Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{
    BURIED_WITHIN, FreezeResult, GridBit, GridShape, LONG_STRETCH, Obstacle, SHORT_STRETCH,
    WayBudget, exit_probe_steps,
};
use paros_core::limits::{EXIT_PROBES, max_bit_steps_per_tick};
use paros_core::session::ToolBit;
use paros_core::volume::{Axis, BitGrid, Column, Grid, Range, Size};
use paros_core::{Brush, RangeMaps};
use paros_models::cases::random_cases;
use paros_models::contact::ContactModel;
use paros_models::dense::{DenseVolume, MaskedVolume, closed_volumes_with_inner_mask};
use paros_models::path::path_poses;
use proptest::prelude::*;

use self::stone::{
    ContactHarness, STONE_16, STONE_128, STONE_256, any_rotations, lock_stone, table_bit,
    tick_budget, voxel_micrometres,
};

/// A strategy for bits: those of the table at both grid sizes, and balls and boxes of any proportion.
fn any_bits() -> impl Strategy<Value = GridBit> {
    let table = (0..ToolBit::ALL.len() as u8, prop_oneof![Just(128), Just(256)])
        .prop_map(|(number, n)| table_bit(number, n));
    let balls = (1..6 * SUBUNITS_PER_VOXEL, 0..1000).prop_map(|(radius, share)| GridBit {
        shape: GridShape::Ball(radius),
        bite: radius * share / 1000,
    });
    let boxes = (
        [1..6 * SUBUNITS_PER_VOXEL, 1..6 * SUBUNITS_PER_VOXEL, 1..6 * SUBUNITS_PER_VOXEL],
        0..1000,
    )
        .prop_map(|(half, share)| {
            let half = IVec3::from_array(half);
            GridBit { shape: GridShape::Box(half), bite: half.min_element() * share / 1000 }
        });
    let discs = (1..8 * SUBUNITS_PER_VOXEL, 1..3 * SUBUNITS_PER_VOXEL, 0..1000).prop_map(
        |(radius, half_thickness, share)| {
            let half_thickness = half_thickness.min(radius);
            let shape = GridShape::Disc { radius, half_thickness };
            GridBit { shape, bite: radius * share / 1000 }
        },
    );
    prop_oneof![3 => table, 2 => balls, 2 => boxes, 2 => discs]
}

/// A strategy for poses in and around a grid of `n`^3, some at a voxel's centre or corner, some metres away.
fn any_poses(n: usize) -> impl Strategy<Value = Pose> {
    let n = n as f32;
    let near = [-6.0..n + 6.0, -6.0..n + 6.0, -6.0..n + 6.0];
    let halves = near.clone().prop_map(|p| p.map(|f: f32| (f * 2.0).round() / 2.0));
    let far = [-5000.0..5000.0f32, -5000.0..5000.0f32, -5000.0..5000.0f32];
    let position = prop_oneof![6 => near, 2 => halves, 2 => far];
    (position, any_rotations())
        .prop_map(|(p, rotation)| Pose { position: Vec3::from_array(p), rotation })
}

/// A strategy for a hand's motion in a tick: a jump, a small motion, a rotation in place.
fn any_motions(n: usize) -> impl Strategy<Value = Motion> {
    let small = [-3.0..3.0f32, -3.0..3.0f32, -3.0..3.0f32].prop_map(Vec3::from_array);
    prop_oneof![
        2 => any_poses(n).prop_map(Motion::To),
        4 => (small.clone(), (small.clone(), 0.0..0.4f32)).prop_map(|(by, (axis, angle))| {
            Motion::By(by, Quat::from_axis_angle(axis.normalize_or(Vec3::X), angle))
        }),
        1 => any_rotations().prop_map(|turn| Motion::By(Vec3::ZERO, turn)),
        1 => small.prop_map(|by| Motion::By(by, Quat::IDENTITY)),
        1 => Just(Motion::By(Vec3::ZERO, Quat::IDENTITY)),
    ]
}

#[derive(Clone, Copy, Debug)]
enum Motion {
    To(Pose),
    By(Vec3, Quat),
}

impl Motion {
    fn apply_to(self, pose: &Pose) -> Pose {
        match self {
            Motion::To(pose) => pose,
            Motion::By(by, turn) => {
                Pose { position: pose.position + by, rotation: (turn * pose.rotation).normalize() }
            }
        }
    }
}

/// Asserts that a freeze equals the model's walk and slide, and that no depth exceeds its limit.
fn assert_freeze_follows_walk(
    obstacle: &Obstacle<'_, 16>,
    block: &ContactModel,
    bit: &GridBit,
    from: &Pose,
    raw: &Pose,
) -> Result<FreezeResult, TestCaseError> {
    let mut frozen = obstacle.freeze_bit(bit, from, raw, WayBudget::of_steps(0));
    prop_assert_eq!(frozen, block.freeze_by_walk(bit, from, raw, WayBudget::of_steps(0)));
    prop_assert!(frozen.pose == *from && frozen.ran_out && frozen.steps == 0);
    let few = WayBudget { steps: 20, quarter_voxels: 23 };
    for budget in [few, tick_budget(16)] {
        frozen = obstacle.freeze_bit(bit, from, raw, budget);
        prop_assert_eq!(frozen, block.freeze_by_walk(bit, from, raw, budget));
        let way = bit.path_steps(from, &frozen.pose);
        prop_assert!(frozen.jumped || way <= budget.quarter_voxels.saturating_add(1), "{way}");
        check_way_through_the_open(block, bit, from, &frozen)?;
        let (before, after) =
            (block.penetration_at(bit, from), block.penetration_at(bit, &frozen.pose));
        prop_assert!(after.volume <= bit.bite.max(before.volume), "{before:?} -> {after:?}");
        prop_assert!(after.mask <= before.mask, "{before:?} -> {after:?}");
        prop_assert!(!frozen.ran_out || frozen.steps == budget.steps || budget == few);
        if !frozen.blocked && !frozen.ran_out {
            prop_assert_eq!(frozen.pose, *raw);
        }
    }
    Ok(frozen)
}

/// Asserts that the bit's centre meets no stone on its straight path, unless the bit jumped or its bite lets
/// its centre into stone; and that a bit jumps only out of stone.
fn check_way_through_the_open(
    block: &ContactModel,
    bit: &GridBit,
    from: &Pose,
    frozen: &FreezeResult,
) -> Result<(), TestCaseError> {
    let buried = block.buries(bit, from);
    prop_assert!(!frozen.jumped || buried);
    if frozen.jumped
        || frozen.pose == *from
        || bit.inscribed_radius_subunits() - BURIED_WITHIN < bit.bite
    {
        return Ok(());
    }
    prop_assert!(!buried, "a way out of stone");
    let parts = ((frozen.pose.position - from.position).length() * 64.0).ceil().clamp(1.0, 1e5);
    for i in 0..=parts as u32 {
        let at = from.position.lerp(frozen.pose.position, i as f32 / parts);
        let voxel = at.floor().as_ivec3().to_array();
        prop_assert!(!block.is_occupied(voxel), "the centre is in {voxel:?} on its way");
    }
    Ok(())
}

/// Returns the greatest distance, in voxels, that a point of the bit moves between two poses.
fn longest_point_path(bit: &GridBit, a: &Pose, b: &Pose) -> f32 {
    let half = match bit.shape {
        GridShape::Ball(_) => Vec3::ZERO,
        GridShape::Box(half) => half.as_vec3() / SUBUNITS_PER_VOXEL as f32,
        GridShape::Disc { radius, half_thickness } => {
            Vec3::new(half_thickness as f32, radius as f32, radius as f32)
                / SUBUNITS_PER_VOXEL as f32
        }
    };
    let corner = |pose: &Pose, k: i32| {
        let sign = |bit: i32| if k & bit == 0 { -1.0 } else { 1.0 };
        pose.position + pose.rotation * (half * Vec3::new(sign(1), sign(2), sign(4)))
    };
    (0..8).map(|k| corner(a, k).distance(corner(b, k))).fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(random_cases(200))]

    #[test]
    fn contact_is_that_of_the_voxels(MaskedVolume { volume, mask } in closed_volumes_with_inner_mask(16), bit in any_bits(), pose in any_poses(16)) {
        let mut stone = lock_stone(&STONE_16);
        stone.set(&volume, &mask);
        let block = ContactModel::new(volume, &mask);
        prop_assert_eq!(stone.contact(&bit, &pose), block.contact_at(&bit, &pose));
    }

    #[test]
    fn no_step_is_longer_than_a_quarter_voxel(bit in any_bits(), from in any_poses(16), motion in any_motions(16)) {
        let mut last = from;
        // Only a disc may take longer steps, and only within its plane: one voxel, plus its rotation.
        let most = if matches!(bit.shape, GridShape::Disc { .. }) { 1.01 } else { 0.2525 };
        for next in path_poses(&bit, &from, &motion.apply_to(&from)).take(400) {
            let way = longest_point_path(&bit, &last, &next);
            // The tolerance for positions thousands of voxels away is a two-thousandth of a voxel.
            prop_assert!(way < most, "a step of {way} voxels");
            let across = (next.position - last.position).dot(last.rotation * Vec3::X).abs();
            let is_disc = matches!(bit.shape, GridShape::Disc { .. });
            prop_assert!(!is_disc || across < 0.2525, "{across} voxels across");
            last = next;
        }
    }
}

proptest! {
    #![proptest_config(random_cases(70))]

    /// Tests starts from any pose, deep inside included, as after an undo, a fill or a load; both in the
    /// stone and held by the mask alone.
    #[test]
    fn freeze_is_the_walk_from_anywhere(
        MaskedVolume { volume, mask } in closed_volumes_with_inner_mask(16),
        bit in any_bits(),
        from in any_poses(16),
        motions in proptest::collection::vec(any_motions(16), 1..5),
    ) {
        let mut stone = lock_stone(&STONE_16);
        stone.set(&volume, &mask);
        let of_stone = (false, ContactModel::new(volume, &mask));
        let of_mask = (true, ContactModel::of_mask_alone(&Arc::new(mask)));
        for (is_mask_alone, block) in [of_stone, of_mask] {
            let obstacle = Obstacle { is_mask_alone, ..stone.obstacle() };
            let mut pose = from;
            for motion in &motions {
                let raw = motion.apply_to(&pose);
                pose = assert_freeze_follows_walk(&obstacle, &block, &bit, &pose, &raw)?.pose;
            }
        }
    }

    /// A bit that starts outside never penetrates deeper than its bite, and never enters the mask.
    #[test]
    fn from_outside_nothing_gets_deeper_than_its_bite(
        MaskedVolume { volume, mask } in closed_volumes_with_inner_mask(16),
        bit in any_bits(),
        start in any_rotations(),
        side in [-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32],
        motions in proptest::collection::vec(any_motions(16), 1..6),
    ) {
        let mut stone = lock_stone(&STONE_16);
        stone.set(&volume, &mask);
        let obstacle = stone.obstacle();
        let block = ContactModel::new(volume, &mask);
        let away = Vec3::from_array(side).normalize_or(Vec3::Y) * 60.0;
        let mut pose = Pose { position: Vec3::splat(8.0) + away, rotation: start };
        for motion in motions {
            let raw = motion.apply_to(&pose);
            pose = assert_freeze_follows_walk(&obstacle, &block, &bit, &pose, &raw)?.pose;
            let sits = block.penetration_at(&bit, &pose);
            prop_assert!(sits.volume <= bit.bite && sits.mask == 0, "{sits:?}");
        }
    }
}

/// Asserts how far a tick walks. Along a floor every four steps cost five, because one combined test precedes
/// them; in free air the first four steps cost one, and then every sixteen.
fn assert_tick_reach<const N: usize>(stone: &'static Mutex<ContactHarness<N>>)
where
    Grid<N>: Size,
{
    let mut stone = lock_stone(stone);
    stone.set(&DenseVolume::from_fn(N, |[_, y, _]| y < 20), &DenseVolume::empty(N));
    let bit = ToolBit::MediumBall.to_grid_bit(voxel_micrometres(N));
    let rest =
        19.53 + (bit.inscribed_radius_subunits() - bit.bite) as f32 / SUBUNITS_PER_VOXEL as f32;
    let at = |x: f32, y: f32| Pose { position: Vec3::new(x, y, 40.5), rotation: Quat::IDENTITY };
    let walked = |y: f32, to: f32| {
        let frozen = stone.freeze(&bit, &at(20.0, y), &at(to, y));
        assert!(!frozen.blocked && frozen.steps == max_bit_steps_per_tick(N), "{frozen:?}");
        frozen.pose.position.x - 20.0
    };
    let far = max_bit_steps_per_tick(N) as f32 / 4.0;
    assert!((walked(rest, 120.0) - 0.8 * far).abs() < 0.1);
    assert!((walked(60.0, 1e4) - (16.0 * far - 3.0)).abs() < 0.1);
}

#[test]
fn a_tick_goes_so_far_at_128() {
    assert_tick_reach::<128>(&STONE_128);
}

#[test]
fn a_tick_goes_so_far_at_256() {
    assert_tick_reach::<256>(&STONE_256);
}

/// Two slabs with a gap between them: every bit meets both.
#[test]
fn a_mask_is_met_beyond_its_gap() {
    let slabs = [Range::new(0, 9), Range::new(40, 63)];
    let volume = DenseVolume::from_fn(64, |[x, ..]| slabs.iter().any(|s| s.contains(x as usize)));
    let mut rows = BitGrid::new();
    volume.insert_into_empty_bits(&mut rows);
    let mut mask = RangeMaps::<64, 2>::new();
    for (line, place) in (0..64).flat_map(|line| (0..64).map(move |place| (line, place))) {
        mask.set_column(Axis::X, (line, place), Column::new(slabs));
        if slabs.iter().any(|slab| slab.contains(place)) {
            let whole = Column::from_range(Range::new(0, 63));
            mask.set_column(Axis::Y, (line, place), whole);
            mask.set_column(Axis::Z, (line, place), whole);
        }
    }
    let model = ContactModel::new(volume.clone(), &volume);
    let obstacle = Obstacle { rows: &rows, mask: Some(&mask), is_mask_alone: false };
    for number in 0..ToolBit::ALL.len() as u8 {
        let bit = table_bit(number, 64);
        for x in [5.0, 12.5, 25.0, 38.5, 50.0] {
            let position = Vec3::new(x, 32.0, 32.0);
            let pose = Pose { position, rotation: Quat::from_rotation_y(x) };
            assert_eq!(
                obstacle.contact_at(&bit, &pose),
                model.contact_at(&bit, &pose),
                "{bit:?}, {x}"
            );
        }
    }
}

/// A smoothing file is stopped by the mask alone, and one swept test decides whether a stretch of its path is
/// free. A cover of the file's inside that is deeper than its bite may be cut into fewer pieces, and then
/// reaches farther than a cover of the whole file. A mask voxel in the former alone doesn't stop the file, so
/// its path costs no single steps.
#[test]
fn a_stretch_beside_the_mask_alone_is_tested_once() {
    let bit = table_bit(ToolBit::File as u8, 16);
    let at = |y: f32, turn: f32| Pose {
        position: Vec3::new(8.0, y, 8.0),
        rotation: Quat::from_rotation_y(turn),
    };
    let (from, to) = (at(6.0, 0.0), at(9.7, 1.35));
    let poses: Vec<Pose> = path_poses(&bit, &from, &to).collect();
    assert_eq!(poses.len() as u32, SHORT_STRETCH + LONG_STRETCH);
    let between = poses[SHORT_STRETCH as usize - 1];
    let stretches = [(from, between), (between, to)];
    let cover_of = |depth: i32| {
        let covers = stretches.map(|(from, to)| bit.swept_cover_deeper_than(depth, &from, &to));
        DenseVolume::from_fn(16, |[x, y, z]| {
            covers.iter().flatten().flat_map(Brush::pieces).any(|piece| {
                let row = piece.x_range(y as usize, z as usize, 16);
                row.is_some_and(|row| row.contains(x as usize))
            })
        })
    };
    let farther = cover_of(bit.bite).difference(&cover_of(0)).occupied().next();
    let farther = farther.expect("a voxel that only the inside's cover reaches");
    let mask = DenseVolume::from_fn(16, |voxel| voxel == farther);
    let mut stone = lock_stone(&STONE_16);
    stone.set(&mask, &mask);
    let steps = stretches.iter().map(|(from, to)| bit.stretch_cost_in_steps(from, to)).sum();
    let free = FreezeResult { pose: to, blocked: false, ran_out: false, jumped: false, steps };
    let obstacle = Obstacle { is_mask_alone: true, ..stone.obstacle() };
    assert_eq!(obstacle.freeze_bit(&bit, &from, &to, tick_budget(16)), free);
    let model = ContactModel::of_mask_alone(&Arc::new(mask));
    assert_eq!(model.freeze_by_walk(&bit, &from, &to, tick_budget(16)), free);
}

#[test]
fn looks_are_spread_over_the_rest_of_the_way() {
    for steps in 1..200 {
        for i in 0..steps + 1 {
            let most = [1, 5, 31, u32::MAX][i as usize % 4];
            let probes: Vec<u32> = exit_probe_steps(i, steps, most).collect();
            let ways: Vec<u32> =
                [i].iter().chain(&probes).zip(&probes).map(|(a, b)| b - a).collect();
            assert_eq!(probes.len() as u32, EXIT_PROBES.min(steps - i).min(most));
            assert_eq!(ways.iter().sum::<u32>(), steps - i);
            let widest = ways.iter().max().copied().unwrap_or(1);
            assert!(ways.iter().all(|way| (1..=widest).contains(way) && widest - way <= 1));
        }
    }
}
