//! Parcels: taken piece by piece, checked as a whole, kept, and signed for.

use paros_core::badge::BadgeNumber;
use paros_core::limits::MAX_PARCEL_BYTES;
use paros_core::outbox::messages::{
    ContentHash, Receipt, ReceiptOutcome, SculptureId, UploadFacts,
};

use crate::booth::{Booth, Tx, hash_of};
use crate::grants::is_granted;
use crate::limits::{MAX_CHUNK_BYTES, MAX_OPEN_PARCELS};
use crate::parcel_files::{KeptName, KeptPart, ParcelName};
use crate::reason::Reason;
use crate::records::{Announcement, BadgeClaim, Device, ExportState, Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::Query;
use crate::time::BoothTime;
use crate::value::Field as _;

/// A piece of a parcel.
#[derive(Clone, Copy, Debug)]
pub struct Chunk<'a> {
    /// The sculpture.
    pub id: SculptureId,
    /// SHA-256 of the whole parcel.
    pub hash: ContentHash,
    /// Length of the whole parcel.
    pub parcel_bytes: u64,
    /// Where the piece begins.
    pub offset: u64,
    /// The piece; empty to ask how far the parcel has come.
    pub bytes: &'a [u8],
}

/// How far a parcel has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParcelProgress {
    /// So many bytes are here: go on there.
    Held(u64),
    /// All bytes are here: [`Booth::finish_parcel`] is next.
    Whole,
    /// It was kept or deleted before.
    Done(Receipt),
}

/// Checks that a parcel's files are what its head says: the packed volume or mesh, and the packed trace. Takes no more
/// memory than the head says.
pub type DecodeParcel<'a> = dyn Fn(&UploadFacts, &[u8], &[u8]) -> Result<(), String> + 'a;

impl Booth {
    /// Takes a piece of a parcel. A piece that begins elsewhere than what is held ends is passed over, and the answer
    /// says where to go on.
    ///
    /// # Errors
    /// Too large a piece or parcel, another headset's sculpture, or another parcel of a known sculpture.
    pub fn take_chunk(
        &self,
        device: &Device,
        chunk: &Chunk<'_>,
    ) -> Result<ParcelProgress, Refusal> {
        check_sizes(chunk)?;
        let name = ParcelName { headset: device.headset, id: chunk.id, hash: chunk.hash };
        if let Some(receipt) = self.view_receipt(&name)? {
            return Ok(ParcelProgress::Done(receipt));
        }
        let held = self.files.held_bytes(&name)?;
        let end = chunk.offset + chunk.bytes.len() as u64;
        let held = if chunk.offset != held || chunk.bytes.is_empty() {
            held
        } else if end > chunk.parcel_bytes {
            return Err(Refusal::BadRequest("the piece is longer than its parcel".into()));
        } else {
            if held == 0 {
                self.files.make_room(device.headset, MAX_OPEN_PARCELS)?;
            }
            self.files.append(&name, chunk.offset, chunk.bytes)?
        };
        Ok(match held >= chunk.parcel_bytes {
            true => ParcelProgress::Whole,
            false => ParcelProgress::Held(held),
        })
    }

    /// Keeps a parcel whose bytes are all here, and signs for it. Asked again, it signs the same.
    ///
    /// [`ParcelProgress::Held`] of 0 where its bytes turned into others, as by a power cut: it has to come again.
    ///
    /// # Errors
    /// [`Refusal::Undecodable`] where it is no sculpture of this headset. It is forgotten then.
    pub fn finish_parcel(
        &self,
        device: &Device,
        (id, hash): (SculptureId, ContentHash),
        decode: &DecodeParcel<'_>,
        now: BoothTime,
    ) -> Result<ParcelProgress, Refusal> {
        let name = ParcelName { headset: device.headset, id, hash };
        if let Some(receipt) = self.view_receipt(&name)? {
            return Ok(ParcelProgress::Done(receipt));
        }
        let parcel = self.files.read_parcel(&name)?;
        if hash_of(&parcel) != hash {
            // A power cut turns even what came in one piece into something else.
            self.files.drop_parcel(&name)?;
            return Ok(ParcelProgress::Held(0));
        }
        let facts = check_parcel(device, id, &parcel, decode).map_err(Refusal::Undecodable);
        let facts = match facts {
            Ok(facts) => facts,
            Err(refusal) => {
                self.files.drop_parcel(&name)?;
                return Err(refusal);
            }
        };
        let receipt = self.keep_parcel(&name, &facts, &parcel, now)?;
        // It is kept: what is left of the parcel is swept some day.
        let _ = self.files.drop_parcel(&name);
        Ok(ParcelProgress::Done(receipt))
    }

    /// Files first, then the record: what the record says is there.
    fn keep_parcel(
        &self,
        name: &ParcelName,
        facts: &UploadFacts,
        parcel: &[u8],
        now: BoothTime,
    ) -> Result<Receipt, Refusal> {
        let ParcelName { headset, id, hash } = *name;
        let (first, trace) = parcel.split_at(UploadFacts::BYTES + facts.volume_bytes as usize);
        self.files.keep(&KeptName { id, hash, part: KeptPart::Sculpture }, first)?;
        if !trace.is_empty() {
            self.files.keep(&KeptName { id, hash, part: KeptPart::Trace }, trace)?;
        }
        let receipt = self.update(|tx| {
            if let Some(receipt) = self.find_receipt(tx, name)? {
                return Ok(receipt);
            }
            let claim = find_claim(tx, headset, facts.badge, now)?;
            tx.put(&Sculpture {
                id: id.0,
                headset,
                hash: hash.0,
                badge: facts.badge.map(BadgeNumber::get),
                claim,
                facts: parcel[..UploadFacts::BYTES].to_vec(),
                received_at: now,
                keep_day: now.day().saturating_add(u32::from(self.plan.retention_days)),
                is_in_ledger: false,
                withdrawn_at: None,
                has_trace: !trace.is_empty(),
                export: ExportState::Queued,
                link_generation: 0,
                is_link_revoked: false,
            })?;
            tx.remove::<Announcement>(&[headset.to_value(), id.0.to_value()])?;
            Ok(self.make_receipt(name, facts.badge, ReceiptOutcome::Kept))
        })?;
        if receipt.outcome == ReceiptOutcome::Deleted {
            // It was deleted while it was kept a second time.
            self.files.remove_kept(&KeptName { id, hash, part: KeptPart::Sculpture })?;
            self.files.remove_kept(&KeptName { id, hash, part: KeptPart::Trace })?;
        }
        Ok(receipt)
    }

    fn view_receipt(&self, name: &ParcelName) -> Result<Option<Receipt>, Refusal> {
        crate::store::view(self.store.as_ref(), |tx| self.find_receipt(tx, name))
    }

    /// The receipt of a parcel that was kept or deleted.
    fn find_receipt(&self, tx: &mut Tx<'_>, name: &ParcelName) -> Result<Option<Receipt>, Refusal> {
        let key = [name.id.0.to_value()];
        let (headset, hash, badge, outcome) = if let Some(kept) = tx.get::<Sculpture>(&key)? {
            (kept.headset, kept.hash, kept.badge, ReceiptOutcome::Kept)
        } else if let Some(deleted) = tx.get::<Tombstone>(&key)? {
            (deleted.headset, deleted.hash, deleted.badge, ReceiptOutcome::Deleted)
        } else {
            return Ok(None);
        };
        if headset != name.headset {
            return Err(Refusal::Conflict(Reason::ForeignSculpture));
        }
        if hash != name.hash.0 {
            return Err(Refusal::Conflict(Reason::OtherParcel));
        }
        Ok(Some(self.make_receipt(name, badge.and_then(BadgeNumber::new), outcome)))
    }

    const fn make_receipt(
        &self,
        name: &ParcelName,
        badge: Option<BadgeNumber>,
        outcome: ReceiptOutcome,
    ) -> Receipt {
        let ParcelName { headset, id, hash } = *name;
        Receipt { site: self.keys.site, headset, id, hash, badge, outcome }
    }
}

fn check_sizes(chunk: &Chunk<'_>) -> Result<(), Refusal> {
    if chunk.bytes.len() > MAX_CHUNK_BYTES {
        return Err(Refusal::TooLarge { what: "bytes of a request", most: MAX_CHUNK_BYTES as u64 });
    }
    if chunk.parcel_bytes > MAX_PARCEL_BYTES {
        return Err(Refusal::TooLarge { what: "bytes of a parcel", most: MAX_PARCEL_BYTES });
    }
    if chunk.parcel_bytes <= UploadFacts::BYTES as u64 || chunk.offset > chunk.parcel_bytes {
        return Err(Refusal::BadRequest("a parcel longer than its head, an offset in it".into()));
    }
    Ok(())
}

/// Checks that a parcel is this sculpture of this headset.
fn check_parcel(
    device: &Device,
    id: SculptureId,
    parcel: &[u8],
    decode: &DecodeParcel<'_>,
) -> Result<UploadFacts, String> {
    let head = parcel.get(..UploadFacts::BYTES).ok_or("it is shorter than its head")?;
    let facts = UploadFacts::from_bytes(head)
        .map_err(|bad| format!("its head at byte {}: expected {}", bad.offset, bad.expected))?;
    if facts.id != id || facts.headset != device.headset {
        return Err("its head is of another sculpture or headset".into());
    }
    if facts.parcel_bytes() != parcel.len() as u64 {
        return Err("its head tells another length".into());
    }
    let (volume, trace) = parcel[UploadFacts::BYTES..].split_at(facts.volume_bytes as usize);
    decode(&facts, volume, trace)?;
    Ok(facts)
}

/// What a badge says of a sculpture that has just come.
fn find_claim(
    tx: &mut Tx<'_>,
    headset: u32,
    badge: Option<BadgeNumber>,
    now: BoothTime,
) -> Result<BadgeClaim, Refusal> {
    let Some(badge) = badge else { return Ok(BadgeClaim::Sole) };
    if badge.is_provisional() {
        return Ok(BadgeClaim::Shared);
    }
    if !is_granted(tx, headset, badge)? {
        return Ok(BadgeClaim::Unleased);
    }
    let others = Query::all::<Sculpture>().equal("badge", &badge.get());
    let others: Vec<Sculpture> = tx.find(&others)?;
    // What another headset claims that was never handed the badge stands in nobody's way.
    let is_taken = others
        .iter()
        .any(|other| other.keep_day >= now.day() && other.claim != BadgeClaim::Unleased);
    Ok(if is_taken { BadgeClaim::Disputed } else { BadgeClaim::Sole })
}
