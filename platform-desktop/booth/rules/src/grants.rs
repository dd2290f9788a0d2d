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

#[cfg(test)]
mod tests {
    use paros_core::badge::{BadgeNumber, LeaseAnswer, LeasedBlock};

    use super::{grants_of, is_granted, note_grants};
    use crate::memory_store::MemoryStore;
    use crate::store::{update, view};

    const BLOCK: u16 = 5;

    /// Hands the tail of the block from a place on to a headset.
    fn hand(store: &MemoryStore, headset: u32, first: u8, is_void: bool) {
        let blocks = LeasedBlock::new(BLOCK, first).into_iter().collect();
        let answer = LeaseAnswer { headset, epoch: 1, report: 1, taken: 0, is_void, blocks };
        update(store, |tx| note_grants(tx, &answer)).expect("a store");
    }

    /// The places at which the block's numbers change hands, and who has them from there on; 0 for nobody.
    fn owners(store: &MemoryStore) -> Vec<(u32, u32)> {
        let mut changes = Vec::new();
        for place in 0..64 {
            let number = BadgeNumber::new(u32::from(BLOCK) * 64 + place).expect("a number");
            let is_its = |headset: &u32| {
                view(store, |tx| is_granted(tx, *headset, number)).expect("a store")
            };
            let owner = (1..4).find(is_its).unwrap_or(0);
            if changes.last().is_none_or(|(_, before)| *before != owner) {
                changes.push((place, owner));
            }
        }
        changes
    }

    #[test]
    fn a_tail_is_its_new_holders_and_what_was_before_it_stays() {
        let store = MemoryStore::new();
        assert_eq!(owners(&store), [(0, 0)]);
        hand(&store, 1, 0, true);
        assert_eq!(owners(&store), [(0, 0)], "a void lease hands nothing out");
        hand(&store, 1, 3, false);
        // What it has taken since is its own all the same, and no row more.
        hand(&store, 1, 9, false);
        assert_eq!(owners(&store), [(0, 0), (3, 1)]);
        hand(&store, 2, 20, false);
        hand(&store, 3, 40, false);
        assert_eq!(owners(&store), [(0, 0), (3, 1), (20, 2), (40, 3)]);
        hand(&store, 1, 41, false);
        assert_eq!(owners(&store), [(0, 0), (3, 1), (20, 2), (40, 3), (41, 1)]);
        // The block begins anew.
        hand(&store, 2, 0, false);
        assert_eq!(owners(&store), [(0, 2)]);
        let rows = view(&store, |tx| tx.count_rows(&grants_of(u32::from(BLOCK)))).expect("a store");
        assert_eq!(rows, 1);
    }
}
