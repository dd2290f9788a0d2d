//! What heartbeats tell, and what is taken of their answers.

use std::collections::HashSet;

use paros_core::badge::{LeaseAnswer, LeaseReport, LeasedBlocks};
use paros_core::limits::{CONFIRM_MS, HEARTBEAT_MS, HEARTBEAT_TIMEOUT_MS, MAX_ANNOUNCEMENTS};
use paros_core::outbox::messages::{
    Announcement, AnnouncementState, BoothCommand, CommandKind, CommandOutcome, CommandReport,
    Heartbeat, HeartbeatAnswer, ReceiptOutcome, SculptureId, SiteId,
};
use paros_core::outbox::{DueCommand, EntryState, Outbox, UploadAnswer};

use super::journal::{load, save};
use super::{BOOT, OWNER, STATUS, empty, id, keeping, receipt, state};

fn beat(outbox: &mut Outbox) -> Heartbeat {
    assert!(outbox.is_heartbeat_due());
    outbox.begin_heartbeat(&STATUS, None, 0)
}

fn answer_to(heartbeat: &Heartbeat) -> HeartbeatAnswer {
    HeartbeatAnswer {
        site: OWNER.site,
        headset: heartbeat.headset,
        boot_id: heartbeat.boot_id,
        number: heartbeat.number,
        booth_time: 1_790_000_000,
        lease: None,
        command: None,
        noted: heartbeat.announcements.clone(),
    }
}

const IDENTIFY: BoothCommand = BoothCommand {
    id: 1,
    boot_id: BOOT,
    session_id: 5,
    kind: CommandKind::Identify,
    lives_ms: 10_000,
};

/// Sends a heartbeat that is answered with a command after so long, in the visit of these bits.
fn command(
    outbox: &mut Outbox,
    command: BoothCommand,
    after_ms: u64,
    session_id: u64,
) -> Option<DueCommand> {
    let heartbeat = beat(outbox);
    // Every test's clock begins at 0 and goes on by whole heartbeats.
    let sent_ms = u64::from(heartbeat.number - 1) * 20_000;
    outbox.pass_time(sent_ms + after_ms);
    let answer = HeartbeatAnswer { command: Some(command), ..answer_to(&heartbeat) };
    let due = outbox.take_heartbeat_answer(&answer, session_id).expect("its answer");
    outbox.pass_time(sent_ms + 20_000);
    due
}

fn last_report(outbox: &mut Outbox) -> Option<CommandReport> {
    outbox.clone().begin_heartbeat(&STATUS, None, 0).last_command
}

#[test]
fn heartbeats_come_every_two_seconds_one_at_a_time() {
    let mut outbox = keeping([1]);
    let first = beat(&mut outbox);
    assert_eq!((first.number, first.boot_id, first.outbox_depth), (1, BOOT, 1));
    assert!(!outbox.is_heartbeat_due());
    outbox.pass_time(HEARTBEAT_MS);
    assert!(!outbox.is_heartbeat_due(), "the first isn't answered");
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&first), 5), Some(None));
    assert!(outbox.is_heartbeat_due() && outbox.hears_booth());
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&first), 5), None, "twice");
    let second = beat(&mut outbox);
    outbox.pass_time(2 * HEARTBEAT_MS);
    let mut others = [(); 4].map(|()| answer_to(&second));
    others[0].number = 1;
    others[1].boot_id += 1;
    others[2].headset += 1;
    others[3].site = SiteId([8; 16]);
    for other in others {
        assert_eq!(outbox.take_heartbeat_answer(&other, 5), None);
    }
    // It isn't waited for for ever, and then seldomer.
    outbox.pass_time(HEARTBEAT_MS + HEARTBEAT_TIMEOUT_MS);
    let third = beat(&mut outbox);
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&second), 5), None, "too late");
    outbox.note_heartbeat_failed(third.number);
    outbox.pass_time(2 * HEARTBEAT_MS + HEARTBEAT_TIMEOUT_MS);
    assert!(!outbox.hears_booth());
    let fourth = beat(&mut outbox);
    outbox.note_heartbeat_failed(fourth.number);
    outbox.pass_time(3 * HEARTBEAT_MS + HEARTBEAT_TIMEOUT_MS);
    assert!(!outbox.is_heartbeat_due());
}

#[test]
fn every_sculpture_is_told_of_until_its_state_is_noted_and_then_in_turn() {
    let mut outbox = empty();
    outbox.pass_time(0);
    let ids: Vec<_> = (0..100u8).map(|number| SculptureId([number + 1; 16])).collect();
    ids.iter().for_each(|&id| outbox.announce(id, None).expect("room"));
    let mut now = 0;
    let mut told = |outbox: &mut Outbox, is_noted: bool| {
        let heartbeat = beat(outbox);
        now += HEARTBEAT_MS;
        outbox.pass_time(now);
        let mut answer = answer_to(&heartbeat);
        if !is_noted {
            answer.noted.clear();
        }
        assert_eq!(outbox.take_heartbeat_answer(&answer, 5), Some(None));
        heartbeat.announcements.iter().map(|announcement| announcement.id).collect::<Vec<_>>()
    };
    // The booth notes nothing: all have their turn all the same.
    let unheard: HashSet<_> = (0..4).flat_map(|_| told(&mut outbox, false)).collect();
    assert_eq!(unheard.len(), 100);
    let heard: Vec<_> = (0..4).flat_map(|_| told(&mut outbox, true)).collect();
    assert_eq!(heard[..100].iter().collect::<HashSet<_>>().len(), 100, "no one twice before all");
    // News go first, of any place in the table.
    for number in [3, 50, 97] {
        outbox.note_parcel_missing(ids[number]).expect("announced");
        let list = told(&mut outbox, false);
        assert_eq!((list[0], list.len()), (ids[number], MAX_ANNOUNCEMENTS));
        told(&mut outbox, true);
    }
    let again: HashSet<_> = (0..4).flat_map(|_| told(&mut outbox, true)).collect();
    assert_eq!(again.len(), 97, "those that are noted as lost are told of no more");
}

#[test]
fn what_was_noted_before_it_changed_is_told_again() {
    let mut outbox = keeping([1]);
    let heartbeat = beat(&mut outbox);
    let told = Announcement { id: id(1), badge: None, state: AnnouncementState::Kept };
    assert_eq!(heartbeat.announcements[..], [told]);
    outbox.note_parcel_missing(id(1)).expect("kept");
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&heartbeat), 5), Some(None));
    assert!(state(&outbox, 1).is_some(), "that it is lost is noted nowhere");
    outbox.pass_time(HEARTBEAT_MS);
    let heartbeat = beat(&mut outbox);
    assert_eq!(heartbeat.announcements[0].state, AnnouncementState::Lost);
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&heartbeat), 5), Some(None));
    assert_eq!(state(&outbox, 1), None);
}

/// Has the booth sign for a sculpture.
fn sign(outbox: &mut Outbox, number: u8) {
    let request = outbox.begin_upload(0).expect("something to send");
    assert_eq!(request.id, id(number));
    let signed = UploadAnswer::Receipt(receipt(id(number), ReceiptOutcome::Kept));
    outbox.take_upload_answer(request.number, signed, 0).expect("its receipt");
}

/// A booth that came back from a copy of before it signed.
#[test]
fn what_the_booth_forgot_is_sent_again_within_the_grace() {
    let mut outbox = keeping([1]);
    sign(&mut outbox, 1);
    let asked = Announcement { id: id(1), badge: None, state: AnnouncementState::SignedFor };
    let missed = Announcement { state: AnnouncementState::Kept, ..asked };
    let mut now = 0;
    let mut ask = |outbox: &mut Outbox, after_ms: u64| {
        now += after_ms;
        outbox.pass_time(now);
        let heartbeat = beat(outbox);
        assert_eq!(heartbeat.outbox_depth, 0, "it is owed no more");
        heartbeat
    };
    let first = ask(&mut outbox, HEARTBEAT_MS);
    assert_eq!(first.announcements[..], [], "it has just signed");
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&first), 5), Some(None));
    let second = ask(&mut outbox, CONFIRM_MS);
    assert_eq!(second.announcements[..], [asked]);
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&second), 5), Some(None));
    assert!(matches!(state(&outbox, 1), Some(EntryState::Receipted { .. })));
    let third = ask(&mut outbox, HEARTBEAT_MS);
    assert_eq!(third.announcements[..], [], "it was confirmed");
    // The booth has another ledger of badges: it may have lost more.
    let lease = LeaseAnswer {
        headset: OWNER.headset,
        epoch: 1,
        report: 1,
        taken: 0,
        is_void: true,
        blocks: LeasedBlocks::new(),
    };
    let void = HeartbeatAnswer { lease: Some(lease), ..answer_to(&third) };
    assert_eq!(outbox.take_heartbeat_answer(&void, 5), Some(None));
    let fourth = ask(&mut outbox, HEARTBEAT_MS);
    assert_eq!(fourth.announcements[..], [asked], "at once");
    outbox.note_journal_written();
    let forgotten =
        HeartbeatAnswer { noted: std::iter::once(missed).collect(), ..answer_to(&fourth) };
    assert_eq!(outbox.take_heartbeat_answer(&forgotten, 5), Some(None));
    assert_eq!(state(&outbox, 1), Some(EntryState::Kept));
    assert!(outbox.is_journal_due());
    sign(&mut outbox, 1);
    assert_eq!(state(&outbox, 1), Some(EntryState::Receipted { seconds: 0 }));
}

/// What was noted of a heartbeat from before the receipt isn't news of what was signed for since.
#[test]
fn an_answer_from_before_the_receipt_asks_for_nothing() {
    let mut outbox = keeping([1]);
    let before = beat(&mut outbox);
    assert_eq!(before.announcements.len(), 1);
    sign(&mut outbox, 1);
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&before), 5), Some(None));
    assert_eq!(state(&outbox, 1), Some(EntryState::Receipted { seconds: 0 }));
    // Each start asks, and an answer to a heartbeat that asked nothing says nothing.
    let mut again = load(&save(&outbox)).expect("its journal");
    again.pass_time(0);
    let asking = beat(&mut again);
    assert_eq!(asking.announcements.len(), 1);
    again.note_heartbeat_failed(asking.number);
    assert_eq!(again.take_heartbeat_answer(&answer_to(&asking), 5), None);
}

#[test]
fn a_command_is_carried_out_once_and_reported() {
    let mut outbox = keeping([]);
    let due = DueCommand { id: 1, kind: CommandKind::Identify };
    assert_eq!(command(&mut outbox, IDENTIFY, 100, 5), Some(due));
    assert_eq!(last_report(&mut outbox), None, "nobody knows yet");
    assert_eq!(command(&mut outbox, IDENTIFY, 100, 5), None, "the booth says it until it knows");
    outbox.note_command_done(1, CommandOutcome::Done);
    outbox.note_command_done(1, CommandOutcome::Refused);
    outbox.note_command_done(7, CommandOutcome::Refused);
    let done = CommandReport { id: 1, outcome: CommandOutcome::Done };
    assert_eq!(last_report(&mut outbox), Some(done));
    assert_eq!(command(&mut outbox, IDENTIFY, 100, 5), None);
    assert_eq!(last_report(&mut outbox), Some(done));
    let next = BoothCommand { id: 3, ..IDENTIFY };
    assert_eq!(command(&mut outbox, next, 0, 5), Some(DueCommand { id: 3, ..due }));
    assert_eq!(command(&mut outbox, BoothCommand { id: 2, ..IDENTIFY }, 0, 5), None, "older");
}

#[test]
fn a_command_is_dead_after_its_life_its_visit_or_its_start() {
    let end = BoothCommand { kind: CommandKind::End, ..IDENTIFY };
    let dead = [
        (BoothCommand { lives_ms: 300, ..IDENTIFY }, 300, 5),
        (BoothCommand { boot_id: BOOT + 1, ..IDENTIFY }, 0, 5),
        (end, 0, 6),
        (end, 0, 0),
        (BoothCommand { session_id: 0, ..end }, 0, 0),
        (BoothCommand { kind: CommandKind::Reset, ..end }, 0, 6),
        (BoothCommand { kind: CommandKind::Extend, ..end }, 0, 6),
    ];
    for (dead, after_ms, session_id) in dead {
        let mut outbox = keeping([]);
        assert_eq!(command(&mut outbox, dead, after_ms, session_id), None, "{dead:?}");
        let expired = CommandReport { id: 1, outcome: CommandOutcome::Expired };
        assert_eq!(last_report(&mut outbox), Some(expired), "{dead:?}");
    }
    let alive = [
        (BoothCommand { lives_ms: 300, ..IDENTIFY }, 299, 5),
        (IDENTIFY, 0, 6),
        (BoothCommand { kind: CommandKind::Recentre, ..IDENTIFY }, 0, 0),
        (end, 9_999, 5),
    ];
    for (alive, after_ms, session_id) in alive {
        let due = command(&mut keeping([]), alive, after_ms, session_id);
        assert_eq!(due, Some(DueCommand { id: 1, kind: alive.kind }), "{alive:?}");
    }
}

#[test]
fn an_answer_over_a_clock_that_was_set_back_is_ignored() {
    let mut outbox = keeping([]);
    outbox.pass_time(50_000);
    let heartbeat = beat(&mut outbox);
    outbox.pass_time(49_000);
    let answer = HeartbeatAnswer { command: Some(IDENTIFY), ..answer_to(&heartbeat) };
    assert_eq!(outbox.take_heartbeat_answer(&answer, 5), None, "nobody knows how old it is");
}

#[test]
fn a_wipe_is_told_until_it_is_heard_over_starts_too() {
    let mut outbox = empty();
    assert!(beat(&mut outbox).was_wiped);
    let mut outbox = load(&save(&outbox)).expect("a journal");
    let heartbeat = beat(&mut outbox);
    assert!(heartbeat.was_wiped, "nobody answered");
    outbox.note_journal_written();
    assert_eq!(outbox.take_heartbeat_answer(&answer_to(&heartbeat), 5), Some(None));
    assert!(!outbox.was_wiped() && outbox.is_journal_due());
    assert!(!load(&save(&outbox)).expect("a journal").was_wiped());
}

#[test]
fn a_heartbeat_tells_of_the_headset_and_of_its_own_lease_alone() {
    let lease = LeaseReport { headset: OWNER.headset, epoch: 1, report: 2, taken: 3 };
    let heartbeat = empty().begin_heartbeat(&STATUS, Some(lease), 0);
    assert_eq!((heartbeat.lease, heartbeat.was_wiped), (Some(lease), true));
    assert_eq!((heartbeat.session_id, heartbeat.battery_percent), (5, Some(80)));
    let other = LeaseReport { headset: OWNER.headset + 1, ..lease };
    assert_eq!(empty().begin_heartbeat(&STATUS, Some(other), 0).lease, None);
    assert!(!keeping([1]).clone().hears_booth());
}
