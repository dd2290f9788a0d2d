//! Sculptures that visitors want printed: an order each, from when it is asked for to when the print is there.

use paros_protocol::SculptureId;

use crate::audit::note;
use crate::booth::{Booth, Tx};
use crate::find::NO_SCULPTURE;
use crate::lifecycle::{get_kept, subject_of};
use crate::limits::{MAX_LISTED, MAX_PRINTS_OF_ONE, MAX_WORKERS};
use crate::print_wish::{PrintSize, PrintWish, check_minutes_can_be_found};
use crate::reason::Reason;
use crate::records::{EstimateState, PrintOrder, PrintState, Sculpture, WorkKind};
use crate::refusal::Refusal;
use crate::store::{Query, RowOrder, StoreError};
use crate::time::BoothTime;
use crate::value::Field as _;
use crate::work::end_work;

pub(crate) const NO_ORDER: Refusal = Refusal::NotFound(Reason::NoPrint);

/// Said of a print whose sculpture isn't shown any more.
const WITHDRAWN: &str = "the sculpture was withdrawn";

/// What happens to a print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrintStep {
    /// The slicer told its time and material.
    Slice,
    /// A printer begins.
    Start,
    /// It is there.
    Finish,
    /// It came to nothing.
    Fail,
    /// Staff take it back.
    Cancel,
    /// It is ordered again.
    Retry,
}

/// A print that is to be sliced or printed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrintJob {
    /// Its order.
    pub order: PrintOrder,
    /// What to print.
    pub sculpture: Sculpture,
}

/// What the slicer tells.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SliceOutcome {
    /// The height in tenths of a millimetre, the time and the material.
    Known {
        /// Tenths of a millimetre.
        height: u32,
        /// Minutes.
        minutes: u32,
        /// Tenths of a gram of filament.
        tenths_gram: u32,
    },
    /// Nothing, and why.
    Unknown(String),
}

impl PrintState {
    /// The state that a step leads to from this one; `None` where it can't be taken from here.
    #[must_use]
    pub const fn after(self, step: PrintStep) -> Option<PrintState> {
        use PrintState::{Cancelled, Done, Failed, Ordered, Printing, Sliced};
        match (self, step) {
            (Ordered, PrintStep::Slice) => Some(Sliced),
            // Without a slicer a print begins without an estimate.
            (Ordered | Sliced, PrintStep::Start) => Some(Printing),
            (Printing, PrintStep::Finish) => Some(Done),
            (Ordered | Sliced | Printing, PrintStep::Fail) => Some(Failed),
            (Ordered | Sliced | Printing, PrintStep::Cancel) => Some(Cancelled),
            (Done | Failed | Cancelled, PrintStep::Retry) => Some(Ordered),
            _ => None,
        }
    }

    /// Whether it is still to be printed, or is being.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, PrintState::Ordered | PrintState::Sliced | PrintState::Printing)
    }
}

impl Booth {
    /// Notes that somebody wants a sculpture printed. `order` is random bits; `can_slice` is whether there is a slicer,
    /// without which no size can be found by time.
    ///
    /// # Errors
    /// [`Refusal::Unfit`] where size or texts are out of their bounds, [`Refusal::NotFound`] where the sculpture
    /// isn't shown, [`Refusal::Conflict`] where it has as many orders as it may; or those of the store.
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
            let sculpture = get_kept(tx, id, now)?;
            if sculpture.withdrawn_at.is_some() {
                return Err(NO_SCULPTURE);
            }
            let is_full = tx.count_rows(&orders_of(&id.0))? >= MAX_PRINTS_OF_ONE;
            if is_full || tx.get::<PrintOrder>(&[order.to_value()])?.is_some() {
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

    /// The prints of a sculpture, the newest first.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_prints(&self, id: &SculptureId) -> Result<Vec<PrintOrder>, Refusal> {
        self.view(|tx| tx.find(&orders_of(&id.0).ordered("asked_at", RowOrder::Descending)))
    }

    /// All prints with their sculptures: those that are open, the oldest first; then the others, the newest first.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_print_queue(&self) -> Result<Vec<PrintJob>, Refusal> {
        self.view(|tx| {
            let all = Query::all::<PrintOrder>;
            let mut orders = Vec::new();
            for state in [PrintState::Printing, PrintState::Sliced, PrintState::Ordered] {
                let of_state =
                    all().equal("state", &state).ordered("asked_at", RowOrder::Ascending);
                orders.extend(tx.find::<PrintOrder>(&of_state.first(MAX_LISTED))?);
            }
            let mut ended = Vec::new();
            for state in [PrintState::Done, PrintState::Failed, PrintState::Cancelled] {
                let of_state =
                    all().equal("state", &state).ordered("changed_at", RowOrder::Descending);
                ended.extend(tx.find::<PrintOrder>(&of_state.first(MAX_LISTED / 4))?);
            }
            ended.sort_by_key(|order: &PrintOrder| std::cmp::Reverse(order.changed_at));
            orders.extend(ended);
            let mut jobs = Vec::new();
            for order in orders {
                if let Some(sculpture) = tx.get::<Sculpture>(&[order.sculpture.to_value()])? {
                    jobs.push(PrintJob { order, sculpture });
                }
            }
            Ok(jobs)
        })
    }

    /// A print with its sculpture.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of the store.
    pub fn find_print(&self, order: u64) -> Result<PrintJob, Refusal> {
        let found = self.view(|tx| {
            let Some(order) = tx.get::<PrintOrder>(&[order.to_value()])? else { return Ok(None) };
            let sculpture = tx.get::<Sculpture>(&[order.sculpture.to_value()])?;
            Ok(sculpture.map(|sculpture| PrintJob { order, sculpture }))
        });
        found?.ok_or(NO_ORDER)
    }

    /// Takes a print a step further, as staff say.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], [`Refusal::Conflict`] where the step can't be taken from its state, or those of the
    /// store.
    pub fn step_print(
        &self,
        order: u64,
        (step, can_slice): (PrintStep, bool),
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let (mut order, sculpture) = get_order(tx, order, now)?;
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
            // What is taken back is still to be stopped at its printer; of all else that sees to itself, or people do.
            if !(step == PrintStep::Cancel && order.job.is_some()) {
                (order.printer, order.job) = (None, None);
            }
            take_step(tx, &mut order, step, "", now)?;
            Ok(note(tx, now, Some(account), name_of(step), subject_of(&sculpture))?)
        })
    }

    /// The print that waits longest for its time and material, of those that no other process slices.
    ///
    /// # Errors
    /// Those of the store.
    pub fn next_slice(&self, now: BoothTime) -> Result<Option<PrintJob>, Refusal> {
        let waiting = |state: &PrintState| {
            Query::all::<PrintOrder>()
                .equal("state", state)
                .equal("estimate", &EstimateState::Waiting)
                .ordered("changed_at", RowOrder::Ascending)
                .first(MAX_WORKERS)
        };
        // The second were begun by hand before their turn came.
        let turns = [waiting(&PrintState::Ordered), waiting(&PrintState::Printing)];
        let are_any = self.view(|tx| {
            let [first, second] = turns.clone();
            let of_first = tx.find_first::<PrintOrder>(first)?.is_some();
            Ok(of_first || tx.find_first::<PrintOrder>(second)?.is_some())
        });
        if !are_any? {
            return Ok(None);
        }
        self.update(|tx| {
            for turn in &turns {
                for order in tx.find::<PrintOrder>(turn)? {
                    let sculpture = tx.get::<Sculpture>(&[order.sculpture.to_value()])?;
                    let Some(sculpture) = sculpture else { continue };
                    if self.begin_work(tx, WorkKind::Slice, &order.order.to_le_bytes(), now)? {
                        return Ok(Some(PrintJob { order, sculpture }));
                    }
                }
            }
            Ok(None)
        })
    }

    /// Notes what the slicer tells of a print; nothing where its order is gone, or has ended. One that was begun by hand
    /// meanwhile gets its estimate all the same. Where the size was to be found by time, a print without an estimate
    /// fails; otherwise it can be started by hand.
    ///
    /// # Errors
    /// Those of the store.
    pub fn note_slice(
        &self,
        order: u64,
        outcome: &SliceOutcome,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            end_work(tx, WorkKind::Slice, &order.to_le_bytes())?;
            let found: Option<PrintOrder> = tx.get(&[order.to_value()])?;
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

/// Takes back what isn't being printed yet of a sculpture, as its visitor wants it hidden.
pub(crate) fn withdraw_prints(
    tx: &mut Tx<'_>,
    sculpture: &[u8; 16],
    now: BoothTime,
) -> Result<(), Refusal> {
    for mut order in tx.find::<PrintOrder>(&orders_of(sculpture))? {
        if matches!(order.state, PrintState::Ordered | PrintState::Sliced) {
            take_step(tx, &mut order, PrintStep::Cancel, WITHDRAWN, now)?;
        }
    }
    Ok(())
}

/// Removes the orders of a sculpture that is deleted.
pub(crate) fn remove_prints(tx: &mut Tx<'_>, sculpture: &[u8; 16]) -> Result<(), StoreError> {
    for order in tx.find::<PrintOrder>(&orders_of(sculpture))? {
        tx.remove::<PrintOrder>(&[order.order.to_value()])?;
    }
    Ok(())
}

/// Takes a print a step further, and keeps it.
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

/// An order, and the sculpture that is kept.
pub(crate) fn get_order(
    tx: &mut Tx<'_>,
    order: u64,
    now: BoothTime,
) -> Result<(PrintOrder, Sculpture), Refusal> {
    let order: PrintOrder = tx.get(&[order.to_value()])?.ok_or(NO_ORDER)?;
    let sculpture = get_kept(tx, &SculptureId(order.sculpture), now)?;
    Ok((order, sculpture))
}

fn orders_of(sculpture: &[u8; 16]) -> Query {
    Query::all::<PrintOrder>().equal("sculpture", sculpture)
}

const fn estimate_at_first(can_slice: bool) -> EstimateState {
    if can_slice { EstimateState::Waiting } else { EstimateState::Unknown }
}

/// As the audit has it.
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
