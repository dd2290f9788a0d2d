//! The replay of a recorded session, shared by the host and bare-metal examples.

use paros_core::codec::ByteReader;
use paros_core::codec::trace::{TickRecord, TraceHeader, digest_start_volumes};
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, StartVolumes, World};

/// Replays a trace whose sessions start from the solid block. `world` and `start_block` must be all zero
/// bytes at first, so that both can be in statics. Returns the digest of the last tick.
///
/// # Errors
/// A description of what was expected of the trace, or an error if a tick's digest differs from the recorded
/// one.
// Shells step their worlds through `TickRunner`, which needs a heap.
#[allow(clippy::disallowed_methods)]
pub(crate) fn replay_to_last_digest<const N: usize>(
    trace: &[u8],
    world: &mut World<N>,
    start_block: &mut RangeMaps<N>,
) -> Result<u64, &'static str>
where
    Grid<N>: Size,
{
    start_block.fill_block();
    let starts = StartVolumes { lump: start_block, figures: &[], creative: start_block, own: None };
    let mut reader = ByteReader::new(trace);
    let header = TraceHeader::read(&mut reader).map_err(|bad| bad.expected)?;
    if usize::from(header.side) != N || header.intervals != 1 {
        return Err("a trace of this size, of one interval a column");
    }
    if header.starts_digest != digest_start_volumes(&starts) {
        return Err("a trace that starts from the block");
    }
    for _ in 0..header.ticks {
        let record = TickRecord::read(&mut reader).map_err(|bad| bad.expected)?;
        world.step(&record.input, &starts);
        if world.digest() != record.digest() {
            return Err("the digest that was recorded");
        }
    }
    Ok(world.digest())
}
