//! Visits from the attract phase to the next visitor, in a world of the shipped size.

mod aiming;
mod booth;
mod guide;
mod headset;
mod previews;
mod resting;

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, SessionState, TICK_RATE};
use paros_core::session::{Tool, ToolBit};
use paros_core::visit::PanelAction as Press;
use paros_core::visit::{GuideStep, PlanSetting, Presence, StaffCommand, VisitPhase, VisitPlan};
use paros_core::{TickInput, World};
use paros_shaders::panel::Language;
use paros_shell::modes::parse_mode;
use paros_shell::settings::StaffPin;
use paros_shell::tick_runner::{TickRunner, with_fresh_world};

use super::{ExportState, VisitHost, close_visits};
use crate::lathe::LatheHand;
use crate::options::{Controls, VisitOptions};
use crate::pin_pad::LEFT_TICKS;
use crate::pointing::{Pointer, UNAIMED_TICKS};
use crate::screen::ButtonAction;
use crate::standing::room_pose;

const N: usize = 128;

fn options() -> VisitOptions {
    let owl = parse_mode("owl").expect("a figure");
    let mut plan = VisitPlan::new();
    plan.set_value(PlanSetting::Length, 200);
    VisitOptions {
        plan,
        languages: vec![Language::Greek, Language::English],
        starts: vec![SessionMode::FreeForm, owl, SessionMode::Creative],
        staff_pin: StaffPin::from_text("2026"),
        controls: Controls::Controllers,
    }
}

/// A world with its host, and a visitor whose right hand points and presses.
struct HostRig<'a, 's> {
    runner: &'a mut TickRunner<'s, N, INTERVALS>,
    host: VisitHost,
    presence: Presence,
    export: ExportState,
}

impl HostRig<'_, '_> {
    fn world(&self) -> &World<N, INTERVALS> {
        self.runner.world()
    }

    fn phase(&self) -> VisitPhase {
        self.world().visit().phase()
    }

    fn tick(&mut self, pointer: Option<Pointer>) {
        self.tick_with(pointer, TickInput::default());
    }

    fn tick_with(&mut self, pointer: Option<Pointer>, mut input: TickInput) {
        self.host.place_panels(|spot, size| room_pose(spot, size, 1.6));
        self.host.follow_pointers(self.runner.world().visit(), &[None, pointer, None]);
        let is_used = self.presence == Presence::Worn;
        self.host.fill_input(self.runner.world(), (self.presence, is_used), &mut input);
        self.runner.run_tick(&input);
        self.host.follow_tick(self.runner.world(), &self.export);
    }

    fn wait(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.tick(None));
    }

    /// Points at the button of an action, pulls the trigger, and releases it; `false` if it isn't there.
    fn press(&mut self, action: ButtonAction) -> bool {
        self.host.place_panels(|spot, size| room_pose(spot, size, 1.6));
        let found = self.host.buttons().find(|(name, _)| *name == format!("{action:?}"));
        let Some((_, target)) = found else { return false };
        let origin = Vec3::new(0.35, 1.35, 0.1);
        let pointer =
            Pointer { origin, direction: target - origin, is_pressed: false, fingertip: None };
        (0..UNAIMED_TICKS).for_each(|_| self.tick(Some(pointer)));
        for is_pressed in [true, false] {
            self.tick(Some(Pointer { is_pressed, ..pointer }));
        }
        self.wait(2);
        true
    }
}

fn with_rig<T>(test: impl FnOnce(&mut HostRig<'_, '_>) -> T) -> T {
    with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        let mut host = VisitHost::new(options(), runner.world().visit());
        host.random_bits = || 4242;
        let export = ExportState::default();
        let mut rig = HostRig { runner: &mut runner, host, presence: Presence::Off, export };
        rig.wait(4);
        assert_eq!(rig.phase(), VisitPhase::Attract);
        test(&mut rig)
    })
}

/// Goes through the panels, from putting the headset on to sculpting.
fn begin_sculpting(rig: &mut HostRig<'_, '_>) {
    rig.presence = Presence::Worn;
    rig.wait(2);
    assert_eq!(rig.phase(), VisitPhase::Welcome);
    assert!(rig.press(ButtonAction::Press(Press::Confirm)));
    assert_eq!(rig.phase(), VisitPhase::Choice);
    assert!(rig.press(ButtonAction::Choose(options().starts[1])));
    assert_eq!(rig.phase(), VisitPhase::Guided);
    for step in GuideStep::ALL.into_iter().take(6) {
        assert_eq!(rig.world().visit().guide_step(), step);
        assert!(rig.press(ButtonAction::Press(Press::Skip { all: false })));
    }
    assert_eq!(rig.phase(), VisitPhase::Sculpting);
}

/// Cuts into the stone's upper front edge with a hand.
fn cut(rig: &mut HostRig<'_, '_>) {
    for item in [BenchItem::Tool(Tool::Rotary), BenchItem::Bit(ToolBit::RoughingBall)] {
        let pointer = PointerCommand::Take { hand: 1, item: item.number() as u8 };
        rig.tick_with(None, TickInput { pointer, ..TickInput::default() });
    }
    for tick in 0..90i16 {
        let world = rig.world();
        let position = Vec3::new(64.0, 70.0, 150.0 - f32::from(tick));
        let pose = Pose { position, ..Pose::ZERO };
        let mut input = TickInput::default();
        input.hands[1] = world.hand_with_bit_at(1, &pose);
        input.hands[1].trigger = if tick > 5 { 255 } else { 0 };
        rig.tick_with(None, input);
    }
    rig.wait(20);
    assert!(rig.world().visit().is_sculpted(), "nothing was cut");
}

/// Goes to the badge of a visitor who has cut, and whose print is stored.
fn go_to_badge(rig: &mut HostRig<'_, '_>) {
    begin_sculpting(rig);
    cut(rig);
    rig.host.perform(ButtonAction::Press(Press::Finish));
    rig.export.is_kept = true;
    while rig.phase() != VisitPhase::Badge {
        rig.tick(None);
    }
}

#[test]
fn a_visit_goes_from_attract_to_the_badge_and_the_next_visitor() {
    with_rig(|rig| {
        begin_sculpting(rig);
        assert_eq!(rig.world().mode(), options().starts[1], "what the card says");
        cut(rig);
        assert!(rig.press(ButtonAction::Ask(super::Question::Finish)));
        assert!(rig.press(ButtonAction::Ask(super::Question::None)), "no");
        assert_eq!(rig.phase(), VisitPhase::Sculpting);
        assert!(rig.press(ButtonAction::Ask(super::Question::Finish)));
        assert!(rig.press(ButtonAction::Press(Press::Finish)), "yes");
        assert_eq!(rig.phase(), VisitPhase::HandsOff);
        rig.export.is_busy = true;
        while rig.phase() == VisitPhase::HandsOff {
            rig.tick(None);
        }
        assert_eq!(rig.phase(), VisitPhase::Export);
        assert_eq!(rig.world().session_state(), SessionState::Finished);
        rig.wait(100);
        assert_eq!(rig.phase(), VisitPhase::Export, "it isn't kept yet");
        rig.export = ExportState { is_kept: true, part: 1.0, ..ExportState::default() };
        rig.wait(3);
        assert_eq!(rig.phase(), VisitPhase::Badge);
        let badge = rig.world().visit().badge().expect("a badge");
        assert_eq!(badge & 0x3_ffff, 4242);
        let confirm = ButtonAction::Press(Press::Confirm);
        assert!(!rig.press(confirm), "it is to be looked at first");
        rig.wait(10 * TICK_RATE);
        assert!(rig.press(confirm));
        assert_eq!(rig.phase(), VisitPhase::Thanks);
        rig.wait(60 * TICK_RATE);
        assert_eq!(rig.phase(), VisitPhase::Handover);
        rig.presence = Presence::Off;
        rig.wait(3);
        assert!(rig.press(ButtonAction::Cleaned));
        assert_eq!(rig.phase(), VisitPhase::Attract);
        rig.presence = Presence::Worn;
        rig.wait(3);
        assert_eq!(rig.phase(), VisitPhase::Welcome);
        assert_eq!(rig.world().visit().badge(), None, "the next visitor's own");
        assert_eq!(rig.world().visit().plan().value(PlanSetting::Length), 200);
    });
}

#[test]
fn a_badge_can_be_left_as_soon_as_its_least_time_is_over_and_no_sooner() {
    with_rig(|rig| {
        go_to_badge(rig);
        let least = 10 * TICK_RATE;
        while rig.world().visit().phase_ticks() < least - 1 {
            rig.tick(None);
        }
        assert_eq!(rig.host.buttons().count(), 0);
        rig.tick(None);
        assert_eq!(rig.host.buttons().count(), 1);
        rig.host.perform(ButtonAction::Press(Press::Confirm));
        rig.tick(None);
        assert_eq!(rig.phase(), VisitPhase::Thanks, "what is shown works");
    });
}

/// The badge must not move while a visitor memorises it.
#[test]
fn a_badge_stays_where_it_is_as_its_button_appears() {
    with_rig(|rig| {
        go_to_badge(rig);
        let mut places = Vec::new();
        for buttons in [0, 1] {
            while rig.host.buttons().count() != buttons {
                rig.tick(None);
            }
            rig.host.place_panels(|spot, size| room_pose(spot, size, 1.6));
            places.push((rig.host.panels()[0].size_mm(), rig.host.panels()[0].pose));
        }
        assert_eq!(places[0], places[1]);
    });
}

#[test]
fn a_sculpture_that_is_never_kept_lets_the_visitor_go_all_the_same() {
    with_rig(|rig| {
        begin_sculpting(rig);
        cut(rig);
        rig.host.perform(ButtonAction::Press(Press::Finish));
        rig.export.pending = 1;
        rig.wait(25 * TICK_RATE + 61 * TICK_RATE);
        assert_eq!(rig.phase(), VisitPhase::Badge);
        assert!(rig.world().visit().badge().is_some());
    });
}

#[test]
fn the_staff_has_its_pin_and_what_it_opens() {
    with_rig(|rig| {
        begin_sculpting(rig);
        cut(rig);
        rig.host.toggle_staff_panel();
        rig.tick(None);
        for digit in [2, 0, 2, 5] {
            assert!(rig.press(ButtonAction::Digit(digit)));
        }
        assert!(!rig.press(ButtonAction::Staff(StaffCommand::Extend)), "not the PIN");
        for digit in [2, 0, 2, 6] {
            assert!(rig.press(ButtonAction::Digit(digit)));
        }
        let before = rig.world().visit().seconds_left().expect("a clock");
        assert!(rig.press(ButtonAction::Staff(StaffCommand::Extend)));
        let after = rig.world().visit().seconds_left().expect("a clock");
        assert!((59..=60).contains(&(after - before)), "{before} {after}");
        rig.host.toggle_staff_panel();
        rig.tick(None);
        for digit in [2, 0, 2, 6] {
            rig.press(ButtonAction::Digit(digit));
        }
        assert!(rig.press(ButtonAction::Recentre));
        assert!(rig.host.take_recentring());
        assert!(!rig.host.take_recentring());
        assert_eq!(rig.phase(), VisitPhase::Sculpting);
    });
}

#[test]
fn without_a_pin_the_staffs_panel_stays_shut() {
    with_rig(|rig| {
        rig.host.options.staff_pin = None;
        rig.host =
            VisitHost::new(VisitOptions { staff_pin: None, ..options() }, rig.world().visit());
        rig.host.toggle_staff_panel();
        rig.wait(2);
        assert!(!rig.press(ButtonAction::Digit(1)));
    });
}

#[test]
fn a_language_is_chosen_by_its_place_on_offer() {
    with_rig(|rig| {
        rig.presence = Presence::Worn;
        rig.wait(2);
        assert_eq!(rig.world().visit().language(), 0);
        assert!(rig.press(ButtonAction::Press(Press::Language(1))));
        assert_eq!(rig.world().visit().language(), 1, "English is the second there");
    });
}

#[test]
fn a_staffs_panel_that_is_left_open_shuts_by_itself() {
    with_rig(|rig| {
        begin_sculpting(rig);
        rig.host.toggle_staff_panel();
        rig.tick(None);
        for digit in [2, 0, 2, 6] {
            rig.wait(LEFT_TICKS / 2);
            assert!(rig.press(ButtonAction::Digit(digit)));
        }
        rig.wait(LEFT_TICKS - 9);
        let extend = ButtonAction::Staff(StaffCommand::Extend);
        let is_there = |rig: &HostRig<'_, '_>| {
            let screen = &rig.host.screen;
            screen.buttons().iter().any(|shown| screen.action(shown.button.id) == Some(extend))
        };
        assert!(is_there(rig));
        rig.wait(9);
        assert!(!is_there(rig), "the next visitor finds it open");
    });
}

/// A run without visits loads the save of a run with visits: the sculpture isn't handed over.
#[test]
fn a_visit_that_nobody_holds_any_more_takes_no_sculpture_away() {
    with_rig(|rig| {
        begin_sculpting(rig);
        cut(rig);
        let voxels = rig.world().volume().count_voxels();
        for _ in 0..120 * TICK_RATE {
            let mut input = TickInput::default();
            close_visits(rig.world().visit(), &mut input);
            rig.runner.run_tick(&input);
        }
        assert_eq!(rig.phase(), VisitPhase::Closed);
        assert_eq!(rig.world().session_state(), SessionState::Sculpting);
        assert_eq!(rig.world().volume().count_voxels(), voxels);
    });
}

/// A hand carves the stone under the core's limits for all hands; then the next stone is carved.
#[test]
fn while_nobody_is_there_a_vase_is_turned_and_then_another() {
    with_rig(|rig| {
        let stone = rig.world().volume().count_voxels();
        rig.wait(LatheHand::default().work_ticks());
        let vase = rig.world().volume().count_voxels();
        assert!(vase * 100 < stone * 45, "{vase} of {stone} are left");
        // The vase is round: as wide along x as along z at its belly.
        let spans = [0, 1].map(|axis| belly_span(rig.world(), axis));
        assert!(spans[0].abs_diff(spans[1]) <= 4, "{spans:?}");
        rig.wait(9 * TICK_RATE);
        assert_eq!(rig.phase(), VisitPhase::Attract);
        assert!(rig.world().volume().count_voxels() * 10 > stone * 9, "a stone again");
    });
}

/// Returns the voxels from the first to the last in the layer of the vase's belly, along x or z.
fn belly_span(world: &World<N, INTERVALS>, axis: usize) -> usize {
    let y = N * 40 / 100;
    let rows = world.volume().rows();
    let is_taken = |x: usize, z: usize| rows.contains([x, y, z]);
    let along = (0..N)
        .filter(|a| (0..N).any(|b| if axis == 0 { is_taken(*a, b) } else { is_taken(b, *a) }));
    let (first, last) = along.fold((N, 0), |(first, last), a| (first.min(a), last.max(a)));
    last + 1 - first
}
