//! How a device becomes one of a site's headsets: by the token of a fleet's file, or by hand.
//!
//! By hand nothing secret is known beforehand, and somebody may stand between device and booth. The device commits to
//! a nonce and its token's hash, the booth answers with a nonce and its keys, the device reveals: neither side can
//! choose its part once it has seen the other's, so that whoever stands between has one chance in 2^24 that both
//! ends show the same four pictograms. Staff accept where they are the same.

use crate::badge::Pictogram;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::outbox::messages::fields::{
    fixed_bytes, read_headset, read_numbered, read_version, write_version,
};
use crate::outbox::messages::{
    ContentHash, DeviceHint, EnrolNonce, EnrolmentToken, ReceiptKey, SiteId,
};

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
    /// By which its receipts are checked.
    pub receipt_key: ReceiptKey,
}

/// `POST /v1/enrol/commit`: a device begins an enrolment by hand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolCommit {
    /// SHA-256 of [`nonce_commitment`].
    pub commitment: ContentHash,
    /// One attempt of a hint is open at a time.
    pub hint: DeviceHint,
    /// What the device calls itself.
    pub name: DeviceName,
}

/// The booth's answer to an [`EnrolCommit`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolCommitAnswer {
    /// Which attempt it is: random bits.
    pub attempt: u64,
    /// The booth's nonce.
    pub booth_nonce: EnrolNonce,
    /// SHA-256 of the certificate authority's certificate (DER) that the device will trust.
    pub ca_hash: ContentHash,
    /// By which the site's receipts are checked.
    pub receipt_key: ReceiptKey,
    /// The booth's site.
    pub site: SiteId,
}

/// `POST /v1/enrol/reveal`: the device shows what it committed to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolReveal {
    /// Of the booth's answer.
    pub attempt: u64,
    /// The device's nonce.
    pub nonce: EnrolNonce,
    /// SHA-256 of the token that the device drew.
    pub token_hash: ContentHash,
}

/// The booth's answer to an [`EnrolReveal`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolRevealAnswer {
    /// [`EnrolState::Waiting`], or [`EnrolState::Declined`] where it isn't what was committed to.
    pub state: EnrolState,
}

/// `POST /v1/enrol/poll`: whether the staff has accepted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolPoll {
    /// Of the booth's answer.
    pub attempt: u64,
    /// SHA-256 of the token that the device drew.
    pub token_hash: ContentHash,
}

/// The booth's answer to an [`EnrolPoll`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnrolPollAnswer {
    /// Where the attempt stands.
    pub state: EnrolState,
    /// The headset's number, from 1, where it is accepted; 0 otherwise.
    pub headset: u32,
}

/// Where an enrolment by hand stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum EnrolState {
    /// The staff hasn't looked yet.
    Waiting = 0,
    /// The device is one of the site's headsets.
    Accepted = 1,
    /// The staff declined, or what was revealed isn't what was committed to.
    Declined = 2,
    /// Nobody looked in time, or there is no such attempt.
    Expired = 3,
}

/// What stands before a transcript where it is hashed.
const TRANSCRIPT_CONTEXT: &[u8; 15] = b"paros enrol v1\0";

/// Length of what a device commits to in bytes.
const COMMITMENT_BYTES: usize = EnrolNonce::BYTES + ContentHash::BYTES;

/// Length of a transcript in bytes.
const TRANSCRIPT_BYTES: usize =
    TRANSCRIPT_CONTEXT.len() + EnrolCommit::BYTES + EnrolCommitAnswer::BYTES + EnrolReveal::BYTES;

/// What a device commits to by its SHA-256: its nonce and its token's hash.
#[must_use]
pub fn nonce_commitment(nonce: &EnrolNonce, token_hash: &ContentHash) -> [u8; COMMITMENT_BYTES] {
    let mut bytes = [0; COMMITMENT_BYTES];
    let mut to = ByteWriter::new(&mut bytes);
    nonce.write(&mut to);
    token_hash.write(&mut to);
    bytes
}

/// All that was said in an enrolment by hand, to be hashed by SHA-256 at both ends.
#[must_use]
pub fn enrolment_transcript(
    commit: &EnrolCommit,
    answer: &EnrolCommitAnswer,
    reveal: &EnrolReveal,
) -> [u8; TRANSCRIPT_BYTES] {
    let mut bytes = [0; TRANSCRIPT_BYTES];
    let mut to = ByteWriter::new(&mut bytes);
    to.bytes(TRANSCRIPT_CONTEXT);
    commit.write(&mut to);
    answer.write(&mut to);
    reveal.write(&mut to);
    bytes
}

/// The four pictograms that both ends show: the first 24 bits of a transcript's SHA-256, six each, the first byte's
/// upper six first.
#[must_use]
pub fn enrolment_pictograms(transcript_hash: &ContentHash) -> [Pictogram; 4] {
    let [a, b, c, ..] = transcript_hash.0;
    let bits = u32::from(a) << 16 | u32::from(b) << 8 | u32::from(c);
    [18, 12, 6, 0].map(|shift| Pictogram::from_low_bits((bits >> shift) as u8))
}

impl EnrolState {
    /// By number.
    pub const ALL: [EnrolState; 4] =
        [EnrolState::Waiting, EnrolState::Accepted, EnrolState::Declined, EnrolState::Expired];

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_numbered(from, &EnrolState::ALL, "where an enrolment stands, 0 to 3")
    }
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
    (write $value:expr, $to:ident, u64) => { $to.u64($value) };
    (write $value:expr, $to:ident, Headset) => { $to.u32($value) };
    (write $value:expr, $to:ident, EnrolState) => { $to.u8($value as u8) };
    (write $value:expr, $to:ident, $kind:ident) => { $value.write($to) };
    (read $from:ident, u64) => { $from.u64()? };
    (read $from:ident, Headset) => { read_headset($from)? };
    (read $from:ident, $kind:ident) => { $kind::read($from)? };
}

field_by_field! {
    FleetEnrolment, 113, {
        enrolment_token: EnrolmentToken, token_hash: ContentHash, hint: DeviceHint, name: DeviceName
    };
    EnrolAnswer, 53, { headset: Headset, site: SiteId, receipt_key: ReceiptKey };
    EnrolCommit, 81, { commitment: ContentHash, hint: DeviceHint, name: DeviceName };
    EnrolCommitAnswer, 121, {
        attempt: u64,
        booth_nonce: EnrolNonce,
        ca_hash: ContentHash,
        receipt_key: ReceiptKey,
        site: SiteId
    };
    EnrolReveal, 73, { attempt: u64, nonce: EnrolNonce, token_hash: ContentHash };
    EnrolRevealAnswer, 2, { state: EnrolState };
    EnrolPoll, 41, { attempt: u64, token_hash: ContentHash };
}

fixed_bytes! { EnrolPollAnswer }

impl EnrolPollAnswer {
    /// Its length in bytes.
    pub const BYTES: usize = 6;

    fn write(&self, to: &mut ByteWriter<'_>) {
        write_version(to);
        to.u8(self.state as u8);
        to.u32(self.headset);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_version(from)?;
        let state = EnrolState::read(from)?;
        let bad = from.error_here("a headset's number where it is accepted, and 0 otherwise");
        let headset = from.u32()?;
        if (state == EnrolState::Accepted) == (headset != 0) {
            Ok(EnrolPollAnswer { state, headset })
        } else {
            Err(bad)
        }
    }
}
