//! An exhibition's day with scripted visitors, run by the host that both shells use. Each day is recorded,
//! and its replay gives the same digests.

mod day;

use day::{Body, STANDING, record_day};
use glam::{Quat, Vec3};
use paros_core::session::{BenchItem, RawPose, TICK_RATE, Tool, ToolBit};
use paros_core::visit::{GuideStep, Presence, VisitPhase};
use paros_core::{HandInput, TickInput};
use paros_models::random_visitor::RandomSource;

/// Length of the visit that presses everything, in ticks: two minutes; an hour with
/// `PAROS_PRESS_TICKS=259200`.
const PRESS_TICKS: u32 = 120 * TICK_RATE;

/// A visitor who follows the panels: takes a tool, touches, cuts, smooths, undoes, turns; then sculpts until
/// the time is up. `.ci/run` replays this day in the other builds and shells.
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

/// A visitor who presses nothing and cuts nothing: timeouts advance the visit, nothing is kept, and the next
/// visitor is welcomed.
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

/// The headset comes off in each phase in turn. Any cut is kept, and the next visitor is welcomed.
#[test]
fn visitors_who_leave_in_every_phase() {
    let finished = record_day("visit-left", |day| {
        day.put_on(STANDING);
        day.leave();
        day.put_on(STANDING);
        day.must_press("Press(Confirm)");
        day.leave();
        // Guided and sculpting, each without and with a cut.
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

/// Tools are taken and released in mid-air again and again; each returns.
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

/// Any presses in any order lead to attract in the end, and no sculpture is lost.
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
