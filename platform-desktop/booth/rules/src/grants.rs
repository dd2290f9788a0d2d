//! Which headset was handed which numbers of badges. The ledger forgets it once they are spent; here it is kept, as a
//! sculpture comes after its number was spent, and another headset may say that the number is its own.

use paros_core::badge::{BadgeNumber, LeaseAnswer};
use paros_core::limits::BLOCK_NUMBERS;

use crate::booth::Tx;
use crate::records::BlockGrant;
use crate::store::{Query, StoreError};
use crate::value::Field as _;

/// Notes what an answer hands to its headset: the tails of blocks. Whoever had places before a tail keeps these; who
/// had some in it has lost them, as where the block began anew.
pub(crate) fn note_grants(tx: &mut Tx<'_>, answer: &LeaseAnswer) -> Result<(), StoreError> {
    for tail in answer.blocks.iter().filter(|_| !answer.is_void) {
        let block = u32::from(tail.block());
        let first_place = (BLOCK_NUMBERS as u32 - tail.count()) as u8;
        let mut owner = None;
        for grant in tx.find::<BlockGrant>(&grants_of(block))? {
            if grant.first_place > first_place {
                let key = [grant.block.to_value(), grant.first_place.to_value()];
                tx.remove::<BlockGrant>(&key)?;
            } else {
                owner = Some(grant.headset);
            }
        }
        if owner != Some(answer.headset) {
            tx.put(&BlockGrant { block, first_place, headset: answer.headset })?;
        }
    }
    Ok(())
}

/// Whether a leased number is one that the headset was handed.
pub(crate) fn is_granted(
    tx: &mut Tx<'_>,
    headset: u32,
    number: BadgeNumber,
) -> Result<bool, StoreError> {
    let (block, place) = (number.get() / BLOCK_NUMBERS as u32, number.get() % BLOCK_NUMBERS as u32);
    let grants: Vec<BlockGrant> = tx.find(&grants_of(block))?;
    let owner = grants.iter().rfind(|grant| u32::from(grant.first_place) <= place);
    Ok(owner.is_some_and(|owner| owner.headset == headset))
}

/// In the order of their places.
fn grants_of(block: u32) -> Query {
    Query::all::<BlockGrant>().equal("block", &block)
}
