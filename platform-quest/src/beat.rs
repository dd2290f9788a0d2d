//! Ticks at their fixed rate, from the times at which frames will be shown.

use std::time::Duration;

use paros_core::input::TICK_RATE;
use paros_shell::stage::Pace;

/// Turns the times of frames into ticks. Times are the runtime's, in nanoseconds.
#[derive(Clone, Copy, Default, Debug)]
pub struct Beat {
    pace: Pace,
    last: Option<i64>,
}

/// The ticks that a frame brings.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Due {
    /// How many; at most [`Pace::CATCH_UP`].
    pub count: u32,
    /// How many more there should have been.
    pub dropped: u32,
    /// How far the frame is from the last of them to the next, 0 to 1.
    pub fraction: f32,
    /// When the last of them is.
    last: i64,
}

impl Beat {
    /// The ticks that lie between the frame before and one that is shown at a time.
    #[must_use]
    pub fn frame(&mut self, shown_at: i64) -> Due {
        let since = self.last.map_or(0, |last| shown_at.saturating_sub(last).max(0));
        self.last = Some(self.last.map_or(shown_at, |last| last.max(shown_at)));
        let (count, dropped) = self.pace.ticks(Duration::from_nanos(since.cast_unsigned()));
        let fraction = self.pace.between();
        let ago = f64::from(fraction) * 1e9 / f64::from(TICK_RATE);
        Due { count, dropped, fraction, last: shown_at - ago as i64 }
    }

    /// Frames have stopped: the time until the next is nobody's, and is not made up.
    pub fn rest(&mut self) {
        self.last = None;
    }
}

impl Due {
    /// When each tick is, the first one first.
    pub fn times(&self) -> impl Iterator<Item = i64> + use<> {
        let Due { count, last, .. } = *self;
        let before = |ticks: u32| i64::from(ticks) * 1_000_000_000 / i64::from(TICK_RATE);
        (0..count).rev().map(move |left| last - before(left))
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};
    use paros_core::frame::STOOL;
    use paros_core::hand::RoomPose;
    use paros_core::input::{HandInput, Input, Mode, Pointer, RawPose};
    use paros_core::size::Grid;
    use paros_core::world::World;
    use paros_shaders::scene::{Assembly, Fresh, MeshId};
    use paros_shell::stage::{Pace, Stage};
    use paros_shell::statics::Resident;

    use super::Beat;

    const TICK: i64 = 1_000_000_000 / 72;

    /// When frames are shown: so many a second, each off by at most `jitter` nanoseconds.
    fn frames(rate: i64, jitter: i64) -> impl Iterator<Item = i64> {
        let mut dice = 12345u32;
        (0..rate * 3).map(move |i| {
            dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let off = if jitter == 0 { 0 } else { i64::from(dice >> 8) % (2 * jitter) - jitter };
            1_000_000_000_000 + i * 1_000_000_000 / rate + off
        })
    }

    const CASES: [(i64, i64); 6] =
        [(60, 0), (72, 0), (90, 0), (120, 2_000_000), (72, 4_000_000), (20, 3_000_000)];

    #[test]
    fn ticks_are_a_72nd_of_a_second_apart_at_any_rate_of_frames() {
        for (rate, jitter) in CASES {
            let mut beat = Beat::default();
            let mut last = None;
            let mut ticks = 0;
            for shown_at in frames(rate, jitter) {
                let due = beat.frame(shown_at);
                assert_eq!(due.dropped, 0, "{rate} Hz");
                for at in due.times() {
                    assert!(at <= shown_at && shown_at - at < 5 * TICK, "{rate} Hz");
                    if let Some(last) = last.replace(at) {
                        assert!((at - last - TICK).abs() < 10, "{rate} Hz: {}", at - last);
                    }
                    ticks += 1;
                }
            }
            assert!((210..=216).contains(&ticks), "{rate} Hz: {ticks}");
        }
    }

    #[test]
    fn what_can_not_be_made_up_is_dropped_and_counted() {
        let mut beat = Beat::default();
        assert_eq!(beat.frame(0).count, 0);
        let due = beat.frame(20 * TICK + 1000);
        assert_eq!((due.count, due.dropped), (Pace::CATCH_UP, 20 - Pace::CATCH_UP));
        // What is made up are the latest.
        let first = due.times().next().expect("ticks");
        assert!((first - 17 * TICK).abs() < 2000);
        // Time that goes backwards brings nothing, and is not counted twice.
        assert_eq!(beat.frame(10 * TICK).count, 0);
        assert_eq!(beat.frame(21 * TICK + 1000).count, 1);
        beat.rest();
        let due = beat.frame(1000 * TICK);
        assert_eq!((due.count, due.dropped), (0, 0));
    }

    /// Where the tool's tip and a mark on the stool's rim are drawn in each frame, for a hand that
    /// goes along a line at 0.4 m/s while the stool turns.
    fn drawn(
        world: &mut World<128>,
        rate: i64,
        jitter: i64,
        hand: impl Fn(f32) -> RoomPose,
    ) -> Vec<(f32, Vec3, Vec3)> {
        let mut starts = Grid::<128>::start_volumes();
        starts.make(&mut Grid::<128>::plane(), |_| {});
        let hidden = starts.hidden();
        world.clear();
        let mut stage = Stage::new(world, starts.starts(&hidden));
        let (mut beat, mut scene) = (Beat::default(), Assembly::new());
        stage.tick(&Input { start: Mode::FreeForm, ..Input::default() });
        let pointer = Pointer::Take { hand: 1, item: 0 };
        stage.tick(&Input { pointer, ..Input::default() });
        let begin = 1_000_000_000_000;
        let seconds = |at: i64| (at - begin) as f32 * 1e-9;
        let mut seen = Vec::new();
        for shown_at in frames(rate, jitter) {
            let due = beat.frame(shown_at);
            for at in due.times() {
                let (position, rotation) = hand(seconds(at));
                let grip = RawPose::new(position, rotation);
                let right = HandInput { grip, aim: grip, tracked: true, ..HandInput::default() };
                let left = HandInput { stick: [100, 0], ..right };
                stage.tick(&Input { hands: [left, right], ..Input::default() });
                scene.follow(stage.world());
            }
            let grips = [None, Some(hand(seconds(shown_at)))];
            let fresh = Fresh { grips, hands: true, fraction: due.fraction, time: 0.0 };
            let list = scene.assemble(stage.world(), &fresh);
            let tool = list.of(MeshId::of_tool(paros_core::tools::Tool::Rotary));
            let top = list.of(MeshId::StoolTop)[0].place(Vec3::X * 0.3);
            seen.push((seconds(shown_at), tool[0].place(Vec3::ZERO), top));
        }
        seen
    }

    /// The frames of the session's first moments are left out: a tool enters, the stool speeds up.
    const SETTLED: usize = 12;

    #[test]
    fn what_moves_uniformly_is_drawn_uniformly() {
        let mut world = Grid::<128>::world();
        for (rate, jitter) in [(60, 0), (72, 0), (90, 0), (72, 4_000_000)] {
            let along = |t: f32| (Vec3::new(-0.6 + 0.4 * t, 1.5, -0.3), Quat::IDENTITY);
            let seen = drawn(&mut world, rate, jitter, along);
            let (t0, _, first) = seen[SETTLED];
            let angle = |top: Vec3| (top - STOOL).x.atan2((top - STOOL).z);
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
}
