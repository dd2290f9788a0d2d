//! Replays a recorded session on bare metal: a Cortex-M4F with 4 MiB of memory, no operating system and no
//! allocator. It prints the digest of the last tick by semihosting; the `step_trace` example prints the same
//! line on a host.
//!
//! `cargo build --release --target thumbv7em-none-eabihf`, and then
//! `qemu-system-arm -machine mps2-an386 -nographic -semihosting-config enable=on,target=native -kernel
//! target/thumbv7em-none-eabihf/release/paros-bare-metal`.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use panic_semihosting as _;
use paros_core::{RangeMaps, World};

#[path = "../../replay/mod.rs"]
mod replay;

#[entry]
fn main() -> ! {
    // `entry` passes these statics as exclusive references.
    static mut WORLD: World<128> = World::new();
    static mut BLOCK: RangeMaps<128> = RangeMaps::new();

    match replay::replay_to_last_digest(include_bytes!("../../replay/groove.trace"), WORLD, BLOCK) {
        Ok(digest) => {
            hprintln!("{} ticks, last digest {:016x}", WORLD.tick(), digest);
            debug::exit(debug::EXIT_SUCCESS);
        }
        Err(expected) => {
            hprintln!("tick {}: expected {}", WORLD.tick(), expected);
            debug::exit(debug::EXIT_FAILURE);
        }
    }
    loop {}
}
