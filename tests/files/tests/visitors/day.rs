//! An exhibition's day: the world, its host, and the present visitor.

use std::fs;
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, PointerCommand, RawPose, SessionState, TICK_RATE};
use paros_core::visit::{PlanSetting, Presence, VisitPhase, VisitPlan};
use paros_core::{HandInput, TickInput, World, WorldEvent};
use paros_shell::replay::write_replay_digests;
use paros_shell::settings::StaffPin;
use paros_shell::tick_runner::{TickRunner, with_fresh_world};
use paros_visit::{ExportState, POINTERS, Pointer, VisitHost, VisitOptions, room_pose};

pub(crate) const N: usize = 128;

/// Length of a session in seconds: short, so that a day has many.
const LENGTH: u16 = 25;

/// Number of ticks from aiming at a button to pressing it: a third of a second.
const AIMING_TICKS: u32 = TICK_RATE / 3;

/// A visitor's body.
#[derive(Clone, Copy)]
pub(crate) struct Body {
    /// The working hand; the other hand points.
    pub(crate) hand: usize,
    pub(crate) has_both_hands: bool,
    pub(crate) eye_height: f32,
}

pub(crate) const STANDING: Body = Body { hand: 1, has_both_hands: true, eye_height: 1.65 };

/// An exhibition's day: the world, its host, and the present visitor.
pub(crate) struct Day<'a, 's> {
    pub(crate) runner: &'a mut TickRunner<'s, N, INTERVALS>,
    pub(crate) host: VisitHost,
    pub(crate) body: Body,
    pub(crate) presence: Presence,
    pub(crate) export: ExportState,
    /// Number of finished sculptures, and number of badges shown.
    pub(crate) finished: u32,
    pub(crate) badges: u32,
    pub(crate) is_sculpted: bool,
}

fn options() -> VisitOptions {
    let mut plan = VisitPlan::new();
    plan.set_value(PlanSetting::Length, LENGTH);
    plan.set_value(PlanSetting::Welcome, 5);
    plan.set_value(PlanSetting::Choice, 5);
    plan.set_value(PlanSetting::Guided, 8);
    plan.set_value(PlanSetting::Thanks, 5);
    VisitOptions { plan, staff_pin: StaffPin::from_text("1507"), ..VisitOptions::default() }
}

impl Day<'_, '_> {
    pub(crate) fn world(&self) -> &World<N, INTERVALS> {
        self.runner.world()
    }

    pub(crate) fn phase(&self) -> VisitPhase {
        self.world().visit().phase()
    }

    /// Runs a tick in which the working hand performs `input`, or points.
    pub(crate) fn tick(&mut self, pointer: Option<Pointer>, mut input: TickInput) {
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

    /// Checks the invariants of a tick: a sculpture is finished before anything else begins.
    pub(crate) fn check_tick(&mut self, was_sculpted: bool) {
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

    pub(crate) fn wait(&mut self, seconds: f32) {
        let ticks = (seconds * TICK_RATE as f32) as u32;
        (0..ticks).for_each(|_| self.tick(None, TickInput::default()));
    }

    pub(crate) fn put_on(&mut self, body: Body) {
        (self.body, self.presence) = (body, Presence::Worn);
        self.wait(0.1);
        assert_eq!(self.phase(), VisitPhase::Welcome);
    }

    /// Takes the headset off and waits until the visit no longer waits for its visitor.
    pub(crate) fn leave(&mut self) {
        self.presence = Presence::Off;
        for _ in 0..200 {
            self.wait(1.0);
            if self.phase() == VisitPhase::Attract {
                return;
            }
        }
        panic!("{:?} goes on without anybody", self.phase());
    }

    /// Presses the button whose action begins with `action`. Returns `false` if there is no such button.
    pub(crate) fn press(&mut self, action: &str) -> bool {
        let found = self.host.buttons().find(|(name, _)| name.starts_with(action));
        let Some((_, target)) = found else { return false };
        let side = if self.body.hand == 1 { 0.35 } else { -0.35 };
        let origin = Vec3::new(side, self.body.eye_height - 0.3, 0.1);
        let direction = target - origin;
        let pointer = Pointer { origin, direction, is_pressed: false, fingertip: None };
        // A button that has just appeared can't be pressed yet.
        (0..AIMING_TICKS).for_each(|_| self.tick(Some(pointer), TickInput::default()));
        for is_pressed in [true, false] {
            self.tick(Some(Pointer { is_pressed, ..pointer }), TickInput::default());
        }
        self.wait(0.05);
        true
    }

    pub(crate) fn must_press(&mut self, action: &str) {
        let (phase, hand, height) = (self.phase(), self.body.hand, self.body.eye_height);
        let is_there = self.press(action);
        assert!(is_there, "{action}: no such button in {phase:?}, hand {hand}, eyes at {height}");
    }

    pub(crate) fn take(&mut self, item: BenchItem) {
        let (hand, item) = (self.body.hand as u8, item.number() as u8);
        let pointer = PointerCommand::Take { hand, item };
        self.tick(None, TickInput { pointer, ..TickInput::default() });
    }

    /// Moves the held bit into the stone from the front, and along it.
    pub(crate) fn stroke(&mut self, height: f32) {
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

    /// Goes from the welcome to sculpting, skipping the guided steps one by one.
    pub(crate) fn begin(&mut self, start: &str) {
        self.must_press("Press(Confirm)");
        self.must_press(start);
        assert_eq!(self.phase(), VisitPhase::Guided);
        while self.phase() == VisitPhase::Guided {
            self.must_press("Press(Skip");
        }
        assert_eq!(self.phase(), VisitPhase::Sculpting);
    }

    pub(crate) fn finish_by_panel(&mut self) {
        self.must_press("Ask(Finish)");
        self.must_press("Press(Finish)");
        assert_eq!(self.phase(), VisitPhase::HandsOff);
    }

    /// Goes to the badge, sees it, and goes to the end.
    pub(crate) fn take_badge_and_leave(&mut self) {
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

/// Records a visitor's day under a name, replays it, and returns the number of finished sculptures.
pub(crate) fn record_day(name: &str, visitor: impl FnOnce(&mut Day<'_, '_>)) -> u32 {
    let (bytes, finished) = with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let host = VisitHost::new(options(), runner.world().visit());
        let export =
            ExportState { is_busy: false, is_kept: false, part: 0.0, pending: 0, booth: None };
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
