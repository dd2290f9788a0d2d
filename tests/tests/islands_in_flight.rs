//! Island passes in flight: edits, saves and aborts between two ticks, against connected components
//! of plain booleans. The faults planted are listed in `islands`.

use std::sync::Mutex;

use paros_core::codec::Reader;
use paros_core::islands::IslandReport;
use paros_core::row::Bits;
use paros_tests::models::dense::Dense;
use paros_tests::models::island_bench::{Bench, Visit, loose_volumes, visits};
use paros_tests::models::islands::{cleared, untouched_islands};
use paros_tests::models::saved;
use proptest::prelude::*;

static VISITED: Mutex<Bench<16>> = Mutex::new(Bench::new());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]
    #[test]
    fn while_visitors_edit(
        (volume, mask) in loose_volumes(16),
        visits in visits(16),
        budget in 1u32..60,
    ) {
        check_visited(&volume, &mask, &visits, budget)?;
    }

    #[test]
    fn saved_in_the_middle(
        (volume, mask) in loose_volumes(16),
        visits in visits(16),
        budget in 1u32..60,
        cut in 0usize..20,
    ) {
        check_saved(&volume, &mask, &visits, budget, cut)?;
    }
}

/// Edits on every tick. No pass removes what is supported in that tick; what was an island when a
/// pass began, and was let be, is gone when it ends, but for what closure keeps of it; and the
/// volume comes to rest as the definition says.
fn check_visited(
    volume: &Dense,
    mask: &Dense,
    visits: &[Visit],
    budget: u32,
) -> Result<(), TestCaseError> {
    const N: usize = 16;
    let mut bench = VISITED.lock().unwrap_or_else(|e| e.into_inner());
    bench.set(volume, mask);
    bench.islands.edited();
    let mut begun = None;
    let mut added = Dense::new(N);
    for visit in visits {
        for ((y, z), voxels) in bench.edit(visit) {
            voxels.ones().for_each(|x| added.set([x as i32, y as i32, z as i32], true));
        }
        prop_assert_eq!(bench.islands.digest(), bench.islands.recompute_digest());
        let before = bench.dense();
        if begun.is_none() && bench.islands.is_busy() {
            begun = Some(before.clone());
            added = Dense::new(N);
        }
        let Some(report) = bench.advance(budget)? else { continue };
        let after = bench.dense();
        let gone = before.without(&after);
        prop_assert_eq!(gone.count(), report.removed);
        prop_assert!(after.is_within(&before));
        prop_assert!(gone.and(&before.supported(mask)).is_empty(), "supported voxels are gone");
        let start = begun.take().expect("a pass began");
        if report.unsupported {
            prop_assert!(gone.is_empty());
        } else {
            let let_be = untouched_islands(&start, mask, &added);
            let rest = after.without(&let_be);
            prop_assert!(after.is_within(&rest.closure()), "an island is still there");
        }
    }
    // Hands off: one more pass may be needed for what happened during the one in flight.
    let mut passes = 0;
    while bench.islands.is_busy() {
        passes += u32::from(bench.advance(budget)?.is_some());
        prop_assert!(passes <= 2);
    }
    let at_rest = bench.dense();
    prop_assert!(cleared(&at_rest, mask).after == at_rest, "not at rest");
    Ok(())
}

fn check_saved(
    volume: &Dense,
    mask: &Dense,
    visits: &[Visit],
    budget: u32,
    cut: usize,
) -> Result<(), TestCaseError> {
    static PAIR: Mutex<(Bench<16>, Bench<16>)> = Mutex::new((Bench::new(), Bench::new()));
    let mut pair = PAIR.lock().unwrap_or_else(|e| e.into_inner());
    let (one, other) = &mut *pair;
    one.set(volume, mask);
    other.set(volume, mask);
    one.islands.edited();
    for (tick, visit) in visits.iter().enumerate() {
        if tick == cut.min(visits.len() - 1) {
            other.volume.set_maps(one.volume.maps());
            let bytes = saved(|out| one.islands.save(out));
            other.islands.edited();
            let mut reader = Reader::new(&bytes);
            prop_assert_eq!(other.islands.load(&mut reader), Ok(()));
            prop_assert_eq!(reader.end(), Ok(()));
            prop_assert_eq!(saved(|out| other.islands.save(out)), bytes);
        }
        one.edit(visit);
        let report = one.advance(budget)?;
        if tick >= cut.min(visits.len() - 1) {
            other.edit(visit);
            prop_assert_eq!(other.advance(budget)?, report);
            prop_assert_eq!(other.islands.digest(), one.islands.digest());
            prop_assert_eq!(other.volume.digest(), one.volume.digest());
        }
    }
    Ok(())
}

/// Cut short or with bytes changed: an error and no pass, or a state, but no panic.
#[test]
fn bad_bytes() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(
        &Dense::from_fn(16, |[x, y, z]| (x + z) % 3 != 0 || y == 2).closure(),
        &Dense::new(16),
    );
    bench.islands.edited();
    assert_eq!(bench.advance(40).unwrap(), None);
    let bytes = saved(|out| bench.islands.save(out));
    for len in 0..bytes.len() {
        assert!(bench.islands.load(&mut Reader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert!(!bench.islands.is_busy());
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 4, 16, 128, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match bench.islands.load(&mut Reader::new(&bytes)) {
                Ok(()) => assert_eq!(bench.islands.digest(), bench.islands.recompute_digest()),
                Err(error) => {
                    assert!(error.offset <= bytes.len());
                    assert!(!bench.islands.is_busy());
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "rows of 16 voxels in words of 64 leave most flips detectable");
}

/// A visitor who for ever carves and fills the same voxel doesn't keep a pass from ending.
#[test]
fn one_voxel_for_ever() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(&Dense::from_fn(16, |[_, y, _]| y < 12), &Dense::new(16));
    bench.islands.edited();
    for tick in 0.. {
        assert!(tick < 1000, "the pass doesn't end");
        bench.edit(&Visit { at: [8, 11, 8], radius: 0, kind: (tick % 2) as u8 });
        if bench.advance(2).unwrap().is_some() {
            break;
        }
    }
}

/// In flight every tick moves the digest; at rest none does.
#[test]
fn digest_moves() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(&Dense::from_fn(16, |_| true), &Dense::new(16));
    bench.islands.edited();
    let mut digests = vec![bench.islands.digest()];
    while bench.advance(3).unwrap().is_none() {
        digests.push(bench.islands.digest());
    }
    let rest = bench.islands.digest();
    digests.push(rest);
    let count = digests.len();
    digests.sort_unstable();
    digests.dedup();
    assert_eq!(digests.len(), count);
    assert_eq!(bench.advance(3).unwrap(), None);
    assert_eq!(bench.islands.digest(), rest);
}

/// The ground goes while a pass is in flight: at its end nothing is left to stand on.
#[test]
fn ground_goes_in_flight() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let stand =
        Dense::from_fn(16, |[x, y, z]| (x < 3 && z < 3 && y < 6) || (x > 10 && z > 10 && y > 10));
    bench.set(&stand, &Dense::new(16));
    bench.islands.edited();
    assert_eq!(bench.advance(1).unwrap(), None);
    bench.edit(&Visit { at: [1, 0, 1], radius: 8, kind: 0 });
    let before = bench.dense();
    let (report, _) = bench.run(10).unwrap();
    assert_eq!(report, IslandReport { unsupported: true, ..Default::default() });
    assert!(bench.dense() == before);
}

/// Aborted, a pass leaves nothing behind.
#[test]
fn aborted() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let idle = bench.islands.digest();
    bench.set(&Dense::from_fn(16, |[x, y, z]| y == 0 || (x + z) % 2 == 0), &Dense::new(16));
    bench.islands.edited();
    assert_eq!(bench.advance(5).unwrap(), None);
    bench.islands.abort();
    assert_eq!(bench.islands.digest(), idle);
    assert_eq!(bench.islands.recompute_digest(), idle);
    assert_eq!(bench.advance(5).unwrap(), None);
    assert!(!bench.islands.is_busy());
}
