//! Identifiers and secrets of fixed width, written in hexadecimal digits.

use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sha2::{Digest as _, Sha256};

fn parse_hex<const BYTES: usize>(text: &str) -> Option<[u8; BYTES]> {
    let digits = text.as_bytes();
    if digits.len() != 2 * BYTES {
        return None;
    }
    let digit = |letter: u8| char::from(letter).to_digit(16);
    let mut bytes = [0; BYTES];
    for (byte, pair) in bytes.iter_mut().zip(digits.chunks(2)) {
        *byte = (digit(pair[0])? << 4 | digit(pair[1])?) as u8;
    }
    Some(bytes)
}

/// Bytes as hexadecimal digits.
struct Hex<'a>(&'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

macro_rules! byte_names {
    ($($(#[$doc:meta])* $name:ident, $bytes:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub [u8; $bytes]);

        impl $name {
            /// The length in bytes.
            pub const BYTES: usize = $bytes;

            #[doc = concat!("Reads ", stringify!($bytes), " bytes in hexadecimal digits; `None` for other text.")]
            #[must_use]
            pub fn parse_hex(text: &str) -> Option<Self> {
                parse_hex(text).map($name)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.collect_str(&Hex(&self.0))
            }
        }

        /// Rejects zeros: they mean that drawing the bits was forgotten.
        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let text = std::borrow::Cow::<'de, str>::deserialize(from)?;
                let found = $name::parse_hex(&text).filter(|found| found.0 != [0; $bytes]);
                found.ok_or_else(|| D::Error::custom(concat!(
                    "expected ", stringify!($name), ": ", stringify!($bytes),
                    " bytes in hexadecimal digits, not all zeros"
                )))
            }
        }
    )*};
}

macro_rules! shown_as_hex {
    ($($name:ident)*) => {$(
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                Hex(&self.0).fmt(f)
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
            /// Returns the hexadecimal digits, for the header or file that carries the secret. `Debug`
            /// doesn't show them, which keeps them out of logs.
            #[must_use]
            pub fn reveal(&self) -> impl fmt::Display + '_ {
                Hex(&self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}(not shown)", stringify!($name))
            }
        }
    )*};
}

byte_names! {
    /// The id of a sculpture: 128 random bits, drawn at *finish*.
    SculptureId, 16;
    /// The id of a site, which is a booth and its headsets: 128 random bits.
    SiteId, 16;
    /// The serial of one lease of a block: 64 random bits, known to the booth and the headset.
    BlockSerial, 8;
    /// A SHA-256 hash, such as of a parcel, a token or a certificate.
    ContentHash, 32;
    /// A stable device identifier (Android's `ANDROID_ID`, or random bits). It helps staff to recognise a
    /// wiped headset, and is never a credential.
    DeviceHint, 16;
    /// A secret that a device draws and sends with each request. The booth stores only its SHA-256.
    DeviceToken, 32;
    /// The secret of a fleet file. It enrols a limited number of devices.
    EnrolmentToken, 32;
}

shown_as_hex! { SculptureId SiteId BlockSerial ContentHash DeviceHint }
never_shown! { DeviceToken EnrolmentToken }

impl ContentHash {
    /// Computes the SHA-256 of bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        ContentHash(Sha256::digest(bytes).into())
    }
}
