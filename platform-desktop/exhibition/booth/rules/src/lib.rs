//! What the booth decides: who is enrolled, what is kept, found and deleted. [`Booth`] takes requests that were read,
//! the time and random bits, and gives answers; records are kept in a [`Store`], parcels in [`ParcelFiles`]. Doesn't
//! know the network, clocks or disks.
//!
//! What it promises:
//! - A parcel that it took is kept until it is deleted by a person's wish or by age, and then it says so.
//! - No sculpture is kept twice, whatever is lost, doubled or late.
//! - No leased badge is two sculptures' own: one that comes with a badge that isn't its own, or isn't any more, is kept with
//!   its badge *lapsed*.
//! - What a headset announced is kept, or was deleted, or is listed as missing.
//! - A headset that lies harms only itself: all that is its own is under its number.
#![forbid(unsafe_code)]

mod accounts;
mod audit;
mod badges;
mod booth;
mod clock;
mod commands;
mod deletions;
mod devices;
mod enrol;
mod find;
mod heartbeat;
mod lifecycle;
pub mod limits;
mod links;
mod list;
mod mail;
mod parcel_files;
mod print_wish;
mod printers;
mod prints;
mod privacy;
mod queues;
mod reason;
mod record;
pub mod records;
mod refusal;
mod restore;
mod size_search;
mod staff;
mod store;
mod time;
mod upload;
mod value;
mod words;
mod work;

pub use badges::BadgeTotals;
pub use booth::{Booth, BoothPlan, SiteKeys};
pub use clock::ClockJump;
pub use deletions::Deletion;
pub use find::{BadgeMatches, FoundByBadge, MissingSculpture};
pub use heartbeat::device_status;
pub use lifecycle::SweepReport;
pub use links::LinkToken;
pub use list::{ListFilter, ListPage, ListPlace, PageStart};
pub use mail::{MailJob, MailOutcome};
pub use parcel_files::{KeptName, KeptPart, ParcelFiles};
pub use print_wish::{PrintSize, PrintWish};
pub use printers::{PrinterTask, PrinterWord};
pub use prints::{PrintJob, PrintStep, SliceOutcome};
pub use privacy::{BadgeRecords, SculptureRecords};
pub use queues::QueueReport;
pub use reason::{Expected, Reason};
pub use record::{Record, Row};
pub use refusal::Refusal;
pub use restore::RestoreReport;
pub use size_search::{SizeSearch, Sliced};
pub use staff::{LoggedIn, SessionBits};
pub use store::{Access, Store, StoreError, Transaction, has_nul, update, view};
pub use time::BoothTime;
pub use upload::{DecodeParcel, ImportOutcome};
pub use value::{Field, ToValue, Value};
pub use words::{BadgeComparison, HeardBadge, WordsFault};
