//! Links of visitors: unguessable tokens that staff can revoke.

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

/// The secret part of a visitor's link, beside the sculpture's id. It is never logged.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct LinkToken(pub [u8; 16]);

/// Domain separation: keeps link tokens apart from other values of the secret.
const LINK_CONTEXT: &[u8] = b"paros visitor link v1\0";

/// Hides the token, which keeps it out of logs.
impl fmt::Debug for LinkToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LinkToken(not shown)")
    }
}

impl Booth {
    /// Returns the token of a sculpture's valid link. Repeated calls return the same token.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] if there is no such sculpture, or its link was revoked; or a store error.
    pub fn link_token(&self, id: &SculptureId) -> Result<LinkToken, Refusal> {
        let sculpture = self.find_sculpture(id)?;
        if sculpture.is_link_revoked {
            return Err(Refusal::NotFound(Reason::LinkRevoked));
        }
        Ok(self.make_token(&sculpture))
    }

    /// Finds the sculpture of a visitor's link. Compares the token in constant time.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] for any invalid link, without telling why; or a store error.
    pub fn find_by_link(&self, id: &SculptureId, token: &LinkToken) -> Result<Sculpture, Refusal> {
        let sculpture = self.find_sculpture(id)?;
        let is_right = bool::from(self.make_token(&sculpture).0.ct_eq(&token.0));
        let is_open = !sculpture.is_link_revoked && sculpture.withdrawn_at.is_none();
        if is_right && is_open { Ok(sculpture) } else { Err(NO_SCULPTURE) }
    }

    /// Deletes the sculpture of a visitor's link, at the visitor's request.
    ///
    /// # Errors
    /// Errors of [`Booth::find_by_link`] and [`Booth::delete`].
    pub fn delete_by_link(
        &self,
        id: &SculptureId,
        token: &LinkToken,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.find_by_link(id, token)?;
        self.delete_as(id, (None, "delete by visitor"), now)
    }

    /// Revokes all links of a sculpture. No link is valid until one is renewed.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
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

    /// Makes a new link, and invalidates all earlier links.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
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
