//! What a tick computes, kept from one version of the program to the next.
//!
//! `goldens/session.txt` holds digests of a session, and what they hang on. It is written by
//! `PAROS_GOLDEN=write cargo test -p paros-tests --test golden`, which refuses where only a raised
//! `CORE_VERSION` would be right.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use paros_core::codec::Writer;
use paros_core::events::Event;
use paros_core::input::{Input, Mode, Pointer};
use paros_core::tools::{Action, Tool};
use paros_core::trace::{CORE_VERSION, starts_digest};
use paros_core::workbench::Item;
use paros_core::world::Starts;
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::Visitor;

/// Modes, the visitors' seeds, and the tool that is put into a hand early on; each session takes so
/// many ticks.
const SESSIONS: [(Mode, u64, Tool); 4] = [
    (Mode::FreeForm, 1, Tool::Rotary),
    (Mode::Constrained { figure: 0 }, 2, Tool::Rasp),
    (Mode::Creative, 3, Tool::FillGun),
    (Mode::Creative, 4, Tool::Rotary),
];
const TICKS: usize = 800;

/// Ticks from one kept digest to the next.
const EVERY: usize = 100;

const AGAIN: &str = "write it: PAROS_GOLDEN=write cargo test -p paros-tests --test golden";

/// What a golden file says, line by line: `core`, `starts` and `inputs`, then ticks.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Golden {
    core: u16,
    starts: u64,
    inputs: u64,
    digests: Vec<(usize, u64)>,
}

impl Golden {
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
        Some(Golden { core, starts, inputs, digests })
    }

    fn write(&self) -> String {
        let Golden { core, starts, inputs, digests } = self;
        let mut text = String::from("# Digests of a session; see tests/golden.rs.\n");
        let _ = write!(text, "core {core}\nstarts {starts:016x}\ninputs {inputs:016x}\n");
        for (tick, digest) in digests {
            let _ = writeln!(text, "tick {tick} {digest:016x}");
        }
        text
    }

    /// What is to be done about it where `now` differs.
    fn compare(&self, now: &Golden) -> Result<(), String> {
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
                 core/src/trace.rs; then {AGAIN}",
                was.0, is.1, was.1
            )),
            None if self.digests.len() != now.digests.len() => {
                Err(format!("the session has another length: {AGAIN}"))
            }
            None => Ok(()),
        }
    }
}

/// What the sessions touch, so that one which tests nothing is found out.
#[derive(Default, Debug)]
struct Tally {
    actions: [u32; 3],
    mirrored: u32,
    fallen: u32,
    undone: u32,
    redone: u32,
}

impl Tally {
    fn count(&mut self, events: &[Event], symmetry: bool) {
        for event in events {
            match event {
                Event::Edited { bit, report, .. } if report.changed() => {
                    self.actions[match bit.data().action {
                        Action::Carve => 0,
                        Action::Fill => 1,
                        Action::Smooth => 2,
                    }] += 1;
                    self.mirrored += u32::from(symmetry);
                }
                Event::Islands(report) => self.fallen += report.removed,
                Event::Undone => self.undone += 1,
                Event::Redone => self.redone += 1,
                _ => {}
            }
        }
    }
}

fn played() -> (Golden, Tally) {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    studio.open();
    let (_, lump, figure, creative) = studio.parts();
    let figures = [figure];
    let starts = starts_digest(&Starts { lump, figures: &figures, creative, own: None });
    let (mut tally, mut bytes, mut digests) = (Tally::default(), vec![], vec![]);
    for (mode, seed, tool) in SESSIONS {
        let mut visitor = Visitor::new(seed);
        for tick in 0..TICKS {
            let start = if tick == 0 { mode } else { Mode::None };
            let mut input = Input { start, ..visitor.act() };
            if tick == 20 {
                let item = Item::Tool(tool).number() as u8;
                input.pointer = Pointer::Take { hand: 1, item };
            }
            let at = bytes.len();
            bytes.resize(at + Input::BYTES, 0);
            input.write(&mut Writer::new(&mut bytes[at..]));
            studio.step(&input);
            tally.count(studio.world.events(), studio.world.symmetry());
            if (tick + 1) % EVERY == 0 {
                digests.push((studio.world.tick() as usize, studio.world.digest()));
            }
        }
    }
    let inputs = paros_core::checksum(&bytes);
    (Golden { core: CORE_VERSION, starts, inputs, digests }, tally)
}

#[test]
fn ticks_compute_what_they_did_at_this_core_version() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("goldens/session.txt");
    let (now, tally) = played();
    let Tally { actions, mirrored, fallen, undone, redone } = tally;
    let others = [mirrored, fallen, undone, redone];
    assert!(actions.iter().chain(&others).all(|&count| count > 0), "{tally:?}");
    let kept = std::fs::read_to_string(&path).ok();
    let kept = kept.map(|text| Golden::read(&text).expect("a golden file"));
    let verdict = kept.as_ref().map_or(Err(format!("there is none: {AGAIN}")), |k| k.compare(&now));
    let raise = verdict.as_ref().is_err_and(|why| why.contains("raise CORE_VERSION"));
    if std::env::var("PAROS_GOLDEN").as_deref() == Ok("write") && !raise {
        std::fs::write(&path, now.write()).expect("the golden file");
    } else if let Err(why) = verdict {
        panic!("{}: {why}", path.display());
    }
}

#[test]
fn a_golden_file_tells_what_to_do() {
    let one = Golden { core: 1, starts: 2, inputs: 3, digests: vec![(50, 4), (100, 5)] };
    assert_eq!(Golden::read(&one.write()).as_ref(), Some(&one));
    assert_eq!(one.compare(&one), Ok(()));
    let raise = |now: &Golden| one.compare(now).unwrap_err().contains("raise CORE_VERSION");
    assert!(raise(&Golden { digests: vec![(50, 4), (100, 6)], ..one.clone() }));
    assert!(!raise(&Golden { core: 2, digests: vec![(50, 4), (100, 6)], ..one.clone() }));
    assert!(!raise(&Golden { inputs: 9, digests: vec![(50, 7)], ..one.clone() }));
    assert!(!raise(&Golden { digests: vec![(50, 4)], ..one.clone() }));
}
