//! The trace that the core's examples replay on a host and on bare metal: a groove drawn through the solid
//! block, undone and drawn again. `PAROS_GOLDEN=write cargo test -p paros-tests-core groove` writes the
//! trace.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool, commands};
use paros_core::{HandInput, RangeMaps, StartVolumes, TickInput, World};
use paros_shell::tick_runner::TickRunner;

/// Length of the stroke, in ticks.
const STROKE: u16 = 72;

/// Returns the hand's input in a tick.
fn input_at(world: &World<128>, tick: u16) -> TickInput {
    let mut input = TickInput::default();
    match tick {
        0 => input.start = SessionMode::FreeForm,
        1 => {
            let item = BenchItem::Tool(Tool::Rotary).number() as u8;
            input.pointer = PointerCommand::Take { hand: 1, item };
        }
        _ if tick == 2 + STROKE => input.commands = commands::UNDO,
        _ if tick == 3 + STROKE => input.commands = commands::REDO,
        _ => {
            let x = 30.0 + f32::from(tick);
            let pose = Pose { position: Vec3::new(x, 127.0, 64.0), rotation: Quat::IDENTITY };
            input.hands[1] = HandInput { trigger: 255, ..world.hand_with_bit_at(1, &pose) };
        }
    }
    input
}

fn record_groove() -> Vec<u8> {
    static WORLD: Mutex<World<128>> = Mutex::new(World::new());
    static BLOCK: Mutex<RangeMaps<128>> = Mutex::new(RangeMaps::new());
    let mut world = WORLD.lock().unwrap_or_else(PoisonError::into_inner);
    let mut block = BLOCK.lock().unwrap_or_else(PoisonError::into_inner);
    block.fill_block();
    let starts = StartVolumes { lump: &block, figures: &[], creative: &block, own: None };
    let mut runner = TickRunner::new(&mut world, starts);
    runner.start_recording();
    for tick in 0..STROKE + 10 {
        let input = input_at(runner.world(), tick);
        runner.run_tick(&input);
    }
    assert!(!runner.world().volume().rows().contains([60, 126, 64]), "no groove was drawn");
    runner.end_recording_to_bytes().expect("a recording")
}

#[test]
fn the_examples_trace_is_what_a_tick_computes_today() {
    let path =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../core/examples/replay/groove.trace");
    let now = record_groove();
    if std::env::var("PAROS_GOLDEN").as_deref() == Ok("write") {
        std::fs::write(&path, now).expect("the trace");
        return;
    }
    let kept = std::fs::read(&path).expect("the trace");
    assert!(kept == now, "write it: PAROS_GOLDEN=write cargo test -p paros-tests-core groove");
}
