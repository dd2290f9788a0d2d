//! Visitors' links: a token that nobody guesses, and that staff can take back.

use std::fmt;

use paros_protocol::SculptureId;
use subtle::ConstantTimeEq as _;

use crate::audit::{Subject, note};
use crate::booth::Booth;
use crate::find::NO_SCULPTURE;
use crate::reason::Reason;
use crate::records::Sculpture;
use crate::refusal::Refusal;
use crate::time::BoothTime;

/// What a visitor's link carries beside the sculpture's id. It is never logged.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct LinkToken(pub [u8; 16]);

/// What stands before what the tokens are of, so that nothing else that is made of the secret is one.
const LINK_CONTEXT: &[u8] = b"paros visitor link v1\0";

/// Doesn't show it, so that no log does.
impl fmt::Debug for LinkToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LinkToken(not shown)")
    }
}

impl Booth {
    /// The token of a sculpture's valid link, to print it, again too.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] where there is none, or its link was taken back; or those of the store.
    pub fn link_token(&self, id: &SculptureId) -> Result<LinkToken, Refusal> {
        let sculpture = self.find_sculpture(id)?;
        if sculpture.is_link_revoked {
            return Err(Refusal::NotFound(Reason::LinkRevoked));
        }
        Ok(self.make_token(&sculpture))
    }

    /// The sculpture of a visitor's link. The token's other half is compared in a time that tells nothing.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] for all that isn't a valid link, without a difference; or those of the store.
    pub fn find_by_link(&self, id: &SculptureId, token: &LinkToken) -> Result<Sculpture, Refusal> {
        let sculpture = self.find_sculpture(id)?;
        let is_right = bool::from(self.make_token(&sculpture).0.ct_eq(&token.0));
        let is_open = !sculpture.is_link_revoked && sculpture.withdrawn_at.is_none();
        if is_right && is_open { Ok(sculpture) } else { Err(NO_SCULPTURE) }
    }

    /// Deletes the sculpture of a visitor's link, as the visitor wants it.
    ///
    /// # Errors
    /// As of [`Booth::find_by_link`] and [`Booth::delete`].
    pub fn delete_by_link(
        &self,
        id: &SculptureId,
        token: &LinkToken,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.find_by_link(id, token)?;
        self.delete_as(id, (None, "delete by visitor"), now)
    }

    /// Takes a sculpture's links back. None is valid then, until a new one is made.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of the store.
    pub fn revoke_link(
        &self,
        id: &SculptureId,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.change_link(id, "revoke link", account, now, |sculpture| {
            sculpture.is_link_revoked = true;
        })
    }

    /// Makes another link valid, and all before void.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of the store.
    pub fn renew_link(
        &self,
        id: &SculptureId,
        account: &str,
        now: BoothTime,
    ) -> Result<LinkToken, Refusal> {
        self.change_link(id, "renew link", account, now, |sculpture| {
            sculpture.link_generation = sculpture.link_generation.wrapping_add(1);
            sculpture.is_link_revoked = false;
        })?;
        self.link_token(id)
    }

    fn change_link(
        &self,
        id: &SculptureId,
        action: &str,
        account: &str,
        now: BoothTime,
        change: impl Fn(&mut Sculpture),
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut sculpture: Sculpture = tx.get(&[&id.0])?.ok_or(NO_SCULPTURE)?;
            change(&mut sculpture);
            tx.put(&sculpture)?;
            let subject = Subject { sculpture: Some(id.0), ..Subject::default() };
            Ok(note(tx, now, Some(account), action, subject)?)
        })
    }

    fn make_token(&self, sculpture: &Sculpture) -> LinkToken {
        let generation = sculpture.link_generation.to_le_bytes();
        LinkToken(self.keys.make_secret(LINK_CONTEXT, &[&sculpture.id, &generation]))
    }
}
