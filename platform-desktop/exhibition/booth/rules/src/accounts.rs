//! What staff may change of their own accounts.

use crate::audit::{Subject, note};
use crate::booth::Booth;
use crate::reason::Reason;
use crate::records::Account;
use crate::refusal::Refusal;
use crate::staff::end_sessions;
use crate::time::BoothTime;

impl Booth {
    /// Gives an account another password, of which the shell has checked the one before. All its logins end: who knows the
    /// old one is out.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] where there is none, or it is shut out; or those of the store.
    pub fn set_password(
        &self,
        name: &str,
        password_hash: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let account: Option<Account> = tx.get(&[&name])?;
            let account = account.filter(|account| !account.is_disabled);
            let mut account = account.ok_or(Refusal::NotFound(Reason::NoAccount))?;
            password_hash.clone_into(&mut account.password_hash);
            tx.put(&account)?;
            end_sessions(tx, name)?;
            Ok(note(tx, now, Some(name), "change password", Subject::default())?)
        })
    }
}
