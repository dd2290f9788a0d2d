//! The protocol between headsets and the booth: JSON over HTTPS.
//!
//! | request | message | answer |
//! |---|---|---|
//! | `POST /v1/enrol/fleet` | [`FleetEnrolment`] | [`EnrolAnswer`] |
//! | `POST /v1/heartbeat`, every two seconds | [`Heartbeat`] | [`HeartbeatAnswer`] |
//! | `PUT /v1/sculptures/{id}` | a [`Parcel`] | [`ParcelOutcome`], or an HTTP status |
//!
//! Every message carries the protocol version. Unknown fields are ignored, so that a later program may add
//! fields. Received bytes are untrusted: `from_json` of each message parses and validates them.
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

/// The path of enrolments with a fleet file.
pub const FLEET_ENROLMENT_PATH: &str = "/v1/enrol/fleet";

/// The path of parcels, to which the sculpture's id is appended.
pub const PARCEL_PATH: &str = "/v1/sculptures/";

/// The protocol version. It is raised by a change that an earlier program can't ignore.
pub const PROTOCOL_VERSION: u16 = 1;

/// The reason why bytes aren't a valid message.
#[derive(Debug, thiserror::Error)]
pub enum ProtocolError {
    /// The bytes aren't the expected JSON.
    #[error("no message: {0}")]
    Json(#[from] serde_json::Error),
    /// The message has another protocol version.
    #[error(
        "version {found} of the protocol, expected {PROTOCOL_VERSION}: update {}",
        if *found > PROTOCOL_VERSION { "this program" } else { "the program that sent it" }
    )]
    Version {
        /// The version of the message.
        found: u16,
    },
    /// A field has an invalid value.
    #[error("{field}: expected {expected}")]
    Value {
        /// The field's name.
        field: &'static str,
        /// The valid values.
        expected: &'static str,
    },
}

/// A message with the protocol version.
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
    // Serialising can't fail: no message has a map with non-text keys, or a number that JSON can't represent.
    serde_json::to_vec(&versioned).unwrap_or_default()
}

/// Reads a message of this protocol version.
fn from_json<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, ProtocolError> {
    let VersionAlone { version: found } = serde_json::from_slice(bytes)?;
    if found != PROTOCOL_VERSION {
        return Err(ProtocolError::Version { found });
    }
    Ok(serde_json::from_slice(bytes)?)
}

/// Implements `to_json` and `from_json` for messages with a private `check`.
macro_rules! messages {
    ($($message:ident)*) => {$(
        impl $message {
            /// Writes the message as JSON.
            #[must_use]
            pub fn to_json(&self) -> Vec<u8> {
                to_json(self)
            }

            /// Reads and checks a message.
            ///
            /// # Errors
            /// Returns a [`ProtocolError`] if the bytes aren't a valid message of this version.
            pub fn from_json(bytes: &[u8]) -> Result<Self, ProtocolError> {
                let message: Self = from_json(bytes)?;
                message.check()?;
                Ok(message)
            }
        }
    )*};
}

messages! { UploadFacts Heartbeat HeartbeatAnswer FleetEnrolment EnrolAnswer }

/// Returns an error for a field if its value isn't right.
const fn expect(
    is_right: bool,
    field: &'static str,
    expected: &'static str,
) -> Result<(), ProtocolError> {
    if is_right { Ok(()) } else { Err(ProtocolError::Value { field, expected }) }
}

#[cfg(test)]
mod tests;
