//! The protocol between headsets and the booth: JSON over HTTPS.
//!
//! | request | message | answer |
//! |---|---|---|
//! | `POST /v1/enrol/fleet` | [`FleetEnrolment`] | [`EnrolAnswer`] |
//! | `POST /v1/heartbeat`, every two seconds | [`Heartbeat`] | [`HeartbeatAnswer`] |
//! | `PUT /v1/sculptures/{id}` | a [`Parcel`] | [`ParcelOutcome`], or a status of HTTP |
//!
//! Every message carries the protocol's version. Unknown fields are ignored, so that a later program may add some. All
//! that arrives is hostile until it was read and checked: `from_json` of each message does both.
#![forbid(unsafe_code)]

mod answers;
mod badges;
mod commands;
mod enrolment;
mod facts;
mod fields;
mod heartbeat;
mod ids;
pub mod limits;
mod parcel;
mod parcel_names;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

pub use answers::{HEARTBEAT_TIMEOUT_MS, LinkTimes, ParcelOutcome};
pub use badges::{BadgeReport, HeldBlock};
pub use commands::{BoothCommand, CommandKind, CommandOutcome, CommandReport};
pub use enrolment::{DeviceName, EnrolAnswer, FleetEnrolment};
pub use facts::{AgeGroup, FinishCause, UploadFacts};
pub use heartbeat::{
    Announcement, HeadsetStatus, Heartbeat, HeartbeatAnswer, HeatLevel, UploadStatus,
};
pub use ids::{
    BlockSerial, ContentHash, DeviceHint, DeviceToken, EnrolmentToken, SculptureId, SiteId,
};
pub use parcel::{Parcel, ParcelFault, append_hash, split_hash};
pub use parcel_names::{parcel_name, parse_parcel_name};

/// The path of heartbeats.
pub const HEARTBEAT_PATH: &str = "/v1/heartbeat";

/// The path of enrolments by a fleet's file.
pub const FLEET_ENROLMENT_PATH: &str = "/v1/enrol/fleet";

/// The path of parcels, before the id.
pub const PARCEL_PATH: &str = "/v1/sculptures/";

/// The version of the protocol. A change that an earlier program can't ignore raises it.
pub const PROTOCOL_VERSION: u16 = 1;

/// Why bytes are no message.
#[derive(Debug, thiserror::Error)]
pub enum ProtocolError {
    /// The bytes are no such message.
    #[error("no message: {0}")]
    Json(#[from] serde_json::Error),
    /// The message has another version.
    #[error(
        "version {found} of the protocol, expected {PROTOCOL_VERSION}: update {}",
        if *found > PROTOCOL_VERSION { "this program" } else { "the program that sent it" }
    )]
    Version {
        /// As the message has it.
        found: u16,
    },
    /// A field has a value that it can't have.
    #[error("{field}: expected {expected}")]
    Value {
        /// The field's name.
        field: &'static str,
        /// Values that it can have.
        expected: &'static str,
    },
}

/// A message with the protocol's version.
#[derive(Serialize)]
struct Versioned<'a, M> {
    version: u16,
    #[serde(flatten)]
    message: &'a M,
}

#[derive(Deserialize)]
struct VersionAlone {
    version: u16,
}

/// Writes a message as JSON.
fn to_json(message: &impl Serialize) -> Vec<u8> {
    let versioned = Versioned { version: PROTOCOL_VERSION, message };
    // No message has a map whose keys aren't text, nor a number that JSON doesn't have.
    serde_json::to_vec(&versioned).unwrap_or_default()
}

/// Reads a message of this version.
fn from_json<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, ProtocolError> {
    let VersionAlone { version: found } = serde_json::from_slice(bytes)?;
    if found != PROTOCOL_VERSION {
        return Err(ProtocolError::Version { found });
    }
    Ok(serde_json::from_slice(bytes)?)
}

/// Gives messages with a private `check` the two ends that all have.
macro_rules! messages {
    ($($message:ident)*) => {$(
        impl $message {
            /// Writes the message as JSON.
            #[must_use]
            pub fn to_json(&self) -> Vec<u8> {
                to_json(self)
            }

            /// Reads a message, and checks it.
            ///
            /// # Errors
            /// [`ProtocolError`].
            pub fn from_json(bytes: &[u8]) -> Result<Self, ProtocolError> {
                let message: Self = from_json(bytes)?;
                message.check()?;
                Ok(message)
            }
        }
    )*};
}

messages! { UploadFacts Heartbeat HeartbeatAnswer FleetEnrolment EnrolAnswer }

/// Checks a value of a field.
const fn expect(
    is_right: bool,
    field: &'static str,
    expected: &'static str,
) -> Result<(), ProtocolError> {
    if is_right { Ok(()) } else { Err(ProtocolError::Value { field, expected }) }
}

#[cfg(test)]
mod tests;
