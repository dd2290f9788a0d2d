//! Sessions: whatever the inputs, every invariant holds after each tick, and a saved and loaded world
//! continues identically.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::codec::ByteReader;
use paros_core::edit::Pose;
use paros_core::session::{PointerCommand, SessionMode, commands};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput};
use paros_models::random_visitor::RandomSource;
use paros_models::save_layout::save_to_vec;
use paros_models::world_harness::WorldHarness;

use crate::engine::FuzzTarget;

/// The input is a byte for the world and the session's mode, then actions, each a byte and its arguments.
pub(super) const STEP: FuzzTarget = FuzzTarget {
    name: "step",
    seeds,
    words: &[
        b"\x10\x01",
        b"\x10\x02",
        b"\x10\x04",
        b"\x18",
        b"\x20\0\0",
        b"\x20\x01\x01",
        b"\x30\0\x40",
    ],
    longest: 600,
    runs: 120,
    run: |bytes| {
        let Some((first, rest)) = bytes.split_first() else { return "nothing".into() };
        match first >> 4 & 3 {
            0 => run(&ONE, *first, rest),
            1 => run(&TWO, *first, rest),
            2 => run(&FOUR, *first, rest),
            _ => run(&LARGER, *first, rest),
        }
    },
};

static ONE: Mutex<WorldHarness<16, 1>> = Mutex::new(WorldHarness::new());
static TWO: Mutex<WorldHarness<16, 2>> = Mutex::new(WorldHarness::new());
static FOUR: Mutex<WorldHarness<16, 4>> = Mutex::new(WorldHarness::new());
static LARGER: Mutex<WorldHarness<32, 2>> = Mutex::new(WorldHarness::new());

fn seeds() -> Vec<Vec<u8>> {
    let seed = |seed: u8| {
        let mut dice = RandomSource::new(seed.into());
        // Both hands take a tool, then sculpt.
        let mut bytes = vec![seed * 17, 0x20, 0, seed % 4, 0x21, 1, seed / 4];
        bytes.extend((0..200).map(|_| dice.next_bits() as u8 | 0x40));
        bytes
    };
    (0..15).map(seed).collect()
}

fn run<const N: usize, const K: usize>(
    harness: &Mutex<WorldHarness<N, K>>,
    first: u8,
    bytes: &[u8],
) -> String
where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let modes =
        [SessionMode::FreeForm, SessionMode::Constrained { figure: 0 }, SessionMode::Creative];
    match modes.get(usize::from(first & 3)) {
        Some(mode) => harness.start_session(*mode),
        // Thin structures, from which pieces come off.
        None => {
            harness.start_from_voxels(|[x, y, z]| y < 2 || x % 5 < 2 && (z % 4 < 2 || y % 8 == 7))
        }
    };
    let mut session = FuzzedSession { bytes, hands: [HandInput::default(); 2] };
    let mut seen = [false; 3];
    while let Some(what) = session.next_byte() {
        if (0x18..0x20).contains(&what) {
            let (saved, digest) = (save_to_vec(&harness.world), harness.world.digest());
            harness.world.load(&saved).expect("what was saved is loaded");
            assert_eq!(harness.world.digest(), digest);
            continue;
        }
        for input in session.next_inputs(what, harness) {
            harness.step(&input);
            harness.check_invariants();
        }
        let counts = harness.world.undo_counts();
        let now = [counts.undoable > 0, counts.redoable > 0, harness.world.is_mirrored()];
        seen.iter_mut().zip(now).for_each(|(seen, now)| *seen |= now);
    }
    format!("{:?} {seen:?}", harness.world.session_state())
}

/// The rest of an input, and the state of the hands.
struct FuzzedSession<'a> {
    bytes: &'a [u8],
    hands: [HandInput; 2],
}

impl FuzzedSession<'_> {
    fn next_byte(&mut self) -> Option<u8> {
        let (first, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(*first)
    }

    fn next_or_zero(&mut self) -> u8 {
        self.next_byte().unwrap_or(0)
    }

    /// Returns the ticks of an action byte, and consumes its arguments.
    fn next_inputs<const N: usize, const K: usize>(
        &mut self,
        what: u8,
        harness: &WorldHarness<N, K>,
    ) -> Vec<TickInput>
    where
        Grid<N>: Size,
    {
        let mut input = TickInput { hands: self.hands, ..TickInput::default() };
        match what {
            0..0x10 => return self.raw_input().into_iter().collect(),
            0x10..0x20 => {
                // Ends the session occasionally.
                let commands = self.next_or_zero();
                input.commands =
                    if commands == 0xff { commands } else { commands & !commands::FINISH };
            }
            0x20..0x30 => {
                let (hand, item) = (self.next_or_zero(), self.next_or_zero());
                input.pointer = match what & 7 {
                    7 => PointerCommand::Return { hand },
                    5 => PointerCommand::Steady { string_mm: hand },
                    6 => PointerCommand::Resize { hand, by: item as i8 },
                    _ => PointerCommand::Take { hand, item: item % 12 },
                };
            }
            0x30..0x40 => {
                let by = i16::from_le_bytes([self.next_or_zero(), self.next_or_zero()]);
                input.pointer = PointerCommand::Turn { by };
            }
            _ => {
                let hand = usize::from(what & 1);
                let pose = self.next_pose(N);
                self.hands[hand] = HandInput {
                    trigger: if what & 6 != 0 { 255 } else { 0 },
                    squeeze: if what & 0x38 == 0 { 255 } else { 0 },
                    ..harness.world.hand_with_bit_at(hand, &pose)
                };
                input.hands = self.hands;
                return vec![input; if what < 0x80 { 1 } else { 3 }];
            }
        }
        vec![input]
    }

    /// Returns a pose in the stone or near it.
    fn next_pose(&mut self, grid_side: usize) -> Pose {
        let coordinate = |byte: u8| (f32::from(byte) / 170.0 - 0.25) * grid_side as f32;
        let position = [(); 3].map(|()| coordinate(self.next_or_zero()));
        let turn = self.next_or_zero();
        let (yaw, pitch) = (f32::from(turn & 15) * 0.4, f32::from(turn >> 4) * 0.4);
        let rotation = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch);
        Pose { position: Vec3::from_array(position), rotation }
    }

    /// Returns an input given byte by byte, if it is valid.
    fn raw_input(&mut self) -> Option<TickInput> {
        let (bytes, rest) = self.bytes.split_at_checked(TickInput::BYTES)?;
        self.bytes = rest;
        TickInput::read(&mut ByteReader::new(bytes)).ok()
    }
}
