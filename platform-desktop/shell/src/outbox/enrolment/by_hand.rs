//! Enrolment by hand: nothing is known beforehand, and staff compare pictograms.
//!
//! The link trusts an authority that the booth itself has shown. Whether that is the site's is what the pictograms tell,
//! as they are of its hash too: nothing of it is kept before the staff has accepted.

use paros_core::badge::Pictogram;
use paros_core::outbox::OutboxOwner;
use paros_core::outbox::messages::{
    ContentHash, EnrolCommit, EnrolCommitAnswer, EnrolNonce, EnrolPoll, EnrolPollAnswer,
    EnrolReveal, EnrolRevealAnswer, EnrolState, enrolment_pictograms, enrolment_transcript,
    nonce_commitment,
};
use sha2::{Digest as _, Sha256};

use super::{EnrolError, Enrolment, NewDevice, Secret, ask, random_bytes};
use crate::outbox::BoothCaller;

/// An enrolment that waits for the staff.
#[derive(Clone, Debug)]
pub struct HandEnrolment {
    address: String,
    ca: Vec<u8>,
    token: Secret,
    answer: EnrolCommitAnswer,
    pictograms: [Pictogram; 4],
}

/// Where it stands.
#[derive(Clone, PartialEq, Debug)]
pub enum ByHandState {
    /// The staff hasn't looked yet.
    Waiting,
    /// The device is the site's.
    Accepted(Box<Enrolment>),
}

impl HandEnrolment {
    /// Commits to a nonce, and reveals it once the booth has told its own. `link` trusts `ca` alone, an authority that
    /// was shown at `address`.
    ///
    /// # Errors
    /// What the booth or the way there refuses; [`EnrolError::AnotherSite`] where the booth says that its authority is
    /// another one.
    pub fn begin(
        link: &mut impl BoothCaller,
        (address, ca): (&str, &[u8]),
        device: &NewDevice,
    ) -> Result<Self, EnrolError> {
        let (nonce, token_hash) = (EnrolNonce(random_bytes()?), device.token.hash());
        let commitment = hash_of(&nonce_commitment(&nonce, &token_hash));
        let commit = EnrolCommit { commitment, hint: device.hint, name: device.name };
        let body = ask(link, "/v1/enrol/commit", &commit.to_bytes())?;
        let answer = EnrolCommitAnswer::from_bytes(&body)?;
        if answer.ca_hash != hash_of(ca) {
            return Err(EnrolError::AnotherSite);
        }
        let reveal = EnrolReveal { attempt: answer.attempt, nonce, token_hash };
        let body = ask(link, "/v1/enrol/reveal", &reveal.to_bytes())?;
        end_of(EnrolRevealAnswer::from_bytes(&body)?.state)?;
        let transcript = enrolment_transcript(&commit, &answer, &reveal);
        Ok(HandEnrolment {
            address: address.into(),
            ca: ca.into(),
            token: device.token,
            answer,
            pictograms: enrolment_pictograms(&hash_of(&transcript)),
        })
    }

    /// What the device shows, and staff compare.
    #[must_use]
    pub const fn pictograms(&self) -> [Pictogram; 4] {
        self.pictograms
    }

    /// Asks whether the staff has accepted. To be asked every two seconds or so.
    ///
    /// # Errors
    /// [`EnrolError::Declined`] and [`EnrolError::Expired`] end it, as all but those of the link do.
    pub fn poll(&self, link: &mut impl BoothCaller) -> Result<ByHandState, EnrolError> {
        let EnrolCommitAnswer { attempt, receipt_key, site, .. } = self.answer;
        let asked = EnrolPoll { attempt, token_hash: self.token.hash() };
        let body = ask(link, "/v1/enrol/poll", &asked.to_bytes())?;
        let EnrolPollAnswer { state, headset } = EnrolPollAnswer::from_bytes(&body)?;
        end_of(state)?;
        if state != EnrolState::Accepted {
            return Ok(ByHandState::Waiting);
        }
        Ok(ByHandState::Accepted(Box::new(Enrolment {
            address: self.address.clone(),
            ca: self.ca.clone(),
            token: self.token,
            receipt_key,
            owner: OutboxOwner { site, headset },
        })))
    }
}

const fn end_of(state: EnrolState) -> Result<(), EnrolError> {
    match state {
        EnrolState::Waiting | EnrolState::Accepted => Ok(()),
        EnrolState::Declined => Err(EnrolError::Declined),
        EnrolState::Expired => Err(EnrolError::Expired),
    }
}

fn hash_of(bytes: &[u8]) -> ContentHash {
    ContentHash(Sha256::digest(bytes).into())
}
