//! The sender: brings a studio's finished sculptures to an exhibition's booth.
//!
//! [`connect`] gives what a studio finishes to a [`Courier`](courier::Courier), the thread that owns the outbox. A
//! [`Parcel`](paros_protocol::Parcel) is kept in a [`Spool`], whose folder is the whole state. A [`Sender`] decides what goes to the booth when;
//! it takes a clock and random bits from an [`OutboxHost`], and gives requests to a [`BoothLink`] and events. It knows no
//! network library and starts no thread: the courier steps it in its own, as a step may wait for a disk to sync.
//! [`ThreadedLink`] is a link by any library that sends a request and waits.
//!
//! | file, ID being 32 hexadecimal digits | meaning |
//! |---|---|
//! | `ID.parcel` | *kept here*: to be sent |
//! | `ID.sent` | *kept at the booth*: deleted after the grace, or earlier if there is no room |
//! | `ID.refused` | the booth can't take it: sent again every six hours and at each start |
//! | `ID.damaged` | was a parcel; for people to look at |
//! | `badges.lease` | the blocks of badges' numbers that the device holds |
//! | `last-finished` | the sculpture that was finished last |
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
