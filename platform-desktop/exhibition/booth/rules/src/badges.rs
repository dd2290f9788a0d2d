//! Blocks of badge numbers: leased to headsets, resting, or free.
//!
//! A block without a row is free. A heartbeat *leases* it to a headset. It *rests* once it is used up, or
//! once the headset lost it, was retired, or was silent for too long. It is free again after [`LATE_DAYS`],
//! if no kept sculpture has one of its numbers. A sculpture *claims* its badge by the serial of the lease;
//! each number has at most one claim.

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

/// Number of colours whose badge numbers are leased.
const LEASED_COLOURS: usize = 7;

/// Number of taken blocks in a row after which all taken blocks are read at once.
const ASKED_ONE_BY_ONE: usize = 64;

/// Domain separation: keeps serials apart from other secrets of the site's key.
const SERIAL_CONTEXT: &[u8] = b"paros badge block v1\0";

/// The changes that follow from a headset's report.
#[derive(Default)]
pub(crate) struct BadgePlan {
    /// Rows to store.
    blocks: Vec<BadgeBlock>,
    cursor: Option<BadgeCursor>,
    /// The blocks that the headset holds once the rows are stored.
    pub(crate) held: Vec<HeldBlock>,
}

/// The distribution of the leasable blocks. The three counts add up to [`LEASED_BLOCKS`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadgeTotals {
    /// Free for a lease.
    pub free: u64,
    /// Leased to headsets.
    pub leased: u64,
    /// Resting.
    pub resting: u64,
}

impl BadgeTotals {
    /// `true` if fewer than a tenth of the blocks are free. Staff are warned then.
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
    /// Counts the blocks, for staff.
    ///
    /// # Errors
    /// Store errors.
    pub fn count_badges(&self) -> Result<BadgeTotals, Refusal> {
        self.view(|tx| {
            let known = tx.count::<BadgeBlock>("", &[])?;
            let leased = tx.count::<BadgeBlock>("WHERE free_on IS NULL", &[])?;
            let free = (LEASED_BLOCKS as u64).saturating_sub(known);
            Ok(BadgeTotals { free, leased, resting: known - leased })
        })
    }

    /// Plans which blocks a headset holds after its report, and which rows change. Nothing changes if the
    /// headset holds two blocks and has shown no badge since its last report.
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

    /// Leases blocks until the headset holds two, within the daily limits of the headset and of all headsets.
    fn lease(
        &self,
        tx: &mut Tx<'_>,
        (headset, epoch): (u32, u64),
        now: BoothTime,
        plan: &mut BadgePlan,
    ) -> Result<(), StoreError> {
        let mut cursor = get_cursor(tx)?;
        // Another process may have reached tomorrow. A day further ahead comes from a wrong clock.
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
                // Later heartbeats skip the search until the daily sweep.
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

    /// Returns the serial of a block's lease on a day. Only this site can make it, so that the booth
    /// recognises its serials after a restore.
    fn make_serial(&self, block: u16, day: u32) -> BlockSerial {
        // Days since 1970 fit 16 bits until 2149.
        let day = u16::try_from(day).unwrap_or(u16::MAX).to_be_bytes();
        let [a, b, c, d, e, f] =
            self.keys.make_secret(SERIAL_CONTEXT, &[&block.to_le_bytes(), &day]);
        BlockSerial([day[0], day[1], a, b, c, d, e, f])
    }

    /// `true` if this site made the serial for a later lease of the block than the known one. This happens
    /// after a restore from a backup that is older than the lease.
    fn is_later_lease(
        &self,
        known: Option<&BadgeBlock>,
        (block, serial): (u16, BlockSerial),
    ) -> bool {
        let day = u32::from(u16::from_be_bytes([serial.0[0], serial.0[1]]));
        let is_later = known.is_none_or(|known| known.serial[..2] < serial.0[..2]);
        is_later && self.make_serial(block, day).0.ct_eq(&serial.0).into()
    }

    /// Processes a block of a report: updates its next number, and decides if the headset keeps it.
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

    /// Returns the badge number of a sculpture if its claim is valid: the serial matches the lease of the
    /// block, and no kept sculpture has claimed the number.
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
            // The adopted block rests, as no headset has reported to hold it. No report has the epoch 0.
            let mut adopted = BadgeBlock::leased((block, *serial), (headset, 0), now);
            rest(&mut adopted, now);
            tx.put(&adopted)?;
            lease = Some(adopted);
        }
        let claimed = tx.count::<Sculpture>("WHERE claimed_badge = ?1", &[&badge.get()])?;
        let is_leased = lease.is_some_and(|lease| lease.serial == serial.0);
        Ok((is_leased && claimed == 0).then_some(badge.get()))
    }

    /// Does the daily work: passes over blocks after a restore, rests blocks of silent headsets, and frees
    /// rested blocks.
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

    /// Rests the blocks of headsets that were silent for longer than the retention period plus [`LATE_DAYS`].
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

/// Processes blocks that are leased to a headset but not in its report. A block that it has never reported
/// may not have reached it: it gets that block again. Any other block was lost or given up, and rests.
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

/// Rests the blocks of a headset that is retired.
pub(crate) fn retire_headset(
    tx: &mut Tx<'_>,
    headset: u32,
    now: BoothTime,
) -> Result<(), StoreError> {
    let rest = "UPDATE badge_blocks SET free_on = ?1 WHERE headset = ?2 AND free_on IS NULL";
    tx.run(rest, &[&rested_on(now), &headset]).map(drop)
}

/// Prepares leasing after a restore from a copy. If the clock is before the copy, the number of later leases
/// is unknown, and no block is leased until the clock is right.
pub(crate) fn restore_badges(
    tx: &mut Tx<'_>,
    copied_at: BoothTime,
    now: BoothTime,
) -> Result<(), StoreError> {
    let mut cursor = get_cursor(tx)?;
    // The headset of such a block may have received it since the copy, and used it up.
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

/// Skips as many blocks as may have been leased since the copy was made, among those that were free or may
/// have become free. If that could be all of them, every leased block rests.
///
/// A day's blocks may have been leased twice, if the booth was restored from this copy every day.
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

/// Returns when the booth was last restored from a backup, in milliseconds; 0 for never.
pub(crate) fn store_epoch(tx: &mut Tx<'_>) -> Result<u64, StoreError> {
    Ok(get_cursor(tx)?.restored_at.0)
}

/// Counts the blocks that were leased to a headset in the last 24 hours.
fn count_of_day(tx: &mut Tx<'_>, headset: u32, now: BoothTime) -> Result<usize, StoreError> {
    let day_ago = BoothTime(now.0.saturating_sub(DAY.as_millis() as u64));
    let of_day = "WHERE headset = ?1 AND leased_at >= ?2";
    Ok(tx.count::<BadgeBlock>(of_day, &[&headset, &day_ago])? as usize)
}

/// Finds the next block that has no row and isn't planned.
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

/// Removes a block's row, unless a kept sculpture has one of its numbers: then the block rests until after
/// that sculpture's last day.
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
            // A sculpture past its last day is swept soon.
            block.free_on = Some(last.max(now.day()).saturating_add(1));
            tx.put(&block)
        }
    }
}

fn rest(block: &mut BadgeBlock, now: BoothTime) {
    block.free_on = Some(rested_on(now));
}

/// Returns the first day on which a block is free again if it rests from now on.
const fn rested_on(now: BoothTime) -> u32 {
    now.day().saturating_add(LATE_DAYS + 1)
}

/// Returns the block of a turn. The colours alternate, so that a day's visitors have badges of all colours.
const fn block_of_turn(turn: u16) -> u16 {
    let (turn, of_colour) = (turn as usize % LEASED_BLOCKS, LEASED_BLOCKS / LEASED_COLOURS);
    (turn % LEASED_COLOURS * of_colour + turn / LEASED_COLOURS) as u16
}

const fn next_turn(turn: u16) -> u16 {
    ((turn as usize + 1) % LEASED_BLOCKS) as u16
}
