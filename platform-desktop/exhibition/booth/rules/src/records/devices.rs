//! Headsets, their enrolment, commands and announcements.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

record! {
    /// An enrolled headset.
    pub struct Device in "devices", key 1 {
        /// The number of the headset, which it keeps when its app data is wiped.
        pub headset: u32,
        /// The SHA-256 of the device token.
        pub token_hash: [u8; 32],
        /// The device hint, which is no proof of identity.
        pub hint: [u8; 16],
        /// The name, for people.
        pub name: String,
        /// The time of the last enrolment.
        pub enrolled_at: BoothTime,
        /// The time when staff excluded the headset. Its token is refused since then.
        pub revoked_at: Option<BoothTime>,
        /// The time when the headset last reported a wipe of its app data.
        pub wiped_at: Option<BoothTime>,
        /// The time of the heartbeat in `status`.
        pub seen_at: Option<BoothTime>,
        /// The bytes of the last stored heartbeat, without announcements and badge report.
        pub status: Vec<u8>,
    }
}

record! {
    /// A token that enrols headsets without staff.
    pub struct EnrolToken in "enrol_tokens", key 1 {
        /// The SHA-256 of the token.
        pub token_hash: [u8; 32],
        /// A note for people.
        pub note: String,
        /// The time from which the token is refused.
        pub expires_at: BoothTime,
        /// The number of headsets that the token may still enrol.
        pub uses_left: u32,
        /// `true` if staff revoked the token.
        pub is_revoked: bool,
    }
}

impl EnrolToken {
    /// Returns `true` if the token has neither expired nor been revoked. It may be used up.
    #[must_use]
    pub fn is_valid(&self, now: BoothTime) -> bool {
        !self.is_revoked && now < self.expires_at
    }

    /// Returns `true` if another headset can enrol with the token.
    #[must_use]
    pub fn has_uses_left(&self, now: BoothTime) -> bool {
        self.is_valid(now) && self.uses_left > 0
    }
}

stored_enum! {
    /// The state of a command.
    pub enum CommandState {
        /// The command waits for the headset's next heartbeat.
        Waiting = 0,
        /// The command was sent.
        Sent = 1,
        /// The headset carried the command out.
        Done = 2,
        /// The command's lifetime ended, at the booth or on the headset.
        Expired = 3,
        /// The headset couldn't carry the command out.
        Refused = 4,
    }
}

record! {
    /// A command of staff to a headset.
    pub struct Command in "commands", key 2 {
        /// The number of the headset.
        pub headset: u32,
        /// The number of the command, which increases for each headset.
        pub command: u64,
        /// The program start of the headset that the command is for.
        pub boot: u64,
        /// The visit that the command is for; 0 for none.
        pub session: u64,
        /// The number of the `CommandKind`.
        pub kind: u8,
        /// The time when staff gave the command.
        pub asked_at: BoothTime,
        /// The state of the command.
        pub state: CommandState,
    }
}

record! {
    /// A sculpture that a headset announced as finished.
    pub struct Announcement in "announcements", key 2 {
        /// The headset that announced it.
        pub headset: u32,
        /// The id of the sculpture.
        pub sculpture: [u8; 16],
        /// The number of its badge; `None` until a badge was announced.
        pub badge: Option<u32>,
        /// The time of the first announcement.
        pub heard_at: BoothTime,
        /// The number of the last announced `UploadStatus`.
        pub status: u8,
    }
}
