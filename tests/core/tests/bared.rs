//! The bared share of the hidden figure is reported in tenths, once each, whatever is undone.

use std::f32::consts::PI;
use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use paros_core::limits::max_save_bytes;
use paros_core::session::{BaredEnds, BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_core::{TickInput, WorldEvent};
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;

static HARNESS: Mutex<WorldHarness<64, 2>> = Mutex::new(WorldHarness::new());

/// The middle of the figure, a dome on the ground, in voxels.
const MIDDLE: Vec3 = Vec3::new(32.0, 0.0, 32.0);
const RADIUS: f32 = 17.0;
/// The radius of the large ball burr, in voxels.
const BALL_RADIUS: f32 = 20.0 / 450.0 * 64.0;

/// Starts with the figure under two voxels of stone, and a hand that holds the large ball.
fn start(harness: &mut WorldHarness<64, 2>) {
    let dome = |radius: f32| {
        DenseVolume::from_fn(64, |at| {
            Vec3::from_array(at.map(|i| i as f32 + 0.5)).distance(MIDDLE) < radius
        })
        .closure()
    };
    harness.reset_to_voxels(&dome(RADIUS + 2.0), &dome(RADIUS));
    let mode = SessionMode::Constrained { figure: 0 };
    harness.step(&TickInput { start: mode, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    // The figure's ends have been counted by now.
    wait(harness);
}

/// Returns the events about the figure.
fn told(harness: &WorldHarness<64, 2>) -> Vec<WorldEvent> {
    let events = harness.world.events().iter().copied();
    events.filter(|event| matches!(event, WorldEvent::Bared { .. } | WorldEvent::Found)).collect()
}

/// Holds the bit above the stone until loose parts have fallen.
fn wait(harness: &mut WorldHarness<64, 2>) {
    (0..40).for_each(|_| step_with_bit_at(harness, RIGHT, MIDDLE + 40.0 * Vec3::Y, false));
}

/// Carves along a ring of the dome at the share `part` of its height, in a separate stroke. Returns the
/// events with the bared share at each.
fn carve_ring(harness: &mut WorldHarness<64, 2>, part: f32, press: f32) -> Vec<(WorldEvent, u32)> {
    let mut events = Vec::new();
    let (away, ticks) = (RADIUS + BALL_RADIUS - press, 240);
    let place = |tick: u32| {
        let (up, turn) = (part * PI / 2.0, 2.1 * PI * tick as f32 / ticks as f32);
        MIDDLE + away * Vec3::new(up.cos() * turn.cos(), up.sin(), up.cos() * turn.sin())
    };
    for tick in 0..ticks {
        step_with_bit_at(harness, RIGHT, place(tick), true);
        let percent = harness.world.bared_ends().percent();
        events.extend(told(harness).into_iter().map(|event| (event, percent)));
    }
    wait(harness);
    events
}

#[test]
fn each_tenth_is_told_once_and_the_find() {
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    start(harness);
    let BaredEnds { bared, all } = harness.world.bared_ends();
    assert!(bared * 10 < all && all > 2000, "{bared} of {all} at the start");
    // Records the share before each stroke that changed anything.
    let (mut events, mut starts) = (Vec::new(), Vec::new());
    for (ring, press) in (0..90).map(|ring| (ring, [0.4, 0.0, 0.8][ring / 30])) {
        wait(harness);
        let (at_first, digest) = (harness.world.bared_ends(), harness.world.volume().digest());
        events.extend(carve_ring(harness, (ring % 30) as f32 / 29.0, press));
        // Neither undo and redo nor a load reports a tenth again.
        let command = |commands| TickInput { commands, ..TickInput::default() };
        let before = harness.world.bared_ends();
        if harness.world.volume().digest() != digest {
            starts.push(at_first);
        }
        harness.step(&command(commands::UNDO));
        assert_eq!(harness.world.bared_ends(), *starts.last().unwrap_or(&at_first), "ring {ring}");
        assert_eq!(told(harness), []);
        let mut save = vec![0; max_save_bytes(64, 2)];
        let len = harness.world.save(&mut save);
        harness.world.load(&save[..len]).expect("its own save");
        harness.step(&command(commands::REDO));
        assert_eq!((harness.world.bared_ends(), told(harness)), (before, vec![]), "ring {ring}");
    }
    let tenths: Vec<u8> = events
        .iter()
        .filter_map(|(event, percent)| match event {
            WorldEvent::Bared { tenths } => {
                assert_eq!(*percent / 10, u32::from(*tenths));
                Some(*tenths)
            }
            _ => None,
        })
        .collect();
    assert!(tenths.is_sorted_by(|a, b| a < b) && tenths.len() >= 8, "told were {tenths:?}");
    let found: Vec<u32> =
        events.iter().filter(|(event, _)| *event == WorldEvent::Found).map(|(_, p)| *p).collect();
    assert!(
        found.len() == 1 && found[0] >= 95,
        "found at {found:?}, {:?}",
        harness.world.bared_ends()
    );
}

/// Stone removed by the islands' pass bares the figure as a tool does. Here two lids hang over the figure, on
/// a post beside it. One of the columns' two gaps is closed, so the figure's top isn't a column end until
/// both lids have fallen.
#[test]
fn what_falls_bares_what_it_hid() {
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let within = |x: i32, z: i32| (24..40).contains(&x) && (24..40).contains(&z);
    let figure = DenseVolume::from_fn(64, |[x, y, z]| y < 20 && within(x, z));
    let stone = DenseVolume::from_fn(64, |[x, y, z]| {
        let lid = (21..24).contains(&y) || (27..30).contains(&y);
        let post = y < 30 && (20..22).contains(&x);
        y < 20 && within(x, z) || (29..36).contains(&z) && (post || lid && (20..44).contains(&x))
    });
    harness.reset_to_voxels(&stone, &figure);
    let mode = SessionMode::Constrained { figure: 0 };
    harness.step(&TickInput { start: mode, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    // The figure's ends have been counted by now.
    wait(harness);
    let before = harness.world.bared_ends();
    for tick in 0..400 {
        let place = Vec3::new(19.5, 12.0, 24.0 + tick as f32 * 0.05);
        step_with_bit_at(harness, RIGHT, place, true);
    }
    let fell = harness.world.bared_ends();
    assert!((20..30).all(|y| !harness.world.volume().rows().contains([36, y, 32])), "it hangs");
    assert!(fell.bared >= before.bared + 16 * 7, "{before:?}, {fell:?}");
    assert_eq!(fell.bared, fell.all, "all of it shows");
}
