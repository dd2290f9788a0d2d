//! Enrolment by a token that expires, is counted and can be revoked.

use paros_protocol::{ContentHash, EnrolAnswer, EnrolmentToken, FleetEnrolment};

use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx};
use crate::devices::{NewDevice, enrol, find_by_token, find_wiped};
use crate::reason::Reason;
use crate::records::EnrolToken;
use crate::refusal::Refusal;
use crate::time::BoothTime;

impl Booth {
    /// Adds a token of 256 random bits that enrols up to `uses` devices until it expires.
    ///
    /// # Errors
    /// Store errors.
    pub fn add_enrol_token(
        &self,
        token: &EnrolmentToken,
        (uses, expires_at): (u32, BoothTime),
        note_for_people: &str,
        account: Option<&str>,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        let token = EnrolToken {
            token_hash: ContentHash::of(&token.0).0,
            note: note_for_people.to_owned(),
            expires_at,
            uses_left: uses,
            is_revoked: false,
        };
        self.update(|tx| {
            tx.put(&token)?;
            Ok(note(tx, now, account, "add enrolment token", Subject::default())?)
        })
    }

    /// Returns the records of all tokens, including used-up and expired ones.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_enrol_tokens(&self) -> Result<Vec<EnrolToken>, Refusal> {
        self.view(|tx| tx.find("ORDER BY token_hash", &[]))
    }

    /// Revokes a token. Headsets that enrolled with it stay enrolled.
    ///
    /// # Errors
    /// There is no token with this hash; or a store error.
    pub fn revoke_enrol_token(
        &self,
        token_hash: &[u8; 32],
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let token: Option<EnrolToken> = tx.get(&[token_hash])?;
            let mut token = token.ok_or(Refusal::NotFound(Reason::NoEnrolToken))?;
            token.is_revoked = true;
            tx.put(&token)?;
            Ok(note(tx, now, Some(account), "revoke enrolment token", Subject::default())?)
        })
    }

    /// Enrols a device. Idempotent: a retry after a lost answer gets the same answer. A device with the hint
    /// of a silent headset counts as that headset after a wipe: it takes over its number and leases.
    ///
    /// # Errors
    /// [`Refusal::UnknownToken`] if the token is unknown, expired, used up or revoked.
    pub fn enrol_fleet(
        &self,
        asked: &FleetEnrolment,
        now: BoothTime,
    ) -> Result<EnrolAnswer, Refusal> {
        let headset = self.update(|tx| {
            let mut token = find_valid_token(tx, &asked.enrolment_token, now)?;
            if let Some(device) = find_by_token(tx, &asked.token_hash)? {
                return Ok(device.headset);
            }
            token.uses_left = token.uses_left.checked_sub(1).ok_or(Refusal::UnknownToken)?;
            tx.put(&token)?;
            let new = NewDevice {
                token_hash: asked.token_hash,
                hint: asked.hint,
                name: asked.name.as_str().to_owned(),
            };
            let wiped = find_wiped(tx, &asked.hint, now)?.map(|device| device.headset);
            let headset = enrol(tx, &new, wiped, now)?;
            let action = if wiped.is_some() { "enrol anew" } else { "enrol" };
            let subject = Subject { headset: Some(headset), ..Subject::default() };
            note(tx, now, None, action, subject)?;
            Ok(headset)
        })?;
        Ok(EnrolAnswer { headset, site: self.keys.site })
    }
}

fn find_valid_token(
    tx: &mut Tx<'_>,
    token: &EnrolmentToken,
    now: BoothTime,
) -> Result<EnrolToken, Refusal> {
    let token: Option<EnrolToken> = tx.get(&[&ContentHash::of(&token.0).0])?;
    token.filter(|token| token.is_valid(now)).ok_or(Refusal::UnknownToken)
}
