//! The journal comes back as it was written, and damage is noticed.

use paros_core::codec::BadBytes;
use paros_core::internals::checksum;
use paros_core::limits::MAX_OUTBOX_ENTRIES;
use paros_core::outbox::messages::{ReceiptOutcome, SiteId};
use paros_core::outbox::{EntryState, Outbox, OutboxOwner, UploadAnswer};

use super::{BOOT, OWNER, SETTINGS, answer, hash_of, id, keeping, receipt, state};

pub(super) fn save(outbox: &Outbox) -> Vec<u8> {
    let mut bytes = Box::new([0; Outbox::JOURNAL_BYTES]);
    outbox.save(&mut bytes);
    bytes.to_vec()
}

pub(super) fn load(bytes: &[u8]) -> Result<Box<Outbox>, BadBytes> {
    Outbox::load(bytes, OWNER, SETTINGS, BOOT + 1).map(Box::new)
}

/// One sculpture in each state, and one that gave up an id.
fn mixed() -> Box<Outbox> {
    let mut outbox = keeping([1, 2, 3, 4, 6]);
    outbox.announce(id(5), None).expect("room");
    let request = outbox.begin_upload(0).expect("the newest");
    answer(&mut outbox, &request, UploadAnswer::Refused);
    outbox.take_receipt(&receipt(id(1), ReceiptOutcome::Kept)).expect("its own");
    outbox.take_receipt(&receipt(id(2), ReceiptOutcome::Deleted)).expect("its own");
    outbox.renew(id(3), id(7), hash_of(id(7))).expect("it waits");
    outbox.announce(id(8), None).expect("room");
    outbox.note_parcel_missing(id(8)).expect("announced");
    outbox.pass_time(90_000);
    assert!(outbox.begin_upload(0).is_some());
    outbox
}

#[test]
fn a_start_knows_all_but_what_was_under_way() {
    let outbox = mixed();
    let loaded = load(&save(&outbox)).expect("a journal");
    assert!(!loaded.is_journal_due());
    let states = [1, 2, 7, 4, 6, 5, 8].map(|number| state(&loaded, number).expect("it was there"));
    let receipted = EntryState::Receipted { seconds: 90 };
    let (kept, refused) = (EntryState::Kept, EntryState::Refused);
    let (announced, lost) = (EntryState::Announced, EntryState::Lost);
    assert_eq!(states, [receipted, EntryState::Deletable, kept, kept, refused, announced, lost]);
    assert_eq!(loaded.find(id(7)).and_then(|entry| entry.replaced), Some(id(3)));
    assert_eq!(loaded.bytes_here(), outbox.bytes_here());
    assert_eq!(save(&loaded), save(&outbox), "as it was");
}

#[test]
fn a_receipts_seconds_are_saved_now_and_then() {
    let mut outbox = keeping([1]);
    outbox.take_receipt(&receipt(id(1), ReceiptOutcome::Kept)).expect("its own");
    outbox.note_journal_written();
    outbox.pass_time(599_000);
    assert!(!outbox.is_journal_due());
    outbox.pass_time(600_000);
    assert!(outbox.is_journal_due());
    let mut outbox = keeping([1]);
    outbox.pass_time(1_000_000);
    assert!(!outbox.is_journal_due(), "nothing to tell");
}

#[test]
fn what_another_site_signed_for_counts_for_nothing() {
    let bytes = save(&mixed());
    let owner = OutboxOwner { site: SiteId([8; 16]), ..OWNER };
    let loaded = Outbox::load(&bytes, owner, SETTINGS, BOOT).map(Box::new).expect("a journal");
    assert_eq!(state(&loaded, 1), Some(EntryState::Kept), "this booth hasn't it");
    assert_eq!(state(&loaded, 2), Some(EntryState::Deletable), "somebody wished it deleted");
    assert!(loaded.is_journal_due());
}

#[test]
fn damage_is_noticed_wherever_it_is() {
    let bytes = save(&mixed());
    for at in (0..bytes.len()).step_by(13).chain(0..700).chain(bytes.len() - 8..bytes.len()) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(load(&damaged).is_err(), "at {at}");
    }
    for len in [0, 3, 100, bytes.len() - 1] {
        assert!(load(&bytes[..len]).is_err(), "{len} bytes");
    }
    assert!(load(&[&bytes[..], &[0]].concat()).is_err(), "a byte more");
}

/// Journals with a right checksum that no outbox writes.
#[test]
fn forgeries_are_refused() {
    const FIRST: usize = 29;
    const ENTRY: usize = 77;
    let bytes = save(&mixed());
    let body = bytes.len() - 8;
    let too_many = (MAX_OUTBOX_ENTRIES as u16 + 1).to_le_bytes();
    let announced = FIRST + 5 * ENTRY;
    let faults: &[(usize, &[u8], &str)] = &[
        (0, b"PBLS", "the magic"),
        (4, &[2], "version 1"),
        (6, &[0; 16], "a site's id"),
        (22, &[0; 4], "a headset's number"),
        (26, &[2], "0 or 1"),
        (27, &too_many, "up to 256"),
        (27, &[6, 0], "zeros after"),
        (FIRST, &[0; 16], "a sculpture's id"),
        (FIRST + 16, &[6], "where a sculpture stands"),
        (FIRST + 16, &[1], "where a sculpture stands"),
        (FIRST + 25, &[0; 32], "a parcel's hash"),
        (FIRST + 57, &64u32.to_le_bytes(), "a parcel's hash"),
        (FIRST + 57, &u32::MAX.to_le_bytes(), "a parcel's hash"),
        (announced + 57, &200u32.to_le_bytes(), "a parcel's hash"),
        (announced + 16, &[1], "a parcel's hash"),
        (FIRST + ENTRY, &[1; 16], "another sculpture"),
        (FIRST + ENTRY + 61, &[1; 16], "another sculpture"),
        (FIRST + 61, &[1; 16], "another sculpture"),
    ];
    for &(at, values, expected) in faults {
        let mut forged = bytes.clone();
        forged[at..at + values.len()].copy_from_slice(values);
        let sum = checksum(&forged[..body]).to_le_bytes();
        forged[body..].copy_from_slice(&sum);
        let bad = load(&forged).expect_err(expected);
        assert!(bad.expected.contains(expected), "at {at}: {bad:?}");
    }
}
