//! Prints that go to a printer on the network. A person sends each: whether the last print still lies on the bed, nobody
//! else knows. A printer has one of the booth's prints at most, from when it is sent until it is over.

use crate::audit::note;
use crate::booth::Booth;
use crate::lifecycle::subject_of;
use crate::limits::{LIFE_AT_PRINTER, SENDING_LIFE};
use crate::prints::{PrintJob, PrintStep, get_order, take_step};
use crate::reason::Reason;
use crate::records::{EstimateState, PrintOrder, PrintState, Sculpture, WorkKind};
use crate::refusal::Refusal;
use crate::time::BoothTime;

/// Finds the prints of a printer.
const AT_PRINTER: &str = r#"WHERE printer = ?1 ORDER BY "order""#;

/// What a printer says of the booth's print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrinterWord {
    /// It prints it.
    Prints,
    /// It has printed it.
    Finished,
    /// It was stopped, at the printer or by the booth.
    Stopped,
    /// It broke off.
    Broke,
    /// It is at something else, or at nothing.
    Other,
}

/// What is to be done about a printer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PrinterTask {
    /// Send it this print.
    Send(PrintJob),
    /// Ask it how this print is.
    Watch(PrintOrder),
    /// Stop this print, and say so by [`Booth::release_printer`].
    Stop(PrintOrder),
}

impl Booth {
    /// Sends a print to a printer, as soon as that answers.
    ///
    /// # Errors
    /// [`Refusal::NotFound`]; [`Refusal::Conflict`] where it isn't sliced, or the printer has another print; or those
    /// of the store.
    pub fn send_print(
        &self,
        order: u64,
        printer: &str,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let (mut order, sculpture) = get_order(tx, order)?;
            if order.state != PrintState::Sliced || order.estimate != EstimateState::Known {
                return Err(Refusal::Conflict(Reason::NotSliced));
            }
            if tx.find::<PrintOrder>(AT_PRINTER, &[&printer])?.iter().any(holds_printer) {
                return Err(Refusal::Conflict(Reason::PrinterTaken));
            }
            order.printer = Some(printer.to_owned());
            (order.changed_at, order.why) = (now, String::new());
            tx.put(&order)?;
            Ok(note(tx, now, Some(account), "print sent", subject_of(&sculpture))?)
        })
    }

    /// What is to be done about a printer now; `None` where it has no print of the booth's, or another process sees to
    /// it. What waited too long for an answer of the printer's is taken back: by then something else may lie on its bed.
    ///
    /// # Errors
    /// Those of the store.
    pub fn next_printer_task(
        &self,
        printer: &str,
        now: BoothTime,
    ) -> Result<Option<PrinterTask>, Refusal> {
        self.update(|tx| {
            let orders = tx.find::<PrintOrder>(AT_PRINTER, &[&printer])?;
            // Two that stop a print at once stop the next one too.
            if !orders.is_empty()
                && !self.begin_work(tx, WorkKind::Printer, printer.as_bytes(), now)?
            {
                return Ok(None);
            }
            for mut order in orders {
                match (order.state, &order.job) {
                    (PrintState::Printing, Some(_)) => return Ok(Some(PrinterTask::Watch(order))),
                    (PrintState::Cancelled, Some(_)) => return Ok(Some(PrinterTask::Stop(order))),
                    (PrintState::Sliced, None) if now.since(order.changed_at) > SENDING_LIFE => {
                        order.printer = None;
                        order.why = "the printer didn't answer".into();
                        tx.put(&order)?;
                    }
                    (PrintState::Sliced, None) => {
                        if let Some(sculpture) = tx.get::<Sculpture>(&[&order.sculpture])? {
                            return Ok(Some(PrinterTask::Send(PrintJob { order, sculpture })));
                        }
                    }
                    _ => {}
                }
            }
            // The next one may be sent at any process' page.
            self.end_own_work(tx, WorkKind::Printer, printer.as_bytes())?;
            Ok(None)
        })
    }

    /// Notes that a printer is about to get a print under this name, before it does: from now on it may have it. Returns
    /// whether it is still to be sent.
    ///
    /// # Errors
    /// Those of the store.
    pub fn begin_print(&self, order: u64, job: &str, now: BoothTime) -> Result<bool, Refusal> {
        self.update(|tx| {
            let found: Option<PrintOrder> = tx.get(&[&order])?;
            let is_to_be_sent = |order: &PrintOrder| {
                order.state == PrintState::Sliced && order.printer.is_some() && order.job.is_none()
            };
            let Some(mut order) = found.filter(is_to_be_sent) else { return Ok(false) };
            order.job = Some(job.to_owned());
            take_step(tx, &mut order, PrintStep::Start, "", now)?;
            Ok(true)
        })
    }

    /// Notes what a printer says of a print that it has; nothing where that is over meanwhile.
    ///
    /// # Errors
    /// Those of the store.
    pub fn note_printer_word(
        &self,
        order: u64,
        word: PrinterWord,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        let (step, why) = match word {
            PrinterWord::Prints => return Ok(()),
            PrinterWord::Finished => (PrintStep::Finish, ""),
            PrinterWord::Stopped => (PrintStep::Cancel, "it was stopped at the printer"),
            PrinterWord::Broke => (PrintStep::Fail, "the printer broke off"),
            PrinterWord::Other => (PrintStep::Fail, "the printer doesn't have it"),
        };
        self.end_print(
            order,
            (step, why),
            |order| {
                // It takes a moment until a file that was sent is being printed.
                word != PrinterWord::Other || now.since(order.changed_at) > LIFE_AT_PRINTER
            },
            now,
        )
    }

    /// Notes that a printer refused a print.
    ///
    /// # Errors
    /// Those of the store.
    pub fn refuse_print(&self, order: u64, why: &str, now: BoothTime) -> Result<(), Refusal> {
        self.end_print(order, (PrintStep::Fail, why), |_| true, now)
    }

    /// Notes that a print that was taken back was stopped at its printer, or isn't there.
    ///
    /// # Errors
    /// Those of the store.
    pub fn release_printer(&self, order: u64) -> Result<(), Refusal> {
        self.update(|tx| {
            if let Some(mut order) = tx.get::<PrintOrder>(&[&order])? {
                (order.printer, order.job) = (None, None);
                tx.put(&order)?;
            }
            Ok(())
        })
    }

    fn end_print(
        &self,
        order: u64,
        (step, why): (PrintStep, &str),
        is_due: impl Fn(&PrintOrder) -> bool,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let found: Option<PrintOrder> = tx.get(&[&order])?;
            let is_at_it =
                |order: &PrintOrder| order.state == PrintState::Printing && order.job.is_some();
            let Some(mut order) = found.filter(is_at_it).filter(&is_due) else { return Ok(()) };
            (order.printer, order.job) = (None, None);
            take_step(tx, &mut order, step, why, now)
        })
    }
}

/// Whether a printer can't have another print because of this one.
fn holds_printer(order: &PrintOrder) -> bool {
    match order.state {
        PrintState::Sliced | PrintState::Printing => true,
        PrintState::Cancelled => order.job.is_some(),
        PrintState::Ordered | PrintState::Done | PrintState::Failed => false,
    }
}
