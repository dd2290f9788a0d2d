//! One thread for each printer on the network. It uploads due prints, polls the printer's status, and cancels
//! prints that staff took back. A printer that is switched off delays only its own thread.

use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use paros_booth_rules::records::{PrintOrder, WorkKind};
use paros_booth_rules::{Booth, PrintJob, PrinterTask, PrinterWord, Refusal};
use tracing::{info, warn};

use super::printer_file::{PrinterEntry, read_printers};
use super::printer_link::{Activity, PrinterFault, PrinterLink, PrinterStatus};
use super::slicer::{SliceFault, Slicer};
use super::slices::height_of;
use crate::clock::booth_time;
use crate::error::Error;
use crate::models::exporter::make_stl;
use crate::server::work_keeper::keep_work;
use crate::server::worker::{Waker, Worker};

/// The poll interval of a printer with a current or due print.
const LOOK_OFTEN: Duration = Duration::from_secs(5);

/// The poll interval of other printers.
const LOOK_AGAIN: Duration = Duration::from_secs(30);

/// A printer's state as the staff page shows it.
#[derive(Clone)]
pub(crate) struct PrinterView {
    /// The printer's name.
    pub(crate) name: String,
    /// The last polled status; `None` if the printer didn't respond.
    pub(crate) status: Option<PrinterStatus>,
}

/// The pages' handle of a printer.
pub(crate) struct Printer {
    name: String,
    waker: Waker,
    last: Arc<Mutex<Option<PrinterStatus>>>,
}

/// The state of a printer's thread.
struct PrinterThread {
    name: String,
    link: PrinterLink,
    profile: Option<PathBuf>,
    slicer: Arc<Slicer>,
    booth: Booth,
    last: Arc<Mutex<Option<PrinterStatus>>>,
}

impl Printer {
    /// Returns the printer's name and its last polled status.
    pub(crate) fn view(&self) -> PrinterView {
        let status = self.last.lock().unwrap_or_else(PoisonError::into_inner).clone();
        PrinterView { name: self.name.clone(), status }
    }

    /// Returns the printer's name.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Wakes the printer's thread, as there is work.
    pub(crate) fn wake(&self) {
        self.waker.wake();
    }
}

/// Starts a thread for each printer in a printers file.
///
/// # Errors
/// A description of what is wrong with the file, or that there is no slicer.
pub(crate) fn start_printers(
    file: &std::path::Path,
    booth: &Booth,
    slicer: Option<&Arc<Slicer>>,
) -> Result<(Vec<Printer>, Vec<Worker>), Error> {
    let entries = read_printers(file)?;
    let Some(slicer) = slicer else {
        return Err(Error::Input(format!("--printers {}: expected a slicer", file.display())));
    };
    let (mut printers, mut workers) = (Vec::new(), Vec::new());
    for entry in entries {
        let link = PrinterLink::new(&entry)?;
        let PrinterEntry { name, profile, .. } = entry;
        let last = Arc::new(Mutex::new(None));
        let thread = PrinterThread {
            name: name.clone(),
            link,
            profile,
            slicer: slicer.clone(),
            booth: booth.clone(),
            last: last.clone(),
        };
        let worker = Worker::start(move || thread.look());
        printers.push(Printer { name, waker: worker.waker(), last });
        workers.push(worker);
    }
    Ok((printers, workers))
}

impl PrinterThread {
    /// Polls the printer, and does its next task if there is one. Returns the time until the next poll.
    fn look(&self) -> Duration {
        let task = match self.booth.next_printer_task(&self.name, booth_time()) {
            Ok(task) => task,
            Err(error) => {
                warn!(%error, "a printer's prints could not be looked at");
                return LOOK_AGAIN;
            }
        };
        let status = self.link.status();
        self.show(status.as_ref().ok());
        let wait = if task.is_some() { LOOK_OFTEN } else { LOOK_AGAIN };
        let Some(task) = task else { return wait };
        let subject = self.name.as_bytes();
        let done = match status {
            Ok(status) => keep_work(&self.booth, WorkKind::Printer, subject, || match task {
                PrinterTask::Send(job) => self.send(&job, &status),
                PrinterTask::Watch(order) => self.watch(&order, &status),
                PrinterTask::Stop(order) => self.stop(&order, &status),
            }),
            // The printer doesn't respond. Release the task: another booth may reach the printer. A file that
            // was sent already stays there.
            Err(_) => self.booth.leave_work(WorkKind::Printer, subject),
        };
        if let Err(error) = done {
            warn!(printer = self.name, %error, "a print could not be seen to");
        }
        wait
    }

    fn show(&self, status: Option<&PrinterStatus>) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = status.cloned();
    }

    fn send(&self, job: &PrintJob, status: &PrinterStatus) -> Result<(), Refusal> {
        // The print that ended last doesn't matter: staff confirmed by sending this print that the bed is
        // empty.
        if matches!(status.activity, Activity::Printing | Activity::Busy | Activity::Broken) {
            return Ok(());
        }
        let order = job.order.order;
        let refuse = |why: &str| {
            self.booth.begin_print(order, "", booth_time())?;
            self.booth.refuse_print(order, why, booth_time())
        };
        let stl = match make_stl(&self.booth.read_kept(&job.sculpture)?) {
            Ok(stl) => stl,
            Err(why) => return refuse(&why),
        };
        let Some(model_mm) = height_of(&stl) else { return refuse("it has no height") };
        let scale = f64::from(job.order.height_tenths_mm) / 10.0 / model_mm;
        let sliced = match self.slicer.slice(&stl, scale, self.profile.as_deref()) {
            Ok(sliced) => sliced,
            Err(SliceFault::Over) => return Ok(()),
            Err(SliceFault::Disk(why)) => return Err(Refusal::Files(io::Error::other(why))),
            Err(SliceFault::TooLarge) => return refuse("it is larger than the printer"),
            Err(SliceFault::Failed(why)) => return refuse(&why),
        };
        drop(stl);
        let name = format!("paros-{order:016x}.gcode");
        // Record the begin before the upload, so that a print is never sent twice, even after a power cut.
        if !self.booth.begin_print(order, &name, booth_time())? {
            return Ok(());
        }
        let sent = self.link.send(&name, &sliced.gcode);
        info!(printer = self.name, order, ?sent, "print sent");
        match sent {
            // If the response is missing, the next status poll shows whether the file arrived.
            Ok(()) | Err(PrinterFault::Silent) => Ok(()),
            Err(PrinterFault::Refused(why)) => self.booth.refuse_print(order, &why, booth_time()),
        }
    }

    fn watch(&self, order: &PrintOrder, status: &PrinterStatus) -> Result<(), Refusal> {
        let word = word_of(order, status);
        self.booth.note_printer_word(order.order, word, booth_time())
    }

    fn stop(&self, order: &PrintOrder, status: &PrinterStatus) -> Result<(), Refusal> {
        if word_of(order, status) == PrinterWord::Prints {
            let stopped = self.link.stop(status);
            info!(printer = self.name, order = order.order, ?stopped, "print stopped");
            if stopped.is_err() {
                return Ok(());
            }
        }
        self.booth.release_printer(order.order)
    }
}

/// Interprets a printer's status for the booth's print, which is identified by its file name.
fn word_of(order: &PrintOrder, status: &PrinterStatus) -> PrinterWord {
    // Some printers report no file while they finish. Then nothing is known about the print.
    if status.file.is_none() || status.file != order.job {
        return PrinterWord::Other;
    }
    match status.activity {
        Activity::Printing | Activity::Busy => PrinterWord::Prints,
        Activity::Finished => PrinterWord::Finished,
        Activity::Stopped => PrinterWord::Stopped,
        Activity::Broken => PrinterWord::Broke,
        Activity::Idle => PrinterWord::Other,
    }
}
