//! The booth's signed word that a sculpture is its own now.

use crate::badge::BadgeNumber;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::outbox::messages::fields::{
    fixed_bytes, read_badge, read_headset, read_numbered, read_version, write_badge, write_version,
};
use crate::outbox::messages::{ContentHash, SculptureId, SiteId};

/// What became of a parcel at the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum ReceiptOutcome {
    /// It is kept there.
    Kept = 0,
    /// It was deleted there, by the visitor's wish or by age: the headset deletes it too.
    Deleted = 1,
}

/// What the booth signs for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Receipt {
    /// The booth's site.
    pub site: SiteId,
    /// The headset that sent it.
    pub headset: u32,
    /// The sculpture's.
    pub id: SculptureId,
    /// Of the whole parcel.
    pub hash: ContentHash,
    /// The badge in its facts.
    pub badge: Option<BadgeNumber>,
    /// What became of it.
    pub outcome: ReceiptOutcome,
}

/// A receipt and its signature, which core can't check: shells do, by the site's [`ReceiptKey`](super::ReceiptKey).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SignedReceipt {
    /// What is signed.
    pub receipt: Receipt,
    /// Ed25519, of [`Receipt::signed_bytes`].
    pub signature: [u8; 64],
}

impl ReceiptOutcome {
    /// By number.
    pub const ALL: [ReceiptOutcome; 2] = [ReceiptOutcome::Kept, ReceiptOutcome::Deleted];
}

fixed_bytes! { Receipt SignedReceipt }

impl Receipt {
    /// Length of a written receipt in bytes.
    pub const BYTES: usize = 74;

    /// What stands before a receipt where it is signed, so that no other signed bytes are a receipt's.
    pub const CONTEXT: &'static [u8; 17] = b"paros receipt v1\0";

    /// The bytes that are signed: [`Receipt::CONTEXT`] and the receipt.
    #[must_use]
    pub fn signed_bytes(&self) -> [u8; Self::CONTEXT.len() + Self::BYTES] {
        let mut bytes = [0; Self::CONTEXT.len() + Self::BYTES];
        let mut to = ByteWriter::new(&mut bytes);
        to.bytes(Self::CONTEXT);
        self.write(&mut to);
        bytes
    }

    fn write(&self, to: &mut ByteWriter<'_>) {
        write_version(to);
        self.site.write(to);
        to.u32(self.headset);
        self.id.write(to);
        self.hash.write(to);
        write_badge(to, self.badge);
        to.u8(self.outcome as u8);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_version(from)?;
        Ok(Receipt {
            site: SiteId::read(from)?,
            headset: read_headset(from)?,
            id: SculptureId::read(from)?,
            hash: ContentHash::read(from)?,
            badge: read_badge(from)?,
            outcome: read_numbered(from, &ReceiptOutcome::ALL, "0 for kept, 1 for deleted")?,
        })
    }
}

impl SignedReceipt {
    /// Length of a written receipt with its signature, in bytes.
    pub const BYTES: usize = Receipt::BYTES + 64;

    fn write(&self, to: &mut ByteWriter<'_>) {
        self.receipt.write(to);
        to.bytes(&self.signature);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let receipt = Receipt::read(from)?;
        let mut signature = [0; 64];
        signature.copy_from_slice(from.bytes(64)?);
        Ok(SignedReceipt { receipt, signature })
    }
}
