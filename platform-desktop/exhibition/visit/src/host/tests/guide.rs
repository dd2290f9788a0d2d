//! The end of the guided first cut.

use paros_core::session::TICK_RATE;
use paros_core::visit::{PlanSetting, Presence, StaffCommand, VisitPhase};
use paros_shaders::panel::Language;

use super::{HostRig, Press, begin_sculpting, options, with_rig};
use crate::host::VisitHost;
use crate::screen::{ButtonAction, GuideEnd};

/// Goes to the first step of the guided cut.
pub(super) fn begin_guide(rig: &mut HostRig<'_, '_>) {
    rig.presence = Presence::Worn;
    rig.wait(2);
    rig.host.perform(ButtonAction::Press(Press::Confirm));
    rig.wait(2);
    rig.host.perform(ButtonAction::Choose(options().starts[0]));
    rig.wait(4);
    assert_eq!(rig.phase(), VisitPhase::Guided);
}

/// Completes all steps. The last press takes effect at the end of a tick.
fn end_steps(rig: &mut HostRig<'_, '_>) {
    rig.host.perform(ButtonAction::Press(Press::Skip { all: true }));
    while rig.phase() == VisitPhase::Guided {
        rig.tick(None);
    }
    assert_eq!(rig.phase(), VisitPhase::Sculpting);
}

/// Returns the number of ticks for which the end's message is shown, from the current one on, and the end.
fn read_end(rig: &mut HostRig<'_, '_>) -> (u32, Option<GuideEnd>) {
    let told = rig.host.screen.told_guide_end();
    let mut ticks = 0;
    while rig.host.screen.told_guide_end().is_some() {
        assert_eq!(rig.host.screen.told_guide_end(), told);
        assert!(rig.host.has_guide());
        assert_eq!(rig.host.panels().len(), 2, "the clock, and what is told");
        let skip = format!("{:?}", ButtonAction::Press(Press::Skip { all: false }));
        assert!(rig.host.buttons().all(|(name, _)| name != skip), "there is nothing to skip");
        rig.tick(None);
        ticks += 1;
    }
    assert!(!rig.host.has_guide());
    assert_eq!(rig.host.panels().len(), 1, "the clock");
    (ticks, told)
}

#[test]
fn who_has_done_all_steps_is_told_so_until_it_is_read() {
    for (number, language) in [(0, Language::Greek), (1, Language::English)] {
        with_rig(|rig| {
            rig.presence = Presence::Worn;
            rig.wait(2);
            rig.host.perform(ButtonAction::Press(Press::Language(number)));
            begin_guide(rig);
            assert!(rig.host.has_guide());
            end_steps(rig);
            let (ticks, told) = read_end(rig);
            assert_eq!(told, Some(GuideEnd::Done));
            assert_eq!(ticks, GuideEnd::Done.reading_ticks(language));
            assert!((4 * TICK_RATE..8 * TICK_RATE).contains(&ticks), "{ticks} ticks");
        });
    }
}

/// An unfinished guide isn't praised, but its end is announced.
#[test]
fn who_had_no_time_for_all_steps_is_told_that_they_are_over() {
    with_rig(|rig| {
        begin_guide(rig);
        while rig.phase() == VisitPhase::Guided {
            rig.tick(None);
        }
        let (ticks, told) = read_end(rig);
        assert_eq!(told, Some(GuideEnd::TimeOver));
        assert!(ticks > 4 * TICK_RATE, "{ticks} ticks");
    });
}

/// A question in between doesn't shorten the time to read the message.
#[test]
fn what_is_told_under_a_question_is_told_after_it() {
    with_rig(|rig| {
        begin_guide(rig);
        end_steps(rig);
        rig.host.toggle_finish_question(rig.runner.world().visit());
        rig.wait(TICK_RATE);
        rig.host.toggle_finish_question(rig.runner.world().visit());
        rig.tick(None);
        let (ticks, told) = read_end(rig);
        assert_eq!(told, Some(GuideEnd::Done));
        let all = GuideEnd::Done.reading_ticks(rig.host.language(rig.runner.world().visit()));
        assert!((all - 2..=all).contains(&ticks), "{ticks} of {all} ticks");
    });
}

#[test]
fn a_first_cut_that_another_run_of_the_program_began_is_told_to_have_ended() {
    with_rig(|rig| {
        begin_guide(rig);
        rig.host = VisitHost::new(options(), rig.runner.world().visit());
        end_steps(rig);
        assert_eq!(read_end(rig).1, Some(GuideEnd::Done));
    });
}

/// The longer text is shown for longer.
#[test]
fn a_text_is_told_for_as_long_as_it_takes_to_read() {
    for language in Language::ALL {
        let [done, over] =
            [GuideEnd::Done, GuideEnd::TimeOver].map(|end| end.reading_ticks(language));
        assert!(done < over, "{language:?}: {done} {over}");
    }
}

/// An extension doesn't repeat the message about the first cut, which ended long ago.
#[test]
fn nobody_is_told_again_that_the_first_cut_has_ended() {
    with_rig(|rig| {
        begin_sculpting(rig);
        read_end(rig);
        rig.host.perform(ButtonAction::Press(Press::Finish));
        rig.wait(2);
        assert_eq!(rig.phase(), VisitPhase::HandsOff);
        rig.host.perform(ButtonAction::Staff(StaffCommand::Extend));
        rig.wait(2);
        assert_eq!(rig.phase(), VisitPhase::Sculpting);
        assert_eq!(rig.host.screen.told_guide_end(), None);
    });
}

#[test]
fn where_the_first_cut_is_left_out_nobody_is_told_of_its_end() {
    with_rig(|rig| {
        let mut options = options();
        options.plan.set_value(PlanSetting::Guided, 0);
        let start = options.starts[0];
        rig.host = VisitHost::new(options, rig.world().visit());
        rig.wait(4);
        rig.presence = Presence::Worn;
        rig.wait(2);
        rig.host.perform(ButtonAction::Press(Press::Confirm));
        rig.wait(2);
        rig.host.perform(ButtonAction::Choose(start));
        rig.wait(6);
        assert_eq!(rig.phase(), VisitPhase::Sculpting);
        assert_eq!((rig.host.has_guide(), rig.host.screen.told_guide_end()), (false, None));
    });
}
