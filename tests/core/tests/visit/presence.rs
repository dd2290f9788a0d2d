//! The time that a visitor may rest, which the visit announces before it is over.

use paros_core::session::TICK_RATE;
use paros_core::visit::{PanelAction, PlanSetting, Presence, VisitCommand, VisitPhase};

use super::exhibition::{Deed, Exhibition, Stretch};

/// Rests tick by tick until the visit no longer waits for the visitor, and asserts that the announced time is
/// right. Returns the seconds.
fn rest_until_gone(exhibition: &mut Exhibition, presence: Presence) -> u32 {
    let (phase, mut ticks) = (exhibition.phase(), 0u32);
    while exhibition.phase() == phase {
        let told = exhibition.harness.world.visit().ticks_until_gone();
        let (command, deed) = (VisitCommand::None, Deed::Nothing);
        exhibition.run(&Stretch { ticks: 1, presence, is_used: false, command, deed });
        let now = exhibition.harness.world.visit();
        let is_over = exhibition.phase() != phase;
        assert_eq!(told == Some(1), is_over, "{phase:?} after {ticks} ticks: {told:?}");
        if !is_over && ticks > 0 {
            assert_eq!(now.ticks_until_gone(), told.map(|left| left - 1), "{phase:?}");
        }
        ticks += 1;
        assert!(ticks < 100 * TICK_RATE, "{phase:?} doesn't end");
    }

    ticks.div_ceil(TICK_RATE)
}

#[test]
fn it_is_told_how_long_a_visitor_may_rest() {
    let mut exhibition = Exhibition::open(600);
    assert_eq!(exhibition.harness.world.visit().ticks_until_gone(), None, "nobody is there");
    exhibition.tell(Presence::Unknown, VisitCommand::None);
    // Five seconds of standing still, then as long as a headset may be off.
    assert_eq!(rest_until_gone(&mut exhibition, Presence::Unknown), 15);
    exhibition.leave_for(1);
    exhibition.tell(Presence::Unknown, VisitCommand::None);
    assert_eq!(rest_until_gone(&mut exhibition, Presence::Off), 10);
    exhibition.cut_something();
    assert_eq!(rest_until_gone(&mut exhibition, Presence::Unknown), 50);
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    assert_eq!(exhibition.harness.world.visit().ticks_until_gone(), None, "hands are off");
    exhibition.leave_for(30);
    exhibition.cut_something();
    exhibition.press(PanelAction::Finish);
    exhibition.do_for(4.0, Deed::Nothing);
    exhibition.tell(Presence::Worn, VisitCommand::Exported);
    assert_eq!(exhibition.phase(), VisitPhase::Badge);
    assert_eq!(rest_until_gone(&mut exhibition, Presence::Unknown), 10);
    // Without a clock, a session lasts as long as the headset is in use.
    let mut exhibition = {
        drop(exhibition);
        Exhibition::open(0)
    };
    let (setting, value) = (PlanSetting::Idle, 30);
    exhibition.tell(Presence::Off, VisitCommand::Set { setting, value });
    exhibition.cut_something();
    assert_eq!(rest_until_gone(&mut exhibition, Presence::Unknown), 30);
}
