//! Password changes of accounts. The caller hashes the passwords.

use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx};
use crate::reason::Reason;
use crate::records::Account;
use crate::refusal::Refusal;
use crate::staff::end_sessions;
use crate::time::BoothTime;

impl Booth {
    /// Changes the password of an account. The shell has checked the old password. Ends all logins of the
    /// account, so that the old password gives no access.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] if the account doesn't exist or is disabled; or a store error.
    pub fn set_password(
        &self,
        name: &str,
        password_hash: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let account = find_account(tx, name)?;
            if account.is_disabled {
                return Err(Refusal::NotFound(Reason::NoAccount));
            }
            put_password(tx, account, password_hash)?;
            Ok(note(tx, now, Some(name), "change password", Subject::default())?)
        })
    }

    /// Sets a new password for an account, ends all its logins, and enables it if it was disabled. Returns
    /// `true` if it was disabled. `by` is the admin, or the command line.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] if there is no such account; or a store error.
    pub fn reset_password(
        &self,
        name: &str,
        password_hash: &str,
        by: &str,
        now: BoothTime,
    ) -> Result<bool, Refusal> {
        self.update(|tx| {
            let account = find_account(tx, name)?;
            let was_disabled = account.is_disabled;
            put_password(tx, account, password_hash)?;
            if was_disabled {
                let action = format!("enable account {name}");
                note(tx, now, Some(by), &action, Subject::default())?;
            }
            let action = format!("reset password of {name}");
            note(tx, now, Some(by), &action, Subject::default())?;
            Ok(was_disabled)
        })
    }
}

pub(crate) fn find_account(tx: &mut Tx<'_>, name: &str) -> Result<Account, Refusal> {
    tx.get(&[&name])?.ok_or(Refusal::NotFound(Reason::NoAccount))
}

/// Sets the password, enables the account, and ends all its logins.
fn put_password(tx: &mut Tx<'_>, account: Account, password_hash: &str) -> Result<(), Refusal> {
    let password_hash = password_hash.to_owned();
    let account = Account { password_hash, is_disabled: false, ..account };
    tx.put(&account)?;
    Ok(end_sessions(tx, &account.name)?)
}
