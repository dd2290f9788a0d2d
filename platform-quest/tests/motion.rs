//! Frame pacing and interpolation together: uniform motion is drawn uniformly at every display refresh
//! rate.

use glam::{Quat, Vec3};
use paros_core::internals::{RoomPose, STOOL_TOP};
use paros_core::limits::INTERVALS;
use paros_core::session::{PointerCommand, RawPose, SessionMode};
use paros_core::{HandInput, TickInput};
use paros_headset::frame_pacer::FramePacer;
use paros_shaders::scene::{LatestInput, MeshId, SceneAssembler};
use paros_shell::tick_runner::{TickRunner, with_fresh_world};

/// Returns the display times of three seconds of frames: `rate_hz` a second, each off by at most `jitter_ns`.
fn display_times_ns(rate_hz: i64, jitter_ns: i64) -> impl Iterator<Item = i64> {
    let mut dice = 12345u32;
    (0..rate_hz * 3).map(move |i| {
        dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let off =
            if jitter_ns == 0 { 0 } else { i64::from(dice >> 8) % (2 * jitter_ns) - jitter_ns };
        1_000_000_000_000 + i * 1_000_000_000 / rate_hz + off
    })
}

/// The positions that a frame shows.
struct DrawnPositions {
    seconds: f32,
    tool_tip: Vec3,
    /// A mark on the stool's rim.
    rim_mark: Vec3,
}

/// Draws frames while the stool turns. `hand_at` gives the hand's pose at a time in seconds.
fn draw_positions(
    mut stage: TickRunner<'_, 128, INTERVALS>,
    rate_hz: i64,
    jitter_ns: i64,
    hand_at: impl Fn(f32) -> RoomPose,
) -> Vec<DrawnPositions> {
    let (mut pacer, mut scene) = (FramePacer::default(), SceneAssembler::new());
    stage.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    let pointer = PointerCommand::Take { hand: 1, item: 0 };
    stage.run_tick(&TickInput { pointer, ..TickInput::default() });
    let begin = 1_000_000_000_000;
    let seconds = |at: i64| (at - begin) as f32 * 1e-9;
    let mut seen = Vec::new();
    for display_time in display_times_ns(rate_hz, jitter_ns) {
        let due = pacer.take_due_ticks_until(display_time);
        for at in due.tick_times_ns() {
            let (position, rotation) = hand_at(seconds(at));
            let grip = RawPose::quantise(position, rotation);
            let right = HandInput { grip, aim: grip, tracked: true, ..HandInput::default() };
            let left = HandInput { stick: [100, 0], ..right };
            stage.run_tick(&TickInput { hands: [left, right], ..TickInput::default() });
            scene.follow_tick(stage.world());
        }
        let grips = [None, Some(hand_at(seconds(display_time)))];
        let fresh = LatestInput {
            grips,
            show_hands: true,
            tick_fraction: due.fraction,
            ..LatestInput::default()
        };
        let list = scene.assemble_frame(stage.world(), &fresh);
        let tool = list.instances_of(MeshId::of_tool(paros_core::session::Tool::Rotary));
        let rim_mark = list.instances_of(MeshId::StoolTop)[0].transform_point(Vec3::X * 0.3);
        let tool_tip = tool[0].transform_point(Vec3::ZERO);
        seen.push(DrawnPositions { seconds: seconds(display_time), tool_tip, rim_mark });
    }
    seen
}

/// The first frames, which are skipped: the tool enters, the stool speeds up.
const SETTLED: usize = 12;

#[test]
fn what_moves_uniformly_is_drawn_uniformly() {
    for (rate, jitter) in [(60, 0), (72, 0), (90, 0), (72, 4_000_000)] {
        let along = |t: f32| (Vec3::new(-0.6 + 0.4 * t, 1.5, -0.3), Quat::IDENTITY);
        let seen = with_fresh_world(|stage| draw_positions(stage, rate, jitter, along));
        let DrawnPositions { seconds: t0, rim_mark: first, .. } = seen[SETTLED];
        let angle = |top: Vec3| (top - STOOL_TOP).x.atan2((top - STOOL_TOP).z);
        let DrawnPositions { seconds: t1, rim_mark: last, .. } = seen[SETTLED + 30];
        let speed = (angle(last) - angle(first)) / (t1 - t0);
        for DrawnPositions { seconds: t, tool_tip: tool, rim_mark: top } in
            &seen[SETTLED..SETTLED + 30]
        {
            assert!(tool.distance(along(*t).0) < 0.001, "{rate} Hz: the tool at {t} s");
            let off = angle(*top) - angle(first) - speed * (t - t0);
            assert!((off * 0.3).abs() < 0.001, "{rate} Hz: the stool at {t} s: {off}");
        }
        assert!(speed.abs() > 0.2, "the stool turns");
    }
}
