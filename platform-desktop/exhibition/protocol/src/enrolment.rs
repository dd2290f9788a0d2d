//! Enrolment: a device joins a site with the token of a fleet file.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{ContentHash, DeviceHint, EnrolmentToken, ProtocolError, SiteId, expect};

/// A device name for staff: up to 32 bytes of UTF-8, without control characters. May be empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceName([u8; 32]);

/// The request of `POST /v1/enrol/fleet`: a device with a fleet file asks to join the site.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct FleetEnrolment {
    /// The enrolment token of the fleet file.
    pub enrolment_token: EnrolmentToken,
    /// The SHA-256 of the device token that the device drew.
    pub token_hash: ContentHash,
    /// The hint by which staff recognise a wiped headset.
    pub hint: DeviceHint,
    /// The device's own name.
    pub name: DeviceName,
}

/// The booth's answer to a [`FleetEnrolment`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct EnrolAnswer {
    /// The headset's number, from 1.
    pub headset: u32,
    /// The booth's site.
    pub site: SiteId,
}

impl DeviceName {
    /// Makes a name, cut after the last whole character that fits; `None` if it has control characters.
    #[must_use]
    pub fn new(name: &str) -> Option<Self> {
        let mut bytes = [0; 32];
        let mut ends = (0..=bytes.len().min(name.len())).rev();
        let end = ends.find(|&end| name.is_char_boundary(end)).unwrap_or(0);
        let name = &name[..end];
        bytes[..name.len()].copy_from_slice(name.as_bytes());
        (!name.chars().any(char::is_control)).then_some(DeviceName(bytes))
    }

    /// Returns the name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let len = self.0.iter().position(|&byte| byte == 0).unwrap_or(self.0.len());
        // `new` copied these bytes from a `str` and cut them at a character.
        str::from_utf8(&self.0[..len]).unwrap_or("")
    }
}

impl Serialize for DeviceName {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for DeviceName {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(from)?;
        let name = DeviceName::new(&text);
        name.ok_or_else(|| D::Error::custom("expected a name without control characters"))
    }
}

impl FleetEnrolment {
    /// Succeeds: the types of the fields allow no invalid value.
    pub(crate) const fn check(&self) -> Result<(), ProtocolError> {
        Ok(())
    }
}

impl EnrolAnswer {
    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.headset != 0, "headset", "a number from 1")
    }
}
