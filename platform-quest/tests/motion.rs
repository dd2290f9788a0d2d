//! Frame pacing and interpolation together: uniform motion is drawn uniformly at every display refresh
//! rate.

use glam::{Quat, Vec3};
use paros_core::internals::{RoomPose, STOOL_TOP};
use paros_core::{Grid, HandInput, PointerCommand, RawPose, SessionMode, TickInput, World};
use paros_shaders::scene::{LatestInput, MeshId, SceneAssembler};
use paros_shell::headset::frame_pacer::FramePacer;
use paros_shell::statics::Resident;
use paros_shell::tick_runner::TickRunner;

/// Display times of three seconds of frames in nanoseconds: `rate` a second, each off by at most `jitter`
/// nanoseconds.
fn display_times(rate: i64, jitter: i64) -> impl Iterator<Item = i64> {
    let mut dice = 12345u32;
    (0..rate * 3).map(move |i| {
        dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let off = if jitter == 0 { 0 } else { i64::from(dice >> 8) % (2 * jitter) - jitter };
        1_000_000_000_000 + i * 1_000_000_000 / rate + off
    })
}

/// The drawn positions in each frame: seconds, the tool's tip, and a mark on the stool's rim. `hand` gives
/// the hand's pose at a time in seconds; the stool turns meanwhile.
fn drawn_positions(
    world: &mut World<128>,
    rate: i64,
    jitter: i64,
    hand: impl Fn(f32) -> RoomPose,
) -> Vec<(f32, Vec3, Vec3)> {
    let mut starts = Grid::<128>::lock_start_volumes();
    starts.generate_figures(&mut Grid::<128>::lock_bit_grid(), |_| {});
    let hidden = starts.hidden_figures();
    world.clear();
    let mut stage = TickRunner::new(world, starts.start_volumes(&hidden));
    let (mut pacer, mut scene) = (FramePacer::default(), SceneAssembler::new());
    stage.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    let pointer = PointerCommand::Take { hand: 1, item: 0 };
    stage.run_tick(&TickInput { pointer, ..TickInput::default() });
    let begin = 1_000_000_000_000;
    let seconds = |at: i64| (at - begin) as f32 * 1e-9;
    let mut seen = Vec::new();
    for display_time in display_times(rate, jitter) {
        let due = pacer.take_due_ticks_until(display_time);
        for at in due.tick_times_ns() {
            let (position, rotation) = hand(seconds(at));
            let grip = RawPose::quantise(position, rotation);
            let right = HandInput { grip, aim: grip, tracked: true, ..HandInput::default() };
            let left = HandInput { stick: [100, 0], ..right };
            stage.run_tick(&TickInput { hands: [left, right], ..TickInput::default() });
            scene.follow_tick(stage.world());
        }
        let grips = [None, Some(hand(seconds(display_time)))];
        let fresh =
            LatestInput { grips, show_hands: true, tick_fraction: due.fraction, time_seconds: 0.0 };
        let list = scene.assemble_frame(stage.world(), &fresh);
        let tool = list.instances_of(MeshId::of_tool(paros_core::Tool::Rotary));
        let top = list.instances_of(MeshId::StoolTop)[0].transform_point(Vec3::X * 0.3);
        seen.push((seconds(display_time), tool[0].transform_point(Vec3::ZERO), top));
    }
    seen
}

/// The first frames, which are skipped: the tool enters, the stool speeds up.
const SETTLED: usize = 12;

#[test]
fn what_moves_uniformly_is_drawn_uniformly() {
    let mut world = Grid::<128>::lock_world();
    for (rate, jitter) in [(60, 0), (72, 0), (90, 0), (72, 4_000_000)] {
        let along = |t: f32| (Vec3::new(-0.6 + 0.4 * t, 1.5, -0.3), Quat::IDENTITY);
        let seen = drawn_positions(&mut world, rate, jitter, along);
        let (t0, _, first) = seen[SETTLED];
        let angle = |top: Vec3| (top - STOOL_TOP).x.atan2((top - STOOL_TOP).z);
        let (t1, _, last) = seen[SETTLED + 30];
        let speed = (angle(last) - angle(first)) / (t1 - t0);
        for (t, tool, top) in &seen[SETTLED..SETTLED + 30] {
            assert!(tool.distance(along(*t).0) < 0.001, "{rate} Hz: the tool at {t} s");
            let off = angle(*top) - angle(first) - speed * (t - t0);
            assert!((off * 0.3).abs() < 0.001, "{rate} Hz: the stool at {t} s: {off}");
        }
        assert!(speed.abs() > 0.2, "the stool turns");
    }
}
