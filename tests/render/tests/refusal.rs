//! Voxels that closure restored are marked on the sculpture, at their place, for a short time.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::TickInput;
use paros_core::session::{BenchItem, PointerCommand, Tool, commands};
use paros_core::volume::{Grid, Size};
use paros_models::scripted_hand::{RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shaders::scene::refusal::{REFUSAL_MARGIN, REFUSAL_SECONDS};
use paros_shaders::scene::{LatestInput, MeshId, MeshInstance, SceneAssembler};

static STUDIO: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

fn fresh_at(time: f64) -> LatestInput {
    LatestInput { tick_fraction: 1.0, time_seconds: time, ..LatestInput::default() }
}

/// Returns the edges of marks in the last frame, as pairs of ends in voxels.
fn mark_edges<const N: usize>(studio: &WorldHarness<N>, scene: &SceneAssembler) -> Vec<[Vec3; 2]>
where
    Grid<N>: Size,
{
    let frame = studio.world.stool_frame();
    let is_red = |tint: &[f32; 4]| tint[0] > 3.0 * tint[1];
    let specks = scene.draw_list().instances_of(MeshId::Speck).iter();
    let ends = |edge: &MeshInstance| {
        let along = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| 0.5 * axis);
        let ends = along.map(|end| [-end, end].map(|end| edge.transform_point(end)));
        let longest =
            ends.into_iter().max_by(|a, b| (a[0].distance(a[1])).total_cmp(&b[0].distance(b[1])));
        longest.unwrap().map(|end| frame.to_grid(end, Quat::IDENTITY).position)
    };
    specks.filter(|speck| is_red(&speck.tint)).map(ends).collect()
}

/// Asserts that the marks of the last tick have the expected number of edges around the voxels that closure
/// restored, and none between a bit and its mirror image.
fn assert_box_is_marked<const N: usize>(
    studio: &WorldHarness<N>,
    scene: &SceneAssembler,
    edges: usize,
) where
    Grid<N>: Size,
{
    let marks = mark_edges(studio, scene);
    assert_eq!(marks.len(), edges);
    let ends = || marks.iter().flatten();
    let lo = ends().copied().reduce(Vec3::min).unwrap();
    let hi = ends().copied().reduce(Vec3::max).unwrap();
    let ranges = studio.world.edit_report(RIGHT).closure_box.ranges();
    let margin = REFUSAL_MARGIN / studio.world.stool_frame().voxel_metres();
    let first = Vec3::from_array(ranges.map(|range| range.first() as f32 - margin));
    let last = Vec3::from_array(ranges.map(|range| range.last() as f32 + 1.0 + margin));
    let off = (first - lo).abs().max((last - hi).abs()).max_element();
    assert!(off < 0.01, "{lo} to {hi}: {ranges:?}");
    let between = N as f32 * 0.41..N as f32 * 0.59;
    assert!(ends().all(|end| !between.contains(&end.x)), "nothing between the two");
}

/// Starts from a block with a tunnel along x, in which a column of one interval can't keep anything more
/// empty.
fn start_in_tunnel<const N: usize>(studio: &mut WorldHarness<N>)
where
    Grid<N>: Size,
{
    let per_64th = N / 64;
    studio.start_from_voxels(|[_, y, z]| {
        let [y, z] = [y, z].map(|v| v / per_64th);
        y < 40 && !((10..22).contains(&y) && (8..20).contains(&z))
    });
    take_item(studio, RIGHT, BenchItem::Tool(Tool::Rotary));
}

/// A burr cuts sideways from inside a tunnel, without and with its mirror, on a turned stool.
#[test]
fn what_closure_brought_back_is_marked_where_it_is() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let mut scene = SceneAssembler::new();
    start_in_tunnel(&mut studio);
    let pointer = PointerCommand::Turn { by: 5000 };
    studio.step(&TickInput { pointer, ..TickInput::default() });
    let mut time = 0.0;
    for edges in [12, 24] {
        let mut seen = 0;
        for tick in 0..40 {
            let at = Vec3::new(16.0, 16.0, 14.0 + 0.25 * tick as f32);
            step_with_bit_at(&mut studio, RIGHT, at, true);
            time += 1.0 / 72.0;
            scene.assemble_frame(&studio.world, &fresh_at(time));
            let report = studio.world.edit_report(RIGHT);
            if report.refused_by_closure == 0 {
                continue;
            }
            assert_box_is_marked(&studio, &scene, edges);
            seen += 1;
        }
        assert!(seen > 10, "{seen} ticks");
        for _ in 0..(REFUSAL_SECONDS * 72.0) as u32 + 2 {
            time += 1.0 / 72.0;
            scene.assemble_frame(&studio.world, &fresh_at(time));
        }
        assert_eq!(mark_edges(&studio, &scene), [] as [[Vec3; 2]; 0], "they fade");
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(16.0, 16.0, 14.0), false);
        studio.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
    }
    // Removed voxels aren't marked as refused.
    let mut removed = 0;
    studio.step(&TickInput { pointer: PointerCommand::Return { hand: 1 }, ..TickInput::default() });
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    for tick in 0..60 {
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(32.0, 44.0 - 0.1 * tick as f32, 50.0), true);
        scene.assemble_frame(&studio.world, &fresh_at(time));
        removed += studio.world.edit_report(RIGHT).removed;
        assert_eq!(mark_edges(&studio, &scene).len(), 0);
    }
    assert!(removed > 30, "{removed}");
}

/// A stroke so fast that the bit ends a tick far from where the tick's path began. A mark includes a voxel
/// more than the bit's radius.
#[test]
fn a_fast_mirrored_stroke_is_marked_along_its_way() {
    static STUDIO: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let mut scene = SceneAssembler::new();
    start_in_tunnel(&mut studio);
    studio.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
    let (mut last, mut fast) = (None, 0);
    for tick in 0..11_u8 {
        let x = 8.0 + 5.0 * f32::from(tick.saturating_sub(4)).min(6.0);
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(x, 32.0, 36.8), true);
        scene.assemble_frame(&studio.world, &fresh_at(f64::from(tick) / 72.0));
        let reached = studio.world.hand_state(RIGHT).frozen_pose.position.x;
        let way = last.replace(reached).map_or(0.0, |last| reached - last);
        if studio.world.edit_report(RIGHT).is_mostly_refused_by_closure() && way > 4.0 {
            assert_box_is_marked(&studio, &scene, 24);
            fast += 1;
        }
    }
    assert!(fast > 3, "{fast} fast ticks were refused");
}
