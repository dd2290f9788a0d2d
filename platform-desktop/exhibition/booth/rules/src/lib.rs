//! The booth's rules: who is enrolled, and what is kept, found and deleted. [`Booth`] takes parsed requests,
//! the time and random bits, and returns answers. Records are kept in a [`Store`], parcels in
//! [`ParcelFiles`]. This crate has no access to network, clocks or disks.
//!
//! Guarantees:
//! - An accepted parcel is kept until a person or its age deletes it. Later uploads then get "deleted".
//! - No sculpture is kept twice, whatever messages are lost, duplicated or late.
//! - No leased badge is owned by two sculptures. A sculpture whose badge isn't its own, or no longer is, is
//!   kept with its badge *lapsed*.
//! - An announced sculpture is kept, deleted or listed as missing.
//! - A lying headset harms only itself: its records are stored under its number.
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
