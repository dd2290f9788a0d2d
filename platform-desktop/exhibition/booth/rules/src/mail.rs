//! Mail orders: sculptures that visitors want by e-mail. Each mail is retried until a server accepts it. The
//! address is deleted then, or when the order has failed, unless the visitor agreed that it stays with the
//! sculpture. No log, audit or backup contains addresses.

use std::time::Duration;

use paros_core::badge::Language;
use paros_protocol::SculptureId;

use crate::audit::note;
use crate::booth::{Booth, Tx};
use crate::find::NO_SCULPTURE;
use crate::lifecycle::{get_sculpture, subject_of};
use crate::limits::{
    MAX_MAIL_TRIES, MAX_MAILS_OF_ONE, MAX_RETRY_WAIT, MAX_WORKERS, MIN_RETRY_WAIT,
};
use crate::reason::{Expected, Reason};
use crate::records::{MailOrder, MailState, Sculpture, WorkKind};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;
use crate::work::end_work;

/// A mail that is due.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MailJob {
    /// The order's number.
    pub order: u64,
    /// The address of the recipient.
    pub address: String,
    /// The language of the mail.
    pub language: Language,
    /// The sculpture to send.
    pub sculpture: Sculpture,
    /// `true` if the address is kept after the mail was sent.
    pub keeps_address: bool,
}

/// The outcome of a try. Its texts contain no address.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum MailOutcome {
    /// The server accepted the mail.
    Accepted,
    /// A temporary failure: the mail is retried.
    Later(String),
    /// A permanent failure.
    Refused(String),
}

impl Booth {
    /// Orders a mail of a sculpture, in the language of its visit. `keeps_address` is `true` if the visitor
    /// agreed that the address is kept as long as the sculpture. `order` is random bits.
    ///
    /// # Errors
    /// [`Refusal::Unfit`] for an invalid address, [`Refusal::NotFound`] if the sculpture isn't shown,
    /// [`Refusal::Conflict`] if it has too many orders; or a store error.
    pub fn ask_mail(
        &self,
        id: &SculptureId,
        (address, keeps_address): (&str, bool),
        order: u64,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        let address = address.trim();
        if !is_address(address) {
            return Err(Refusal::Unfit(Expected::MailAddress));
        }
        self.update(|tx| {
            let sculpture = get_sculpture(tx, id)?;
            if sculpture.withdrawn_at.is_some() {
                return Err(NO_SCULPTURE);
            }
            let count = tx.count::<MailOrder>("WHERE sculpture = ?1", &[&id.0])?;
            if count >= MAX_MAILS_OF_ONE || tx.get::<MailOrder>(&[&order])?.is_some() {
                return Err(Refusal::Conflict(Reason::MailsFull));
            }
            tx.put(&MailOrder {
                order,
                sculpture: id.0,
                address: Some(address.to_owned()),
                language: sculpture.visit_language() as u8,
                asked_at: now,
                state: MailState::Queued,
                tries: 0,
                next_try_at: now,
                why: String::new(),
                keeps_address,
            })?;
            Ok(note(tx, now, Some(account), "mail", subject_of(&sculpture))?)
        })
    }

    /// Returns the mails of a sculpture, the newest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_mails(&self, id: &SculptureId) -> Result<Vec<MailOrder>, Refusal> {
        let newest_first = r#"WHERE sculpture = ?1 ORDER BY asked_at DESC, "order""#;
        self.view(|tx| tx.find(newest_first, &[&id.0]))
    }

    /// Returns the mail that is overdue the longest and that no other process sends. Mails of sculptures that
    /// are no longer shown fail.
    ///
    /// # Errors
    /// Store errors.
    pub fn next_mail(&self, now: BoothTime) -> Result<Option<MailJob>, Refusal> {
        loop {
            if self.view(|tx| find_due(tx, now))?.is_empty() {
                return Ok(None);
            }
            let Some(order) = self.update(|tx| self.begin_mail(tx, now))? else {
                return Ok(None);
            };
            let id = SculptureId(order.sculpture);
            let sculpture = match self.find_sculpture(&id) {
                Ok(sculpture) => Some(sculpture).filter(|found| found.withdrawn_at.is_none()),
                Err(Refusal::NotFound(_)) => None,
                Err(refusal) => return Err(refusal),
            };
            if let (Some(sculpture), Some(address)) = (sculpture, order.address) {
                let is_greek = order.language == Language::Greek as u8;
                let language = if is_greek { Language::Greek } else { Language::English };
                let MailOrder { order, keeps_address, .. } = order;
                return Ok(Some(MailJob { order, address, language, sculpture, keeps_address }));
            }
            self.note_mail(order.order, &MailOutcome::Refused(WITHDRAWN.into()), now)?;
        }
    }

    /// Begins the first due mail that no other process sends.
    fn begin_mail(&self, tx: &mut Tx<'_>, now: BoothTime) -> Result<Option<MailOrder>, Refusal> {
        for order in find_due(tx, now)? {
            if self.begin_work(tx, WorkKind::Mail, &order.order.to_le_bytes(), now)? {
                return Ok(Some(order));
            }
        }
        Ok(None)
    }

    /// Stores the outcome of a try. Does nothing if the order is gone or ended meanwhile.
    ///
    /// # Errors
    /// Store errors.
    pub fn note_mail(
        &self,
        order: u64,
        outcome: &MailOutcome,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            end_work(tx, WorkKind::Mail, &order.to_le_bytes())?;
            let found: Option<MailOrder> = tx.get(&[&order])?;
            let Some(mut order) = found.filter(|order| order.state == MailState::Queued) else {
                return Ok(());
            };
            order.tries += 1;
            match outcome {
                MailOutcome::Accepted => end_order(&mut order, MailState::Accepted, ""),
                MailOutcome::Later(why) if order.tries < MAX_MAIL_TRIES => {
                    order.next_try_at = now.after(retry_wait(order.tries));
                    order.why.clone_from(why);
                }
                MailOutcome::Later(why) | MailOutcome::Refused(why) => {
                    end_order(&mut order, MailState::Failed, why);
                }
            }
            Ok(tx.put(&order)?)
        })
    }
}

/// The failure text of a mail whose sculpture is no longer shown.
const WITHDRAWN: &str = "the sculpture was withdrawn";

/// Fails the queued mails of a withdrawn sculpture, and deletes all its addresses.
pub(crate) fn withdraw_mails(tx: &mut Tx<'_>, sculpture: &[u8; 16]) -> Result<(), StoreError> {
    for mut order in tx.find::<MailOrder>("WHERE sculpture = ?1", &[sculpture])? {
        if order.state == MailState::Queued {
            end_order(&mut order, MailState::Failed, WITHDRAWN);
        }
        // A withdrawal also ends the consent to keep addresses.
        order.address = None;
        tx.put(&order)?;
    }
    Ok(())
}

/// Fails all queued mails. Returns their number.
pub(crate) fn fail_queued_mails(tx: &mut Tx<'_>, why: &str) -> Result<usize, StoreError> {
    let mut queued: Vec<MailOrder> = tx.find("WHERE state = ?1", &[&MailState::Queued])?;
    for order in &mut queued {
        end_order(order, MailState::Failed, why);
        tx.put(order)?;
    }
    Ok(queued.len())
}

/// Returns the due mails, up to [`MAX_WORKERS`], as other processes may be sending the first ones.
fn find_due(tx: &mut Tx<'_>, now: BoothTime) -> Result<Vec<MailOrder>, StoreError> {
    let due = r#"WHERE state = ?1 AND next_try_at <= ?2 ORDER BY next_try_at, "order" LIMIT ?3"#;
    tx.find(due, &[&MailState::Queued, &now, &MAX_WORKERS])
}

/// Ends an order. Deletes its address, unless the mail was accepted and the visitor agreed to keep it.
fn end_order(order: &mut MailOrder, state: MailState, why: &str) {
    order.state = state;
    let is_kept = order.keeps_address && state == MailState::Accepted;
    order.address = order.address.take().filter(|_| is_kept);
    order.why = why.to_owned();
}

/// Returns the wait until the next try after `tries` tries: exponential backoff.
fn retry_wait(tries: u32) -> Duration {
    let doubled = MIN_RETRY_WAIT.saturating_mul(1 << (tries - 1).min(16));
    doubled.min(MAX_RETRY_WAIT)
}

/// Returns `true` if a text has the form of an address: an unquoted local part, and several domain labels.
fn is_address(text: &str) -> bool {
    let Some((local, domain)) = text.rsplit_once('@') else { return false };
    let is_local =
        |letter: u8| letter.is_ascii_alphanumeric() || b"!#$%&'*+-/=?^_`{|}~".contains(&letter);
    let is_label = |label: &str| {
        let is_plain = label.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'-');
        (1..=63).contains(&label.len())
            && is_plain
            && !label.starts_with('-')
            && !label.ends_with('-')
    };
    let is_atom = |atom: &str| !atom.is_empty() && atom.bytes().all(is_local);
    text.len() <= 254
        && local.len() <= 64
        && local.split('.').all(is_atom)
        && domain.contains('.')
        && domain.split('.').all(is_label)
}
