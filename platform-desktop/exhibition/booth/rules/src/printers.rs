//! Prints on networked printers. A person sends each print, as only a person can see that the bed is empty. A
//! printer has at most one print of the booth, from when it is sent until it ends.

use crate::audit::note;
use crate::booth::Booth;
use crate::lifecycle::subject_of;
use crate::limits::{LIFE_AT_PRINTER, SENDING_LIFE};
use crate::prints::{PrintJob, PrintStep, get_order, take_step};
use crate::reason::Reason;
use crate::records::{EstimateState, PrintOrder, PrintState, Sculpture, WorkKind};
use crate::refusal::Refusal;
use crate::time::BoothTime;

/// Selects the prints of a printer.
const AT_PRINTER: &str = r#"WHERE printer = ?1 ORDER BY "order""#;

/// A printer's status of the booth's print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrinterWord {
    /// The print is running.
    Prints,
    /// The print is finished.
    Finished,
    /// The print was stopped, at the printer or by the booth.
    Stopped,
    /// The print failed at the printer.
    Broke,
    /// The printer is idle, or has another job.
    Other,
}

/// The next task for a printer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PrinterTask {
    /// Send the print.
    Send(PrintJob),
    /// Ask for the status of the print.
    Watch(PrintOrder),
    /// Stop the print, and confirm it with [`Booth::release_printer`].
    Stop(PrintOrder),
}

impl Booth {
    /// Assigns a print to a printer. It is sent as soon as the printer answers.
    ///
    /// # Errors
    /// [`Refusal::NotFound`]; [`Refusal::Conflict`] if the print isn't sliced, or the printer has another
    /// print; or a store error.
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

    /// Returns the next task for a printer; `None` if it has no print of the booth, or another process
    /// handles it. Takes back a print that the printer didn't answer in time, as something else may lie on
    /// its bed by then.
    ///
    /// # Errors
    /// Store errors.
    pub fn next_printer_task(
        &self,
        printer: &str,
        now: BoothTime,
    ) -> Result<Option<PrinterTask>, Refusal> {
        self.update(|tx| {
            let orders = tx.find::<PrintOrder>(AT_PRINTER, &[&printer])?;
            // Two processes that stop a print at once would also stop the next print.
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
            // Any process may send the next print.
            self.end_own_work(tx, WorkKind::Printer, printer.as_bytes())?;
            Ok(None)
        })
    }

    /// Records the job name of a print before it is sent to the printer, which may have it from now on.
    /// Returns `true` if the print is still to be sent.
    ///
    /// # Errors
    /// Store errors.
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

    /// Applies the printer's status of a print. Does nothing if the print has ended meanwhile.
    ///
    /// # Errors
    /// Store errors.
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
                // A printer takes a moment to start a file that it received.
                word != PrinterWord::Other || now.since(order.changed_at) > LIFE_AT_PRINTER
            },
            now,
        )
    }

    /// Fails a print that its printer refused.
    ///
    /// # Errors
    /// Store errors.
    pub fn refuse_print(&self, order: u64, why: &str, now: BoothTime) -> Result<(), Refusal> {
        self.end_print(order, (PrintStep::Fail, why), |_| true, now)
    }

    /// Releases the printer of a cancelled print, after it was stopped or wasn't found there.
    ///
    /// # Errors
    /// Store errors.
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

/// Returns `true` if a print blocks its printer for other prints.
fn holds_printer(order: &PrintOrder) -> bool {
    match order.state {
        PrintState::Sliced | PrintState::Printing => true,
        PrintState::Cancelled => order.job.is_some(),
        PrintState::Ordered | PrintState::Done | PrintState::Failed => false,
    }
}
