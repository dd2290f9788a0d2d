//! Heartbeats and their answers.

use super::common::*;
use paros_booth_rules::limits::{COMMAND_LIFE, MAX_ANNOUNCED, MAX_WAITING_COMMANDS, STATUS_LIFE};
use paros_booth_rules::records::AuditEntry;
use paros_booth_rules::records::{CommandState, Device};
use paros_booth_rules::{BoothTime, HeardBadge, ListFilter};
use paros_core::badge::{BadgeNumber, Pictogram};

fn device_of(rig: &Rig, headset: u32) -> Device {
    rig.booth.list_devices().unwrap().into_iter().find(|device| device.headset == headset).unwrap()
}

fn states(rig: &Rig, headset: u32, now: BoothTime) -> Vec<CommandState> {
    let commands = rig.booth.list_commands(headset, 99, now).unwrap();
    commands.into_iter().rev().map(|command| command.state).collect()
}

/// Makes a heartbeat that reports the outcome of a command.
fn reporting(headset: u32, id: u64, outcome: CommandOutcome) -> Heartbeat {
    Heartbeat { last_command: Some(CommandReport { id, outcome }), ..heartbeat(headset) }
}

#[test]
fn the_answer_is_to_this_heartbeat() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let beat = Heartbeat { number: 7, boot_id: 3, ..heartbeat(device.headset) };
    let answer = rig.beat(&device, &beat, seconds(5));
    let HeartbeatAnswer { site, headset, boot_id, number, booth_time, .. } = answer;
    assert_eq!((site, headset, boot_id, number), (SITE, device.headset, 3, 7));
    assert_eq!(booth_time, seconds(5).seconds());
    let other = heartbeat(device.headset + 1);
    assert_eq!(status(rig.booth.take_heartbeat(&device, &other, START)), 403);
}

#[test]
fn state_is_kept_when_it_changes_and_now_and_then() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let seen_at = || device_of(&rig, device.headset).seen_at;
    let beat = heartbeat(device.headset);
    rig.beat(&device, &beat, START);
    assert_eq!(seen_at(), Some(START));
    let status = HeadsetStatus { worn_seconds: 62, ..beat.status };
    let next = Heartbeat { number: 2, status, ..beat.clone() };
    rig.beat(&device, &next, seconds(2));
    assert_eq!(seen_at(), Some(START), "nothing but the time has changed");
    let status = HeadsetStatus { battery_percent: Some(9), ..status };
    let low = Heartbeat { status, ..next };
    rig.beat(&device, &low, seconds(4));
    assert_eq!(seen_at(), Some(seconds(4)));
    let later = seconds(4).after(STATUS_LIFE);
    rig.beat(&device, &low, later);
    assert_eq!(seen_at(), Some(later));
    // The clock was set back: the last heartbeat lies in the future.
    rig.beat(&device, &low, START);
    assert_eq!(seen_at(), Some(START));
}

#[test]
fn what_is_announced_is_missing_until_it_comes() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(40, leased(9));
    let beat = heartbeat(device.headset);
    let announced = parcel.announcement(UploadStatus::Making);
    let without_badge = Announcement { badge: None, ..announced };
    let answer = rig.beat(&device, &announcing(&beat, &[without_badge]), START);
    assert_eq!(answer.noted.as_slice(), [without_badge]);
    let kept = parcel.announcement(UploadStatus::Kept);
    let answer = rig.beat(&device, &announcing(&beat, &[kept]), seconds(9));
    assert_eq!(answer.noted.as_slice(), [kept], "as it stood in the heartbeat");
    let missing = rig.booth.list_missing(9).unwrap();
    assert_eq!(missing.len(), 1);
    assert_eq!(missing[0].announcement.badge, leased(9).map(BadgeNumber::get));
    assert_eq!(missing[0].announcement.status, UploadStatus::Kept as u8);
    assert_eq!(missing[0].announcement.heard_at, START);
    let badge = leased(9).map(|number| number.badge()).unwrap();
    let said = |pictogram| Some(HeardBadge::new(None, vec![pictogram]));
    let other = Pictogram::all().find(|shown| !badge.pictograms.contains(shown)).unwrap();
    for (filter, is_admitted) in [
        (ListFilter::default(), true),
        (
            ListFilter {
                headset: Some(device.headset),
                badge: said(badge.pictograms[2]),
                ..ListFilter::default()
            },
            true,
        ),
        (ListFilter { headset: Some(device.headset + 1), ..ListFilter::default() }, false),
        (ListFilter { badge: said(other), ..ListFilter::default() }, false),
        (ListFilter { received: Some(START..seconds(1)), ..ListFilter::default() }, true),
        (ListFilter { received: Some(seconds(1)..seconds(9)), ..ListFilter::default() }, false),
    ] {
        assert_eq!(filter.admits(&missing[0].announcement), is_admitted, "{filter:?}");
    }
    rig.upload(&device, &parcel, seconds(10)).unwrap();
    assert_eq!(rig.booth.list_missing(9).unwrap(), []);
    // A late heartbeat, and one after the deletion: acknowledged, but not missing.
    for _ in 0..2 {
        let answer = rig.beat(&device, &announcing(&beat, &[kept]), seconds(11));
        assert_eq!(answer.noted.len(), 1);
        assert_eq!(rig.booth.list_missing(9).unwrap(), []);
        let _ = rig.booth.delete(&parcel.id, "ana", seconds(11));
    }
}

/// The booth was restored from a backup older than its confirmation, or the sculpture was deleted since.
#[test]
fn what_was_signed_for_and_is_not_there_is_asked_for() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    let beat = heartbeat(device.headset);
    let parcel = Parcel::new(40, leased(9));
    let asked = parcel.announcement(UploadStatus::Sent);
    let missed = parcel.announcement(UploadStatus::Kept);
    let ask = |now| rig.beat(&device, &announcing(&beat, &[asked]), now).noted;
    assert_eq!(ask(START).as_slice(), [missed], "it never came here");
    assert_eq!(ask(seconds(2)).as_slice(), [missed], "it is known that it is missed");
    let missing = rig.booth.list_missing(9).unwrap();
    assert_eq!(missing.len(), 1);
    assert_eq!(missing[0].announcement.status, UploadStatus::Kept as u8);
    rig.upload(&device, &parcel, seconds(3)).unwrap();
    assert_eq!(ask(seconds(4)).as_slice(), [asked]);
    assert_eq!(rig.booth.list_missing(9).unwrap(), []);
    let of_other = announcing(&heartbeat(other.headset), &[asked]);
    assert_eq!(rig.beat(&other, &of_other, seconds(5)).noted.as_slice(), [asked]);
    rig.booth.delete(&parcel.id, "ana", seconds(6)).unwrap();
    // The device sends it again, even as another headset, and deletes it. It isn't listed as missing.
    for sender in [&device, &other] {
        let beat = announcing(&heartbeat(sender.headset), &[asked]);
        assert_eq!(rig.beat(sender, &beat, seconds(7)).noted.as_slice(), [missed]);
        assert_eq!(rig.upload(sender, &parcel, seconds(8)).unwrap(), ParcelOutcome::Deleted);
    }
    assert_eq!(rig.booth.list_missing(9).unwrap(), []);
}

#[test]
fn a_headset_announces_its_own_and_so_many() {
    let rig = Rig::new();
    let (device, liar) = (rig.enrol(1), rig.enrol(2));
    let parcel = Parcel::new(40, leased(9));
    let announced = parcel.announcement(UploadStatus::Making);
    let beat = heartbeat(liar.headset);
    rig.beat(&liar, &announcing(&beat, &[announced]), START);
    rig.upload(&device, &parcel, START).expect("what others announce is nothing to it");
    assert_eq!(rig.booth.list_missing(9).unwrap(), [], "it came, whoever announced it");
    let mut noted = 0;
    for k in 0..=MAX_ANNOUNCED as u32 {
        let mut id = [255; 16];
        id[..4].copy_from_slice(&k.to_le_bytes());
        let announced = Announcement { id: SculptureId(id), ..announced };
        noted += rig.beat(&liar, &announcing(&beat, &[announced]), START).noted.len();
    }
    assert_eq!(noted, MAX_ANNOUNCED as usize);
}

#[test]
fn a_wipe_is_noted_and_what_it_took_is_lost() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let beat = heartbeat(device.headset);
    // The first start of a new headset also finds an empty outbox.
    let first = Heartbeat { was_wiped: true, ..beat.clone() };
    rig.beat(&device, &first, START);
    assert_eq!(device_of(&rig, device.headset).wiped_at, None);
    let parcel = Parcel::new(40, None);
    let announced = parcel.announcement(UploadStatus::Kept);
    rig.beat(&device, &announcing(&first, &[announced]), seconds(2));
    assert!(!rig.booth.list_missing(9).unwrap()[0].is_lost);
    let wiped = Heartbeat { boot_id: 12, was_wiped: true, ..beat };
    rig.beat(&device, &wiped, seconds(100));
    rig.beat(&device, &wiped, seconds(120));
    assert_eq!(device_of(&rig, device.headset).wiped_at, Some(seconds(100)));
    assert!(rig.booth.list_missing(9).unwrap()[0].is_lost);
}

#[test]
fn a_command_rides_until_it_is_reported_or_dead() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let beat = heartbeat(device.headset);
    assert_eq!(status(rig.booth.ask_command(1, CommandKind::Identify, "ana", START)), 409);
    assert_eq!(status(rig.booth.ask_command(9, CommandKind::Identify, "ana", START)), 404);
    rig.beat(&device, &beat, START);
    let id = rig.booth.ask_command(1, CommandKind::Extend, "ana", START).unwrap();
    assert_eq!(states(&rig, 1, START), [CommandState::Waiting]);
    let command = rig.beat(&device, &beat, seconds(2)).command.expect("it waits");
    assert_eq!((command.id, command.kind), (id, CommandKind::Extend));
    assert_eq!((command.boot_id, command.session_id, command.lives_ms), (11, 21, 8000));
    assert_eq!(states(&rig, 1, seconds(2)), [CommandState::Sent]);
    // The answer was lost: the next one carries the command again, with the rest of its lifetime.
    assert_eq!(rig.beat(&device, &beat, seconds(4)).command.expect("again").lives_ms, 6000);
    let done = reporting(1, id, CommandOutcome::Done);
    assert_eq!(rig.beat(&device, &done, seconds(6)).command, None);
    assert_eq!(states(&rig, 1, seconds(6)), [CommandState::Done]);
    // The report is repeated in each heartbeat, and no answer carries the command.
    assert_eq!(rig.beat(&device, &done, seconds(8)).command, None);

    let late = rig.booth.ask_command(1, CommandKind::Identify, "ana", seconds(20)).unwrap();
    let dead = seconds(20).after(COMMAND_LIFE);
    assert_eq!(states(&rig, 1, dead), [CommandState::Done, CommandState::Expired]);
    assert_eq!(rig.beat(&device, &done, dead).command, None);
    // The headset carried it out in time, but the booth gets the report late.
    rig.beat(&device, &reporting(1, late, CommandOutcome::Done), seconds(40));
    assert_eq!(states(&rig, 1, seconds(40)), [CommandState::Done, CommandState::Done]);
}

#[test]
fn a_command_for_an_ended_visit_or_start_never_rides() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let beat = heartbeat(device.headset);
    let next = HeadsetStatus { session_id: 22, ..beat.status };
    let next_visit = Heartbeat { status: next, ..beat.clone() };
    let next_start = Heartbeat { boot_id: 12, ..beat.clone() };
    for (kind, next, rides) in [
        (CommandKind::End, &next_visit, false),
        (CommandKind::Reset, &next_visit, false),
        (CommandKind::Recentre, &next_visit, true),
        (CommandKind::Recentre, &next_start, false),
        (CommandKind::End, &next_start, false),
    ] {
        rig.beat(&device, &beat, START);
        let id = rig.booth.ask_command(1, kind, "ana", START).unwrap();
        assert_eq!(rig.beat(&device, next, seconds(1)).command.is_some(), rides, "{kind:?}");
        let report = reporting(1, id, CommandOutcome::Refused);
        rig.beat(&device, &report, seconds(2));
    }
    let off = HeadsetStatus { session_id: 0, is_worn: false, ..beat.status };
    let nobody = Heartbeat { status: off, ..beat };
    rig.beat(&device, &nobody, START);
    assert_eq!(status(rig.booth.ask_command(1, CommandKind::Extend, "ana", START)), 409);
    rig.booth.ask_command(1, CommandKind::Identify, "ana", START).expect("it needs no visit");
}

#[test]
fn commands_go_one_by_one_and_so_many_wait() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let beat = heartbeat(device.headset);
    rig.beat(&device, &beat, START);
    let ask = || rig.booth.ask_command(1, CommandKind::Identify, "ana", START).unwrap();
    let ids: Vec<u64> = (0..MAX_WAITING_COMMANDS).map(|_| ask()).collect();
    assert!(ids.is_sorted_by(|one, next| one < next));
    assert_eq!(status(rig.booth.ask_command(1, CommandKind::Identify, "ana", START)), 429);
    let mut beat = beat;
    for id in ids {
        assert_eq!(rig.beat(&device, &beat, START).command.map(|command| command.id), Some(id));
        beat = reporting(1, id, CommandOutcome::Done);
    }
    // The audit log names who asked.
    let count = rig.booth.count::<AuditEntry>("WHERE action = 'identify'", &[]).unwrap();
    assert_eq!(count, MAX_WAITING_COMMANDS);
}
