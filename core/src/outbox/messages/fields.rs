//! Fields that several messages have, and the two ends of every message.

use crate::badge::BadgeNumber;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};

/// The version of all messages, their first byte.
const MESSAGE_VERSION: u8 = 1;

/// What stands for no badge.
const NO_BADGE: u32 = u32::MAX;

pub(super) fn write_version(to: &mut ByteWriter<'_>) {
    to.u8(MESSAGE_VERSION);
}

pub(super) fn read_version(from: &mut ByteReader<'_>) -> Result<(), BadBytes> {
    let bad = from.error_here("version 1 of the booth's messages");
    if from.u8()? == MESSAGE_VERSION { Ok(()) } else { Err(bad) }
}

/// Reads a number that isn't zero: what zero means is told otherwise.
pub(super) fn read_headset(from: &mut ByteReader<'_>) -> Result<u32, BadBytes> {
    let bad = from.error_here("a headset's number, from 1");
    Some(from.u32()?).filter(|&number| number != 0).ok_or(bad)
}

pub(super) fn write_badge(to: &mut ByteWriter<'_>, badge: Option<BadgeNumber>) {
    to.u32(badge.map_or(NO_BADGE, BadgeNumber::get));
}

pub(super) fn read_badge(from: &mut ByteReader<'_>) -> Result<Option<BadgeNumber>, BadBytes> {
    let bad = from.error_here("the number of a badge, or four times 255 for none");
    match from.u32()? {
        NO_BADGE => Ok(None),
        number => BadgeNumber::new(number).map(Some).ok_or(bad),
    }
}

/// Reads a byte that counts from 0 in a list.
pub(super) fn read_numbered<T: Copy>(
    from: &mut ByteReader<'_>,
    all: &[T],
    expected: &'static str,
) -> Result<T, BadBytes> {
    let bad = from.error_here(expected);
    all.get(usize::from(from.u8()?)).copied().ok_or(bad)
}

/// Reads a byte of which no other bits than `mask` are set.
pub(super) fn read_flags(
    from: &mut ByteReader<'_>,
    mask: u8,
    expected: &'static str,
) -> Result<u8, BadBytes> {
    let bad = from.error_here(expected);
    let flags = from.u8()?;
    if flags & !mask == 0 { Ok(flags) } else { Err(bad) }
}

/// Passes over bytes that stand for nothing.
pub(super) fn read_zeros(
    from: &mut ByteReader<'_>,
    len: usize,
    expected: &'static str,
) -> Result<(), BadBytes> {
    let bad = from.error_here(expected);
    if from.bytes(len)?.iter().all(|&byte| byte == 0) { Ok(()) } else { Err(bad) }
}

pub(super) fn write_zeros(to: &mut ByteWriter<'_>, len: usize) {
    (0..len).for_each(|_| to.u8(0));
}

/// Gives messages with a private `write`, a private `read` and their `BYTES` the two ends that all have.
macro_rules! fixed_bytes {
    ($($message:ident)*) => {$(
        impl $message {
            #[doc = concat!("Writes it as [`", stringify!($message), "::BYTES`] bytes.")]
            #[must_use]
            pub fn to_bytes(&self) -> [u8; Self::BYTES] {
                let mut bytes = [0; Self::BYTES];
                let mut to = $crate::codec::bytes::ByteWriter::new(&mut bytes);
                self.write(&mut to);
                debug_assert_eq!(to.len(), Self::BYTES);
                bytes
            }

            #[doc = concat!("Reads what [`", stringify!($message), "::to_bytes`] wrote, and no other bytes.")]
            ///
            /// # Errors
            /// [`BadBytes`] for another length or version, or a value that it can't have.
            pub fn from_bytes(bytes: &[u8]) -> Result<Self, $crate::codec::bytes::BadBytes> {
                let mut from = $crate::codec::bytes::ByteReader::new(bytes);
                let message = Self::read(&mut from)?;
                from.expect_end()?;
                Ok(message)
            }
        }
    )*};
}

pub(super) use fixed_bytes;
