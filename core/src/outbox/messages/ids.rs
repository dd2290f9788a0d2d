//! Names and secrets of fixed width: what a sculpture, a site, a device are known by.

use core::fmt;

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};

/// The two hexadecimal digits of a byte that `Display` writes, and both cases read.
fn hex_digit(digit: u8) -> Option<u8> {
    (digit as char).to_digit(16).map(|value| value as u8)
}

fn parse_hex<const BYTES: usize>(text: &str) -> Option<[u8; BYTES]> {
    let digits = text.as_bytes();
    if digits.len() != 2 * BYTES {
        return None;
    }
    let mut bytes = [0; BYTES];
    for (byte, pair) in bytes.iter_mut().zip(digits.chunks(2)) {
        *byte = hex_digit(pair[0])? << 4 | hex_digit(pair[1])?;
    }
    Some(bytes)
}

fn write_hex(f: &mut fmt::Formatter<'_>, bytes: &[u8]) -> fmt::Result {
    bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
}

macro_rules! byte_names {
    ($($(#[$doc:meta])* $name:ident, $bytes:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub [u8; $bytes]);

        impl $name {
            /// Its length in bytes.
            pub const BYTES: usize = $bytes;

            #[doc = concat!("Reads ", stringify!($bytes), " bytes in hexadecimal digits; `None` for other text.")]
            #[must_use]
            pub fn parse_hex(text: &str) -> Option<Self> {
                parse_hex(text).map($name)
            }
        }
    )*};
}

macro_rules! shown_as_hex {
    ($($name:ident)*) => {$(
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write_hex(f, &self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}({self})", stringify!($name))
            }
        }
    )*};
}

macro_rules! never_shown {
    ($($name:ident)*) => {$(
        impl $name {
            /// Its hexadecimal digits, for the one header or file that carries it. `Debug` doesn't show them, so
            /// that no log does.
            #[must_use]
            pub fn reveal(&self) -> impl fmt::Display + '_ {
                Revealed(&self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}(not shown)", stringify!($name))
            }
        }
    )*};
}

macro_rules! in_messages {
    ($($name:ident, $expected:literal;)*) => {$(
        impl $name {
            pub(in crate::outbox) fn write(&self, to: &mut ByteWriter<'_>) {
                to.bytes(&self.0);
            }

            /// Zeros are no name and no secret: somebody forgot to draw one.
            pub(in crate::outbox) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
                let bad = from.error_here($expected);
                let mut bytes = [0; Self::BYTES];
                bytes.copy_from_slice(from.bytes(Self::BYTES)?);
                if bytes == [0; Self::BYTES] { Err(bad) } else { Ok($name(bytes)) }
            }
        }
    )*};
}

byte_names! {
    /// A sculpture's name: 128 random bits, drawn at *finish*.
    SculptureId, 16;
    /// The name of a site, which is a booth and its headsets: 128 random bits.
    SiteId, 16;
    /// A SHA-256: of a parcel, an STL file, a token, a certificate.
    ContentHash, 32;
    /// What a device remembers itself by (Android's `ANDROID_ID`, or random bits). A hint by which staff find a wiped
    /// headset again, never a credential.
    DeviceHint, 16;
    /// A secret that a device draws, and shows the booth with each request. The booth keeps its SHA-256 alone.
    DeviceToken, 32;
    /// A secret of a fleet's file, which lets so many devices in.
    EnrolmentToken, 32;
}

shown_as_hex! { SculptureId SiteId ContentHash DeviceHint }
in_messages! {
    SculptureId, "a sculpture's id, not all zeros";
    SiteId, "a site's id, not all zeros";
    ContentHash, "a SHA-256, not all zeros";
    DeviceHint, "a device's hint, not all zeros";
    EnrolmentToken, "an enrolment token, not all zeros";
}

never_shown! { DeviceToken EnrolmentToken }

struct Revealed<'a>(&'a [u8]);

impl fmt::Display for Revealed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_hex(f, self.0)
    }
}
