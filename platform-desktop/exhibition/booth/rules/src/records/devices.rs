//! Headsets, how they come to be known, and what they and the booth tell each other.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

record! {
    /// A headset that is enrolled.
    pub struct Device in "devices", key 1 {
        /// Its number, which it keeps when its app's data is wiped.
        pub headset: u32,
        /// SHA-256 of its token.
        pub token_hash: [u8; 32],
        /// What it remembers itself by, which proves nothing.
        pub hint: [u8; 16],
        /// For people.
        pub name: String,
        /// When it got its token.
        pub enrolled_at: BoothTime,
        /// When its token was taken away; it is refused since.
        pub revoked_at: Option<BoothTime>,
        /// When it was last known to have lost its app's data.
        pub wiped_at: Option<BoothTime>,
        /// When the last heartbeat came that is kept here.
        pub seen_at: Option<BoothTime>,
        /// That heartbeat's bytes, without announcements and report.
        pub status: Vec<u8>,
    }
}

record! {
    /// What lets headsets enrol without staff.
    pub struct EnrolToken in "enrol_tokens", key 1 {
        /// SHA-256 of it.
        pub token_hash: [u8; 32],
        /// For people.
        pub note: String,
        /// From when on it is refused.
        pub expires_at: BoothTime,
        /// Headsets that it may yet enrol.
        pub uses_left: u32,
        /// Whether staff took it back.
        pub is_revoked: bool,
    }
}

impl EnrolToken {
    /// Returns `true` if the token has neither expired nor been revoked. It may be used up.
    #[must_use]
    pub fn is_valid(&self, now: BoothTime) -> bool {
        !self.is_revoked && now < self.expires_at
    }

    /// Returns `true` if another headset can enrol by the token.
    #[must_use]
    pub fn has_uses_left(&self, now: BoothTime) -> bool {
        self.is_valid(now) && self.uses_left > 0
    }
}

stored_enum! {
    /// What became of a command.
    pub enum CommandState {
        /// It is to go with the headset's next heartbeat.
        Waiting = 0,
        /// It went out.
        Sent = 1,
        /// The headset did it.
        Done = 2,
        /// It lived too long, on either side.
        Expired = 3,
        /// The headset can't do it now.
        Refused = 4,
    }
}

record! {
    /// What staff want a headset to do.
    pub struct Command in "commands", key 2 {
        /// Whose it is.
        pub headset: u32,
        /// Its number, which grows with each of a headset.
        pub command: u64,
        /// The headset's start that it is about.
        pub boot: u64,
        /// The visit that it is about; 0 for none.
        pub session: u64,
        /// What to do, by the number of `CommandKind`.
        pub kind: u8,
        /// When staff asked for it.
        pub asked_at: BoothTime,
        /// What became of it.
        pub state: CommandState,
    }
}

record! {
    /// A sculpture that a headset said it had finished.
    pub struct Announcement in "announcements", key 2 {
        /// Who said it.
        pub headset: u32,
        /// The sculpture.
        pub sculpture: [u8; 16],
        /// The number of its badge, if it has one yet.
        pub badge: Option<u32>,
        /// When that was first heard.
        pub heard_at: BoothTime,
        /// The status of its upload that was last heard, by the number of `UploadStatus`.
        pub status: u8,
    }
}
