//! Traces store the number of intervals a column, and are replayed with that number.

use std::sync::{Mutex, PoisonError};

use paros_core::codec::trace::{HEADER_BYTES, TraceHeader};
use paros_core::codec::{BadBytes, ByteReader};
use paros_core::internals::ByteWriter;
use paros_core::limits::MAX_INTERVALS;
use paros_core::{RangeMaps, StartVolumes, TickInput, World};
use paros_shell::tick_runner::TickRunner;
use paros_shell::trace::{ReplayDivergence, Trace};

/// Returns a header with this many intervals a column.
fn write_header(intervals: u16) -> [u8; HEADER_BYTES] {
    let mut bytes = [0; HEADER_BYTES];
    TraceHeader { side: 128, intervals, ticks: 0, starts_digest: 1, first_digest: 2 }
        .write(&mut ByteWriter::new(&mut bytes));
    bytes
}

fn read_intervals(stored: u16) -> Result<u16, BadBytes> {
    let mut bytes = write_header(1);
    bytes[10..12].copy_from_slice(&stored.to_le_bytes());
    TraceHeader::read(&mut ByteReader::new(&bytes)).map(|header| header.intervals)
}

#[test]
fn headers_say_the_intervals_of_a_column() {
    for (intervals, stored) in [(1, 0), (2, 2), (3, 3), (4, 4)] {
        assert_eq!(write_header(intervals)[10..12], u16::to_le_bytes(stored));
        assert_eq!(read_intervals(stored), Ok(intervals));
    }
    assert_eq!(read_intervals(1), Ok(1));
    for stored in [MAX_INTERVALS as u16 + 1, 256, u16::MAX] {
        let bad = read_intervals(stored).expect_err("too many intervals");
        assert_eq!(bad.offset, 10);
        assert_eq!(bad.expected, format!("0 to {MAX_INTERVALS} intervals a column"));
    }
}

/// A world and its empty start volumes.
type Stage<const K: usize> = Mutex<(World<128, K>, RangeMaps<128, K>)>;

fn on_stage<const K: usize, T>(
    stage: &Stage<K>,
    act: impl FnOnce(&mut TickRunner<'_, 128, K>) -> T,
) -> T {
    let (world, maps) = &mut *stage.lock().unwrap_or_else(PoisonError::into_inner);
    world.clear();
    let starts = StartVolumes { lump: maps, figures: &[], creative: maps, own: None };
    act(&mut TickRunner::new(world, starts))
}

fn record_trace<const K: usize>(stage: &Stage<K>) -> Vec<u8> {
    on_stage(stage, |runner| {
        runner.start_recording();
        (0..3).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().expect("a recording")
    })
}

/// Replays a trace. Returns the number of ticks played, and the divergence from the trace, if any.
fn replay_trace<const K: usize>(
    stage: &Stage<K>,
    trace: &[u8],
) -> (usize, Result<(), ReplayDivergence>) {
    let trace = Trace::decode(trace).expect("a trace");
    on_stage(stage, |runner| {
        let mut ticks = 0;
        let result = runner.replay_on_same_start(&trace, |_| ticks += 1);
        (ticks, result)
    })
}

#[test]
fn traces_of_other_intervals_are_refused_by_both_numbers() {
    static ONE: Stage<1> = Mutex::new((World::new(), RangeMaps::new()));
    static TWO: Stage<2> = Mutex::new((World::new(), RangeMaps::new()));
    let (of_one, of_two) = (record_trace(&ONE), record_trace(&TWO));
    assert_eq!((&of_one[10..12], &of_two[10..12]), (&[0, 0][..], &[2, 0][..]));
    assert_eq!(replay_trace(&ONE, &of_one), (3, Ok(())));
    assert_eq!(replay_trace(&TWO, &of_two), (3, Ok(())));
    let other = |recorded, here| (0, Err(ReplayDivergence::Intervals { recorded, here }));
    assert_eq!(replay_trace(&TWO, &of_one), other(1, 2));
    assert_eq!(replay_trace(&ONE, &of_two), other(2, 1));
    let message = ReplayDivergence::Intervals { recorded: 1, here: 2 }.to_string();
    assert_eq!(message, "before tick 0: intervals a column: 1 as recorded, 2 here");
}
