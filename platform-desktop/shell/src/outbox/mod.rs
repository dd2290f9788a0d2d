//! The outbox's files and what it asks the network: [`OutboxDriver`] carries out what
//! [`Outbox`](paros_core::outbox::Outbox) decides.
//!
//! Takes parcels, a clock and random bits from an [`OutboxHost`]; gives files in an [`OutboxFolder`], requests to a
//! [`BoothLink`], and events. Knows no network library and starts no thread: a shell steps it in one of its own, as a
//! step may wait for a disk to sync. [`ThreadedLink`] is a link by any library that asks and waits.
//!
//! | file | what |
//! |---|---|
//! | `ID.parcel` | a parcel and its hash, ID being 32 hexadecimal digits; it never changes |
//! | `outbox.journal` | what is known of all of them |
//! | `badges.lease` | the lease of badges |
//! | `last-finished` | the sculpture that was finished last |
//! | `ID.damaged` | what was a parcel, for people to look at |

mod answers;
pub mod courier;
mod driver;
pub mod enrolment;
mod events;
mod folder;
mod http;
mod lease_keeper;
mod link;
mod parcel;
mod reconcile;

pub use driver::OutboxDriver;
pub use events::{OutboxError, OutboxEvent, OutboxHost};
pub use folder::{DiskFolder, OutboxFolder};
pub use http::{
    BoothAddress, BoothCaller, HttpMethod, HttpRequest, LinkError, LinkTimes, MAX_ANSWER_BYTES,
    ThreadedLink,
};
pub use link::{BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, SentRequest};
pub use parcel::{Parcel, ParcelFault};

#[cfg(test)]
mod tests;
