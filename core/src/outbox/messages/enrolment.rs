//! How a device becomes one of a site's headsets: by the token of a fleet's file.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::outbox::messages::fields::{fixed_bytes, read_headset, read_version, write_version};
use crate::outbox::messages::{ContentHash, DeviceHint, EnrolmentToken, SiteId};

/// What staff call a device: up to 32 bytes of UTF-8, without control characters. May be empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceName([u8; 32]);

/// `POST /v1/enrol/fleet`: a device that has a fleet's file asks to be let in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FleetEnrolment {
    /// The fleet's.
    pub enrolment_token: EnrolmentToken,
    /// SHA-256 of the token that the device drew.
    pub token_hash: ContentHash,
    /// By which staff find a wiped headset.
    pub hint: DeviceHint,
    /// What the device calls itself.
    pub name: DeviceName,
}

/// The booth's answer to a [`FleetEnrolment`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolAnswer {
    /// The headset's number, from 1.
    pub headset: u32,
    /// The booth's site.
    pub site: SiteId,
}

impl DeviceName {
    /// The name, cut after the last whole character that fits; `None` where it has control characters.
    #[must_use]
    pub fn new(name: &str) -> Option<Self> {
        let mut bytes = [0; 32];
        let name = cut_text(name, bytes.len());
        bytes[..name.len()].copy_from_slice(name.as_bytes());
        (!name.chars().any(char::is_control)).then_some(DeviceName(bytes))
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let len = self.0.iter().position(|&byte| byte == 0).unwrap_or(self.0.len());
        // It was made of text.
        core::str::from_utf8(&self.0[..len]).unwrap_or("")
    }

    fn write(&self, to: &mut ByteWriter<'_>) {
        to.bytes(&self.0);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a name in UTF-8 without control characters, then zeros");
        let bytes = from.bytes(32)?;
        let len = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        let (name, rest) = bytes.split_at(len);
        let name = core::str::from_utf8(name).map_err(|_| bad)?;
        let has_rest = rest.iter().any(|&byte| byte != 0);
        if has_rest { Err(bad) } else { DeviceName::new(name).ok_or(bad) }
    }
}

/// The longest start of a text of at most `most` bytes, in whole characters.
fn cut_text(text: &str, most: usize) -> &str {
    let end = (0..=most.min(text.len())).rev().find(|&end| text.is_char_boundary(end));
    &text[..end.unwrap_or(0)]
}

/// Messages whose fields are written and read one after the other.
macro_rules! field_by_field {
    ($($message:ident, $bytes:expr, { $($field:ident: $kind:ident),* };)*) => {$(
        fixed_bytes! { $message }

        impl $message {
            /// Its length in bytes.
            pub const BYTES: usize = $bytes;

            fn write(&self, to: &mut ByteWriter<'_>) {
                write_version(to);
                $(field_by_field!(write self.$field, to, $kind);)*
            }

            fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
                read_version(from)?;
                Ok($message { $($field: field_by_field!(read from, $kind)),* })
            }
        }
    )*};
    (write $value:expr, $to:ident, Headset) => { $to.u32($value) };
    (write $value:expr, $to:ident, $kind:ident) => { $value.write($to) };
    (read $from:ident, Headset) => { read_headset($from)? };
    (read $from:ident, $kind:ident) => { $kind::read($from)? };
}

field_by_field! {
    FleetEnrolment, 113, {
        enrolment_token: EnrolmentToken, token_hash: ContentHash, hint: DeviceHint, name: DeviceName
    };
    EnrolAnswer, 21, { headset: Headset, site: SiteId };
}
