//! Tests of the plans for the ticks of a world.

use glam::{Quat, Vec3};
use paros_core::glam;
use paros_core::session::{BenchItem, RawPose, SessionMode, Tool, ToolBit, commands};
use paros_core::visit::{VisitCommand, VisitInput, VisitPhase};
use paros_core::{HandInput, TickInput};
use paros_models::scripted_hand::{RIGHT, input_with_bit_at, start_from_stone, take_item};
use paros_models::test_with_one_and_two_intervals;
use paros_models::world_harness::WorldHarness;
use paros_sound::{
    Mixer, SAMPLE_RATE, ShotKind, SoundPlan, SoundPlanner, VoiceKind, frames_in_tick,
};

/// A world whose ticks are planned, with a flat block of stone 200 mm high.
struct PlannedWorld<'a, const K: usize> {
    harness: &'a mut WorldHarness<64, K>,
    planner: SoundPlanner,
}

impl<'a, const K: usize> PlannedWorld<'a, K> {
    fn with_tool(harness: &'a mut WorldHarness<64, K>, items: &[BenchItem]) -> Self {
        start_from_stone(harness, |place| place.y < 200.0);
        items.iter().for_each(|item| take_item(harness, RIGHT, *item));
        PlannedWorld { harness, planner: SoundPlanner::default() }
    }

    fn step(&mut self, input: &TickInput) -> SoundPlan {
        self.harness.step(input);
        self.planner.plan_tick(&self.harness.world, input)
    }

    /// Runs a tick with the right hand's bit at a place in millimetres of the stone's box, pointing along -z.
    fn step_at(&mut self, place: Vec3, trigger: u8) -> SoundPlan {
        let input = input_with_bit_at(self.harness, place, Quat::IDENTITY, trigger);
        self.step(&input)
    }
}

fn count_of(plan: &SoundPlan, is_kind: impl Fn(ShotKind) -> bool) -> usize {
    plan.shots().filter(|shot| is_kind(shot.kind)).count()
}

/// A place in the air, above the middle of the stone.
const ABOVE: Vec3 = Vec3::new(225.0, 330.0, 225.0);
/// A place about a voxel below the stone's face.
const AT_FACE: Vec3 = Vec3::new(225.0, 190.0, 225.0);

test_with_one_and_two_intervals!(
    a_motor_sounds_in_the_tick_of_its_pull_and_has_load_in_stone,
    a_rasp_sounds_while_it_is_moved_on_stone,
    paste_hisses_wherever_it_is_pressed,
    a_hammer_strikes_as_its_table_says,
    a_bit_is_heard_where_it_is,
    undo_and_end_are_heard_and_no_tool_after_it,
    the_stone_of_those_who_look_is_not_heard,
    motor_stone_and_silence_are_heard_within_two_ticks
);

fn a_motor_sounds_in_the_tick_of_its_pull_and_has_load_in_stone<const K: usize>(
    harness: &mut WorldHarness<64, K>,
) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::Rotary)]);
    let at_rest = world.step_at(ABOVE, 0);
    assert_eq!(at_rest.voices.map(|voice| voice.kind), [VoiceKind::Silent; 2]);
    let in_air = world.step_at(ABOVE, 255);
    assert_eq!(in_air.voices.map(|v| v.kind), [VoiceKind::Silent, VoiceKind::Motor]);
    let voice = in_air.voices[RIGHT];
    assert!(voice.level == 1.0 && voice.load == 0.0 && voice.pitch_hz > 100.0, "{voice:?}");
    let mut loads = Vec::new();
    for tick in 0..60 {
        let plan = world.step_at(ABOVE - Vec3::Y * (3.0 * tick as f32), 255);
        loads.push(plan.voices[RIGHT].load);
        let haptic = world.harness.world.hand_state(RIGHT).haptic;
        assert_eq!(plan.voices[RIGHT].load, f32::from(haptic) / 255.0);
    }
    assert_eq!(loads[0], 0.0);
    // In some ticks the bit has cut itself free.
    let mean = loads[45..].iter().sum::<f32>() / 15.0;
    assert!(mean > 0.12, "{loads:?}");
    let mut last = world.step_at(ABOVE, 0);
    // The bit completes the movement of its pull.
    (0..12).for_each(|_| last = world.step_at(ABOVE, 0));
    assert_eq!(last.voices[RIGHT].kind, VoiceKind::Silent);
}

fn a_rasp_sounds_while_it_is_moved_on_stone<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::Rasp)]);
    let scrapes = |plan: SoundPlan| {
        let voice = plan.voices[RIGHT];
        voice.kind == VoiceKind::Scrape && voice.level > 0.1
    };
    let mut passes = [0; 3];
    for tick in 0..40 {
        let along = Vec3::X * (3.0 * tick as f32);
        passes[0] += usize::from(scrapes(world.step_at(AT_FACE + along, 255)));
    }
    for _ in 0..40 {
        passes[1] += usize::from(scrapes(world.step_at(AT_FACE + Vec3::X * 117.0, 255)));
    }
    for tick in 0..40 {
        let along = Vec3::X * (3.0 * tick as f32);
        passes[2] += usize::from(scrapes(world.step_at(ABOVE + along, 255)));
    }
    // In the first tick the pull has no speed yet; lifting the bit from the stone moves it for one tick.
    assert!(passes[0] >= 30 && passes[1] <= 1 && passes[2] <= 1, "{passes:?}");
}

fn paste_hisses_wherever_it_is_pressed<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::FillGun)]);
    for tick in 0..20 {
        let plan = world.step_at(ABOVE + Vec3::X * tick as f32, 255);
        assert_eq!(plan.voices[RIGHT].kind, VoiceKind::Hiss, "{tick}");
    }
    let last = (0..14).map(|_| world.step_at(ABOVE, 0)).last().expect("ticks");
    assert_eq!(last.voices[RIGHT].kind, VoiceKind::Silent);
}

fn a_hammer_strikes_as_its_table_says<const K: usize>(harness: &mut WorldHarness<64, K>) {
    for bit in [ToolBit::PointChisel, ToolBit::FlatChisel] {
        let items = [BenchItem::Tool(Tool::Impact), BenchItem::Bit(bit)];
        let mut world = PlannedWorld::with_tool(harness, &items);
        world.step_at(ABOVE, 0);
        let period = usize::from(bit.spec().bite_period);
        let (mut puffs, mut blows, mut chips) = (Vec::new(), Vec::new(), 0);
        for tick in 0..10 * period {
            // The bit is pressed deeper and deeper into the stone.
            let depth = 1.5 * tick.saturating_sub(5 * period) as f32;
            let at = if tick < 5 * period { ABOVE } else { AT_FACE - Vec3::Y * depth };
            let plan = world.step_at(at, 255);
            puffs.extend((count_of(&plan, |kind| kind == ShotKind::Puff) > 0).then_some(tick));
            blows.extend((count_of(&plan, |kind| kind == ShotKind::Blow) > 0).then_some(tick));
            chips += count_of(&plan, |kind| kind == ShotKind::Chip);
            assert_eq!(plan.voices[RIGHT].kind, VoiceKind::Silent);
        }
        let mut all: Vec<usize> = puffs.iter().chain(&blows).copied().collect();
        all.sort_unstable();
        let expected: Vec<usize> = (0..10).map(|blow| blow * period).collect();
        assert_eq!(all, expected, "{bit:?}: {puffs:?} {blows:?}");
        assert!(puffs.len() >= 5 && blows.len() >= 3 && chips > 0, "{puffs:?} {blows:?} {chips}");
    }
}

fn a_bit_is_heard_where_it_is<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::Rotary)]);
    let mut pan_at = |x: f32, head: Quat| {
        let place = Vec3::new(x, ABOVE.y, ABOVE.z);
        let mut input = input_with_bit_at(world.harness, place, Quat::IDENTITY, 255);
        // The head is an arm's length in front of the stool.
        input.head = RawPose::quantise(Vec3::new(0.0, 1.2, -0.05), head);
        world.step(&input).voices[RIGHT].pan
    };
    let [left, middle, right] = [25.0, 225.0, 425.0].map(|x| pan_at(x, Quat::IDENTITY));
    assert!(left < -0.25 && middle.abs() < 0.02 && right > 0.25, "{left} {middle} {right}");
    // For a head turned to the left, the sound is on the right.
    let turned = pan_at(225.0, Quat::from_rotation_y(std::f32::consts::FRAC_PI_2));
    assert!(turned > 0.6 && turned < 0.9, "{turned}");
}

fn undo_and_end_are_heard_and_no_tool_after_it<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::Rotary)]);
    for tick in 0..40 {
        if tick < 20 {
            world.step_at(AT_FACE, 255)
        } else {
            world.step_at(ABOVE, 0)
        };
    }
    let undone = world.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    assert_eq!(count_of(&undone, |kind| kind == ShotKind::Undo), 1);
    let redone = world.step(&TickInput { commands: commands::REDO, ..TickInput::default() });
    assert_eq!(count_of(&redone, |kind| kind == ShotKind::Redo), 1);
    let mut input = input_with_bit_at(world.harness, ABOVE, Quat::IDENTITY, 255);
    assert_eq!(world.step(&input).voices[RIGHT].kind, VoiceKind::Motor);
    input.commands = commands::FINISH;
    let finished = world.step(&input);
    assert_eq!(count_of(&finished, |kind| kind == ShotKind::End), 1);
    input.commands = 0;
    assert_eq!(world.step(&input).voices[RIGHT].kind, VoiceKind::Silent);
    let started = world.step(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    assert_eq!(started, SoundPlan::default());
}

fn the_stone_of_those_who_look_is_not_heard<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let mut world = PlannedWorld::with_tool(harness, &[]);
    let visit = VisitInput { command: VisitCommand::Open, ..VisitInput::default() };
    world.step(&TickInput { visit, ..TickInput::default() });
    take_item(world.harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    for _ in 0..10 {
        assert_eq!(world.step_at(ABOVE, 255), SoundPlan::default());
        let world = &world.harness.world;
        assert_eq!(world.visit().phase(), VisitPhase::Attract);
        assert!(world.held_tool(RIGHT).is_some() && world.hand_state(RIGHT).is_running());
    }
}

fn motor_stone_and_silence_are_heard_within_two_ticks<const K: usize>(
    harness: &mut WorldHarness<64, K>,
) {
    let mut world = PlannedWorld::with_tool(harness, &[BenchItem::Tool(Tool::Rotary)]);
    let mut mixer = Mixer::new(100);
    let mut heard = |place: Vec3, trigger: u8, ticks: u64| {
        let mut frames = Vec::new();
        for tick in 0..ticks {
            mixer.follow(&world.step_at(place, trigger));
            let begin = frames.len();
            frames.resize(begin + frames_in_tick(tick), [0.0; 2]);
            mixer.render(&mut frames[begin..]);
        }
        let sum: f32 = frames.iter().map(|frame: &[f32; 2]| frame[0] * frame[0]).sum();
        (sum / frames.len() as f32).sqrt()
    };
    assert_eq!(heard(ABOVE, 0, 4), 0.0);
    let pulled = heard(ABOVE, 255, 2);
    assert!(pulled > 0.01, "{pulled}");
    let idle = heard(ABOVE, 255, 36);
    heard(ABOVE, 0, 36);
    assert_eq!(heard(ABOVE, 0, 2), 0.0);
    assert!(idle > pulled * 0.8 && SAMPLE_RATE == 48_000);
}

#[test]
fn hands_that_hold_nothing_are_silent() {
    static HARNESS: std::sync::Mutex<WorldHarness<64, 2>> =
        std::sync::Mutex::new(WorldHarness::new());
    let mut harness = HARNESS.lock().expect("one test has it");
    let mut planner = SoundPlanner::default();
    let pose = RawPose::quantise(Vec3::new(0.0, 1.0, -0.5), Quat::IDENTITY);
    let hand =
        HandInput { aim: pose, grip: pose, trigger: 255, tracked: true, ..HandInput::default() };
    let input = TickInput { hands: [hand; 2], ..TickInput::default() };
    for mode in [SessionMode::None, SessionMode::FreeForm] {
        harness.reset();
        harness.step(&TickInput { start: mode, ..input });
        for _ in 0..10 {
            harness.step(&input);
            assert_eq!(planner.plan_tick(&harness.world, &input), SoundPlan::default());
        }
    }
}
