//! Saved worlds, with header and checksum made valid: rejected at an offset inside the bytes with the world
//! left empty; or loaded, saved again as the same bytes, and sculpted with every invariant.

use std::sync::{Mutex, PoisonError};

use paros_core::TickInput;
use paros_core::codec::BadSave;
use paros_core::session::{SessionMode, commands};
use paros_models::random_visitor::RandomVisitor;
use paros_models::save_layout::{BODY, save_to_vec, write_checksum};
use paros_models::world_harness::WorldHarness;

use crate::engine::FuzzTarget;

/// The input is the number of intervals (0 for one, else two), and the bytes after a save's header.
pub(super) const SAVE: FuzzTarget = FuzzTarget {
    name: "save",
    seeds,
    words: &[b"\0\0\0\0\0\0\0\0", b"\xff\xff\xff\xff\xff\xff\xff\xff", b"\x01\0", b"\xff\x0f"],
    longest: 30_000,
    runs: 1000,
    run: |bytes| {
        let Some((intervals, body)) = bytes.split_first() else { return "nothing".into() };
        if intervals & 1 == 0 { load(&ONE, body) } else { load(&TWO, body) }
    },
};

type Harness<const K: usize> = Mutex<WorldHarness<16, K>>;

static ONE: Harness<1> = Mutex::new(WorldHarness::new());
static TWO: Harness<2> = Mutex::new(WorldHarness::new());

fn seeds() -> Vec<Vec<u8>> {
    fn of<const K: usize>(harness: &Harness<K>, mode: SessionMode, ticks: u64) -> Vec<u8> {
        let mut harness = harness.lock().unwrap_or_else(PoisonError::into_inner);
        harness.start_session(mode);
        let mut visitor = RandomVisitor::new(ticks);
        (0..ticks).for_each(|_| harness.step(&visitor.next_input()));
        let bytes = save_to_vec(&harness.world);
        [&[K as u8 - 1], &bytes[BODY..]].concat()
    }
    let hidden = SessionMode::Constrained { figure: 0 };
    vec![
        of(&ONE, SessionMode::FreeForm, 150),
        of(&ONE, hidden, 160),
        of(&TWO, SessionMode::FreeForm, 170),
        of(&TWO, hidden, 180),
        of(&TWO, SessionMode::Creative, 190),
    ]
}

fn load<const K: usize>(harness: &Harness<K>, body: &[u8]) -> String {
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    harness.reset();
    let empty = harness.world.digest();
    let mut bytes = save_to_vec(&harness.world);
    bytes.truncate(BODY);
    bytes.extend(body);
    write_checksum(&mut bytes);
    if let Err(bad) = harness.world.load(&bytes) {
        assert!(bad.offset() <= bytes.len());
        assert_eq!(harness.world.digest(), empty);
        let (BadSave::Value(bad) | BadSave::Column { bad, .. } | BadSave::Entry { bad, .. }) = bad
        else {
            panic!("the header is right")
        };
        return bad.expected.into();
    }
    harness.check_invariants();
    assert!(save_to_vec(&harness.world) == bytes, "what was loaded is saved as it was");
    sculpt(harness);
    format!("loaded {:?}", harness.world.session_state())
}

/// Undoes and redoes a few strokes, with sculpting in between.
fn sculpt<const K: usize>(harness: &mut WorldHarness<16, K>) {
    let mut visitor = RandomVisitor::new(harness.world.tick());
    for tick in 0..12 {
        let commands = [commands::UNDO, commands::UNDO, commands::REDO, 0][tick % 4];
        let input = visitor.next_input();
        harness.step(&TickInput { commands: input.commands | commands, ..input });
        harness.check_invariants();
    }
}
