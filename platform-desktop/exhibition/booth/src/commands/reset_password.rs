//! Resets a forgotten password from the command line, for a site where no other admin can.

use paros_booth_rules::{Booth, Refusal};

use crate::clock::booth_time;
use crate::error::Error;
use crate::staff::{draw_password, make_hash};

/// Generates a new password for an account, and enables the account if it was disabled. Returns text with the
/// password, which isn't stored anywhere else.
///
/// # Errors
/// There is no such account; an error of the store or the system.
pub(crate) fn reset_password(booth: &Booth, name: &str, by: &str) -> Result<String, Error> {
    let failure = |error| Error::failure("password", error);
    let password = draw_password().map_err(failure)?;
    let hash = make_hash(&password).map_err(failure)?;
    let was_disabled =
        booth.reset_password(name, &hash, by, booth_time()).map_err(|refusal| match refusal {
            Refusal::NotFound(_) => unknown_account(booth, name),
            refusal => refusal.into(),
        })?;
    let let_in = if was_disabled { "It was shut out, and is let in again.\n" } else { "" };
    Ok(format!(
        "new password of {name}: {password}\n{let_in}All logins of the account have ended. Its owner sets another password \
         on the page of their account.\n"
    ))
}

/// Returns the error for an unknown name. It lists the existing names.
fn unknown_account(booth: &Booth, name: &str) -> Error {
    let accounts = match booth.list_accounts() {
        Ok(accounts) => accounts,
        Err(refusal) => return refusal.into(),
    };
    let names: Vec<&str> = accounts.iter().map(|account| account.name.as_str()).collect();
    let there = match names.is_empty() {
        true => {
            "there are no accounts; the server prints a code for the first one at its start".into()
        }
        false => format!("the accounts are {}", names.join(", ")),
    };
    Error::Input(format!("{name:?}: no such account; {there}"))
}
