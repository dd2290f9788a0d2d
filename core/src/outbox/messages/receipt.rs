//! The booth's word that a sculpture is its own now.

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

/// The booth's answer once a parcel is on its disk, or was deleted there. TLS proves that it is the booth's: its
/// certificate is of the site's authority.
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

impl ReceiptOutcome {
    /// By number.
    pub const ALL: [ReceiptOutcome; 2] = [ReceiptOutcome::Kept, ReceiptOutcome::Deleted];
}

fixed_bytes! { Receipt }

impl Receipt {
    /// Length of a written receipt in bytes.
    pub const BYTES: usize = 74;

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
