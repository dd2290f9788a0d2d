//! Queue lengths and ages, for monitoring.

use std::time::Duration;

use crate::booth::Booth;
use crate::clock::seen_time;
use crate::records::{
    Announcement, ExportState, MailOrder, MailState, PrintOrder, PrintState, Sculpture, SeenTime,
};
use crate::refusal::Refusal;
use crate::time::BoothTime;

/// The lengths of the queues, and the ages of their oldest entries.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct QueueReport {
    /// Sculptures whose mesh is still to be made.
    pub exports: u64,
    /// Sculptures that headsets announced and that haven't arrived.
    pub missing: u64,
    /// Mails that wait to be sent.
    pub mails: u64,
    /// The waiting time of the oldest of these mails; 0 if there is none.
    pub oldest_mail: Duration,
    /// Prints that wait for a printer.
    pub prints: u64,
    /// The waiting time of the oldest of these prints; 0 if there is none.
    pub oldest_print: Duration,
}

impl Booth {
    /// Measures the queues.
    ///
    /// # Errors
    /// Store errors.
    pub fn measure_queues(&self, now: BoothTime) -> Result<QueueReport, Refusal> {
        self.view(|tx| {
            let mails = "WHERE state = ?1 ORDER BY asked_at";
            let oldest_mail = tx.find_first::<MailOrder>(mails, &[&MailState::Queued])?;
            let (ordered, sliced) = (PrintState::Ordered, PrintState::Sliced);
            let prints = "WHERE state IN (?1, ?2) ORDER BY asked_at";
            let oldest_print = tx.find_first::<PrintOrder>(prints, &[&ordered, &sliced])?;
            let age =
                |asked_at: Option<BoothTime>| asked_at.map_or(Duration::ZERO, |at| now.since(at));
            Ok(QueueReport {
                exports: tx.count::<Sculpture>("WHERE export = ?1", &[&ExportState::Queued])?,
                missing: tx.count::<Announcement>("", &[])?,
                mails: tx.count::<MailOrder>("WHERE state = ?1", &[&MailState::Queued])?,
                oldest_mail: age(oldest_mail.map(|mail| mail.asked_at)),
                prints: tx.count::<PrintOrder>("WHERE state IN (?1, ?2)", &[&ordered, &sliced])?,
                oldest_print: age(oldest_print.map(|print| print.asked_at)),
            })
        })
    }

    /// Checks that the store is writable, by rewriting a row unchanged.
    ///
    /// # Errors
    /// Store errors.
    pub fn check_store(&self, now: BoothTime) -> Result<(), Refusal> {
        self.update(|tx| {
            let seen_at = seen_time(tx, now)?;
            Ok(tx.put(&SeenTime { row: 0, seen_at })?)
        })
    }
}
