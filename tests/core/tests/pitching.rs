//! The pitching chisel at work: near an edge a blow splits off a flake, elsewhere it chips.

use std::sync::{Mutex, PoisonError};

use glam::{IVec3, Mat3, Quat, Vec3};
use paros_core::TickInput;
use paros_core::WorldEvent;
use paros_core::edit::EditReport;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_core::volume::{Grid, Size};
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{BOX_MM, RIGHT, input_with_bit_at, take_item, volume_of};
use paros_models::world_harness::WorldHarness;

static SMALL: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

/// The stone's top and its edge along z, in millimetres.
const TOP_MM: f32 = 225.0;
const EDGE_MM: f32 = 300.0;

/// The distance from the chisel's centre to its tip, and the reach of a flake, in millimetres.
const TIP_MM: f32 = 14.0;
const FLAKE_MM: f32 = 40.0;

/// Returns the grip of a chisel whose blow points down toward the edge at an inclination.
fn grip(degrees: f32) -> Quat {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let blow = Vec3::new(cosine, -sine, 0.0);
    let up = Vec3::new(sine, cosine, 0.0);
    Quat::from_mat3(&Mat3::from_cols(up.cross(-blow), up, -blow))
}

/// The result of a blow.
struct Blow {
    removed: DenseVolume,
    /// The reported splits: number of voxels and their box.
    splits: Vec<(u32, paros_core::volume::VoxelBox)>,
    report: EditReport,
}

fn take_chisel<const N: usize>(harness: &mut WorldHarness<N, 2>)
where
    Grid<N>: Size,
{
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Impact));
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::PitchingChisel));
}

/// Sets the chisel's tip on a place, in millimetres, and strikes once.
fn strike<const N: usize>(harness: &mut WorldHarness<N, 2>, tip: Vec3, rotation: Quat) -> Blow
where
    Grid<N>: Size,
{
    let mut step = |above: f32, trigger: u8| {
        let place = tip + rotation * Vec3::Z * TIP_MM + Vec3::Y * above;
        harness.step(&input_with_bit_at(harness, place, rotation, trigger));
    };
    (0..3).for_each(|_| step(90.0, 0));
    (0..8).for_each(|i| step(10.0 - 1.6 * i as f32, 0));
    step(-2.0, 0);
    let before = volume_of(harness);
    let mut step = |trigger: u8| {
        let place = tip + rotation * Vec3::Z * TIP_MM - Vec3::Y * 2.0;
        harness.step(&input_with_bit_at(harness, place, rotation, trigger));
        harness.world.events().to_vec()
    };
    // The blow and the rest of its period.
    let events: Vec<WorldEvent> = (0..6).flat_map(|_| step(255)).collect();
    let mut blow = Blow {
        removed: before.difference(&volume_of(harness)),
        splits: vec![],
        report: EditReport::default(),
    };
    for event in events {
        match event {
            WorldEvent::Split { removed, within, .. } => blow.splits.push((removed, within)),
            WorldEvent::Edited { report, .. } => blow.report = blow.report.sum_with(report),
            _ => {}
        }
    }
    blow
}

fn start_block<const N: usize>(harness: &mut WorldHarness<N, 2>)
where
    Grid<N>: Size,
{
    let voxel = BOX_MM / N as f32;
    let is_stone = |at: usize, end: f32| (at as f32 + 0.5) * voxel < end;
    harness.start_from_voxels(|[x, y, _]| is_stone(x, EDGE_MM) && is_stone(y, TOP_MM));
    take_chisel(harness);
}

fn check_edge<const N: usize>(harness: &Mutex<WorldHarness<N, 2>>)
where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(PoisonError::into_inner);
    let voxel = BOX_MM / N as f32;
    for (back, degrees) in [(15.0, 35.0), (24.0, 50.0)] {
        start_block(&mut harness);
        let tip = Vec3::new(EDGE_MM - back, TOP_MM, 225.0);
        let Blow { removed, splits, report } = strike(&mut harness, tip, grip(degrees));
        let [(count, within)] = splits[..] else { panic!("{N}, {back} mm: {splits:?}") };
        assert_eq!((count, report.removed), (removed.count(), count), "{N}, {back} mm");
        // The whole wedge to the edge is removed, as far as 25 mm along it, and nothing else.
        let up = grip(degrees) * Vec3::Y;
        let middle = |at: [i32; 3]| (IVec3::from_array(at).as_vec3() + 0.5) * voxel;
        for at in removed.occupied() {
            let off = middle(at) - tip;
            assert!(off.length() < FLAKE_MM + 3.0 * voxel, "{N}: {at:?} is {off} away");
            assert!(off.dot(up) > -2.0 * voxel, "{N}: {at:?} is below the blow");
            let ranges = within.ranges();
            assert!((0..3).all(|i| ranges[i].contains(at[i] as usize)), "{N}: {at:?}");
        }
        let left = volume_of(&harness);
        for at in left.occupied() {
            let off = middle(at) - tip;
            let is_of_wedge = off.length() < FLAKE_MM - 3.0 * voxel && off.dot(up) > 2.0 * voxel;
            assert!(!is_of_wedge || off.z.abs() > 25.0, "{N}: {at:?} is left");
        }
    }
}

#[test]
fn a_blow_near_an_edge_splits_the_wedge_off() {
    check_edge(&SMALL);
    check_edge(&LARGE);
}

/// In the middle of a face, and on a thin plate far from its rim, there is no edge to split off.
#[test]
fn elsewhere_it_chips() {
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    start_block(&mut harness);
    let tip = Vec3::new(EDGE_MM - 90.0, TOP_MM, 225.0);
    let Blow { removed, splits, report } = strike(&mut harness, tip, grip(35.0));
    assert!(splits.is_empty(), "{splits:?}");
    assert!(report.removed > 0 && removed.count() < 120, "{} chips", removed.count());
    // Straight down through 30 mm of stone: the blow passes through, and the blade's plane has no thinner
    // side.
    harness.start_from_voxels(|[_, y, _]| y < 10);
    take_chisel(&mut harness);
    harness.start_from_voxels(|[x, y, z]| (56..64).contains(&y) || y < 56 && (x < 20 || z < 20));
    take_chisel(&mut harness);
    let Blow { splits, .. } = strike(&mut harness, tip.with_x(225.0), grip(90.0));
    assert!(splits.is_empty(), "{splits:?}");
}

/// With the symmetry mirror, a blow splits two flakes, and one undo restores both.
#[test]
fn a_mirrored_flake_is_undone_as_a_whole() {
    let mut harness = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let is_stone = |at: f32| (150.0..EDGE_MM).contains(&((at + 0.5) * BOX_MM / 256.0));
    harness.start_from_voxels(|[x, y, _]| is_stone(x as f32) && y < 128);
    take_chisel(&mut harness);
    harness.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
    let before = volume_of(&harness);
    let tip = Vec3::new(EDGE_MM - 15.0, TOP_MM, 225.0);
    let Blow { removed, splits, .. } = strike(&mut harness, tip, grip(40.0));
    assert_eq!(splits.len(), 1);
    assert!(removed.count() > 400 && removed == removed.mirrored_in_x());
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    assert!(volume_of(&harness) == before, "undo leaves a part");
}

/// Flakes that split off around the hidden figure leave it whole.
#[test]
fn a_flake_leaves_the_mask() {
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let side = 128;
    let at = |x: f32| (x * side as f32 / BOX_MM) as i32;
    let stone = DenseVolume::from_fn(side, |[x, y, _]| x < at(EDGE_MM) && y < at(TOP_MM));
    let mask = DenseVolume::from_fn(side, |[x, y, z]| {
        (at(286.0)..at(EDGE_MM)).contains(&x) && y < at(TOP_MM - 6.0) && (60..68).contains(&z)
    });
    harness.reset_to_voxels(&stone, &mask);
    harness
        .step(&TickInput { start: SessionMode::Constrained { figure: 0 }, ..TickInput::default() });
    take_chisel(&mut harness);
    let tip = Vec3::new(EDGE_MM - 20.0, TOP_MM, 225.0);
    let Blow { removed, splits, report } = strike(&mut harness, tip, grip(45.0));
    assert_eq!(splits.len(), 1);
    assert!(removed.intersection(&mask).is_empty() && report.refused_by_mask > 0, "{report:?}");
}
