//! The outbox: what a headset owes the booth, until the booth has signed for it.
//!
//! Takes what a visit leaves, times of a clock that nobody sets, random bits and the booth's answers; gives what to
//! store, send, announce and delete. Doesn't know files, networks or cryptography: shells bring these. [`messages`]
//! has all that headset and booth tell each other, as bytes of fixed width.
//!
//! A sculpture is *announced* at its finish, *kept here* once its parcel is on the headset's disk, and *kept at the
//! booth* once the booth has signed for it; [`EntryState::next`] has the table of all that may happen to it.
//!
//! ```
//! use paros_core::outbox::messages::{
//!     ContentHash, Receipt, ReceiptOutcome, SculptureId, SiteId,
//! };
//! use paros_core::outbox::{
//!     EntryState, Outbox, OutboxOwner, OutboxSettings, UploadAnswer,
//! };
//!
//! let owner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };
//! let settings = OutboxSettings { grace_seconds: 86_400, max_bytes: 1 << 30 };
//! let mut outbox = Box::new(Outbox::new(owner, settings, 0x1db7_5aa9));
//! let id = SculptureId([1; 16]); // random bits, drawn at the finish
//! outbox.announce(id, None)?;
//! // The parcel is written, synced and renamed: the visitor reads "kept here".
//! let hash = ContentHash([3; 32]);
//! outbox.keep(id, None, hash, 11_000)?;
//! let request = outbox.begin_upload(0).expect("something to send");
//! let OutboxOwner { site, headset } = owner;
//! // The booth's receipt.
//! let receipt = Receipt { site, headset, id, hash, badge: None, outcome: ReceiptOutcome::Kept };
//! outbox.take_upload_answer(request.number, UploadAnswer::Receipt(receipt), 0)?;
//! assert_eq!(outbox.find(id).map(|entry| entry.state), Some(EntryState::Receipted { seconds: 0 }));
//! # Ok::<(), paros_core::outbox::OutboxRefusal>(())
//! ```
//!
//! # What shells must keep
//! - A parcel is on the disk, whole, under its own name before [`Outbox::keep`] is told; it isn't changed after.
//! - The journal is written whenever [it is due](Outbox::is_journal_due): before the booth hears of a new sculpture,
//!   and whenever it can be. Of what is deleted the journal that is there already says that it is signed for
//!   ([`Outbox::parcels_to_delete`]).
//! - At a start the folder's parcels are compared with the journal: those that are there and not known are kept
//!   ([`Outbox::keep`]) unless they were given up, those that are known and not there, or damaged, are missing.
//! - An id that the booth knows as another's is replaced by one that follows from the old one and its parcel alone, so
//!   that a start in between comes to the same.

mod entry;
mod heartbeats;
mod journal;
mod machine;
pub mod messages;
mod renewal;
mod room;
mod uploads;

pub use entry::{EntryEvent, EntryState, OutboxEntry};
pub use heartbeats::{DueCommand, HeadsetStatus};
pub use machine::{Outbox, OutboxOwner, OutboxRefusal, OutboxSettings};
pub use room::OutboxLevel;
pub use uploads::{UploadAnswer, UploadRequest};
