//! Staff accounts and logins. The shell hashes the passwords.

use std::time::Duration;

use paros_protocol::ContentHash;
use subtle::ConstantTimeEq as _;
use unicode_security::skeleton;

use crate::accounts::find_account;
use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx};
use crate::limits::{SESSION_IDLE, SESSION_LIFE};
use crate::reason::{Expected, Reason};
use crate::records::{Account, StaffRole, StaffSession};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

/// Largest delay of a login's stored last use. It limits how often the use is written.
const USE_STEP: Duration = Duration::from_secs(60);

/// Domain separation: keeps browser tokens apart from other values of the secret.
const BROWSER_CONTEXT: &[u8] = b"paros browser v1\0";
const BROWSER_SIGNATURE_CONTEXT: &[u8] = b"paros browser signature v1\0";

/// The random bits of a login.
#[derive(Clone, Copy)]
pub struct SessionBits {
    /// The cookie. The booth stores its SHA-256.
    pub cookie: [u8; 32],
    /// The token in each form, so that no other page can send the form (CSRF).
    pub form_token: [u8; 16],
}

/// A person who is logged in.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LoggedIn {
    /// The name of the account.
    pub account: String,
    /// The rights of the account.
    pub role: StaffRole,
    /// The token that each form has to contain.
    pub form_token: [u8; 16],
}

impl LoggedIn {
    /// Checks that a form belongs to this login.
    ///
    /// # Errors
    /// [`Refusal::Forbidden`] if it doesn't.
    pub fn check_form(&self, form_token: &[u8; 16]) -> Result<(), Refusal> {
        let is_ours = bool::from(self.form_token.ct_eq(form_token));
        if is_ours { Ok(()) } else { Err(Refusal::Forbidden(Reason::ForeignForm)) }
    }

    /// Checks that the account is an admin's.
    ///
    /// # Errors
    /// [`Refusal::Forbidden`] if it isn't.
    pub fn check_admin(&self) -> Result<(), Refusal> {
        match self.role {
            StaffRole::Admin => Ok(()),
            StaffRole::Attendant => Err(Refusal::Forbidden(Reason::AdminsOnly)),
        }
    }
}

impl Booth {
    /// Returns `true` if there is an account.
    ///
    /// # Errors
    /// Store errors.
    pub fn has_accounts(&self) -> Result<bool, Refusal> {
        Ok(self.count::<Account>("", &[])? > 0)
    }

    /// Makes the first account, with the rights of an admin. The shell has checked the code that it printed.
    ///
    /// # Errors
    /// [`Refusal::Conflict`] if there is an account, [`Refusal::Unfit`] for a bad name; or a store error.
    pub fn add_first_admin(
        &self,
        name: &str,
        password_hash: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        let account = make_account(name, password_hash, StaffRole::Admin)?;
        self.update(|tx| {
            if tx.count::<Account>("", &[])? > 0 {
                return Err(Refusal::Conflict(Reason::FirstAccountThere));
            }
            tx.put(&account)?;
            Ok(note(tx, now, Some(name), "first account", Subject::default())?)
        })
    }

    /// Makes an account.
    ///
    /// # Errors
    /// [`Refusal::Conflict`] if the name is taken or looks like a taken name, [`Refusal::Unfit`] for an
    /// invalid name; or a store error.
    pub fn add_account(
        &self,
        name: &str,
        password_hash: &str,
        role: StaffRole,
        by: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        let account = make_account(name, password_hash, role)?;
        self.update(|tx| {
            let others = tx.find::<Account>("", &[])?;
            if others.iter().any(|other| look_alike(&other.name, name)) {
                return Err(Refusal::Conflict(Reason::NameTaken));
            }
            tx.put(&account)?;
            let action = format!("add account {name}");
            Ok(note(tx, now, Some(by), &action, Subject::default())?)
        })
    }

    /// Disables or enables an account, and ends its logins. The last admin can't be disabled.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or [`Refusal::Conflict`] for the last admin.
    pub fn set_account_disabled(
        &self,
        name: &str,
        is_disabled: bool,
        by: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut account = find_account(tx, name)?;
            account.is_disabled = is_disabled;
            tx.put(&account)?;
            let admins = "WHERE role = ?1 AND is_disabled = 0";
            if tx.count::<Account>(admins, &[&StaffRole::Admin])? == 0 {
                return Err(Refusal::Conflict(Reason::LastAdmin));
            }
            end_sessions(tx, name)?;
            let action = if is_disabled { "disable account" } else { "enable account" };
            Ok(note(tx, now, Some(by), &format!("{action} {name}"), Subject::default())?)
        })
    }

    /// Returns all accounts.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_accounts(&self) -> Result<Vec<Account>, Refusal> {
        self.view(|tx| tx.find("ORDER BY name", &[]))
    }

    /// Returns the password hash of an account; `None` if there is no such account, or it is disabled.
    ///
    /// # Errors
    /// Store errors.
    pub fn password_hash(&self, name: &str) -> Result<Option<String>, Refusal> {
        let account: Option<Account> = self.view(|tx| tx.get(&[&name]))?;
        Ok(account.filter(|account| !account.is_disabled).map(|account| account.password_hash))
    }

    /// Logs an account in. The caller has checked the password.
    ///
    /// # Errors
    /// Store errors.
    pub fn log_in(&self, name: &str, bits: &SessionBits, now: BoothTime) -> Result<(), Refusal> {
        self.update(|tx| {
            let sessions: Vec<StaffSession> = tx.find("WHERE account = ?1", &[&name])?;
            for session in sessions.iter().filter(|session| is_over(session, now)) {
                end_session(tx, &session.token_hash)?;
            }
            tx.put(&StaffSession {
                token_hash: ContentHash::of(&bits.cookie).0,
                account: name.to_owned(),
                form_token: bits.form_token,
                used_at: now,
                expires_at: now.after(SESSION_LIFE),
            })?;
            Ok(note(tx, now, Some(name), "log in", Subject::default())?)
        })
    }

    /// Returns the login of a cookie, and records its use.
    ///
    /// # Errors
    /// [`Refusal::UnknownToken`] if there is no such login, or it is over; or a store error.
    pub fn find_login(&self, cookie: &[u8; 32], now: BoothTime) -> Result<LoggedIn, Refusal> {
        let (login, used_at) = self.read_login(cookie, now)?;
        if now.since(used_at) >= USE_STEP {
            self.update(|tx| {
                let used = "UPDATE staff_sessions SET used_at = ?1 WHERE token_hash = ?2";
                tx.run(used, &[&now, &ContentHash::of(cookie).0])?;
                Ok(())
            })?;
        }
        Ok(login)
    }

    /// Returns the login of a cookie without recording its use, for requests that pages make by themselves.
    ///
    /// # Errors
    /// [`Refusal::UnknownToken`] if there is no such login, or it is over; or a store error.
    pub fn peek_login(&self, cookie: &[u8; 32], now: BoothTime) -> Result<LoggedIn, Refusal> {
        self.read_login(cookie, now).map(|(login, _)| login)
    }

    /// Reads a login that isn't over, and the time of its last use.
    fn read_login(
        &self,
        cookie: &[u8; 32],
        now: BoothTime,
    ) -> Result<(LoggedIn, BoothTime), Refusal> {
        let (session, account) = self.view(|tx| {
            let session: Option<StaffSession> = tx.get(&[&ContentHash::of(cookie).0])?;
            let account: Option<Account> = match &session {
                Some(session) => tx.get(&[&session.account])?,
                None => None,
            };
            Ok((session, account))
        })?;
        let session = session.filter(|session| !is_over(session, now));
        let account = account.filter(|account| !account.is_disabled);
        let (Some(session), Some(account)) = (session, account) else {
            return Err(Refusal::UnknownToken);
        };
        let StaffSession { form_token, used_at, .. } = session;
        Ok((LoggedIn { account: account.name, role: account.role, form_token }, used_at))
    }

    /// Makes the token of a browser in which an account was logged in. The token grants no access.
    #[must_use]
    pub fn make_browser_token(&self, name: &str) -> [u8; 32] {
        let account = self.keys.make_secret(BROWSER_CONTEXT, &[name.as_bytes()]);
        self.sign_browser(account)
    }

    /// Returns the account's number in a browser token, which proves an earlier login; `None` if forged.
    #[must_use]
    pub fn check_browser_token(&self, token: &[u8; 32]) -> Option<[u8; 16]> {
        let account: [u8; 16] = *token.first_chunk()?;
        bool::from(self.sign_browser(account).ct_eq(token)).then_some(account)
    }

    fn sign_browser(&self, account: [u8; 16]) -> [u8; 32] {
        let signature: [u8; 16] = self.keys.make_secret(BROWSER_SIGNATURE_CONTEXT, &[&account]);
        let mut token = [0; 32];
        token[..16].copy_from_slice(&account);
        token[16..].copy_from_slice(&signature);
        token
    }

    /// Ends a login.
    ///
    /// # Errors
    /// Store errors.
    pub fn log_out(&self, cookie: &[u8; 32]) -> Result<(), Refusal> {
        self.update(|tx| Ok(end_session(tx, &ContentHash::of(cookie).0)?))
    }
}

fn make_account(name: &str, password_hash: &str, role: StaffRole) -> Result<Account, Refusal> {
    let is_plain = name.chars().all(|letter| letter.is_alphanumeric() || "._-".contains(letter));
    if name.is_empty() || name.len() > 64 || !is_plain {
        return Err(Refusal::Unfit(Expected::AccountName));
    }
    let (name, password_hash) = (name.to_owned(), password_hash.to_owned());
    Ok(Account { name, password_hash, role, is_disabled: false })
}

/// Returns `true` if people may confuse two names: they differ in case only, or in letters of different
/// scripts that look alike.
fn look_alike(name: &str, other: &str) -> bool {
    let forms = visible_forms(name);
    visible_forms(other).iter().any(|form| forms.contains(form))
}

/// Returns the skeletons (UTS #39) of a name as written, in lower case and in upper case. Some Greek and
/// Latin names look alike only in capitals (`ΑΝΝΑ`).
fn visible_forms(name: &str) -> [String; 3] {
    let written = [name.to_owned(), name.to_lowercase(), name.to_uppercase()];
    written.map(|name| skeleton(&name).collect::<String>().to_lowercase())
}

/// Ends all logins of an account.
pub(crate) fn end_sessions(tx: &mut Tx<'_>, name: &str) -> Result<(), StoreError> {
    tx.run("DELETE FROM staff_sessions WHERE account = ?1", &[&name]).map(drop)
}

fn end_session(tx: &mut Tx<'_>, token_hash: &[u8; 32]) -> Result<(), StoreError> {
    tx.run("DELETE FROM staff_sessions WHERE token_hash = ?1", &[token_hash]).map(drop)
}

fn is_over(session: &StaffSession, now: BoothTime) -> bool {
    now >= session.expires_at || now.since(session.used_at) >= SESSION_IDLE
}
