//! Headset identity: authentication, enrolment and exclusion.

use paros_protocol::{ContentHash, DeviceHint, DeviceToken};
use subtle::ConstantTimeEq as _;

use crate::audit::{Subject, note};
use crate::badges::retire_headset;
use crate::booth::{Booth, Tx};
use crate::limits::{MAX_HEADSETS, SILENCE_OF_WIPED};
use crate::reason::Reason;
use crate::records::Device;
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

/// The refusal for a headset that staff excluded.
const SHUT_OUT: Refusal = Refusal::Forbidden(Reason::ShutOut);

/// A device that asks to become a headset.
#[derive(Clone, Debug)]
pub(crate) struct NewDevice {
    pub(crate) token_hash: ContentHash,
    pub(crate) hint: DeviceHint,
    pub(crate) name: String,
}

impl Booth {
    /// Finds the headset that has this token.
    ///
    /// # Errors
    /// [`Refusal::UnknownToken`] if no headset has it, [`Refusal::Forbidden`] if the headset was excluded; or
    /// a store error. An unknown device may enrol again, such as after a restore from an older backup.
    pub fn authenticate(&self, token: &DeviceToken) -> Result<Device, Refusal> {
        let hash = ContentHash::of(&token.0);
        let devices = self.view(|tx| tx.find::<Device>("WHERE token_hash = ?1", &[&hash.0]))?;
        // Compare the full hash in constant time, whatever the index found.
        let is_its = |device: &Device| bool::from(device.token_hash.ct_eq(&hash.0));
        let mut devices = devices.into_iter().filter(is_its).peekable();
        let is_known = devices.peek().is_some();
        let let_in = devices.find(|device| device.revoked_at.is_none());
        let_in.ok_or(if is_known { SHUT_OUT } else { Refusal::UnknownToken })
    }

    /// Returns all headsets, in the order of their numbers.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_devices(&self) -> Result<Vec<Device>, Refusal> {
        self.view(|tx| tx.find("ORDER BY headset", &[]))
    }

    /// Excludes a headset that was lost, broken or sent home, and rests its badge blocks.
    ///
    /// # Errors
    /// There is no headset of this number; or a store error.
    pub fn revoke_device(
        &self,
        headset: u32,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let device: Option<Device> = tx.get(&[&headset])?;
            let mut device = device.ok_or(Refusal::NotFound(Reason::NoHeadset))?;
            device.revoked_at = Some(now);
            tx.put(&device)?;
            retire_headset(tx, headset, now)?;
            let subject = Subject { headset: Some(headset), ..Subject::default() };
            Ok(note(tx, now, Some(account), "revoke", subject)?)
        })
    }
}

/// Finds the headset with a token of this hash, unless it was excluded.
pub(crate) fn find_by_token(
    tx: &mut Tx<'_>,
    token_hash: &ContentHash,
) -> Result<Option<Device>, StoreError> {
    tx.find_first("WHERE token_hash = ?1 AND revoked_at IS NULL", &[&token_hash.0])
}

/// Finds the headset that a wiped device with this hint may be: the only one with the hint that isn't
/// excluded, if it has been silent for long enough.
pub(crate) fn find_wiped(
    tx: &mut Tx<'_>,
    hint: &DeviceHint,
    now: BoothTime,
) -> Result<Option<Device>, StoreError> {
    let mut found: Vec<Device> =
        tx.find("WHERE hint = ?1 AND revoked_at IS NULL LIMIT 2", &[&hint.0])?;
    let is_silent = |device: &Device| {
        device.seen_at.is_none_or(|seen_at| now.since(seen_at) > SILENCE_OF_WIPED)
    };
    Ok(if found.len() == 1 { found.pop().filter(is_silent) } else { None })
}

/// Enrols a device: as a new headset, or as the headset `number`, whose old token becomes invalid.
pub(crate) fn enrol(
    tx: &mut Tx<'_>,
    new: &NewDevice,
    number: Option<u32>,
    now: BoothTime,
) -> Result<u32, Refusal> {
    let known: Option<Device> = match number {
        Some(number) => tx.get(&[&number])?,
        None => None,
    };
    let headset = match &known {
        Some(device) => device.headset,
        None => next_number(tx)?,
    };
    tx.put(&Device {
        headset,
        token_hash: new.token_hash.0,
        hint: new.hint.0,
        name: new.name.clone(),
        enrolled_at: now,
        revoked_at: None,
        // The heartbeat reports a wipe itself. The device may have lost only its token.
        wiped_at: known.as_ref().and_then(|device| device.wiped_at),
        seen_at: known.as_ref().and_then(|device| device.seen_at),
        status: known.map_or_else(Vec::new, |device| device.status),
    })?;
    Ok(headset)
}

/// Returns the number after the greatest one, so that a number is never reused.
fn next_number(tx: &mut Tx<'_>) -> Result<u32, Refusal> {
    let active = tx.count::<Device>("WHERE revoked_at IS NULL", &[])?;
    if active >= MAX_HEADSETS {
        return Err(Refusal::Conflict(Reason::HeadsetsFull));
    }
    let last: Option<Device> = tx.find_first("ORDER BY headset DESC", &[])?;
    let number = last.map_or(Some(1), |device| device.headset.checked_add(1));
    number.ok_or(Refusal::Conflict(Reason::NumbersFull))
}
