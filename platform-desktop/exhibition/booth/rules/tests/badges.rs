//! Badge blocks: leased, resting, and free again; and which sculpture owns a badge.

use super::common::*;
use super::restore::restored;
use paros_booth_rules::limits::{DAY_BLOCKS, LATE_DAYS, MAX_HEADSET_DAY_BLOCKS};
use paros_booth_rules::records::{BadgeBlock, BadgeCursor, Device, Sculpture};
use paros_booth_rules::{BadgeTotals, BoothTime, FoundByBadge, Transaction, update, view};
use paros_booth_sqlite::SqliteStore;
use paros_core::badge::{BadgeNumber, LEASED_BLOCKS};

/// The retention of the test rig's plan, in days.
const RETENTION: u64 = 30;

fn of_epoch(epoch: u64, blocks: &[HeldBlock]) -> BadgeReport {
    BadgeReport { epoch, blocks: blocks.to_vec() }
}

fn at_place(held: HeldBlock, next: u8) -> HeldBlock {
    HeldBlock { next, ..held }
}

fn row(rig: &Rig, block: u16) -> Option<BadgeBlock> {
    view(rig.store.as_ref(), |tx| tx.get(&[&block])).expect("a store")
}

fn totals(rig: &Rig) -> (u64, u64) {
    let BadgeTotals { free, leased, resting } = rig.booth.count_badges().unwrap();
    assert_eq!(free + leased + resting, LEASED_BLOCKS as u64);
    (leased, resting)
}

/// Sends a parcel. Returns the badge number that it owns.
fn claim(rig: &Rig, device: &Device, parcel: &Parcel, now: BoothTime) -> Option<u32> {
    rig.upload(device, parcel, now).expect("it is kept all the same");
    rig.booth.find_sculpture(&parcel.id).expect("it is kept").claimed_badge
}

#[test]
fn a_headset_holds_two_blocks_and_gets_the_same_until_it_has_heard_of_them() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    let held = rig.lease(&device, 5, START);
    assert_eq!(held.len(), 2);
    assert_ne!(held[0].block / 4096, held[1].block / 4096, "of two colours");
    // The answer was lost.
    assert_eq!(rig.lease(&device, 5, seconds(2)), held);
    let others = rig.lease(&other, 5, START);
    assert!(others.iter().all(|block| held.iter().all(|mine| mine.block != block.block)));
    // The greater index counts, of booth or headset: the headset may be behind.
    let used = [at_place(held[0], 9), held[1]];
    assert_eq!(rig.report(&device, &of_epoch(5, &used), seconds(4)), used);
    assert_eq!(rig.report(&device, &of_epoch(5, &held), seconds(6)), used);
    assert_eq!(totals(&rig), (4, 0));
}

#[test]
fn a_used_up_block_rests_and_another_comes_in_the_same_exchange() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let held = rig.lease(&device, 5, START);
    let used = [at_place(held[0], 64), at_place(held[1], 1)];
    let next = rig.report(&device, &of_epoch(5, &used), seconds(2));
    assert_eq!((next.len(), next[0]), (2, used[1]));
    assert_eq!(totals(&rig), (2, 1));
    // The answer was lost: the retry gets the same answer.
    assert_eq!(rig.report(&device, &of_epoch(5, &used), seconds(4)), next);
    assert_eq!(rig.report(&device, &of_epoch(5, &next), seconds(6)), next);
    assert_eq!(totals(&rig), (2, 1));
}

#[test]
fn blocks_of_an_epoch_before_rest_and_late_reports_of_it_take_none_away() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let before = rig.lease(&device, 5, START);
    let after = rig.lease(&device, 6, seconds(100));
    assert!(after.iter().all(|held| before.iter().all(|old| old.block != held.block)));
    assert_eq!(totals(&rig), (2, 2));
    // A late report of the former epoch costs blocks. The headset still owns what it showed of them.
    rig.report(&device, &of_epoch(5, &before), seconds(101));
    let again = rig.report(&device, &of_epoch(6, &after), seconds(102));
    assert_eq!(again.len(), 2);
    let parcel = Parcel::of_block(1, &after[0], 3);
    assert!(claim(&rig, &device, &parcel, seconds(103)).is_some());
}

#[test]
fn what_a_headset_gave_up_or_copied_is_not_its_own() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    let held = rig.lease(&device, 5, START);
    rig.report(&device, &of_epoch(5, &held), seconds(1));
    // The headset has reported both blocks, and now only one of them.
    let next = rig.report(&device, &of_epoch(5, &held[..1]), seconds(2));
    assert_eq!((next.len(), next[0]), (2, held[0]));
    assert_ne!(next[1].block, held[1].block);
    // The block is reported by another headset, or with another serial.
    let copied = rig.report(&other, &of_epoch(5, &held[..1]), seconds(3));
    assert!(copied.iter().all(|block| block.block != held[0].block));
    let forged = HeldBlock { serial: BlockSerial([1; 8]), ..held[0] };
    let told = rig.report(&device, &of_epoch(5, &[forged]), seconds(4));
    assert!(told.iter().all(|block| block.serial != forged.serial));
}

#[test]
fn a_block_is_free_once_it_has_rested_and_no_sculpture_has_its_numbers() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let [claimed, unclaimed] = rig.lease(&device, 5, START)[..] else { panic!("two blocks") };
    let parcel = Parcel::of_block(1, &claimed, 0);
    assert!(claim(&rig, &device, &parcel, days(2)).is_some());
    rig.booth.revoke_device(device.headset, "ana", days(3)).unwrap();
    assert_eq!(totals(&rig), (0, 2), "a headset that is shut out");
    let late = u64::from(LATE_DAYS);
    let last_day = days(40).day();
    rig.booth.keep_until(&parcel.id, last_day, "ana", days(4)).unwrap();
    for (day, is_unclaimed_free) in [(3 + late, false), (4 + late, true), (5 + late, true)] {
        rig.sweep(days(day));
        assert_eq!(row(&rig, unclaimed.block).is_none(), is_unclaimed_free, "day {day}");
        assert!(row(&rig, claimed.block).is_some());
    }
    rig.sweep(days(34));
    rig.sweep(days(40));
    assert!(row(&rig, claimed.block).is_some(), "it is kept until the end of that day");
    rig.sweep(days(41));
    assert!(row(&rig, claimed.block).is_none());
}

#[test]
fn a_silent_headsets_blocks_rest_and_it_leases_others_when_it_returns() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let held = rig.lease(&device, 5, START);
    let silence = RETENTION + u64::from(LATE_DAYS);
    rig.sweep(days(silence));
    assert_eq!(totals(&rig), (2, 0));
    rig.sweep(days(silence + 1));
    assert_eq!(totals(&rig), (0, 2));
    let used = [at_place(held[0], 30), held[1]];
    let next = rig.report(&device, &of_epoch(5, &used), days(silence + 2));
    assert_eq!(next.len(), 2);
    assert!(next.iter().all(|new| held.iter().all(|old| old.block != new.block)));
    // The headset owns the badges that it showed meanwhile, as the block wasn't leased again.
    let parcel = Parcel::of_block(1, &held[0], 29);
    assert!(claim(&rig, &device, &parcel, days(silence + 2)).is_some());
}

#[test]
fn a_badge_is_the_own_of_one_sculpture_that_shows_its_serial() {
    let rig = Rig::new();
    let (device, liar) = (rig.enrol(1), rig.enrol(2));
    let held = rig.lease(&device, 5, START);
    let theirs = rig.lease(&liar, 6, START);
    let right = Parcel::of_block(2, &held[0], 3);
    let number = right.facts.badge.expect("a number");
    // Stolen badges arrive before the right one, from a headset that never leased the block.
    for (id, serial) in [(1, BlockSerial([9; 8])), (3, theirs[0].serial)] {
        let stolen = Parcel::with_serial(id, Some(number), serial);
        assert_eq!(claim(&rig, &liar, &stolen, START), None);
    }
    assert_eq!(claim(&rig, &device, &right, seconds(1)), Some(number.get()));
    let twice = Parcel::of_block(4, &held[0], 3);
    assert_eq!(claim(&rig, &device, &twice, seconds(2)), None);
    let without = Parcel::of_facts(UploadFacts {
        badge_serial: None,
        ..Parcel::of_block(5, &held[0], 4).facts
    });
    assert_eq!(claim(&rig, &device, &without, seconds(2)), None);
    // A search by badge finds the owner first, then the newest.
    let found = rig.booth.find_by_badge(&number.badge().into()).unwrap();
    let FoundByBadge::Exact(found) = found else { panic!("a right badge") };
    let ids: Vec<u8> = found.kept.iter().map(|kept| kept.id[0]).collect();
    assert_eq!(ids, [2, 4, 1, 3]);
    // After the deletion the number is free, and the serial still proves the lease.
    rig.booth.delete(&right.id, "ana", seconds(4)).unwrap();
    let after = Parcel::of_block(6, &held[0], 3);
    assert_eq!(claim(&rig, &device, &after, seconds(5)), Some(number.get()));
    for id in [7, 8] {
        let provisional = Parcel::new(id, Some(BadgeNumber::provisional(5)));
        rig.upload(&device, &provisional, seconds(6)).unwrap();
        let kept = rig.booth.find_sculpture(&provisional.id).unwrap();
        assert!(kept.claimed_badge.is_none() && !kept.is_badge_lapsed());
    }
}

#[test]
fn a_headset_gets_so_many_blocks_a_day_and_all_together_so_many() {
    let rig = Rig::new();
    let liar = rig.enrol(250);
    for epoch in 1..100 {
        rig.lease(&liar, epoch, seconds(epoch));
    }
    let (leased, resting) = totals(&rig);
    assert_eq!((leased + resting) as usize, MAX_HEADSET_DAY_BLOCKS);
    // A made-up number of a free block gives no claim.
    let made_up = Parcel::new(1, BadgeNumber::of_block(20_000, 0));
    assert_eq!(claim(&rig, &liar, &made_up, seconds(200)), None);
    assert_eq!(row(&rig, 20_000), None);
    for byte in 1..=99 {
        let device = rig.enrol(byte);
        (1..4).for_each(|epoch| drop(rig.lease(&device, epoch, seconds(300 + epoch))));
    }
    let (leased, resting) = totals(&rig);
    assert_eq!(leased + resting, u64::from(DAY_BLOCKS));
    let late = rig.enrol(249);
    assert_eq!(rig.lease(&late, 1, seconds(400)), []);
    assert_eq!(rig.lease(&late, 1, days(1)).len(), 2);
    assert_eq!(rig.lease(&liar, 200, days(2)).len(), 2);
}

/// Makes a booth that is restored from a backup of the time `copied_at`.
fn restore(rig: &Rig, copy: SqliteStore, copied_at: BoothTime, now: BoothTime) -> Rig {
    let again = restored(copy, rig.files.clone());
    again.booth.make_restored(&[], copied_at, now).unwrap();
    again
}

/// Regression test: the booth once refused such a headset for ever, for the numbers of former records.
#[test]
fn a_headset_goes_on_with_its_blocks_after_a_restore() {
    let rig = Rig::new();
    let (early, late) = (rig.enrol(1), rig.enrol(2));
    let held = rig.lease(&early, 5, START);
    rig.report(&early, &of_epoch(5, &held), seconds(1));
    let unheard = rig.lease(&late, 5, START);
    let copy = copy_of(rig.store.as_ref());
    // Since the backup, the first headset used a block up. The second received its blocks and used them up.
    let used = [at_place(held[0], 64), at_place(held[1], 20)];
    let after = rig.report(&early, &of_epoch(5, &used), seconds(100));
    let used_up = unheard.iter().map(|block| at_place(*block, 64)).collect::<Vec<_>>();
    let fresh = rig.report(&late, &of_epoch(5, &used_up), seconds(100));
    let again = restore(&rig, copy, seconds(50), days(1));
    // Their blocks are recognised by the serials. Blocks that they gave up aren't leased to them again.
    assert_eq!(again.report(&early, &of_epoch(5, &after), days(1)), after);
    assert_eq!(again.report(&late, &of_epoch(5, &fresh), days(1)), fresh);
    // Blocks that were leased since aren't leased to others.
    let next = again.enrol(3);
    let others = again.lease(&next, 1, days(1));
    assert_eq!(others.len(), 2);
    let known = [&held, &unheard, &after, &fresh].map(Vec::as_slice).concat();
    assert!(others.iter().all(|new| known.iter().all(|old| old.block != new.block)));
    // Sculptures that the booth lost are sent again and own their badges, of current and former blocks.
    for (id, device, block, place) in
        [(1, &early, held[0], 63), (2, &early, after[1], 0), (3, &late, unheard[1], 7)]
    {
        assert!(claim(&again, device, &Parcel::of_block(id, &block, place), days(1)).is_some());
    }
}

#[test]
fn all_numbers_rest_where_every_block_may_have_been_leased_since_a_copy() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let held = rig.lease(&device, 5, days(1));
    rig.report(&device, &of_epoch(5, &held), days(1));
    let now = days(60);
    let again = restore(&rig, copy_of(rig.store.as_ref()), days(1), now);
    assert_eq!(again.report(&device, &of_epoch(5, &held), now), []);
    let after = days(61 + u64::from(LATE_DAYS));
    assert_eq!(again.report(&device, &of_epoch(5, &held), after).len(), 2);
    // The headset owns the badge that it showed.
    assert!(claim(&again, &device, &Parcel::of_block(1, &held[0], 0), after).is_some());
}

#[test]
fn nothing_is_leased_after_a_restore_until_the_clock_is_right() {
    let rig = Rig::new();
    let devices = [1, 2].map(|byte| rig.enrol(byte));
    let held = rig.lease(&devices[0], 5, days(10));
    rig.report(&devices[0], &of_epoch(5, &held), days(10));
    let copy = copy_of(rig.store.as_ref());
    let since = rig.lease(&devices[1], 5, days(11));
    let again = restore(&rig, copy, days(10), days(2));
    again.sweep(days(3));
    assert_eq!(again.lease(&devices[1], 6, days(3)), []);
    assert_eq!(
        again.report(&devices[0], &of_epoch(5, &held), days(3)),
        held,
        "it holds them still"
    );
    // The clock is corrected. Blocks that may have been leased since are passed over.
    again.sweep(days(12));
    let other = again.enrol(3);
    let leased = again.lease(&other, 1, days(12));
    assert_eq!(leased.len(), 2);
    assert!(leased.iter().all(|new| since.iter().all(|old| old.block != new.block)));
}

/// Leasing skips taken blocks, and a restore doesn't count them.
#[test]
fn a_restore_passes_over_what_may_have_been_leased_beyond_taken_blocks() {
    let rig = Rig::new();
    let devices = [1, 2].map(|byte| rig.enrol(byte));
    let held = rig.lease(&devices[0], 5, START);
    let taken = row(&rig, held[0].block).expect("it is leased");
    // The next blocks rest for a long time.
    let block_of_turn = |turn: u16| turn % 7 * (LEASED_BLOCKS as u16 / 7) + turn / 7;
    let rows = (2..300).map(|turn| BadgeBlock {
        block: block_of_turn(turn),
        free_on: Some(days(500).day()),
        ..taken.clone()
    });
    let put_all = |tx: &mut (dyn Transaction + '_)| rows.clone().try_for_each(|row| tx.put(&row));
    update(rig.store.as_ref(), put_all).unwrap();
    let copy = copy_of(rig.store.as_ref());
    let since = rig.lease(&devices[1], 5, days(2));
    assert_eq!(since[0].block, block_of_turn(300));
    let again = restore(&rig, copy, START, seconds(120));
    let other = again.enrol(3);
    let leased = again.lease(&other, 1, days(2));
    assert_eq!(leased.len(), 2);
    assert_eq!(leased[0].block, block_of_turn(300 + DAY_BLOCKS));
}

/// A visitor's badge reveals its block. A lying headset may make up a serial for it.
#[test]
fn a_liar_takes_no_block_that_a_restored_booth_forgot() {
    let rig = Rig::new();
    let (device, liar) = (rig.enrol(1), rig.enrol(2));
    let copy = copy_of(rig.store.as_ref());
    let held = rig.lease(&device, 5, START);
    let again = restore(&rig, copy, START, seconds(60));
    let day = held[0].serial.0;
    for (id, serial) in
        [[9; 8], [255; 8], [day[0], day[1], 0, 0, 0, 0, 0, 1]].into_iter().enumerate()
    {
        let forged = HeldBlock { serial: BlockSerial(serial), ..held[0] };
        let told = again.report(&liar, &of_epoch(6, &[forged]), seconds(60));
        assert!(told.iter().all(|block| block.block != held[0].block));
        let parcel = Parcel::of_block(10 + id as u8, &forged, 0);
        assert_eq!(claim(&again, &liar, &parcel, seconds(60)), None);
    }
    assert_eq!(again.report(&device, &of_epoch(5, &held), seconds(61)), held);
    assert!(claim(&again, &device, &Parcel::of_block(3, &held[0], 0), seconds(62)).is_some());
}

#[test]
fn a_clock_that_was_ahead_once_stops_no_lease() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    rig.lease(&device, 1, days(400));
    for day in 0..40 {
        for epoch in 0..15 {
            assert_eq!(
                rig.lease(&device, 2 + 100 * day + epoch, days(2 * day)).len(),
                2,
                "day {day}"
            );
        }
    }
}

#[test]
fn a_headset_that_was_shut_out_a_moment_ago_is_leased_nothing() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    rig.booth.revoke_device(device.headset, "ana", START).unwrap();
    assert_eq!(rig.lease(&device, 1, START), []);
}

/// Regression test: a badge was once shown twice, as an upload was stuck beyond the retention and its number
/// was free meanwhile.
#[test]
fn an_upload_that_was_stuck_for_too_long_has_its_badge_lapsed() {
    let rig = Rig::new();
    let (stuck, other) = (rig.enrol(1), rig.enrol(2));
    let held = rig.lease(&stuck, 5, START);
    let parcel = Parcel::of_block(1, &held[0], 0);
    // The headset was wiped, except for its parcel: its blocks rest, and become free.
    rig.lease(&stuck, 6, seconds(60));
    rig.sweep(days(u64::from(LATE_DAYS) + 1));
    assert!(row(&rig, held[0].block).is_none());
    // Set the turn back to this block.
    let turn_back = |tx: &mut (dyn Transaction + '_)| {
        let cursor: BadgeCursor = tx.get(&[&0u8])?.expect("blocks were leased");
        tx.put(&BadgeCursor { turn: 0, ..cursor })
    };
    update(rig.store.as_ref(), turn_back).unwrap();
    let again = rig.lease(&other, 8, days(13));
    assert_eq!(again[0].block, held[0].block);
    assert!(claim(&rig, &other, &Parcel::of_block(2, &again[0], 0), days(13)).is_some());
    assert_eq!(
        claim(&rig, &stuck, &parcel, days(14)),
        None,
        "it is kept, and its badge is another's"
    );
    assert_eq!(rig.booth.count::<Sculpture>("WHERE claimed_badge IS NOT NULL", &[]).unwrap(), 1);
}
