//! Island passes in flight: edits, saves and aborts between two ticks, against connected components of plain
//! booleans. The planted faults are listed in `islands`.

use std::sync::Mutex;

use paros_core::codec::ByteReader;
use paros_core::edit::IslandReport;
use paros_core::volume::BitSet;
use paros_models::cases::random_cases;
use paros_models::dense::{DenseVolume, MaskedVolume};
use paros_models::island_harness::{
    AddedVoxels, IslandHarness, RandomEdit, barely_joined_volumes, random_edits,
};
use paros_models::islands::{clear_islands, islands_away_from};
use paros_models::save_to_bytes;
use proptest::prelude::*;

static VISITED: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());

proptest! {
    #![proptest_config(random_cases(150))]
    #[test]
    fn while_visitors_edit(
        MaskedVolume { volume, mask } in barely_joined_volumes(16),
        edits in random_edits(16),
        budget in 1u32..60,
    ) {
        check_while_edited(&volume, &mask, &edits, budget)?;
    }

    #[test]
    fn saved_in_the_middle(
        MaskedVolume { volume, mask } in barely_joined_volumes(16),
        edits in random_edits(16),
        budget in 1u32..60,
        cut in 0usize..20,
    ) {
        check_saved(&volume, &mask, &edits, budget, cut)?;
    }
}

/// Edits on every tick. No pass removes voxels that are supported in that tick. An island that exists when a
/// pass begins and isn't edited is gone when the pass ends, except for voxels that closure keeps. The volume
/// ends up as the definition requires.
fn check_while_edited(
    volume: &DenseVolume,
    mask: &DenseVolume,
    edits: &[RandomEdit],
    budget: u32,
) -> Result<(), TestCaseError> {
    const N: usize = 16;
    let mut harness = VISITED.lock().unwrap_or_else(|e| e.into_inner());
    harness.set_volume(volume, mask);
    harness.islands.request_pass();
    let mut begun = None;
    let mut added = DenseVolume::empty(N);
    for edit in edits {
        for AddedVoxels { row: (y, z), voxels } in harness.apply_edit(edit) {
            voxels.iter_ones().for_each(|x| added.set([x as i32, y as i32, z as i32], true));
        }
        prop_assert_eq!(harness.islands.digest(), harness.islands.recompute_digest());
        let before = harness.to_dense();
        if begun.is_none() && harness.islands.is_busy() {
            begun = Some(before.clone());
            added = DenseVolume::empty(N);
        }
        let Some(report) = harness.advance_checked(budget)? else { continue };
        let after = harness.to_dense();
        let gone = before.difference(&after);
        prop_assert_eq!(gone.count(), report.removed);
        prop_assert!(after.is_within(&before));
        prop_assert!(
            gone.intersection(&before.supported_by_ground_or(mask)).is_empty(),
            "supported voxels are gone"
        );
        let start = begun.take().expect("a pass began");
        if report.unsupported {
            prop_assert!(gone.is_empty());
        } else {
            let let_be = islands_away_from(&start, mask, &added);
            let rest = after.difference(&let_be);
            prop_assert!(after.is_within(&rest.closure()), "an island is still there");
        }
    }
    // Edits stop: one more pass may be needed for changes made during the pass in flight.
    let mut passes = 0;
    while harness.islands.is_busy() {
        passes += u32::from(harness.advance_checked(budget)?.is_some());
        prop_assert!(passes <= 2);
    }
    let at_rest = harness.to_dense();
    prop_assert!(clear_islands(&at_rest, mask).after == at_rest, "not at rest");
    Ok(())
}

fn check_saved(
    volume: &DenseVolume,
    mask: &DenseVolume,
    edits: &[RandomEdit],
    budget: u32,
    cut: usize,
) -> Result<(), TestCaseError> {
    static PAIR: Mutex<(IslandHarness<16>, IslandHarness<16>)> =
        Mutex::new((IslandHarness::new(), IslandHarness::new()));
    let mut pair = PAIR.lock().unwrap_or_else(|e| e.into_inner());
    let (one, other) = &mut *pair;
    one.set_volume(volume, mask);
    other.set_volume(volume, mask);
    one.islands.request_pass();
    for (tick, edit) in edits.iter().enumerate() {
        if tick == cut.min(edits.len() - 1) {
            other.volume.set_maps(one.volume.maps());
            let bytes = save_to_bytes(|out| one.islands.save(out));
            other.islands.request_pass();
            let mut reader = ByteReader::new(&bytes);
            prop_assert_eq!(other.islands.load(&mut reader), Ok(()));
            prop_assert_eq!(reader.expect_end(), Ok(()));
            prop_assert_eq!(save_to_bytes(|out| other.islands.save(out)), bytes);
        }
        one.apply_edit(edit);
        let report = one.advance_checked(budget)?;
        if tick >= cut.min(edits.len() - 1) {
            other.apply_edit(edit);
            prop_assert_eq!(other.advance_checked(budget)?, report);
            prop_assert_eq!(other.islands.digest(), one.islands.digest());
            prop_assert_eq!(other.volume.digest(), one.volume.digest());
        }
    }
    Ok(())
}

/// Loads truncated or changed bytes: the result is an error without a pass, or a valid state, but no panic.
#[test]
fn bad_bytes() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    harness.set_volume(
        &DenseVolume::from_fn(16, |[x, y, z]| (x + z) % 3 != 0 || y == 2).closure(),
        &DenseVolume::empty(16),
    );
    harness.islands.request_pass();
    assert_eq!(harness.advance_checked(40).unwrap(), None);
    let bytes = save_to_bytes(|out| harness.islands.save(out));
    for len in 0..bytes.len() {
        assert!(harness.islands.load(&mut ByteReader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert!(!harness.islands.is_busy());
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 4, 16, 128, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match harness.islands.load(&mut ByteReader::new(&bytes)) {
                Ok(()) => assert_eq!(harness.islands.digest(), harness.islands.recompute_digest()),
                Err(error) => {
                    assert!(error.offset <= bytes.len());
                    assert!(!harness.islands.is_busy());
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "rows of 16 voxels in words of 64 leave most flips detectable");
}

/// Carving and filling the same voxel for ever doesn't keep a pass from ending.
#[test]
fn one_voxel_for_ever() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    harness.set_volume(&DenseVolume::from_fn(16, |[_, y, _]| y < 12), &DenseVolume::empty(16));
    harness.islands.request_pass();
    for tick in 0.. {
        assert!(tick < 1000, "the pass doesn't end");
        harness.apply_edit(&RandomEdit { at: [8, 11, 8], radius: 0, kind: (tick % 2) as u8 });
        if harness.advance_checked(2).unwrap().is_some() {
            break;
        }
    }
}

/// The digest changes on every tick while a pass is in flight, and on none at rest.
#[test]
fn digest_moves() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    harness.set_volume(&DenseVolume::from_fn(16, |_| true), &DenseVolume::empty(16));
    harness.islands.request_pass();
    let mut digests = vec![harness.islands.digest()];
    while harness.advance_checked(3).unwrap().is_none() {
        digests.push(harness.islands.digest());
    }
    let rest = harness.islands.digest();
    digests.push(rest);
    let count = digests.len();
    digests.sort_unstable();
    digests.dedup();
    assert_eq!(digests.len(), count);
    assert_eq!(harness.advance_checked(3).unwrap(), None);
    assert_eq!(harness.islands.digest(), rest);
}

/// The ground is removed while a pass is in flight, so at its end nothing is supported.
#[test]
fn ground_goes_in_flight() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let stand = DenseVolume::from_fn(16, |[x, y, z]| {
        (x < 3 && z < 3 && y < 6) || (x > 10 && z > 10 && y > 10)
    });
    harness.set_volume(&stand, &DenseVolume::empty(16));
    harness.islands.request_pass();
    assert_eq!(harness.advance_checked(1).unwrap(), None);
    harness.apply_edit(&RandomEdit { at: [1, 0, 1], radius: 8, kind: 0 });
    let before = harness.to_dense();
    let report = harness.run_pass(10).unwrap().report;
    assert_eq!(report, IslandReport { unsupported: true, ..Default::default() });
    assert!(harness.to_dense() == before);
}

/// An aborted pass leaves no trace.
#[test]
fn aborted() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let idle = harness.islands.digest();
    harness.set_volume(
        &DenseVolume::from_fn(16, |[x, y, z]| y == 0 || (x + z) % 2 == 0),
        &DenseVolume::empty(16),
    );
    harness.islands.request_pass();
    assert_eq!(harness.advance_checked(5).unwrap(), None);
    harness.islands.cancel_passes();
    assert_eq!(harness.islands.digest(), idle);
    assert_eq!(harness.islands.recompute_digest(), idle);
    assert_eq!(harness.advance_checked(5).unwrap(), None);
    assert!(!harness.islands.is_busy());
}

/// A loose voxel stands beside a pillar; another pillar's rows are visited last. Voxels filled in between, at
/// any point of the pass, connect the loose voxel, even if its row has already been visited.
#[test]
fn what_joins_a_visited_row_is_reached() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let volume = DenseVolume::from_fn(16, |[x, y, z]| {
        y == 0 || [x, z] == [12, 2] || [x, z] == [7, 8] && y <= 8 || [x, y, z] == [5, 8, 8]
    });
    let mut joined = volume.clone();
    joined.set([6, 8, 8], true);
    let mut budgets_in_flight = 0;
    for budget in 1.. {
        harness.set_volume(&volume, &DenseVolume::empty(16));
        harness.islands.request_pass();
        if harness.advance_checked(budget).unwrap().is_some() {
            break;
        }
        budgets_in_flight += 1;
        harness.apply_edit(&RandomEdit { at: [6, 8, 8], radius: 0, kind: 1 });
        while harness.islands.is_busy() {
            harness.advance_checked(1000).unwrap();
        }
        assert!(harness.to_dense() == joined, "begun with {budget} visits");
    }
    assert!(budgets_in_flight > 16, "the row of the loose voxel was visited in flight");
}
