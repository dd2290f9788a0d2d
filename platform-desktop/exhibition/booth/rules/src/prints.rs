//! Print orders: sculptures that visitors want printed, from the order to the finished print.

use paros_protocol::SculptureId;

use crate::audit::note;
use crate::booth::{Booth, Tx};
use crate::find::NO_SCULPTURE;
use crate::lifecycle::{get_sculpture, subject_of};
use crate::limits::{MAX_LISTED, MAX_PRINTS_OF_ONE, MAX_WORKERS};
use crate::print_wish::{PrintSize, PrintWish, check_minutes_can_be_found};
use crate::reason::Reason;
use crate::records::{EstimateState, PrintOrder, PrintState, Sculpture, WorkKind};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;
use crate::value::ToValue;
use crate::work::end_work;

pub(crate) const NO_ORDER: Refusal = Refusal::NotFound(Reason::NoPrint);

/// The failure text of a print whose sculpture is no longer shown.
const WITHDRAWN: &str = "the sculpture was withdrawn";

/// A step in the life of a print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrintStep {
    /// The slicer estimated duration and material.
    Slice,
    /// A printer starts the print.
    Start,
    /// The print is finished.
    Finish,
    /// The print failed.
    Fail,
    /// Staff cancel the print.
    Cancel,
    /// The print is ordered again.
    Retry,
}

/// A print to slice or to print.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrintJob {
    /// The order of the print.
    pub order: PrintOrder,
    /// The sculpture to print.
    pub sculpture: Sculpture,
}

/// The result of the slicer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SliceOutcome {
    /// The height, the duration and the material.
    Known {
        /// The height in tenths of a millimetre.
        height: u32,
        /// The duration in minutes.
        minutes: u32,
        /// The filament in tenths of a gram.
        tenths_gram: u32,
    },
    /// No estimate, with the reason.
    Unknown(String),
}

impl PrintState {
    /// Returns the state after a step; `None` if the step isn't possible in this state.
    #[must_use]
    pub const fn after(self, step: PrintStep) -> Option<PrintState> {
        use PrintState::{Cancelled, Done, Failed, Ordered, Printing, Sliced};
        match (self, step) {
            (Ordered, PrintStep::Slice) => Some(Sliced),
            // Without a slicer, a print starts without an estimate.
            (Ordered | Sliced, PrintStep::Start) => Some(Printing),
            (Printing, PrintStep::Finish) => Some(Done),
            (Ordered | Sliced | Printing, PrintStep::Fail) => Some(Failed),
            (Ordered | Sliced | Printing, PrintStep::Cancel) => Some(Cancelled),
            (Done | Failed | Cancelled, PrintStep::Retry) => Some(Ordered),
            _ => None,
        }
    }

    /// `true` if the print is waiting to be printed, or is being printed.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, PrintState::Ordered | PrintState::Sliced | PrintState::Printing)
    }
}

impl Booth {
    /// Orders a print of a sculpture. `order` is random bits. `can_slice` is `true` if there is a slicer,
    /// without which no size can be found for a duration.
    ///
    /// # Errors
    /// [`Refusal::Unfit`] if size or texts are out of bounds, [`Refusal::NotFound`] if the sculpture isn't
    /// shown, [`Refusal::Conflict`] if it has too many orders; or a store error.
    pub fn ask_print(
        &self,
        id: &SculptureId,
        wish: &PrintWish,
        (order, can_slice): (u64, bool),
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        wish.check(can_slice)?;
        let (height_tenths_mm, most_minutes) = match wish.size {
            PrintSize::Height(height) => (height, None),
            PrintSize::Minutes(minutes) => (0, Some(minutes)),
        };
        self.update(|tx| {
            let sculpture = get_sculpture(tx, id)?;
            if sculpture.withdrawn_at.is_some() {
                return Err(NO_SCULPTURE);
            }
            let count = tx.count::<PrintOrder>("WHERE sculpture = ?1", &[&id.0])?;
            if count >= MAX_PRINTS_OF_ONE || tx.get::<PrintOrder>(&[&order])?.is_some() {
                return Err(Refusal::Conflict(Reason::PrintsFull));
            }
            tx.put(&PrintOrder {
                order,
                sculpture: id.0,
                height_tenths_mm,
                filament: wish.filament.trim().to_owned(),
                note: wish.note.trim().to_owned(),
                asked_at: now,
                state: PrintState::Ordered,
                most_minutes,
                estimate: estimate_at_first(can_slice),
                minutes: None,
                tenths_gram: None,
                printer: None,
                job: None,
                changed_at: now,
                why: String::new(),
            })?;
            Ok(note(tx, now, Some(account), "print", subject_of(&sculpture))?)
        })
    }

    /// Returns the prints of a sculpture, the newest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_prints(&self, id: &SculptureId) -> Result<Vec<PrintOrder>, Refusal> {
        let newest_first = r#"WHERE sculpture = ?1 ORDER BY asked_at DESC, "order""#;
        self.view(|tx| tx.find(newest_first, &[&id.0]))
    }

    /// Returns all prints with their sculptures: open prints, oldest first; then ended prints, newest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_print_queue(&self) -> Result<Vec<PrintJob>, Refusal> {
        self.view(|tx| {
            let open = r#"WHERE state = ?1 ORDER BY asked_at, "order" LIMIT ?2"#;
            let mut orders = Vec::new();
            for state in [PrintState::Printing, PrintState::Sliced, PrintState::Ordered] {
                orders.extend(tx.find::<PrintOrder>(open, &[&state, &MAX_LISTED])?);
            }
            let ended = r#"WHERE state IN (?1, ?2, ?3) ORDER BY changed_at DESC, "order" LIMIT ?4"#;
            let (done, failed) = (PrintState::Done, PrintState::Failed);
            let values: [&dyn ToValue; 4] = [&done, &failed, &PrintState::Cancelled, &MAX_LISTED];
            orders.extend(tx.find::<PrintOrder>(ended, &values)?);
            let mut jobs = Vec::new();
            for order in orders {
                if let Some(sculpture) = tx.get::<Sculpture>(&[&order.sculpture])? {
                    jobs.push(PrintJob { order, sculpture });
                }
            }
            Ok(jobs)
        })
    }

    /// Returns a print with its sculpture.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
    pub fn find_print(&self, order: u64) -> Result<PrintJob, Refusal> {
        let found = self.view(|tx| {
            let Some(order) = tx.get::<PrintOrder>(&[&order])? else { return Ok(None) };
            let sculpture = tx.get::<Sculpture>(&[&order.sculpture])?;
            Ok(sculpture.map(|sculpture| PrintJob { order, sculpture }))
        });
        found?.ok_or(NO_ORDER)
    }

    /// Applies a step of a print, at the request of staff.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], [`Refusal::Conflict`] if the step isn't possible in the print's state, or a
    /// store error.
    pub fn step_print(
        &self,
        order: u64,
        (step, can_slice): (PrintStep, bool),
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let (mut order, sculpture) = get_order(tx, order)?;
            if step == PrintStep::Retry {
                if sculpture.withdrawn_at.is_some() {
                    return Err(NO_SCULPTURE);
                }
                if order.most_minutes.is_some() {
                    check_minutes_can_be_found(can_slice)?;
                    order.height_tenths_mm = 0;
                }
                order.estimate = estimate_at_first(can_slice);
                (order.minutes, order.tenths_gram) = (None, None);
            }
            // A cancelled print keeps its printer, where it has to be stopped. Any other step frees it.
            if !(step == PrintStep::Cancel && order.job.is_some()) {
                (order.printer, order.job) = (None, None);
            }
            take_step(tx, &mut order, step, "", now)?;
            Ok(note(tx, now, Some(account), name_of(step), subject_of(&sculpture))?)
        })
    }

    /// Returns the print that waits longest for the slicer, and that no other process slices.
    ///
    /// # Errors
    /// Store errors.
    pub fn next_slice(&self, now: BoothTime) -> Result<Option<PrintJob>, Refusal> {
        if self.view(find_unsliced)?.is_empty() {
            return Ok(None);
        }
        self.update(|tx| {
            for order in find_unsliced(tx)? {
                let sculpture = tx.get::<Sculpture>(&[&order.sculpture])?;
                let Some(sculpture) = sculpture else { continue };
                if self.begin_work(tx, WorkKind::Slice, &order.order.to_le_bytes(), now)? {
                    return Ok(Some(PrintJob { order, sculpture }));
                }
            }
            Ok(None)
        })
    }

    /// Stores the slicer's result of a print. Does nothing if the order is gone or has ended. A print that
    /// was started by hand meanwhile also gets its estimate. A print without an estimate fails if its size
    /// depends on its duration; otherwise it can be started by hand.
    ///
    /// # Errors
    /// Store errors.
    pub fn note_slice(
        &self,
        order: u64,
        outcome: &SliceOutcome,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            end_work(tx, WorkKind::Slice, &order.to_le_bytes())?;
            let found: Option<PrintOrder> = tx.get(&[&order])?;
            let is_waiting = |order: &PrintOrder| {
                matches!(order.state, PrintState::Ordered | PrintState::Printing)
                    && order.estimate == EstimateState::Waiting
            };
            let Some(mut order) = found.filter(is_waiting) else { return Ok(()) };
            let is_begun = order.state == PrintState::Printing;
            match outcome {
                SliceOutcome::Known { height, minutes, tenths_gram } => {
                    order.height_tenths_mm = *height;
                    order.estimate = EstimateState::Known;
                    (order.minutes, order.tenths_gram) = (Some(*minutes), Some(*tenths_gram));
                    if is_begun {
                        return Ok(tx.put(&order)?);
                    }
                    take_step(tx, &mut order, PrintStep::Slice, "", now)
                }
                SliceOutcome::Unknown(why) => {
                    order.estimate = EstimateState::Unknown;
                    if order.most_minutes.is_some() && !is_begun {
                        return take_step(tx, &mut order, PrintStep::Fail, why, now);
                    }
                    order.why.clone_from(why);
                    Ok(tx.put(&order)?)
                }
            }
        })
    }
}

/// Cancels the prints of a withdrawn sculpture that aren't being printed yet.
pub(crate) fn withdraw_prints(
    tx: &mut Tx<'_>,
    sculpture: &[u8; 16],
    now: BoothTime,
) -> Result<(), Refusal> {
    for mut order in tx.find::<PrintOrder>("WHERE sculpture = ?1", &[sculpture])? {
        if matches!(order.state, PrintState::Ordered | PrintState::Sliced) {
            take_step(tx, &mut order, PrintStep::Cancel, WITHDRAWN, now)?;
        }
    }
    Ok(())
}

/// Applies a step of a print, and stores the print.
pub(crate) fn take_step(
    tx: &mut Tx<'_>,
    order: &mut PrintOrder,
    step: PrintStep,
    why: &str,
    now: BoothTime,
) -> Result<(), Refusal> {
    let Some(state) = order.state.after(step) else {
        return Err(Refusal::Conflict(Reason::PrintMovedOn));
    };
    order.state = state;
    order.changed_at = now;
    order.why = why.to_owned();
    Ok(tx.put(order)?)
}

/// Returns an order and its sculpture.
pub(crate) fn get_order(tx: &mut Tx<'_>, order: u64) -> Result<(PrintOrder, Sculpture), Refusal> {
    let order: PrintOrder = tx.get(&[&order])?.ok_or(NO_ORDER)?;
    let sculpture = get_sculpture(tx, &SculptureId(order.sculpture))?;
    Ok((order, sculpture))
}

/// Finds prints that wait for the slicer: first those that wait for a printer, then those started by hand.
fn find_unsliced(tx: &mut Tx<'_>) -> Result<Vec<PrintOrder>, StoreError> {
    let (ordered, printing) = (PrintState::Ordered, PrintState::Printing);
    let waiting = r#"WHERE state IN (?1, ?2) AND estimate = ?3
        ORDER BY state = ?2, changed_at, "order" LIMIT ?4"#;
    tx.find(waiting, &[&ordered, &printing, &EstimateState::Waiting, &MAX_WORKERS])
}

const fn estimate_at_first(can_slice: bool) -> EstimateState {
    if can_slice { EstimateState::Waiting } else { EstimateState::Unknown }
}

/// Returns the name of a step for the audit log.
const fn name_of(step: PrintStep) -> &'static str {
    match step {
        PrintStep::Slice => "print sliced",
        PrintStep::Start => "print started",
        PrintStep::Finish => "print done",
        PrintStep::Fail => "print failed",
        PrintStep::Cancel => "print cancelled",
        PrintStep::Retry => "print again",
    }
}
