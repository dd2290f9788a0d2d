//! Golden test: compares the digests of recorded sessions from one version of the program to the next.
//!
//! `tests/goldens/session.txt` holds the digests of a session with one interval a column, and the versions
//! that they depend on; `session-of-two.txt` the digests of the same input with two intervals.
//! `PAROS_GOLDEN=write cargo test -p paros-tests-core --test main golden` writes both, and refuses if
//! `CORE_VERSION` has to be raised instead.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use paros_core::codec::trace::{CORE_VERSION, digest_start_volumes};
use paros_core::internals::{BitAction, ByteWriter};
use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool};
use paros_core::{HiddenFigure, StartVolumes, TickInput, WorldEvent};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::{WorldAndStarts, WorldHarness};

/// The sessions: mode, the visitor's seed, and the tool that is taken early on.
const SESSIONS: [(SessionMode, u64, Tool); 4] = [
    (SessionMode::FreeForm, 61, Tool::Rotary),
    (SessionMode::Constrained { figure: 0 }, 62, Tool::Rasp),
    (SessionMode::Creative, 63, Tool::FillGun),
    (SessionMode::Creative, 64, Tool::Rotary),
];
const TICKS: usize = 800;

/// Ticks between two digests.
const EVERY: usize = 100;

const AGAIN: &str =
    "write it: PAROS_GOLDEN=write cargo test -p paros-tests-core --test main golden";

/// The contents of a golden file: the lines `core`, `starts` and `inputs`, then one digest a line.
#[derive(Clone, PartialEq, Eq, Debug)]
struct GoldenSession {
    core: u16,
    starts: u64,
    inputs: u64,
    digests: Vec<(usize, u64)>,
}

impl GoldenSession {
    fn read(text: &str) -> Option<Self> {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let mut after = |word| lines.next()?.strip_prefix(word);
        let hex = |text: &str| u64::from_str_radix(text, 16).ok();
        let core = after("core ")?.parse().ok()?;
        let (starts, inputs) = (hex(after("starts ")?)?, hex(after("inputs ")?)?);
        let digest = |line: &str| {
            let (tick, digest) = line.strip_prefix("tick ")?.split_once(' ')?;
            Some((tick.parse().ok()?, hex(digest)?))
        };
        let digests = lines.map(digest).collect::<Option<_>>()?;
        Some(GoldenSession { core, starts, inputs, digests })
    }

    fn write(&self) -> String {
        let GoldenSession { core, starts, inputs, digests } = self;
        let mut text = String::from("# Digests of a session; see tests/golden.rs.\n");
        let _ = write!(text, "core {core}\nstarts {starts:016x}\ninputs {inputs:016x}\n");
        for (tick, digest) in digests {
            let _ = writeln!(text, "tick {tick} {digest:016x}");
        }
        text
    }

    /// Compares with `now`. If they differ, the error describes what to do.
    fn compare_with(&self, now: &GoldenSession) -> Result<(), String> {
        if self.core != now.core {
            return Err(format!("CORE_VERSION was {} and is {}: {AGAIN}", self.core, now.core));
        }
        if (self.starts, self.inputs) != (now.starts, now.inputs) {
            return Err(format!("the start volumes or the visitors have changed: {AGAIN}"));
        }
        match self.digests.iter().zip(&now.digests).find(|(was, is)| was != is) {
            Some((was, is)) => Err(format!(
                "up to tick {} another digest came out ({:016x}, was {:016x}): what a tick \
                 computes has changed. If it was meant to, raise CORE_VERSION in \
                 core/src/codec/trace.rs; then {AGAIN}",
                was.0, is.1, was.1
            )),
            None if self.digests.len() != now.digests.len() => {
                Err(format!("the session has another length: {AGAIN}"))
            }
            None => Ok(()),
        }
    }
}

/// Counts of what the sessions exercise: the test fails if they exercise too little.
#[derive(Default, Debug)]
struct GoldenTally {
    actions: [u32; 3],
    mirrored: u32,
    fallen: u32,
    undone: u32,
    redone: u32,
}

impl GoldenTally {
    fn count(&mut self, events: &[WorldEvent], symmetry: bool) {
        for event in events {
            match event {
                WorldEvent::Edited { bit, report, .. } if report.changed_volume() => {
                    self.actions[match bit.spec().action {
                        BitAction::Carve => 0,
                        BitAction::Fill => 1,
                        BitAction::Smooth | BitAction::Flatten => 2,
                    }] += 1;
                    self.mirrored += u32::from(symmetry);
                }
                WorldEvent::Islands(report) => self.fallen += report.removed,
                WorldEvent::Undone => self.undone += 1,
                WorldEvent::Redone => self.redone += 1,
                _ => {}
            }
        }
    }
}

fn play_sessions<const K: usize>(
    harness: &mut WorldHarness<128, K>,
) -> (GoldenSession, GoldenTally) {
    harness.reset();
    let WorldAndStarts { lump, figure, creative, .. } = harness.world_and_start_volumes();
    let figures = [HiddenFigure { figure, stone: lump }];
    let starts =
        digest_start_volumes(&StartVolumes { lump, figures: &figures, creative, own: None });
    let (mut tally, mut bytes, mut digests) = (GoldenTally::default(), vec![], vec![]);
    for (mode, seed, tool) in SESSIONS {
        let mut visitor = RandomVisitor::new(seed);
        for tick in 0..TICKS {
            let start = if tick == 0 { mode } else { SessionMode::None };
            let mut input = TickInput { start, ..visitor.next_input() };
            if tick == 20 {
                let item = BenchItem::Tool(tool).number() as u8;
                input.pointer = PointerCommand::Take { hand: 1, item };
            }
            let at = bytes.len();
            bytes.resize(at + TickInput::BYTES, 0);
            input.write(&mut ByteWriter::new(&mut bytes[at..]));
            harness.step(&input);
            tally.count(harness.world.events(), harness.world.is_mirrored());
            if (tick + 1) % EVERY == 0 {
                digests.push((harness.world.tick() as usize, harness.world.digest()));
            }
        }
    }
    let inputs = paros_core::internals::checksum(&bytes);
    (GoldenSession { core: CORE_VERSION, starts, inputs, digests }, tally)
}

#[test]
fn ticks_compute_what_they_did_at_this_core_version() {
    static ONE: Mutex<WorldHarness<128, 1>> = Mutex::new(WorldHarness::new());
    static TWO: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
    let one = play_sessions(&mut ONE.lock().unwrap_or_else(PoisonError::into_inner));
    check_or_write_golden("session.txt", one);
    let two = play_sessions(&mut TWO.lock().unwrap_or_else(PoisonError::into_inner));
    check_or_write_golden("session-of-two.txt", two);
}

fn check_or_write_golden(name: &str, (now, tally): (GoldenSession, GoldenTally)) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../goldens").join(name);
    let GoldenTally { actions, mirrored, fallen, undone, redone } = tally;
    let others = [mirrored, fallen, undone, redone];
    assert!(actions.iter().chain(&others).all(|&count| count > 0), "{tally:?}");
    let kept = std::fs::read_to_string(&path).ok();
    let kept = kept.map(|text| GoldenSession::read(&text).expect("a golden file"));
    let verdict =
        kept.as_ref().map_or(Err(format!("there is none: {AGAIN}")), |k| k.compare_with(&now));
    let raise = verdict.as_ref().is_err_and(|why| why.contains("raise CORE_VERSION"));
    if std::env::var("PAROS_GOLDEN").as_deref() == Ok("write") && !raise {
        std::fs::write(&path, now.write()).expect("the golden file");
    } else if let Err(why) = verdict {
        panic!("{}: {why}", path.display());
    }
}

#[test]
fn a_golden_file_tells_what_to_do() {
    let one = GoldenSession { core: 1, starts: 2, inputs: 3, digests: vec![(50, 4), (100, 5)] };
    assert_eq!(GoldenSession::read(&one.write()).as_ref(), Some(&one));
    assert_eq!(one.compare_with(&one), Ok(()));
    let raise =
        |now: &GoldenSession| one.compare_with(now).unwrap_err().contains("raise CORE_VERSION");
    assert!(raise(&GoldenSession { digests: vec![(50, 4), (100, 6)], ..one.clone() }));
    assert!(!raise(&GoldenSession { core: 2, digests: vec![(50, 4), (100, 6)], ..one.clone() }));
    assert!(!raise(&GoldenSession { inputs: 9, digests: vec![(50, 7)], ..one.clone() }));
    assert!(!raise(&GoldenSession { digests: vec![(50, 4)], ..one.clone() }));
}
