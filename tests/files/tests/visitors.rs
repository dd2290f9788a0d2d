//! An exhibition's day with scripted visitors, held by the host that both shells have: each is recorded, and leads to
//! the same digests when it is played again.

use std::fs;
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::limits::INTERVALS;
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionState, TICK_RATE, Tool, ToolBit,
};
use paros_core::visit::{GuideStep, PlanSetting, Presence, VisitCommand, VisitPhase};
use paros_core::{HandInput, TickInput, World, WorldEvent};
use paros_models::random_visitor::RandomSource;
use paros_shell::replay::write_replay_digests;
use paros_shell::settings::StaffPin;
use paros_shell::tick_runner::{TickRunner, with_fresh_world};
use paros_visit::{ExportState, POINTERS, Pointer, VisitHost, VisitOptions, room_pose};

const N: usize = 128;

/// Seconds of a session, so that a day has many.
const LENGTH: u16 = 25;

/// Ticks of who presses everything: two minutes; an hour with `PAROS_PRESS_TICKS=259200`.
const PRESS_TICKS: u32 = 120 * TICK_RATE;

/// A visitor's body.
#[derive(Clone, Copy)]
struct Body {
    /// The hand that works, and the one that points.
    hand: usize,
    has_both_hands: bool,
    eye_height: f32,
}

const STANDING: Body = Body { hand: 1, has_both_hands: true, eye_height: 1.65 };

/// A day: the world, its host, and who is there.
struct Day<'a, 's> {
    runner: &'a mut TickRunner<'s, N, INTERVALS>,
    host: VisitHost,
    body: Body,
    presence: Presence,
    export: ExportState,
    /// Sculptures that were finished, and badges that were shown.
    finished: u32,
    badges: u32,
    is_sculpted: bool,
}

fn options() -> VisitOptions {
    let set = |setting, value| VisitCommand::Set { setting, value };
    VisitOptions {
        plan: vec![
            set(PlanSetting::Length, LENGTH),
            set(PlanSetting::Welcome, 5),
            set(PlanSetting::Choice, 5),
            set(PlanSetting::Guided, 8),
            set(PlanSetting::Thanks, 5),
        ],
        staff_pin: StaffPin::from_text("1507"),
        ..VisitOptions::default()
    }
}

impl Day<'_, '_> {
    fn world(&self) -> &World<N, INTERVALS> {
        self.runner.world()
    }

    fn phase(&self) -> VisitPhase {
        self.world().visit().phase()
    }

    /// A tick in which the working hand does what `input` says, or points.
    fn tick(&mut self, pointer: Option<Pointer>, mut input: TickInput) {
        let eye_height = self.body.eye_height;
        let head = Vec3::new(0.0, eye_height, 0.02 * (self.world().tick() as f32 * 0.1).sin());
        input.head = RawPose::quantise(head, Quat::IDENTITY);
        if !self.body.has_both_hands {
            input.hands[1 - self.body.hand] = HandInput::default();
        }
        self.host.place_panels(|spot, size| room_pose(spot, size, eye_height));
        let mut pointers = [None; POINTERS];
        pointers[self.body.hand] = pointer;
        self.host.follow_pointers(self.runner.world().visit(), &pointers);
        let is_used = self.presence == Presence::Worn;
        self.host.fill_input(self.runner.world(), (self.presence, is_used), &mut input);
        let was_sculpted = self.world().visit().is_sculpted();
        self.runner.run_tick(&input);
        self.host.follow_tick(self.runner.world(), &self.export);
        self.check_tick(was_sculpted);
    }

    /// What holds whatever visitors do: what was sculpted is finished before anything else begins.
    fn check_tick(&mut self, was_sculpted: bool) {
        let world = self.runner.world();
        for event in world.events() {
            match event {
                WorldEvent::Finished => {
                    self.finished += 1;
                    self.is_sculpted = false;
                    self.export = ExportState { is_busy: true, is_kept: false, ..self.export };
                }
                WorldEvent::Visit(VisitPhase::Badge) => self.badges += 1,
                WorldEvent::Started(_) => assert!(!self.is_sculpted, "a sculpture is lost"),
                _ => {}
            }
        }
        self.is_sculpted |= !was_sculpted && world.visit().is_sculpted();
        if self.export.is_busy && world.visit().phase_ticks() > TICK_RATE {
            self.export = ExportState { is_busy: false, is_kept: true, ..self.export };
        }
        let holds = (0..2).any(|hand| world.held_tool(hand).is_some());
        assert!(world.visit().phase().lets_hands_work() || !holds, "a tool hangs in the air");
    }

    fn wait(&mut self, seconds: f32) {
        let ticks = (seconds * TICK_RATE as f32) as u32;
        (0..ticks).for_each(|_| self.tick(None, TickInput::default()));
    }

    fn put_on(&mut self, body: Body) {
        (self.body, self.presence) = (body, Presence::Worn);
        self.wait(0.1);
        assert_eq!(self.phase(), VisitPhase::Welcome);
    }

    /// The headset comes off, and stays so until nobody waits for its visitor any more.
    fn leave(&mut self) {
        self.presence = Presence::Off;
        for _ in 0..200 {
            self.wait(1.0);
            if self.phase() == VisitPhase::Attract {
                return;
            }
        }
        panic!("{:?} goes on without anybody", self.phase());
    }

    /// Presses the button that does what begins so. False where there is none.
    fn press(&mut self, action: &str) -> bool {
        let found = self.host.buttons().find(|(name, _)| name.starts_with(action));
        let Some((_, target)) = found else { return false };
        let side = if self.body.hand == 1 { 0.35 } else { -0.35 };
        let origin = Vec3::new(side, self.body.eye_height - 0.3, 0.1);
        for is_pressed in [false, true, false] {
            let direction = target - origin;
            let pointer = Pointer { origin, direction, is_pressed, fingertip: None };
            self.tick(Some(pointer), TickInput::default());
        }
        self.wait(0.05);
        true
    }

    fn must_press(&mut self, action: &str) {
        let (phase, hand, height) = (self.phase(), self.body.hand, self.body.eye_height);
        let is_there = self.press(action);
        assert!(is_there, "{action}: no such button in {phase:?}, hand {hand}, eyes at {height}");
    }

    fn take(&mut self, item: BenchItem) {
        let (hand, item) = (self.body.hand as u8, item.number() as u8);
        let pointer = PointerCommand::Take { hand, item };
        self.tick(None, TickInput { pointer, ..TickInput::default() });
    }

    /// The held bit goes into the stone from the front, and along it.
    fn stroke(&mut self, height: f32) {
        for tick in 0..110i16 {
            let x = 40.0 + 0.4 * f32::from(tick);
            let depth = 128.0 - f32::from(tick.min(60));
            let pose = Pose { position: Vec3::new(x, height, depth), ..Pose::ZERO };
            let mut input = TickInput::default();
            let trigger = if (8..100).contains(&tick) { 255 } else { 0 };
            input.hands[self.body.hand] =
                HandInput { trigger, ..self.world().hand_with_bit_at(self.body.hand, &pose) };
            self.tick(None, input);
        }
    }

    /// From the welcome to sculpting, the guided steps skipped one by one.
    fn begin(&mut self, start: &str) {
        self.must_press("Press(Confirm)");
        self.must_press(start);
        assert_eq!(self.phase(), VisitPhase::Guided);
        while self.phase() == VisitPhase::Guided {
            self.must_press("Press(Skip");
        }
        assert_eq!(self.phase(), VisitPhase::Sculpting);
    }

    fn finish_by_panel(&mut self) {
        self.must_press("Ask(Finish)");
        self.must_press("Press(Finish)");
        assert_eq!(self.phase(), VisitPhase::HandsOff);
    }

    /// To the badge and, with it seen, to the end.
    fn take_badge_and_leave(&mut self) {
        let before = self.badges;
        while self.phase() != VisitPhase::Badge {
            self.wait(0.2);
            assert!(!matches!(self.phase(), VisitPhase::Thanks | VisitPhase::Attract));
        }
        assert_eq!(self.badges, before + 1);
        assert!(self.world().visit().badge().is_some());
        assert_eq!(self.world().session_state(), SessionState::Finished);
        self.wait(10.5);
        self.must_press("Press(Confirm)");
        self.wait(1.0);
        self.leave();
    }
}

/// Records a visitor's day by a name, plays it again, and returns how many sculptures were finished.
fn record_day(name: &str, visitor: impl FnOnce(&mut Day<'_, '_>)) -> u32 {
    let (bytes, finished) = with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let host = VisitHost::new(options(), runner.world().visit());
        let export = ExportState { is_busy: false, is_kept: false, part: 0.0, pending: 0 };
        let mut day = Day {
            runner: &mut runner,
            host,
            body: STANDING,
            presence: Presence::Off,
            export,
            finished: 0,
            badges: 0,
            is_sculpted: false,
        };
        day.wait(2.0);
        assert_eq!(day.phase(), VisitPhase::Attract);
        visitor(&mut day);
        let finished = day.finished;
        (runner.end_recording_to_bytes().expect("a recording"), finished)
    });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [trace, digests] = ["trace", "digests"].map(|end| folder.join(format!("{name}.{end}")));
    fs::write(&trace, bytes).expect("room on the disk");
    let _ = fs::remove_file(&digests);
    write_replay_digests(&trace, &digests).expect("it was just recorded");
    finished
}

/// Who does what the panels ask for: takes a tool, touches, cuts, smooths, undoes, turns; then sculpts until the time
/// is up. `.ci/run` plays it in the other builds and shells.
#[test]
fn a_visitor_who_follows_the_panels() {
    let finished = record_day("visit-followed", |day| {
        day.put_on(STANDING);
        day.must_press("Press(Language(1))");
        day.must_press("Press(Confirm)");
        day.must_press("Choose(Constrained");
        assert_eq!(day.world().visit().guide_step(), GuideStep::TakeTool);
        day.take(BenchItem::Tool(Tool::Rotary));
        day.stroke(60.0);
        assert_eq!(day.world().visit().guide_step(), GuideStep::Smooth);
        day.take(BenchItem::Tool(Tool::Rasp));
        day.stroke(60.0);
        assert_eq!(day.world().visit().guide_step(), GuideStep::Undo);
        day.must_press("Undo");
        assert_eq!(day.world().visit().guide_step(), GuideStep::TurnStool);
        day.must_press("Turn");
        day.wait(0.5);
        assert_eq!(day.phase(), VisitPhase::Sculpting);
        while day.phase() == VisitPhase::Sculpting {
            day.take(BenchItem::Bit(ToolBit::MediumBall));
            day.stroke(70.0);
        }
        day.take_badge_and_leave();
    });
    assert_eq!(finished, 1);
}

#[test]
fn left_handed_one_handed_and_seated_visitors_reach_everything() {
    let bodies = [
        Body { hand: 0, ..STANDING },
        Body { hand: 1, has_both_hands: false, ..STANDING },
        Body { hand: 0, has_both_hands: false, ..STANDING },
        Body { eye_height: 1.15, ..STANDING },
    ];
    let finished = record_day("visit-bodies", |day| {
        for body in bodies {
            day.put_on(body);
            day.must_press(if body.hand == 0 {
                "Press(WorkingHand(0))"
            } else {
                "Press(WorkingHand(1))"
            });
            assert_eq!(usize::from(day.world().visit().working_hand()), body.hand);
            day.must_press(if body.eye_height < 1.4 {
                "Press(Seated(true))"
            } else {
                "Press(Seated(false))"
            });
            day.begin("Choose(FreeForm)");
            day.take(BenchItem::Tool(Tool::Rotary));
            day.stroke(70.0);
            let cut = day.world().volume().count_voxels();
            day.must_press("Undo");
            assert!(day.world().volume().count_voxels() > cut, "nothing was undone");
            let stool = day.world().stool_frame();
            day.must_press("Turn");
            day.wait(0.6);
            assert!(day.world().stool_frame() != stool, "the stool stands");
            day.stroke(60.0);
            day.must_press("Press(PutBack)");
            assert!(day.world().held_tool(body.hand).is_none());
            day.finish_by_panel();
            day.take_badge_and_leave();
        }
    });
    assert_eq!(finished, 4);
}

/// Nothing is pressed, nothing is cut: all times lead on, nothing is kept, and the next one is welcome.
#[test]
fn a_visitor_who_presses_nothing() {
    let finished = record_day("visit-nothing", |day| {
        day.put_on(STANDING);
        let mut seen = vec![day.phase()];
        while day.phase() != VisitPhase::Handover {
            day.wait(0.5);
            if seen.last() != Some(&day.phase()) {
                seen.push(day.phase());
            }
        }
        use VisitPhase::{Choice, Guided, Handover, HandsOff, Sculpting, Thanks, Welcome};
        assert_eq!(seen, [Welcome, Choice, Guided, Sculpting, HandsOff, Thanks, Handover]);
        day.leave();
        day.put_on(STANDING);
    });
    assert_eq!(finished, 0);
}

/// The headset comes off in each phase in turn; what was cut before is kept, and the next visitor is welcome.
#[test]
fn visitors_who_leave_in_every_phase() {
    let finished = record_day("visit-left", |day| {
        day.put_on(STANDING);
        day.leave();
        day.put_on(STANDING);
        day.must_press("Press(Confirm)");
        day.leave();
        // Guided and sculpting, without a cut and with one.
        for is_cut in [false, true] {
            for is_guided in [true, false] {
                day.put_on(STANDING);
                if is_guided {
                    day.must_press("Press(Confirm)");
                    day.must_press("Choose(Creative)");
                } else {
                    day.begin("Choose(Creative)");
                }
                if is_cut {
                    day.take(BenchItem::Tool(Tool::Rotary));
                    day.stroke(64.0);
                    assert!(day.world().visit().is_sculpted());
                }
                day.leave();
            }
        }
        for phase in [VisitPhase::HandsOff, VisitPhase::Export, VisitPhase::Badge] {
            day.put_on(STANDING);
            day.begin("Choose(Creative)");
            day.take(BenchItem::Tool(Tool::Rotary));
            day.stroke(64.0);
            day.finish_by_panel();
            while day.phase() != phase {
                day.tick(None, TickInput::default());
            }
            day.leave();
        }
    });
    assert_eq!(finished, 2 + 3);
}

/// Tools are taken and let go of in mid-air, again and again; each comes back.
#[test]
fn a_child_who_throws_the_tools() {
    record_day("visit-thrown", |day| {
        day.put_on(Body { eye_height: 1.1, ..STANDING });
        day.begin("Choose(FreeForm)");
        for throw in 0..12u32 {
            day.take(BenchItem::Tool(Tool::ALL[throw as usize % Tool::ALL.len()]));
            for tick in 0..24i16 {
                let mut input = TickInput::default();
                let swing = Vec3::new(0.1, 1.0 + 0.03 * f32::from(tick), -0.05 * f32::from(tick));
                let pose = RawPose::quantise(swing, Quat::IDENTITY);
                let squeeze = if tick < 16 { 255 } else { 0 };
                input.hands[1] = HandInput {
                    aim: pose,
                    grip: pose,
                    squeeze,
                    tracked: true,
                    ..HandInput::default()
                };
                day.tick(None, input);
            }
        }
        day.must_press("Press(PutBack)");
        day.wait(0.1);
        assert!((0..2).all(|hand| day.world().held_tool(hand).is_none()));
        day.wait(11.0);
        for tool in Tool::ALL {
            day.take(BenchItem::Tool(tool));
            assert_eq!(day.world().held_tool(1).map(|(held, _)| held), Some(tool));
        }
        day.leave();
    });
}

#[test]
fn staff_who_extends_recentres_and_ends() {
    let finished = record_day("visit-staff", |day| {
        day.put_on(STANDING);
        day.begin("Choose(FreeForm)");
        day.take(BenchItem::Tool(Tool::Rotary));
        day.stroke(64.0);
        for (action, seconds) in [("Staff(Extend)", 60), ("Recentre", 0), ("Staff(End)", 0)] {
            let before = day.world().visit().seconds_left().expect("a clock");
            day.host.toggle_staff_panel();
            day.wait(0.1);
            for digit in ["Digit(1)", "Digit(5)", "Digit(0)", "Digit(7)"] {
                day.must_press(digit);
            }
            day.must_press(action);
            let after = day.world().visit().seconds_left().expect("a clock");
            assert!(after + 3 >= before + seconds, "{action}: {before} {after}");
        }
        assert!(day.host.take_recentring());
        assert_eq!(day.phase(), VisitPhase::HandsOff);
        day.take_badge_and_leave();
    });
    assert_eq!(finished, 1);
}

/// Whatever is pressed in whatever order, attract is reached in the end, and no sculpture is lost on the way.
#[test]
fn a_visitor_who_presses_everything() {
    let ticks = std::env::var("PAROS_PRESS_TICKS").ok().and_then(|ticks| ticks.parse().ok());
    let ticks: u32 = ticks.unwrap_or(PRESS_TICKS);
    record_day("visit-pressed", |day| {
        let mut random = RandomSource::new(77);
        day.presence = Presence::Worn;
        let begun = day.world().tick();
        let mut phases = std::collections::BTreeSet::new();
        while day.world().tick() < begun + u64::from(ticks) {
            phases.insert(day.phase() as u8);
            let names: Vec<String> = day.host.buttons().map(|(name, _)| name).collect();
            match random.below(12) {
                0 => day.host.toggle_staff_panel(),
                1 => day.stroke(64.0),
                2 => day.take(BenchItem::Tool(Tool::Rotary)),
                3 => {
                    let off = random.below(4) == 0;
                    day.presence = if off { Presence::Off } else { Presence::Worn };
                    day.wait(0.5);
                }
                _ if names.is_empty() => day.wait(0.2),
                _ => {
                    let name = &names[random.below(names.len() as u64) as usize];
                    day.press(name);
                }
            }
        }
        assert!(phases.len() >= 7, "{phases:?}");
        day.leave();
    });
}
