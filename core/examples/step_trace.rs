//! Replays the session of the bare-metal example on a host and prints the digest of its last tick, the same
//! line that the board prints.
//!
//! `cargo run -p paros-core --example step_trace`

use std::sync::Mutex;

use paros_core::{RangeMaps, World};

mod replay;

static WORLD: Mutex<World<128>> = Mutex::new(World::new());
static BLOCK: Mutex<RangeMaps<128>> = Mutex::new(RangeMaps::new());

fn main() -> Result<(), String> {
    let (mut world, mut block) = (WORLD.lock().unwrap(), BLOCK.lock().unwrap());
    let digest = replay::replay_to_last_digest(
        include_bytes!("replay/groove.trace"),
        &mut world,
        &mut block,
    )
    .map_err(|expected| format!("tick {}: expected {expected}", world.tick()))?;
    println!("{} ticks, last digest {digest:016x}", world.tick());
    Ok(())
}
