//! Enrolment where nothing secret is known beforehand: commit, reveal, compare four pictograms.

use paros_core::outbox::messages::{
    ContentHash, DeviceHint, DeviceName, EnrolCommit, EnrolCommitAnswer, EnrolNonce, EnrolPoll,
    EnrolPollAnswer, EnrolReveal, EnrolRevealAnswer, EnrolState, enrolment_pictograms,
    enrolment_transcript, nonce_commitment,
};
use subtle::ConstantTimeEq as _;

use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx, hash_of};
use crate::devices::{NewDevice, enrol, find_wiped};
use crate::limits::{ATTEMPT_LIFE, MAX_OPEN_ATTEMPTS, MAX_RECENT_ATTEMPTS};
use crate::reason::Reason;
use crate::records::{AttemptState, EnrolAttempt};
use crate::refusal::Refusal;
use crate::store::{Query, StoreError};
use crate::time::BoothTime;
use crate::value::Field as _;

/// Random bits of an enrolment by hand.
#[derive(Clone, Copy, Debug)]
pub struct EnrolBits {
    /// Its number.
    pub attempt: u64,
    /// The booth's nonce.
    pub booth_nonce: EnrolNonce,
}

/// An enrolment that staff have to look at.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AttemptView {
    /// Its number.
    pub attempt: u64,
    /// What the device calls itself.
    pub name: String,
    /// The pictograms that it must show, by their numbers.
    pub pictograms: [u8; 4],
    /// The headset that it seems to be, wiped.
    pub maybe_headset: Option<u32>,
}

impl Booth {
    /// Begins an enrolment by hand: the device committed itself to a nonce.
    ///
    /// # Errors
    /// [`Refusal::Busy`] where one of this hint is open, or too many are.
    pub fn commit_enrolment(
        &self,
        asked: &EnrolCommit,
        bits: EnrolBits,
        now: BoothTime,
    ) -> Result<EnrolCommitAnswer, Refusal> {
        let EnrolBits { attempt, booth_nonce } = bits;
        self.update(|tx| {
            drop_old_attempts(tx, now)?;
            let attempts: Vec<EnrolAttempt> = tx.find(&Query::all::<EnrolAttempt>())?;
            let open = || attempts.iter().filter(|other| is_open(other, now));
            let is_full =
                open().count() >= MAX_OPEN_ATTEMPTS || attempts.len() >= MAX_RECENT_ATTEMPTS;
            if is_full || open().any(|other| other.hint == asked.hint.0) {
                let retry_after = ATTEMPT_LIFE.as_secs() as u32;
                return Err(Refusal::Busy { what: "enrolments by hand", retry_after });
            }
            if tx.get::<EnrolAttempt>(&[attempt.to_value()])?.is_some() {
                return Err(Refusal::Conflict(Reason::AttemptTaken));
            }
            Ok(tx.put(&EnrolAttempt {
                attempt,
                commitment: asked.commitment.0,
                hint: asked.hint.0,
                name: asked.name.as_str().to_owned(),
                booth_nonce: booth_nonce.0,
                began_at: now,
                state: AttemptState::Committed,
                token_hash: None,
                pictograms: None,
                headset: None,
            })?)
        })?;
        Ok(self.commit_answer(attempt, booth_nonce))
    }

    /// Takes what the device committed itself to. From now on staff see its pictograms.
    ///
    /// # Errors
    /// Those of the store.
    pub fn reveal_enrolment(
        &self,
        asked: &EnrolReveal,
        now: BoothTime,
    ) -> Result<EnrolRevealAnswer, Refusal> {
        let state = self.update(|tx| {
            let Some(mut attempt) = find_living(tx, asked.attempt, now)? else {
                return Ok(EnrolState::Expired);
            };
            if attempt.state != AttemptState::Committed {
                // Revealed once more, as after a lost answer; another token isn't what was committed to.
                let is_same = attempt.token_hash == Some(asked.token_hash.0);
                return Ok(if is_same { state_of(&attempt) } else { EnrolState::Declined });
            }
            let revealed = hash_of(&nonce_commitment(&asked.nonce, &asked.token_hash));
            if !bool::from(revealed.0.ct_eq(&attempt.commitment)) {
                attempt.state = AttemptState::Declined;
                tx.put(&attempt)?;
                return Ok(EnrolState::Declined);
            }
            attempt.state = AttemptState::Waiting;
            attempt.token_hash = Some(asked.token_hash.0);
            attempt.pictograms = self.pictograms_of(&attempt, asked);
            tx.put(&attempt)?;
            Ok(EnrolState::Waiting)
        })?;
        Ok(EnrolRevealAnswer { state })
    }

    /// Tells a device whether staff have accepted it.
    ///
    /// # Errors
    /// Those of the store.
    pub fn poll_enrolment(
        &self,
        asked: &EnrolPoll,
        now: BoothTime,
    ) -> Result<EnrolPollAnswer, Refusal> {
        let attempt = self.view(|tx| find_living(tx, asked.attempt, now))?;
        let attempt = attempt.filter(|attempt| attempt.token_hash == Some(asked.token_hash.0));
        let state = attempt.as_ref().map_or(EnrolState::Expired, state_of);
        let headset = attempt.and_then(|attempt| attempt.headset).unwrap_or(0);
        Ok(EnrolPollAnswer { state, headset })
    }

    /// The enrolments that staff have to look at.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_attempts(&self, now: BoothTime) -> Result<Vec<AttemptView>, Refusal> {
        self.view(|tx| {
            let waiting = Query::all::<EnrolAttempt>().equal("state", &AttemptState::Waiting);
            let mut views = Vec::new();
            for attempt in tx.find::<EnrolAttempt>(&waiting)? {
                let Some(pictograms) = attempt.pictograms.filter(|_| is_open(&attempt, now)) else {
                    continue;
                };
                let wiped = find_wiped(tx, &DeviceHint(attempt.hint), now)?;
                views.push(AttemptView {
                    attempt: attempt.attempt,
                    name: attempt.name,
                    pictograms,
                    maybe_headset: wiped.map(|device| device.headset),
                });
            }
            Ok(views)
        })
    }

    /// Lets a device in, whose pictograms staff have found equal: as the headset `number`, which it is, wiped, or as a
    /// new one. Returns its number.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] where nothing waits under this number.
    pub fn accept_attempt(
        &self,
        attempt: u64,
        number: Option<u32>,
        account: &str,
        now: BoothTime,
    ) -> Result<u32, Refusal> {
        self.update(|tx| {
            let mut attempt = find_waiting(tx, attempt, now)?;
            let token_hash = attempt.token_hash.ok_or(NOTHING_WAITS)?;
            let new = NewDevice {
                token_hash: ContentHash(token_hash),
                hint: DeviceHint(attempt.hint),
                name: attempt.name.clone(),
            };
            let headset = enrol(tx, &new, number, now)?;
            (attempt.state, attempt.headset) = (AttemptState::Accepted, Some(headset));
            tx.put(&attempt)?;
            let subject = Subject { headset: Some(headset), ..Subject::default() };
            note(tx, now, Some(account), "accept enrolment", subject)?;
            Ok(headset)
        })
    }

    /// Sends a device away.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] where nothing waits under this number.
    pub fn decline_attempt(
        &self,
        attempt: u64,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut attempt = find_waiting(tx, attempt, now)?;
            attempt.state = AttemptState::Declined;
            tx.put(&attempt)?;
            Ok(note(tx, now, Some(account), "decline enrolment", Subject::default())?)
        })
    }

    fn commit_answer(&self, attempt: u64, booth_nonce: EnrolNonce) -> EnrolCommitAnswer {
        EnrolCommitAnswer {
            attempt,
            booth_nonce,
            ca_hash: self.keys.ca_hash,
            receipt_key: self.keys.receipt_key(),
            site: self.keys.site,
        }
    }

    /// The pictograms of all that was said.
    fn pictograms_of(&self, attempt: &EnrolAttempt, reveal: &EnrolReveal) -> Option<[u8; 4]> {
        let commit = EnrolCommit {
            commitment: ContentHash(attempt.commitment),
            hint: DeviceHint(attempt.hint),
            name: DeviceName::new(&attempt.name)?,
        };
        let answer = self.commit_answer(attempt.attempt, EnrolNonce(attempt.booth_nonce));
        let transcript = enrolment_transcript(&commit, &answer, reveal);
        let pictograms = enrolment_pictograms(&hash_of(&transcript));
        Some(pictograms.map(|pictogram| pictogram.number() as u8))
    }
}

const NOTHING_WAITS: Refusal = Refusal::NotFound(Reason::NoAttempt);

fn is_living(attempt: &EnrolAttempt, now: BoothTime) -> bool {
    now.since(attempt.began_at) < ATTEMPT_LIFE
}

fn is_open(attempt: &EnrolAttempt, now: BoothTime) -> bool {
    let is_undecided = matches!(attempt.state, AttemptState::Committed | AttemptState::Waiting);
    is_undecided && is_living(attempt, now)
}

fn state_of(attempt: &EnrolAttempt) -> EnrolState {
    match attempt.state {
        AttemptState::Committed | AttemptState::Waiting => EnrolState::Waiting,
        AttemptState::Accepted => EnrolState::Accepted,
        AttemptState::Declined => EnrolState::Declined,
    }
}

/// An attempt that isn't too old.
fn find_living(
    tx: &mut Tx<'_>,
    attempt: u64,
    now: BoothTime,
) -> Result<Option<EnrolAttempt>, StoreError> {
    let attempt: Option<EnrolAttempt> = tx.get(&[attempt.to_value()])?;
    Ok(attempt.filter(|attempt| is_living(attempt, now)))
}

fn find_waiting(tx: &mut Tx<'_>, attempt: u64, now: BoothTime) -> Result<EnrolAttempt, Refusal> {
    let attempt = find_living(tx, attempt, now)?;
    attempt.filter(|attempt| attempt.state == AttemptState::Waiting).ok_or(NOTHING_WAITS)
}

fn drop_old_attempts(tx: &mut Tx<'_>, now: BoothTime) -> Result<(), StoreError> {
    for attempt in tx.find::<EnrolAttempt>(&Query::all::<EnrolAttempt>())? {
        if !is_living(&attempt, now) {
            tx.remove::<EnrolAttempt>(&[attempt.attempt.to_value()])?;
        }
    }
    Ok(())
}
