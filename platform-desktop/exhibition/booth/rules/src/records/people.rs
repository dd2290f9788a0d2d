//! Staff, what visitors asked for, and who did what.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// What a person may do.
    pub enum StaffRole {
        /// Find, view, mail, print, withdraw, and command headsets.
        Attendant = 0,
        /// All of that; and enrol, delete, and see accounts and the audit.
        Admin = 1,
    }
}

record! {
    /// A person who works at the booth.
    pub struct Account in "accounts", key 1 {
        /// What they log in as.
        pub name: String,
        /// Of their password: a string that says by which function it was made.
        pub password_hash: String,
        /// What they may do.
        pub role: StaffRole,
        /// Whether they are shut out.
        pub is_disabled: bool,
    }
}

record! {
    /// A browser in which somebody is logged in.
    pub struct StaffSession in "staff_sessions", key 1 {
        /// SHA-256 of its cookie.
        pub token_hash: [u8; 32],
        /// Who.
        pub account: String,
        /// What each of its forms has to bring.
        pub form_token: [u8; 16],
        /// When it was last used.
        pub used_at: BoothTime,
        /// When it ends, used or not.
        pub expires_at: BoothTime,
    }
}

stored_enum! {
    /// How far a mail has come.
    pub enum MailState {
        /// It is to be sent.
        Queued = 0,
        /// The server took it; the address is gone, unless the visitor agreed that it stays.
        Accepted = 1,
        /// It was refused for good, or too often; the address is gone.
        Failed = 2,
    }
}

record! {
    /// A sculpture that somebody wants by e-mail.
    pub struct MailOrder in "mail_orders", key 1 {
        /// Its random number.
        pub order: u64,
        /// What to send.
        pub sculpture: [u8; 16],
        /// Where to. Kept no longer than until the mail is accepted, unless the visitor agreed.
        pub address: Option<String>,
        /// In which language, by the number of `Language`.
        pub language: u8,
        /// When it was asked for.
        pub asked_at: BoothTime,
        /// How far it has come.
        pub state: MailState,
        /// How often it was tried.
        pub tries: u32,
        /// When it is tried next.
        pub next_try_at: BoothTime,
        /// What came of the last try, if it wasn't taken.
        pub why: String,
        /// Whether the visitor agreed that the address is kept as long as the sculpture.
        pub keeps_address: bool,
    }
}

record! {
    /// Something that was done. It names no address.
    pub struct AuditEntry in "audit", key 2 {
        /// When.
        pub at: BoothTime,
        /// Random bits, which tell it from others of that time.
        pub number: u64,
        /// Who did it: an account, or nothing where the booth did it by itself.
        pub account: Option<String>,
        /// What, in a word.
        pub action: String,
        /// The headset that it was about.
        pub headset: Option<u32>,
        /// The sculpture that it was about.
        pub sculpture: Option<[u8; 16]>,
        /// The badge that it was about.
        pub badge: Option<u32>,
    }
}
