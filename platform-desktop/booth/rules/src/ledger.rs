//! The ledger of badges, which is loaded, asked and saved in one transaction.
//!
//! It is 158 KB long, so that it isn't written with every sculpture: what sculptures keep their numbers for longer is
//! told to it before it is asked again.

use paros_core::badge::{BadgeLedger, BadgeNumber, LeaseAnswer, LeaseReport, MAX_LEDGER_BYTES};

use crate::booth::{BoothPlan, Tx};
use crate::grants::note_grants;
use crate::records::{BadgeClaim, LedgerSave, Sculpture};
use crate::refusal::Refusal;
use crate::store::{Query, StoreError};
use crate::time::BoothTime;
use crate::value::Field as _;

/// Answers a headset's report; `None` where the ledger refuses it, and the headset reports again.
pub(crate) fn answer_report(
    tx: &mut Tx<'_>,
    plan: &BoothPlan,
    report: &LeaseReport,
    now: BoothTime,
) -> Result<Option<LeaseAnswer>, Refusal> {
    let mut ledger = load(tx, plan)?;
    tell_of_sculptures(tx, &mut ledger)?;
    let answer = ledger.answer_report(report, now.seconds());
    save(tx, &ledger)?;
    if let Ok(answer) = &answer {
        note_grants(tx, answer)?;
    }
    Ok(answer.ok())
}

/// Takes back what a headset holds that is gone for good.
pub(crate) fn retire_headset(
    tx: &mut Tx<'_>,
    plan: &BoothPlan,
    headset: u32,
    now: BoothTime,
) -> Result<(), Refusal> {
    let mut ledger = load(tx, plan)?;
    tell_of_sculptures(tx, &mut ledger)?;
    ledger.retire_headset(headset, now.seconds());
    Ok(save(tx, &ledger)?)
}

/// Sets numbers aside that may have been handed out since the store was copied.
pub(crate) fn begin_generation(
    tx: &mut Tx<'_>,
    plan: &BoothPlan,
    copied_at: BoothTime,
    now: BoothTime,
) -> Result<(), StoreError> {
    let mut ledger = load(tx, plan)?;
    tell_of_sculptures(tx, &mut ledger)?;
    ledger.begin_generation(copied_at.seconds(), now.seconds());
    save(tx, &ledger)
}

/// Tells it of each sculpture that came, or is to be kept for longer, since it was last asked.
fn tell_of_sculptures(tx: &mut Tx<'_>, ledger: &mut BadgeLedger) -> Result<(), StoreError> {
    let untold = Query::all::<Sculpture>().equal("is_in_ledger", &false);
    for mut sculpture in tx.find::<Sculpture>(&untold)? {
        // A headset that lies spends no number but its own.
        let is_its = sculpture.claim != BadgeClaim::Unleased;
        if let Some(number) = sculpture.badge.and_then(BadgeNumber::new).filter(|_| is_its) {
            ledger.keep_until(number, sculpture.keep_day);
        }
        sculpture.is_in_ledger = true;
        tx.put(&sculpture)?;
    }
    Ok(())
}

fn load(tx: &mut Tx<'_>, plan: &BoothPlan) -> Result<Box<BadgeLedger>, StoreError> {
    let mut ledger = Box::new(BadgeLedger::new(plan.retention_days));
    if let Some(save) = tx.get::<LedgerSave>(&[0u8.to_value()])? {
        let bad = StoreError::BadRow { table: "ledger", column: "bytes" };
        ledger.load(&save.bytes).map_err(|_| bad)?;
    }
    Ok(ledger)
}

fn save(tx: &mut Tx<'_>, ledger: &BadgeLedger) -> Result<(), StoreError> {
    let mut bytes = vec![0; MAX_LEDGER_BYTES];
    let length = ledger.save(&mut bytes);
    bytes.truncate(length);
    tx.put(&LedgerSave { row: 0, bytes })
}
