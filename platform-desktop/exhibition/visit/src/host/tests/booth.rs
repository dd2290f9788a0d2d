//! Visits at a booth: leased badges, the upload status, and commands from the staff's page.

use paros_core::badge::BadgeNumber;
use paros_core::session::TICK_RATE;
use paros_core::visit::VisitPhase;
use paros_protocol::UploadStatus;
use paros_protocol::{CommandKind, CommandOutcome};
use paros_upload::courier::{BoothState, CourierSummary};
use paros_upload::{BoothContact, RemoteCommand};

use super::super::keeping::BADGE_TICKS;
use super::{ButtonAction, ExportState, HostRig, Press, begin_sculpting, cut, with_rig};
use crate::host::remote::GLOW_TICKS;

/// Makes the state of a booth that has leased no badge yet, and has received nothing.
fn booth() -> BoothState {
    let outbox = CourierSummary { owed: 1, is_nearly_full: false, contact: BoothContact::Silent };
    BoothState { id: None, badge: None, status: Some(UploadStatus::Making), outbox }
}

/// Goes to an export whose files are already written.
fn finish(rig: &mut HostRig<'_, '_>, booth: BoothState) {
    begin_sculpting(rig);
    cut(rig);
    rig.export =
        ExportState { is_kept: true, part: 1.0, booth: Some(booth), ..ExportState::default() };
    assert!(rig.press(ButtonAction::Ask(crate::screen::Question::Finish)));
    assert!(rig.press(ButtonAction::Press(Press::Finish)));
    while rig.phase() == VisitPhase::HandsOff {
        rig.tick(None);
    }
}

#[test]
fn a_badge_is_the_leased_one_and_waits_for_it() {
    with_rig(|rig| {
        finish(rig, booth());
        rig.wait(BADGE_TICKS - 10);
        assert_eq!((rig.phase(), rig.world().visit().badge()), (VisitPhase::Export, None));
        let leased = BadgeNumber::new(0x123).expect("a number");
        rig.export.booth = Some(BoothState { badge: Some(leased), ..booth() });
        rig.wait(4);
        assert_eq!(rig.phase(), VisitPhase::Badge);
        assert_eq!(rig.world().visit().badge(), Some(leased.get()));
    });
}

#[test]
fn a_booth_that_is_down_keeps_nobody_waiting() {
    with_rig(|rig| {
        finish(rig, booth());
        rig.wait(BADGE_TICKS + 4);
        assert_eq!(rig.phase(), VisitPhase::Badge);
        let badge = rig.world().visit().badge().and_then(BadgeNumber::new).expect("a badge");
        assert!(badge.is_provisional());
    });
}

#[test]
fn panels_tell_where_the_sculpture_is_and_follow_it() {
    with_rig(|rig| {
        let leased = BadgeNumber::new(0x123).expect("a number");
        finish(rig, BoothState { badge: Some(leased), ..booth() });
        rig.wait(4);
        assert_eq!(rig.phase(), VisitPhase::Badge);
        for status in [UploadStatus::Kept, UploadStatus::Sent] {
            let outbox = CourierSummary { is_nearly_full: true, ..booth().outbox };
            let state = BoothState { id: None, status: Some(status), badge: Some(leased), outbox };
            rig.export.booth = Some(state);
            rig.wait(1);
            let told = rig.host.screen.told_booth().expect("there is a booth");
            assert_eq!((told.status, told.owed, told.is_nearly_full), (Some(status), 1, true));
        }
    });
}

#[test]
fn the_staff_s_page_extends_ends_and_resets_the_visit_that_it_means() {
    with_rig(|rig| {
        begin_sculpting(rig);
        cut(rig);
        let session_id = rig.host.remote.session_id();
        let ask = |rig: &mut HostRig<'_, '_>, kind, session_id| {
            let visit = *rig.world().visit();
            rig.host.carry_out(&RemoteCommand { id: 1, kind, session_id }, &visit)
        };
        let left = rig.world().visit().seconds_left().expect("a clock");
        assert_eq!(ask(rig, CommandKind::Extend, session_id), CommandOutcome::Done);
        rig.wait(2);
        assert!(rig.world().visit().seconds_left().expect("a clock") > left + 50);
        assert_eq!(ask(rig, CommandKind::Identify, 0), CommandOutcome::Done);
        rig.wait(1);
        assert_eq!(rig.host.buttons().count(), 0, "the sign covers them");
        rig.wait(GLOW_TICKS);
        assert!(rig.host.buttons().count() > 0);
        assert_eq!(ask(rig, CommandKind::Recentre, 0), CommandOutcome::Done);
        assert!(rig.host.take_recentring());
        assert_eq!(ask(rig, CommandKind::End, session_id), CommandOutcome::Done);
        rig.wait(2);
        assert_eq!(rig.phase(), VisitPhase::HandsOff);
        assert_eq!(ask(rig, CommandKind::End, session_id), CommandOutcome::Refused);
        assert_eq!(ask(rig, CommandKind::Reset, session_id), CommandOutcome::Done);
        rig.wait(20 * TICK_RATE);
        assert_eq!(ask(rig, CommandKind::Reset, session_id ^ 1), CommandOutcome::Expired);
    });
}
