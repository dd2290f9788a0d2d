//! Blocks of badges' numbers: leased to headsets, resting, and free again.
//!
//! A block without a row is free. It is *leased* to a headset in a heartbeat, and *rests* once it is used up, or the headset
//! lost it, was retired, or was silent for too long. It is free again after [`LATE_DAYS`], when no sculpture that is kept
//! has one of its numbers. A sculpture *claims* its badge by the serial of the block's lease, at most one a number.

use std::collections::{BTreeMap, BTreeSet};

use paros_core::badge::LEASED_BLOCKS;
use paros_core::limits::BLOCK_NUMBERS;
use paros_protocol::limits::MAX_HELD_BLOCKS;
use paros_protocol::{BadgeReport, BlockSerial, HeldBlock, UploadFacts};
use subtle::ConstantTimeEq as _;

use crate::booth::{Booth, Tx};
use crate::limits::{DAY_BLOCKS, LATE_DAYS, MAX_HEADSET_DAY_BLOCKS, SWEEP_BATCH};
use crate::records::{BadgeBlock, BadgeCursor, Device, Sculpture};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::{BoothTime, DAY};

/// Colours whose numbers are leased.
const LEASED_COLOURS: usize = 7;

/// Blocks in a row that are taken, after which all taken ones are read at once.
const ASKED_ONE_BY_ONE: usize = 64;

/// Stands before the parts of a serial, so that no other secret of the site's key is a serial.
const SERIAL_CONTEXT: &[u8] = b"paros badge block v1\0";

/// The changes that a headset's report leads to.
#[derive(Default)]
pub(crate) struct BadgePlan {
    /// Rows to keep.
    blocks: Vec<BadgeBlock>,
    cursor: Option<BadgeCursor>,
    /// The blocks that the headset holds once they are kept.
    pub(crate) held: Vec<HeldBlock>,
}

/// How the leasable numbers are distributed, in blocks. All three together are [`LEASED_BLOCKS`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadgeTotals {
    /// To be leased.
    pub free: u64,
    /// Leased to headsets.
    pub leased: u64,
    /// Resting.
    pub resting: u64,
}

impl BadgeTotals {
    /// `true` if fewer than a tenth are free: staff are warned.
    #[must_use]
    pub const fn are_scarce(&self) -> bool {
        self.free < LEASED_BLOCKS as u64 / 10
    }
}

impl BadgePlan {
    pub(crate) const fn changes_nothing(&self) -> bool {
        self.blocks.is_empty() && self.cursor.is_none()
    }

    pub(crate) fn write(&self, tx: &mut Tx<'_>) -> Result<(), StoreError> {
        self.blocks.iter().try_for_each(|block| tx.put(block))?;
        self.cursor.iter().try_for_each(|cursor| tx.put(cursor))
    }

    fn rest(&mut self, mut block: BadgeBlock, now: BoothTime) {
        rest(&mut block, now);
        self.blocks.push(block);
    }
}

impl Booth {
    /// Counts blocks, for staff.
    ///
    /// # Errors
    /// Those of the store.
    pub fn count_badges(&self) -> Result<BadgeTotals, Refusal> {
        self.view(|tx| {
            let known = tx.count::<BadgeBlock>("", &[])?;
            let leased = tx.count::<BadgeBlock>("WHERE free_on IS NULL", &[])?;
            let free = (LEASED_BLOCKS as u64).saturating_sub(known);
            Ok(BadgeTotals { free, leased, resting: known - leased })
        })
    }

    /// Finds what a headset holds after its report, and what changes by it. Nothing does where it holds two blocks and has
    /// shown no badge since.
    pub(crate) fn plan_badges(
        &self,
        tx: &mut Tx<'_>,
        headset: u32,
        report: &BadgeReport,
        now: BoothTime,
    ) -> Result<BadgePlan, StoreError> {
        let mut plan = BadgePlan::default();
        for reported in &report.blocks {
            self.take_reported(tx, (headset, report.epoch), reported, now, &mut plan)?;
        }
        if plan.held.len() < MAX_HELD_BLOCKS {
            take_unreported(tx, (headset, report), now, &mut plan)?;
        }
        if plan.held.len() < MAX_HELD_BLOCKS {
            self.lease(tx, (headset, report.epoch), now, &mut plan)?;
        }
        Ok(plan)
    }

    /// Leases blocks until the headset holds two; fewer where it, or all headsets together, had a day's number of them.
    fn lease(
        &self,
        tx: &mut Tx<'_>,
        (headset, epoch): (u32, u64),
        now: BoothTime,
        plan: &mut BadgePlan,
    ) -> Result<(), StoreError> {
        let mut cursor = get_cursor(tx)?;
        // Tomorrow's may be there from another process. What lies further ahead is of a clock that was wrong.
        let (today, tomorrow) = (now.day(), now.day().saturating_add(1));
        if !(today..=tomorrow).contains(&cursor.day) {
            (cursor.day, cursor.left_today) = (today, DAY_BLOCKS);
        }
        let is_closed = (tomorrow..=rested_on(now)).contains(&cursor.closed_until);
        if is_closed || cursor.copied_at.is_some() || cursor.is_used_up {
            return Ok(());
        }
        let is_new = |block: &&BadgeBlock| block.leased_at == now && block.free_on.is_none();
        let new = plan.blocks.iter().filter(is_new).count();
        let mut own_left =
            MAX_HEADSET_DAY_BLOCKS.saturating_sub(count_of_day(tx, headset, now)? + new);
        let before = cursor.clone();
        while plan.held.len() < MAX_HELD_BLOCKS && own_left > 0 && cursor.left_today > 0 {
            let planned: BTreeSet<u16> = plan.blocks.iter().map(|block| block.block).collect();
            let Some(block) = find_free(tx, planned, &mut cursor.turn)? else {
                // Not every heartbeat looks again.
                cursor.is_used_up = true;
                break;
            };
            let lease = (block, self.make_serial(block, today));
            let leased = BadgeBlock::leased(lease, (headset, epoch), now);
            plan.held.push(leased.held());
            plan.blocks.push(leased);
            (cursor.left_today, own_left) = (cursor.left_today - 1, own_left - 1);
        }
        plan.cursor = (cursor != before).then_some(cursor);
        Ok(())
    }

    /// The serial of a block's lease on a day. Nobody else can make one, so that the booth knows its own again after a restore.
    fn make_serial(&self, block: u16, day: u32) -> BlockSerial {
        // Days are counted from 1970: until 2149.
        let day = u16::try_from(day).unwrap_or(u16::MAX).to_be_bytes();
        let [a, b, c, d, e, f] =
            self.keys.make_secret(SERIAL_CONTEXT, &[&block.to_le_bytes(), &day]);
        BlockSerial([day[0], day[1], a, b, c, d, e, f])
    }

    /// `true` if this site made a serial for a block later than the lease that it knows, as where it came back from a backup
    /// of before that.
    fn is_later_lease(
        &self,
        known: Option<&BadgeBlock>,
        (block, serial): (u16, BlockSerial),
    ) -> bool {
        let day = u32::from(u16::from_be_bytes([serial.0[0], serial.0[1]]));
        let is_later = known.is_none_or(|known| known.serial[..2] < serial.0[..2]);
        is_later && self.make_serial(block, day).0.ct_eq(&serial.0).into()
    }

    /// Takes a block of a report: notes how far it is used, and whether the headset keeps it.
    fn take_reported(
        &self,
        tx: &mut Tx<'_>,
        (headset, epoch): (u32, u64),
        reported: &HeldBlock,
        now: BoothTime,
        plan: &mut BadgePlan,
    ) -> Result<(), StoreError> {
        let shown = (reported.block, reported.serial);
        let mut known: Option<BadgeBlock> = tx.get(&[&reported.block])?;
        if self.is_later_lease(known.as_ref(), shown) {
            known = Some(BadgeBlock::leased(shown, (headset, epoch), now));
        }
        let is_its = |block: &BadgeBlock| {
            (block.headset, block.epoch, block.serial) == (headset, epoch, reported.serial.0)
                && block.free_on.is_none()
        };
        let Some(mut block) = known.filter(is_its) else { return Ok(()) };
        let before = block.next.replace(reported.next.max(block.next.unwrap_or_default()));
        if block.held().is_used_up() {
            plan.rest(block, now);
            return Ok(());
        }
        plan.held.push(block.held());
        if before != block.next {
            plan.blocks.push(block);
        }
        Ok(())
    }

    /// Returns the number of a sculpture's badge if it is its own: its serial is that of the block's lease, and no sculpture that
    /// is kept has claimed the number.
    pub(crate) fn claim_badge(
        &self,
        tx: &mut Tx<'_>,
        headset: u32,
        facts: &UploadFacts,
        now: BoothTime,
    ) -> Result<Option<u32>, StoreError> {
        let UploadFacts { badge, badge_serial, .. } = facts;
        let (Some(badge), Some(serial)) = (badge, badge_serial) else { return Ok(None) };
        let Some((block, _)) = badge.block_and_place() else { return Ok(None) };
        let mut lease: Option<BadgeBlock> = tx.get(&[&block])?;
        if self.is_later_lease(lease.as_ref(), (block, *serial)) {
            // It rests: nobody said that a headset holds it still. No report has the epoch 0.
            let mut adopted = BadgeBlock::leased((block, *serial), (headset, 0), now);
            rest(&mut adopted, now);
            tx.put(&adopted)?;
            lease = Some(adopted);
        }
        let claimed = tx.count::<Sculpture>("WHERE claimed_badge = ?1", &[&badge.get()])?;
        let is_leased = lease.is_some_and(|lease| lease.serial == serial.0);
        Ok((is_leased && claimed == 0).then_some(badge.get()))
    }

    /// Does what is due once a day: what a restore left to be passed over, blocks of silent headsets, which rest, and blocks
    /// that have rested, which are free.
    pub(crate) fn sweep_badges(&self, now: BoothTime) -> Result<(), Refusal> {
        let is_due = self.update(|tx| {
            let mut cursor = get_cursor(tx)?;
            let before = cursor.clone();
            if let Some(copied_at) = cursor.copied_at.take_if(|copied_at| now >= *copied_at) {
                pass_over(tx, &mut cursor, copied_at, now)?;
            }
            let is_due = cursor.swept_on != now.day();
            if is_due {
                (cursor.swept_on, cursor.is_used_up) = (now.day(), false);
                self.rest_silent(tx, now)?;
            }
            if cursor != before {
                tx.put(&cursor)?;
            }
            Ok(is_due)
        })?;
        let rested = "WHERE free_on <= ?1 ORDER BY block LIMIT ?2";
        while is_due
            && self.update(|tx| {
                let blocks: Vec<BadgeBlock> = tx.find(rested, &[&now.day(), &SWEEP_BATCH])?;
                let count = blocks.len();
                blocks.into_iter().try_for_each(|block| free_unless_claimed(tx, block, now))?;
                Ok(count == SWEEP_BATCH)
            })?
        {}
        Ok(())
    }

    /// Puts blocks to rest whose headsets have said nothing for longer than sculptures are kept and may be late.
    fn rest_silent(&self, tx: &mut Tx<'_>, now: BoothTime) -> Result<(), StoreError> {
        let silence = DAY * (u32::from(self.plan.retention_days) + LATE_DAYS);
        for mut block in tx.find::<BadgeBlock>("WHERE free_on IS NULL", &[])? {
            let device: Option<Device> = tx.get(&[&block.headset])?;
            let heard_at = device.and_then(|device| device.seen_at).unwrap_or(block.leased_at);
            if now.since(heard_at.max(block.leased_at)) > silence {
                rest(&mut block, now);
                tx.put(&block)?;
            }
        }
        Ok(())
    }
}

/// Blocks that are leased to a headset and not in its report. One that it never reported it may not have heard of: it gets
/// the same again. Others it lost, or gave up.
fn take_unreported(
    tx: &mut Tx<'_>,
    (headset, report): (u32, &BadgeReport),
    now: BoothTime,
    plan: &mut BadgePlan,
) -> Result<(), StoreError> {
    let leased = "WHERE headset = ?1 AND free_on IS NULL ORDER BY block";
    for block in tx.find::<BadgeBlock>(leased, &[&headset])? {
        if report.blocks.iter().any(|reported| reported.block == block.block) {
            continue;
        }
        let is_unheard = block.epoch == report.epoch && block.next.is_none();
        if is_unheard && plan.held.len() < MAX_HELD_BLOCKS {
            plan.held.push(block.held());
        } else {
            plan.rest(block, now);
        }
    }
    Ok(())
}

/// A headset is gone for good: its blocks rest.
pub(crate) fn retire_headset(
    tx: &mut Tx<'_>,
    headset: u32,
    now: BoothTime,
) -> Result<(), StoreError> {
    let rest = "UPDATE badge_blocks SET free_on = ?1 WHERE headset = ?2 AND free_on IS NULL";
    tx.run(rest, &[&rested_on(now), &headset]).map(drop)
}

/// Begins the leasing of a booth that came back from a copy. A clock that is before the copy says nothing of what was leased
/// since: until it is right, no block is leased.
pub(crate) fn restore_badges(
    tx: &mut Tx<'_>,
    copied_at: BoothTime,
    now: BoothTime,
) -> Result<(), StoreError> {
    let mut cursor = get_cursor(tx)?;
    // Their headsets may have heard of them since, and used them up.
    let rest = "UPDATE badge_blocks SET free_on = ?1 WHERE free_on IS NULL AND next IS NULL";
    tx.run(rest, &[&rested_on(now)])?;
    cursor.restored_at = now;
    if now < copied_at {
        cursor.copied_at = Some(copied_at);
    } else {
        pass_over(tx, &mut cursor, copied_at, now)?;
    }
    tx.put(&cursor)
}

/// Passes over as many blocks as may have been leased since a copy was made, of those that were free or may have become so.
/// Where these are all, every block rests.
///
/// A day's blocks may have been leased twice, as the booth may have come back from the same copy on each day before.
fn pass_over(
    tx: &mut Tx<'_>,
    cursor: &mut BadgeCursor,
    copied_at: BoothTime,
    now: BoothTime,
) -> Result<(), StoreError> {
    let days = now.day().saturating_sub(copied_at.day());
    let mut left = u64::from(DAY_BLOCKS) * (2 * u64::from(days) + 1);
    let known: BTreeMap<u16, u32> = tx
        .find::<BadgeBlock>("", &[])?
        .iter()
        .map(|block| (block.block, block.free_on.unwrap_or(rested_on(copied_at))))
        .collect();
    let is_maybe_leased =
        |block: u16| known.get(&block).is_none_or(|free_on| *free_on <= now.day());
    for _ in 0..LEASED_BLOCKS {
        if left == 0 {
            break;
        }
        left -= u64::from(is_maybe_leased(block_of_turn(cursor.turn)));
        cursor.turn = next_turn(cursor.turn);
    }
    (cursor.day, cursor.left_today) = (now.day(), DAY_BLOCKS);
    if left > 0 {
        let rest = "UPDATE badge_blocks SET free_on = ?1 WHERE free_on IS NULL";
        tx.run(rest, &[&rested_on(now)])?;
        cursor.closed_until = rested_on(now);
    }
    Ok(())
}

/// When the booth last came back from a backup, in milliseconds; 0 if it never did.
pub(crate) fn store_epoch(tx: &mut Tx<'_>) -> Result<u64, StoreError> {
    Ok(get_cursor(tx)?.restored_at.0)
}

/// Blocks that a headset got in the last 24 hours.
fn count_of_day(tx: &mut Tx<'_>, headset: u32, now: BoothTime) -> Result<usize, StoreError> {
    let day_ago = BoothTime(now.0.saturating_sub(DAY.as_millis() as u64));
    let of_day = "WHERE headset = ?1 AND leased_at >= ?2";
    Ok(tx.count::<BadgeBlock>(of_day, &[&headset, &day_ago])? as usize)
}

/// The next block without a row, and not planned.
fn find_free(
    tx: &mut Tx<'_>,
    mut taken: BTreeSet<u16>,
    turn: &mut u16,
) -> Result<Option<u16>, StoreError> {
    for tried in 0..LEASED_BLOCKS {
        if tried == ASKED_ONE_BY_ONE {
            let all = tx.find::<BadgeBlock>("", &[])?;
            taken.extend(all.iter().map(|block| block.block));
        }
        let block = block_of_turn(*turn);
        *turn = next_turn(*turn);
        let is_known =
            |tx: &mut Tx<'_>| Ok::<_, StoreError>(tx.get::<BadgeBlock>(&[&block])?.is_some());
        if !taken.contains(&block) && (tried >= ASKED_ONE_BY_ONE || !is_known(tx)?) {
            return Ok(Some(block));
        }
    }
    Ok(None)
}

fn get_cursor(tx: &mut Tx<'_>) -> Result<BadgeCursor, StoreError> {
    Ok(tx.get(&[&0u8])?.unwrap_or_default())
}

/// Removes a block's row, unless a sculpture that is kept has one of its numbers: then it is looked at again after that one's
/// last day.
fn free_unless_claimed(
    tx: &mut Tx<'_>,
    mut block: BadgeBlock,
    now: BoothTime,
) -> Result<(), StoreError> {
    let first = u32::from(block.block) * BLOCK_NUMBERS as u32;
    let claims = "WHERE claimed_badge >= ?1 AND claimed_badge < ?2 ORDER BY keep_day DESC";
    let after = first + BLOCK_NUMBERS as u32;
    let last = tx.find_first::<Sculpture>(claims, &[&first, &after])?.map(|kept| kept.keep_day);
    match last {
        None => tx.run("DELETE FROM badge_blocks WHERE block = ?1", &[&block.block]).map(drop),
        Some(last) => {
            // What is past its last day is swept soon.
            block.free_on = Some(last.max(now.day()).saturating_add(1));
            tx.put(&block)
        }
    }
}

fn rest(block: &mut BadgeBlock, now: BoothTime) {
    block.free_on = Some(rested_on(now));
}

/// The first day on which a block is free that rests from now on.
const fn rested_on(now: BoothTime) -> u32 {
    now.day().saturating_add(LATE_DAYS + 1)
}

/// The blocks take turns by colour, so that visitors of a day have badges of all.
const fn block_of_turn(turn: u16) -> u16 {
    let (turn, of_colour) = (turn as usize % LEASED_BLOCKS, LEASED_BLOCKS / LEASED_COLOURS);
    (turn % LEASED_COLOURS * of_colour + turn / LEASED_COLOURS) as u16
}

const fn next_turn(turn: u16) -> u16 {
    ((turn as usize + 1) % LEASED_BLOCKS) as u16
}
