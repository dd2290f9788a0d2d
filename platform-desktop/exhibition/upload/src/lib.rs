//! The sender: brings a studio's finished sculptures to an exhibition's booth.
//!
//! [`connect`] passes what a studio finishes to a [`Courier`](courier::Courier), the thread that owns the
//! outbox. A [`Parcel`](paros_protocol::Parcel) is stored in a [`Spool`], whose folder is the whole state. A
//! [`Sender`] decides when to send what. It gets clock and random bits from an [`OutboxHost`], passes
//! requests to a [`BoothLink`], and reports events. It uses no network library and starts no thread: the
//! courier steps it in its own thread, as a step may wait for a disk sync. [`ThreadedLink`] is a link for any
//! blocking HTTP library.
//!
//! | file (ID: 32 hexadecimal digits) | meaning |
//! |---|---|
//! | `ID.parcel` | *kept here*: to be sent |
//! | `ID.sent` | *kept at the booth*: deleted after the grace period, or earlier if space is needed |
//! | `ID.refused` | refused by the booth: sent again every six hours and at each start |
//! | `ID.damaged` | a damaged parcel, kept for people to examine |
//! | `badges.lease` | the blocks of badge numbers that the device holds |
//! | `last-finished` | the mark of the last finished sculpture |
#![forbid(unsafe_code)]

mod badge_lease;
pub mod courier;
pub mod enrolment;
mod events;
mod folder;
mod heartbeats;
mod http;
mod link;
mod outgoing;
mod sender;
mod spool;

pub use events::{BoothContact, OutboxEvent, OutboxHost, OutboxOwner, RemoteCommand};
pub use folder::{DiskFolder, OutboxFolder};
pub use heartbeats::CONFIRM_MS;
pub use http::{BoothAddress, BoothCaller, HttpMethod, HttpRequest, LinkError, ThreadedLink};
pub use link::{BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, RequestKind};
pub use outgoing::{SendPlan, connect};
pub use sender::Sender;
pub use spool::{MAX_SPOOL_ENTRIES, OutboxSettings, Spool, SpoolEntry, SpoolError};

#[cfg(test)]
mod tests;
