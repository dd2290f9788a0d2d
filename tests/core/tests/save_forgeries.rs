//! Saves forged with a valid checksum: a save that loads keeps every invariant, whatever is done afterwards.
//!
//! `save_trust` has a directed test for each check, and lists the faults planted in it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use paros_core::TickInput;
use paros_core::codec::{BadBytes, BadSave};
use paros_core::session::{SessionMode, commands};
use paros_core::volume::{Grid, Size};
use paros_models::cases::scaled_cases;
use paros_models::random_visitor::{RandomSource, RandomVisitor};
use paros_models::save_layout::{BODY, MAPS, SaveLayout, save_to_vec, write_checksum};
use paros_models::world_harness::WorldHarness;

/// Returns saves of visits: each mode, at rest and during a search, with and without undone entries.
fn saves_of_visits<const N: usize, const K: usize>(harness: &mut WorldHarness<N, K>) -> Vec<Vec<u8>>
where
    Grid<N>: Size,
{
    let mut saves = Vec::new();
    let modes =
        [SessionMode::FreeForm, SessionMode::Constrained { figure: 0 }, SessionMode::Creative];
    for (seed, mode) in (0..12).map(|seed| (seed, modes[seed as usize % 3])) {
        harness.start_session(mode);
        let mut visitor = RandomVisitor::new(70 + seed);
        for _ in 0..150 + 20 * seed {
            harness.step(&visitor.next_input());
        }
        for _ in 0..seed % 4 {
            harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
        }
        harness.check_invariants();
        saves.push(save_to_vec(&harness.world));
    }
    saves
}

/// Forges one thing: any byte, or a value of the history or the search.
fn forge<const N: usize, const K: usize>(bytes: &mut Vec<u8>, dice: &mut RandomSource) {
    let Some(layout) = SaveLayout::of::<N, K>(bytes) else { return };
    let pick = |dice: &mut RandomSource, range: Range<usize>| {
        range.start + dice.below((range.end - range.start).max(1) as u64) as usize
    };
    let end = bytes.len();
    let flip = |bytes: &mut [u8], range: Range<usize>, dice: &mut RandomSource| {
        let at = pick(dice, range);
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << dice.below(8);
        }
    };
    let entry = |dice: &mut RandomSource| {
        (!layout.entries.is_empty())
            .then(|| layout.entries[dice.below(layout.entries.len() as u64) as usize].clone())
    };
    match dice.below(8) {
        0 => flip(bytes, BODY..end, dice),
        1 => flip(bytes, BODY..MAPS, dice),
        2 => flip(bytes, layout.islands..end, dice),
        3 => flip(bytes, layout.undo..layout.undo + 5, dice),
        // Moves an end of a range in an entry by a voxel; the columns lie at the entry's end.
        4 | 5 => {
            if let Some(entry) = entry(dice) {
                let at = pick(dice, entry.end - (entry.len() / 2).max(2)..entry.end);
                bytes[at] = bytes[at].wrapping_add([1, 255][dice.below(2) as usize]);
            }
        }
        // Exchanges two entries.
        6 => {
            if let (Some(one), Some(other)) = (entry(dice), entry(dice))
                && one.end <= other.start
            {
                let mut all = bytes[..one.start].to_vec();
                all.extend(&bytes[other.clone()]);
                all.extend(&bytes[one.end..other.start]);
                all.extend(&bytes[one.clone()]);
                all.extend(&bytes[other.end..]);
                *bytes = all;
            }
        }
        // Changes the number of applied entries.
        _ => {
            let applied = dice.below(layout.entries.len() as u64 + 1) as u16;
            bytes[layout.undo + 2..layout.undo + 4].copy_from_slice(&applied.to_le_bytes());
        }
    }
}

/// Undoes and redoes everything, sculpting in between, and checks the invariants on every tick.
fn storm<const N: usize, const K: usize>(harness: &mut WorldHarness<N, K>, seed: u64)
where
    Grid<N>: Size,
{
    let mut visitor = RandomVisitor::new(seed);
    let all = harness.world.undo_counts();
    let commands = [(commands::UNDO, all.undoable), (commands::REDO, all.undoable + all.redoable)];
    for (command, times) in commands {
        for _ in 0..times.min(20) {
            harness.step(&TickInput { commands: command, ..TickInput::default() });
            harness.check_invariants();
        }
    }
    for tick in 0..16 {
        let mut input = visitor.next_input();
        input.commands |= if tick % 5 == 4 { commands::UNDO } else { 0 };
        harness.step(&input);
        harness.check_invariants();
    }
}

/// Counts of what happened to forged saves.
#[derive(Default, Debug)]
struct Outcomes {
    loaded: u32,
    refused: BTreeMap<&'static str, u32>,
}

fn load_forgeries<const N: usize, const K: usize>(
    harness: &Mutex<WorldHarness<N, K>>,
    count: u32,
) -> Outcomes
where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let saves = saves_of_visits(harness);
    let mut dice = RandomSource::new(N as u64 * 10 + K as u64);
    let mut outcomes = Outcomes::default();
    for i in 0..count {
        let save = &saves[dice.below(saves.len() as u64) as usize];
        let mut bytes = save.clone();
        for _ in 0..1 + dice.below(2) {
            forge::<N, K>(&mut bytes, &mut dice);
        }
        write_checksum(&mut bytes);
        if bytes == *save {
            continue;
        }
        match harness.world.load(&bytes) {
            Ok(()) => {
                outcomes.loaded += 1;
                harness.check_invariants();
                assert!(save_to_vec(&harness.world) == bytes, "what was loaded is saved as it was");
                storm(harness, i.into());
            }
            Err(bad) => {
                assert!(bad.offset() <= bytes.len());
                let (BadSave::Value(BadBytes { expected, .. })
                | BadSave::Column { bad: BadBytes { expected, .. }, .. }
                | BadSave::Entry { bad: BadBytes { expected, .. }, .. }) = bad
                else {
                    panic!("{bad}")
                };
                *outcomes.refused.entry(expected).or_default() += 1;
            }
        }
    }
    outcomes
}

#[test]
fn a_forged_save_is_refused_or_keeps_every_invariant() {
    static ONE: Mutex<WorldHarness<16, 1>> = Mutex::new(WorldHarness::new());
    static TWO: Mutex<WorldHarness<16, 2>> = Mutex::new(WorldHarness::new());
    static THREE: Mutex<WorldHarness<32, 3>> = Mutex::new(WorldHarness::new());
    static LARGER: Mutex<WorldHarness<32, 2>> = Mutex::new(WorldHarness::new());
    for outcomes in [
        load_forgeries(&ONE, scaled_cases(500)),
        load_forgeries(&TWO, scaled_cases(500)),
        load_forgeries(&THREE, scaled_cases(100)),
        load_forgeries(&LARGER, scaled_cases(240)),
    ] {
        println!("{outcomes:?}");
        // Every kind of outcome occurred.
        assert!(outcomes.loaded > 10 && outcomes.refused["tight ranges"] > 3, "{outcomes:?}");
    }
}
