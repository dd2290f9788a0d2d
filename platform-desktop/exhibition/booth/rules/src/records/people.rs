//! Staff accounts, mail orders and the audit log.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// The rights of an account.
    pub enum StaffRole {
        /// Find, view, mail, print, withdraw, and command headsets.
        Attendant = 0,
        /// All rights of an attendant; and enrol, delete, and see accounts and the audit log.
        Admin = 1,
    }
}

record! {
    /// A person who works at the booth.
    pub struct Account in "accounts", key 1 {
        /// The login name.
        pub name: String,
        /// The hash of the password, in a format that names the hash function.
        pub password_hash: String,
        /// The rights of the account.
        pub role: StaffRole,
        /// `true` if the account can't log in.
        pub is_disabled: bool,
    }
}

record! {
    /// A login: a browser in which somebody is logged in.
    pub struct StaffSession in "staff_sessions", key 1 {
        /// The SHA-256 of the cookie.
        pub token_hash: [u8; 32],
        /// The name of the account.
        pub account: String,
        /// The token that each form has to contain.
        pub form_token: [u8; 16],
        /// The time of the last use.
        pub used_at: BoothTime,
        /// The time when the login ends, used or not.
        pub expires_at: BoothTime,
    }
}

stored_enum! {
    /// The state of a mail.
    pub enum MailState {
        /// The mail waits to be sent.
        Queued = 0,
        /// The server accepted the mail. The address is deleted, unless the visitor agreed that it stays.
        Accepted = 1,
        /// The mail was refused for good, or failed too often. The address is deleted.
        Failed = 2,
    }
}

record! {
    /// An order of a mail with a sculpture.
    pub struct MailOrder in "mail_orders", key 1 {
        /// The random number of the order.
        pub order: u64,
        /// The id of the sculpture.
        pub sculpture: [u8; 16],
        /// The address of the recipient. Deleted once the mail is accepted, unless the visitor agreed to keep
        /// it.
        pub address: Option<String>,
        /// The number of the `Language` of the mail.
        pub language: u8,
        /// The time of the order.
        pub asked_at: BoothTime,
        /// The state of the mail.
        pub state: MailState,
        /// The number of tries.
        pub tries: u32,
        /// The time of the next try.
        pub next_try_at: BoothTime,
        /// The reason why the last try failed.
        pub why: String,
        /// `true` if the visitor agreed that the address is kept as long as the sculpture.
        pub keeps_address: bool,
    }
}

record! {
    /// An action in the audit log. It contains no address.
    pub struct AuditEntry in "audit", key 2 {
        /// The time of the action.
        pub at: BoothTime,
        /// A number that distinguishes entries of the same time.
        pub number: u64,
        /// The account that did it; `None` if the booth acted by itself.
        pub account: Option<String>,
        /// A short text that names the action.
        pub action: String,
        /// The headset that was affected.
        pub headset: Option<u32>,
        /// The sculpture that was affected.
        pub sculpture: Option<[u8; 16]>,
        /// The badge that was affected.
        pub badge: Option<u32>,
    }
}
