//! Heartbeats, and what their answers change.

use std::mem;

use paros_protocol::limits::MAX_ANNOUNCEMENTS;
use paros_protocol::{BoothCommand, CommandKind, CommandOutcome};

use super::*;
use crate::CONFIRM_MS;

/// Returns an answer that acknowledges all announcements of a heartbeat.
fn answer_to(beat: &Heartbeat) -> HeartbeatAnswer {
    HeartbeatAnswer {
        site: OWNER.site,
        headset: OWNER.headset,
        boot_id: beat.boot_id,
        number: beat.number,
        booth_time: 1,
        store_epoch: 1,
        badges: Vec::new(),
        command: None,
        noted: beat.announcements.clone(),
    }
}

/// Steps by a second until a heartbeat is sent.
fn next_beat(sender: &mut Sender<DiskFolder, Link>, host: &mut Host) -> Heartbeat {
    for _ in 0..40 {
        host.now_ms += 1000;
        sender.step(host);
        let sent = mem::take(&mut sender.link().sent);
        let is_beat = |request: &BoothRequest| request.kind == RequestKind::Heartbeat;
        let beat = sent.into_iter().find(is_beat).map(|request| request.body);
        if let Some(body) = beat {
            return Heartbeat::from_json(&body[..]).expect("its own");
        }
    }
    panic!("no heartbeat");
}

fn give(sender: &mut Sender<DiskFolder, Link>, host: &mut Host, answer: &HeartbeatAnswer) {
    let (kind, number) = (RequestKind::Heartbeat, answer.number);
    let body = answer.to_json();
    let result = Ok(HttpAnswer { status: 200, retry_after: None, body });
    sender.link().answers.push_back(LinkAnswer { kind, number, result });
    sender.step(host);
}

/// Lets the booth confirm all sculptures that it is asked about.
pub(super) fn confirm(sender: &mut Sender<DiskFolder, Link>, host: &mut Host) {
    // Earlier heartbeats stay unanswered.
    sender.link().sent.clear();
    let beat = next_beat(sender, host);
    give(sender, host, &answer_to(&beat));
}

fn announced(beat: &Heartbeat) -> Vec<(u8, UploadStatus)> {
    beat.announcements.iter().map(|told| (told.id.0[0], told.status)).collect()
}

#[test]
fn a_heartbeat_without_an_answer_is_followed_by_rarer_ones() {
    let folder = Folder::new("beats");
    let mut sender = folder.open();
    let mut host = Host::default();
    let mut times = Vec::new();
    for _ in 0..6 {
        let beat = next_beat(&mut sender, &mut host);
        times.push(host.now_ms / 1000);
        let (kind, number) = (RequestKind::Heartbeat, beat.number);
        let result = Err(LinkFault::Unreachable);
        sender.link().answers.push_back(LinkAnswer { kind, number, result });
        assert_eq!(sender.contact(), BoothContact::Silent);
    }
    assert_eq!(times, [1, 3, 5, 9, 14, 19]);
    let beat = next_beat(&mut sender, &mut host);
    give(&mut sender, &mut host, &answer_to(&beat));
    assert_eq!(sender.contact(), BoothContact::Open);
}

#[test]
fn sculptures_are_announced_until_the_booth_has_them() {
    use UploadStatus::{Kept, Lost, Making};
    let folder = Folder::new("announced");
    let mut sender = folder.open();
    let mut host = Host::default();
    assert!(sender.was_wiped());
    sender.announce(id_of(1), None).expect("room");
    sender.announce(id_of(2), None).expect("room");
    let beat = next_beat(&mut sender, &mut host);
    assert_eq!((announced(&beat), beat.was_wiped), (vec![(1, Making), (2, Making)], true));
    give(&mut sender, &mut host, &answer_to(&beat));
    assert!(!sender.was_wiped());
    sender.abandon(id_of(1)).expect("it was announced");
    sender.keep(&parcel(3)).expect("room");
    let beat = next_beat(&mut sender, &mut host);
    assert_eq!(announced(&beat), [(1, Lost), (3, Kept), (2, Making)], "first what is news");
    assert_eq!((beat.was_wiped, beat.outbox_depth), (false, 3));
    // A lost sculpture is forgotten once the booth has acknowledged the loss.
    give(&mut sender, &mut host, &answer_to(&beat));
    assert_eq!(status(&sender, 1), None);
    // An answer of another booth, or to another heartbeat, is ignored.
    sender.abandon(id_of(2)).expect("it was announced");
    let beat = next_beat(&mut sender, &mut host);
    let fine = answer_to(&beat);
    for wrong in [
        HeartbeatAnswer { site: SiteId([9; 16]), ..fine.clone() },
        HeartbeatAnswer { number: beat.number + 1, ..fine.clone() },
        HeartbeatAnswer { boot_id: 77, ..fine.clone() },
    ] {
        give(&mut sender, &mut host, &wrong);
        assert_eq!(status(&sender, 2), Some(Lost));
    }
}

#[test]
fn more_than_a_heartbeat_holds_take_turns() {
    let folder = Folder::new("turns");
    let mut sender = folder.open();
    let mut host = Host::default();
    let count = MAX_ANNOUNCEMENTS as u8 + 8;
    (1..=count).for_each(|number| sender.announce(id_of(number), None).expect("room"));
    let mut seen = Vec::new();
    for _ in 0..2 {
        let beat = next_beat(&mut sender, &mut host);
        assert_eq!(beat.announcements.len(), MAX_ANNOUNCEMENTS);
        seen.extend(announced(&beat).into_iter().map(|(number, _)| number));
        give(&mut sender, &mut host, &answer_to(&beat));
    }
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), usize::from(count));
}

/// The booth was restored from a backup, or deleted the sculpture: the answer to the upload says which.
#[test]
fn a_sent_parcel_that_the_booth_lacks_is_sent_again() {
    let folder = Folder::new("lacking");
    let mut host = Host::default();
    let settings = OutboxSettings { grace_seconds: 10_000, ..SETTINGS };
    let sender = send_all(&folder, &mut host, &[1, 2]);
    drop(sender);
    let mut sender = folder.open_with(settings);
    let beat = next_beat(&mut sender, &mut host);
    // Each start asks once, and then every minute.
    assert_eq!(announced(&beat), [(1, UploadStatus::Sent), (2, UploadStatus::Sent)]);
    give(&mut sender, &mut host, &answer_to(&beat));
    let beat = next_beat(&mut sender, &mut host);
    assert_eq!(announced(&beat), []);
    give(&mut sender, &mut host, &answer_to(&beat));
    host.now_ms += CONFIRM_MS;
    let beat = next_beat(&mut sender, &mut host);
    let lacking = |told: &Announcement| match told.id == id_of(2) {
        true => Announcement { status: UploadStatus::Kept, ..*told },
        false => *told,
    };
    let noted = beat.announcements.iter().map(lacking).collect();
    give(&mut sender, &mut host, &HeartbeatAnswer { noted, ..answer_to(&beat) });
    assert_eq!(status(&sender, 1), Some(UploadStatus::Sent));
    // It is being sent by then.
    assert_eq!(folder.names(), [name_of(1, "sent"), name_of(2, "parcel")]);
    // A new store epoch means that the booth was restored: all sculptures are asked about at once.
    let beat = next_beat(&mut sender, &mut host);
    assert_eq!(announced(&beat), [(2, UploadStatus::Kept)]);
    give(&mut sender, &mut host, &HeartbeatAnswer { store_epoch: 2, ..answer_to(&beat) });
    let beat = next_beat(&mut sender, &mut host);
    assert_eq!(announced(&beat), [(1, UploadStatus::Sent), (2, UploadStatus::Kept)]);
}

#[test]
fn a_command_is_carried_out_once_in_its_start_visit_and_life() {
    let folder = Folder::new("commands");
    let mut sender = folder.open();
    let mut host = Host::default();
    let command = |id, kind| BoothCommand { id, boot_id: 1, session_id: 5, kind, lives_ms: 10_000 };
    let mut ask = |command: BoothCommand| {
        let beat = next_beat(&mut sender, &mut host);
        let answer = HeartbeatAnswer { command: Some(command), ..answer_to(&beat) };
        host.events.clear();
        give(&mut sender, &mut host, &answer);
        let is_due = host.events.iter().any(|event| matches!(event, OutboxEvent::Command { .. }));
        let report = next_beat(&mut sender, &mut host).last_command;
        (is_due, report.map(|report| (report.id, report.outcome)))
    };
    let extend = command(3, CommandKind::Extend);
    assert_eq!(ask(extend), (true, None));
    assert_eq!(ask(extend), (false, None), "it rides on each answer");
    let expired = |id| (false, Some((id, CommandOutcome::Expired)));
    assert_eq!(ask(BoothCommand { session_id: 6, ..command(4, CommandKind::End) }), expired(4));
    assert_eq!(ask(BoothCommand { boot_id: 2, ..command(5, CommandKind::Identify) }), expired(5));
    let identify = BoothCommand { session_id: 0, ..command(6, CommandKind::Identify) };
    assert_eq!(ask(identify), (true, None), "it is for no visit");
    assert_eq!(ask(command(2, CommandKind::End)), (false, None), "it is older");
    sender.note_command_done(6, CommandOutcome::Done);
    let beat = next_beat(&mut sender, &mut host);
    let report = beat.last_command.expect("it is reported");
    assert_eq!((report.id, report.outcome), (6, CommandOutcome::Done));
    // The answer took longer than the command's lifetime.
    host.now_ms += 9_000;
    let late = BoothCommand { lives_ms: 500, ..command(7, CommandKind::End) };
    give(&mut sender, &mut host, &HeartbeatAnswer { command: Some(late), ..answer_to(&beat) });
    let report = next_beat(&mut sender, &mut host).last_command.expect("it is reported");
    assert_eq!((report.id, report.outcome), (7, CommandOutcome::Expired));
}
