//! Uploads: parcels are validated as a whole, and stored.

use paros_core::badge::BadgeNumber;
use paros_protocol::limits::MAX_PARCEL_FILE_BYTES;
use paros_protocol::{ContentHash, Parcel, ParcelFault, ParcelOutcome, SculptureId, UploadFacts};

use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx};
use crate::clock::seen_time;
use crate::parcel_files::{KeptName, KeptPart};
use crate::reason::Reason;
use crate::records::{Device, ExportState, Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::{StoreError, view};
use crate::time::BoothTime;
use crate::words::picture_bits;

/// The outcome of the import of a parcel that staff copied from a headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ImportOutcome {
    /// The parcel is now stored.
    Taken,
    /// The booth already had the parcel.
    Known,
    /// The booth had the parcel, and it was deleted.
    Deleted,
}

/// A check that the packed volume and the packed trace match the head of their parcel. Uses no more memory
/// than the head declares.
pub type DecodeParcel<'a> = dyn Fn(&UploadFacts, &[u8], &[u8]) -> Result<(), String> + 'a;

impl Booth {
    /// Stores a parcel. Idempotent: the same parcel, from any headset, has the same outcome. `file` is the
    /// parcel with its SHA-256 at the end.
    ///
    /// # Errors
    /// `TooLarge`; `BadRequest` if the hash doesn't match; `Undecodable` if the bytes aren't a sculpture;
    /// `Conflict` if another parcel of this id was stored; or an error of store or disk.
    pub fn take_parcel(
        &self,
        headset: u32,
        id: SculptureId,
        file: &[u8],
        decode: &DecodeParcel<'_>,
        now: BoothTime,
    ) -> Result<ParcelOutcome, Refusal> {
        let parcel = read_parcel(id, file)?;
        let known = view(self.store.as_ref(), |tx| find_outcome(tx, id, parcel.hash()))?;
        if let Some(outcome) = known {
            return Ok(outcome);
        }
        decode(parcel.facts(), parcel.volume(), parcel.trace()).map_err(Refusal::Undecodable)?;
        self.keep_parcel(headset, &parcel, now)
    }

    /// Stores a parcel that staff copied from a headset's disk, as if the headset had sent it. The headset
    /// may be excluded.
    ///
    /// # Errors
    /// No headset has this number; and the errors of [`Booth::take_parcel`].
    pub fn import_parcel(
        &self,
        headset: u32,
        (id, file): (SculptureId, &[u8]),
        decode: &DecodeParcel<'_>,
        account: &str,
        now: BoothTime,
    ) -> Result<ImportOutcome, Refusal> {
        self.check_headset(headset)?;
        let hash = read_parcel(id, file)?.hash();
        let known = view(self.store.as_ref(), |tx| find_outcome(tx, id, hash))?;
        let outcome = match known {
            Some(ParcelOutcome::Kept) => return Ok(ImportOutcome::Known),
            Some(outcome) => outcome,
            None => self.take_parcel(headset, id, file, decode, now)?,
        };
        if outcome == ParcelOutcome::Deleted {
            return Ok(ImportOutcome::Deleted);
        }
        let subject = Subject { headset: Some(headset), sculpture: Some(id.0), badge: None };
        self.update(|tx| Ok(note(tx, now, Some(account), "import", subject)?))?;
        Ok(ImportOutcome::Taken)
    }

    /// Checks that a headset has this number. The headset may be excluded.
    ///
    /// # Errors
    /// No headset has this number; or a store error.
    pub fn check_headset(&self, headset: u32) -> Result<(), Refusal> {
        let device: Option<Device> = self.view(|tx| tx.get(&[&headset]))?;
        device.map(drop).ok_or(Refusal::NotFound(Reason::NoHeadset))
    }

    /// Stores a parcel. Writes the files before the record, so that every record has its files.
    fn keep_parcel(
        &self,
        headset: u32,
        parcel: &Parcel<&[u8]>,
        now: BoothTime,
    ) -> Result<ParcelOutcome, Refusal> {
        let (facts, hash, trace) = (parcel.facts(), parcel.hash(), parcel.trace());
        let UploadFacts { id, badge, language, mode, .. } = *facts;
        let name = |part| KeptName { id, hash, part };
        self.files.keep(&name(KeptPart::Sculpture), parcel.sculpture())?;
        if !trace.is_empty() {
            self.files.keep(&name(KeptPart::Trace), trace)?;
        }
        let outcome = self.update(|tx| {
            if let Some(outcome) = find_outcome(tx, id, hash)? {
                return Ok(outcome);
            }
            let claimed_badge = self.claim_badge(tx, headset, facts, now)?;
            let seen_day = seen_time(tx, now)?.day();
            tx.put(&Sculpture {
                id: id.0,
                headset,
                hash: hash.0,
                badge: badge.map(BadgeNumber::get),
                claimed_badge,
                pictures: badge.map_or(0, |badge| picture_bits(&badge.badge().pictograms)),
                language,
                mode,
                facts: facts.to_json(),
                received_at: now,
                keep_day: seen_day.saturating_add(u32::from(self.plan.retention_days)),
                withdrawn_at: None,
                has_trace: !trace.is_empty(),
                export: ExportState::Queued,
                link_generation: 0,
                is_link_revoked: false,
            })?;
            remove_announcements(tx, &id.0)?;
            Ok::<_, Refusal>(ParcelOutcome::Kept)
        })?;
        if outcome == ParcelOutcome::Deleted {
            // The sculpture was deleted while the files were stored again.
            self.files.remove_kept(&name(KeptPart::Sculpture))?;
            self.files.remove_kept(&name(KeptPart::Trace))?;
        }
        Ok(outcome)
    }
}

/// Returns the outcome of an earlier upload of the same parcel; `None` if there is none.
fn find_outcome(
    tx: &mut Tx<'_>,
    id: SculptureId,
    hash: ContentHash,
) -> Result<Option<ParcelOutcome>, Refusal> {
    let (known, outcome) = if let Some(kept) = tx.get::<Sculpture>(&[&id.0])? {
        (kept.hash, ParcelOutcome::Kept)
    } else if let Some(deleted) = tx.get::<Tombstone>(&[&id.0])? {
        (deleted.hash, ParcelOutcome::Deleted)
    } else {
        return Ok(None);
    };
    if known == hash.0 { Ok(Some(outcome)) } else { Err(Refusal::Conflict(Reason::OtherParcel)) }
}

/// Removes the announcements of a sculpture by any headset, as a device may have enrolled again meanwhile.
pub(crate) fn remove_announcements(tx: &mut Tx<'_>, id: &[u8; 16]) -> Result<(), StoreError> {
    tx.run("DELETE FROM announcements WHERE sculpture = ?1", &[id]).map(drop)
}

/// Reads a file as a parcel, and checks that it is of this sculpture.
fn read_parcel(id: SculptureId, file: &[u8]) -> Result<Parcel<&[u8]>, Refusal> {
    let parcel = Parcel::read(file).map_err(|fault| match fault {
        ParcelFault::TooLong { .. } => {
            Refusal::TooLarge { what: "bytes of a parcel", most: MAX_PARCEL_FILE_BYTES }
        }
        ParcelFault::Damaged { .. } => Refusal::BadRequest(fault.to_string()),
        fault => Refusal::Undecodable(fault.to_string()),
    })?;
    match parcel.facts().id == id {
        true => Ok(parcel),
        false => Err(Refusal::Undecodable("its head is of another sculpture".into())),
    }
}
