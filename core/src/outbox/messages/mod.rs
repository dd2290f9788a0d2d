//! What a headset and the booth tell each other: bytes of fixed width, little-endian, whose first is the message's
//! version. All that arrives is hostile until it is read: a reader refuses every value that no writer makes, and says
//! where it stands and what was expected.
//!
//! | message | goes | carries |
//! |---|---|---|
//! | [`UploadFacts`] | to the booth, before a parcel's files | whose sculpture it is, and what follows |
//! | [`Heartbeat`], [`HeartbeatAnswer`] | both ways, every two seconds | state, announcements, leases, a command |
//! | [`FleetEnrolment`], [`EnrolAnswer`] | both ways, once | a token of the fleet, by which a device is let in |
//!
//! Bytes that a message leaves unused are zero, lists are as long as they may be, and a message ends where its
//! length says: so any two messages that are equal are equal as bytes.

mod commands;
mod enrolment;
mod facts;
mod fields;
mod heartbeat;
mod heartbeat_answer;
mod ids;

pub use commands::{BoothCommand, CommandKind, CommandOutcome, CommandReport};
pub use enrolment::{DeviceName, EnrolAnswer, FleetEnrolment};
pub use facts::{AgeGroup, FinishCause, UploadFacts};
pub use heartbeat::{Announcement, Announcements, Heartbeat, HeatLevel, UploadStatus};
pub use heartbeat_answer::HeartbeatAnswer;
pub use ids::{ContentHash, DeviceHint, DeviceToken, EnrolmentToken, SculptureId, SiteId};
