//! Traces: round trip, rejected bytes, and the tick at which a replay diverges.

use std::sync::{Mutex, PoisonError};

use paros_core::codec::ByteReader;
use paros_core::codec::trace::{
    CORE_VERSION, EXPECTED_CORE_VERSION, EXPECTED_TRACE_VERSION, HEADER_BYTES, RECORD_BYTES,
    TRACE_VERSION, TickRecord, TraceHeader, digest_start_volumes,
};
use paros_core::internals::{ByteWriter, DIGEST_PARTS};
use paros_core::session::{PointerCommand, RawPose, SessionMode};
use paros_core::visit::{Presence, VisitCommand, VisitInput};
use paros_core::{HandInput, HiddenFigure, RangeMaps, StartVolumes, TickInput, World};
use paros_models::random_visitor::{RandomSource, RandomVisitor, arbitrary_input};
use paros_models::world_harness::{WorldAndStarts, WorldHarness};
use paros_shell::tick_runner::TickRunner;
use paros_shell::trace::{ReplayDivergence, Trace, TraceError, TraceFault};

static STUDIO: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());
const TICKS: usize = 80;

/// Runs a function on an empty world with these start volumes.
fn on_stage<T>(
    studio: &mut WorldHarness<128>,
    change: impl FnOnce(&mut World<128>),
    act: impl FnOnce(&mut TickRunner<'_, 128, 1>) -> T,
) -> T {
    studio.reset();
    let WorldAndStarts { world, lump, figure, creative } = studio.world_and_start_volumes();
    change(world);
    let figures = [HiddenFigure { figure, stone: lump }];
    act(&mut TickRunner::new(world, StartVolumes { lump, figures: &figures, creative, own: None }))
}

/// Records a session on the lump and returns the trace's bytes.
fn record_trace(studio: &mut WorldHarness<128>) -> Vec<u8> {
    on_stage(
        studio,
        |_| {},
        |stage| {
            stage.start_recording();
            let mut visitor = RandomVisitor::new(17);
            stage.run_tick(&TickInput {
                start: SessionMode::Constrained { figure: 0 },
                ..TickInput::default()
            });
            (1..TICKS).for_each(|_| stage.run_tick(&visitor.next_input()));
            stage.end_recording_to_bytes().expect("a recording")
        },
    )
}

fn replay_trace(
    studio: &mut WorldHarness<128>,
    trace: &Trace,
) -> (usize, Result<(), ReplayDivergence>) {
    on_stage(
        studio,
        |_| {},
        |stage| {
            let mut ticks = 0;
            let result = stage.replay_on_same_start(trace, |_| ticks += 1);
            (ticks, result)
        },
    )
}

fn decode_trace(bytes: &[u8]) -> Trace {
    Trace::decode(bytes).expect("a trace")
}

/// Returns the bytes of a tick's record.
fn record_of(bytes: &mut [u8], tick: usize) -> &mut [u8] {
    &mut bytes[HEADER_BYTES + tick * RECORD_BYTES..][..RECORD_BYTES]
}

#[test]
fn a_replay_makes_the_recorded_digests() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let bytes = record_trace(&mut studio);
    assert_eq!(bytes.len(), HEADER_BYTES + TICKS * RECORD_BYTES);
    let trace = decode_trace(&bytes);
    assert_eq!((trace.header().side, trace.header().ticks), (128, TICKS as u32));
    assert_eq!(trace.records().len(), TICKS);
    assert_eq!(replay_trace(&mut studio, &trace), (TICKS, Ok(())));
    // A second recording is identical.
    let again = on_stage(
        &mut studio,
        |_| {},
        |stage| {
            stage.start_recording();
            stage.replay_on_same_start(&trace, |_| {}).expect("the same session");
            stage.end_recording_to_bytes()
        },
    );
    assert!(again.as_deref() == Some(&bytes[..]));
}

#[test]
fn a_changed_input_or_digest_is_named_by_its_tick() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let bytes = record_trace(&mut studio);
    let diverged_at = |studio: &mut WorldHarness<128>, bytes: &[u8]| match replay_trace(
        studio,
        &decode_trace(bytes),
    ) {
        (played, Err(ReplayDivergence::Tick { tick, part, recorded, here })) => {
            assert_eq!(played, tick, "ticks before it are played");
            assert_ne!(recorded, here);
            (tick, part)
        }
        other => panic!("{other:?}"),
    };
    for tick in [0, 1, 40, TICKS - 1] {
        let mut moved = bytes.clone();
        match tick {
            0 => record_of(&mut moved, 0)[114] = 1, // freely, not constrained
            tick => record_of(&mut moved, tick)[1] ^= 1, // the head's position
        }
        assert_eq!(diverged_at(&mut studio, &moved), (tick, DIGEST_PARTS[0]));
        for (i, part) in DIGEST_PARTS.into_iter().enumerate() {
            let mut other = bytes.clone();
            record_of(&mut other, tick)[TickInput::BYTES + 8 * i] ^= 1; // its digest
            assert_eq!(diverged_at(&mut studio, &other), (tick, part));
        }
    }
    let message = ReplayDivergence::Tick { tick: 40, part: DIGEST_PARTS[1], recorded: 1, here: 2 }
        .to_string();
    assert!(message.starts_with("tick 40: another state of volume"), "{message}");
}

#[test]
fn traces_of_other_volumes_states_and_sizes_part_before_the_first_tick() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let trace = decode_trace(&record_trace(&mut studio));
    studio.reset();
    let WorldAndStarts { world, lump, figure, creative } = studio.world_and_start_volumes();
    // Figure and toy are swapped.
    let figures = [HiddenFigure { figure: creative, stone: lump }];
    let starts = StartVolumes { lump, figures: &figures, creative: figure, own: None };
    let played = TickRunner::new(world, starts)
        .replay_on_same_start(&trace, |_| panic!("a tick was played"));
    assert!(matches!(played, Err(ReplayDivergence::Starts { .. })), "{played:?}");
    assert!(played.expect_err("other volumes").to_string().starts_with("before tick 0:"));
    assert_eq!(world.tick(), 0);
    let figures = [HiddenFigure { figure, stone: lump }];
    let starts = || StartVolumes { lump, figures: &figures, creative, own: None };
    TickRunner::new(world, starts()).run_tick(&TickInput::default());
    let played = TickRunner::new(world, starts())
        .replay_on_same_start(&trace, |_| panic!("a tick was played"));
    assert!(matches!(played, Err(ReplayDivergence::State { .. })), "{played:?}");
    static SMALL: Mutex<(World<64>, RangeMaps<64>)> = Mutex::new((World::new(), RangeMaps::new()));
    let mut small = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let (world, maps) = &mut *small;
    let starts = StartVolumes { lump: maps, figures: &[], creative: maps, own: None };
    let played = TickRunner::new(world, starts)
        .replay_on_same_start(&trace, |_| panic!("a tick was played"));
    assert_eq!(played, Err(ReplayDivergence::Size { recorded: 128, here: 64 }));
}

#[test]
fn each_start_volume_counts_in_their_digest() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    studio.reset();
    let WorldAndStarts { lump, figure, creative, .. } = studio.world_and_start_volumes();
    let two = [figure, creative].map(|figure| HiddenFigure { figure, stone: lump });
    let of_other_stone = [HiddenFigure { figure, stone: figure }];
    let of = |lump, figures, creative, own| {
        digest_start_volumes(&StartVolumes { lump, figures, creative, own })
    };
    let all = [
        of(lump, &two[..1], creative, None),
        of(creative, &two[..1], creative, None),
        of(lump, &[], creative, None),
        of(lump, &two, creative, None),
        of(lump, &two[1..], creative, None),
        of(lump, &of_other_stone, creative, None),
        of(lump, &two[..1], figure, None),
        of(lump, &two[..1], creative, Some(figure)),
    ];
    for (i, digest) in all.iter().enumerate() {
        assert!(!all[..i].contains(digest), "{i}");
    }
}

#[test]
fn traces_cut_short_name_the_tick() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let bytes = record_trace(&mut studio);
    for len in 0..HEADER_BYTES {
        let TraceFault { tick, bad } =
            Trace::decode(&bytes[..len]).expect_err("a header cut short");
        assert_eq!(tick, None);
        assert!(bad.offset <= len && !bad.expected.is_empty());
    }
    for tick in [0, 1, 33, TICKS - 1] {
        let start = HEADER_BYTES + tick * RECORD_BYTES;
        // Cut at a record's start, in its input and in its digest.
        for len in [start, start + 1, start + TickInput::BYTES, start + RECORD_BYTES - 1] {
            let TraceFault { tick: at, bad } =
                Trace::decode(&bytes[..len]).expect_err("a record cut short");
            assert_eq!(at, Some(tick), "{len} bytes");
            assert!((start..=len).contains(&bad.offset), "{bad:?}");
        }
    }
    let mut longer = bytes.clone();
    longer.extend_from_slice(record_of(&mut bytes.clone(), 0));
    assert_eq!(Trace::decode(&longer).expect_err("a record too many").tick, Some(TICKS));
    let path = std::env::temp_dir().join(format!("paros-{}-cut.trace", std::process::id()));
    std::fs::write(&path, &bytes[..bytes.len() - 1]).expect("a file");
    let error = Trace::read(&path).expect_err("a trace cut short");
    assert!(matches!(error, TraceError::Record { tick, .. } if tick == TICKS - 1));
    assert!(error.to_string().contains(&format!("tick {}", TICKS - 1)), "{error}");
    std::fs::remove_file(&path).expect("the file");
    assert!(matches!(Trace::read(&path), Err(TraceError::Read(..))));
}

#[test]
fn headers_of_another_kind_or_version_are_turned_away() {
    let header = TraceHeader {
        side: 256,
        intervals: 1,
        ticks: 0,
        starts_digest: 0x0123_4567_89ab_cdef,
        first_digest: 42,
    };
    let mut bytes = [0; HEADER_BYTES];
    let mut to = ByteWriter::new(&mut bytes);
    header.write(&mut to);
    assert_eq!((to.len(), to.fits()), (HEADER_BYTES, true));
    assert_eq!(TraceHeader::read(&mut ByteReader::new(&bytes)), Ok(header));
    assert_eq!(decode_trace(&bytes).records().len(), 0);
    for (at, offset) in [(0, 0), (3, 0), (4, 4), (5, 4), (6, 6), (8, 8), (9, 8), (10, 10)] {
        let mut wrong = bytes;
        wrong[at] ^= 0x40;
        let bad = TraceHeader::read(&mut ByteReader::new(&wrong)).expect_err("another header");
        assert_eq!(bad.offset, offset, "byte {at}: {}", bad.expected);
        assert_eq!(Trace::decode(&wrong).expect_err("another header").tick, None);
        match offset {
            4 => assert_eq!(bad.expected, EXPECTED_TRACE_VERSION),
            6 => assert_eq!(bad.expected, EXPECTED_CORE_VERSION),
            _ => {}
        }
    }
    assert_eq!(EXPECTED_TRACE_VERSION, format!("trace version {TRACE_VERSION}"));
    assert_eq!(EXPECTED_CORE_VERSION, format!("core version {CORE_VERSION}"));
}

#[test]
fn a_record_that_is_no_input_is_named_by_its_tick() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let bytes = record_trace(&mut studio);
    for (at, value) in [(110, 6), (110, 255), (114, 5), (115, 1)] {
        let mut wrong = bytes.clone();
        let record = record_of(&mut wrong, 7);
        record[110..116].fill(0);
        record[at] = value;
        let TraceFault { tick, bad } = Trace::decode(&wrong).expect_err("no such command or mode");
        let from = HEADER_BYTES + 7 * RECORD_BYTES;
        assert_eq!((tick, bad.offset), (Some(7), from + if at < 114 { 110 } else { 114 }));
    }
}

#[test]
fn inputs_are_of_a_fixed_width_there_and_back() {
    let mut dice = RandomSource::new(23);
    for _ in 0..5000 {
        let mut input = arbitrary_input(&mut dice);
        input.hands.iter_mut().for_each(|hand| hand.buttons &= 0x7f);
        let mut bytes = [0; RECORD_BYTES];
        let record = TickRecord { input, part_digests: DIGEST_PARTS.map(|_| dice.next_bits()) };
        let mut to = ByteWriter::new(&mut bytes);
        record.write(&mut to);
        assert_eq!(to.len(), RECORD_BYTES);
        assert_eq!(TickRecord::read(&mut ByteReader::new(&bytes)), Ok(record));
        let mut to = ByteWriter::new(&mut []);
        input.write(&mut to);
        assert_eq!(to.len(), TickInput::BYTES);
    }
    // The eighth button's bit stands for "tracked", and must not be mistaken for a button.
    let hand = HandInput { buttons: 0x80, ..HandInput::default() };
    let mut bytes = [0; TickInput::BYTES];
    TickInput { hands: [hand; 2], ..TickInput::default() }.write(&mut ByteWriter::new(&mut bytes));
    assert_eq!(TickInput::read(&mut ByteReader::new(&bytes)), Ok(TickInput::default()));
}

/// Little-endian, in the order of the fields.
const INPUT: &str = "\
010000000200000003000000 0100020003000400 \
feffffff ffff0000 00000080 ff7f008001000200 111111110000000001000000 0500060007000800 ff80 7f81 87 \
0000000000000000000000000000000000000000 0000000000000000000000000000000000000000 0000 0000 00 \
030cfe 09 0205 06 0903020107";

#[test]
fn the_bytes_of_an_input_are_the_golden_ones() {
    let pose = |position, rotation| RawPose { position, rotation };
    let hand = HandInput {
        aim: pose([-2, 0xffff_u16.into(), i32::MIN], [i16::MAX, i16::MIN, 1, 2]),
        grip: pose([0x1111_1111, 0, 1], [5, 6, 7, 8]),
        trigger: 255,
        squeeze: 128,
        stick: [127, -127],
        buttons: 7,
        tracked: true,
    };
    let input = TickInput {
        head: pose([1, 2, 3], [1, 2, 3, 4]),
        hands: [hand, HandInput::default()],
        pointer: PointerCommand::Turn { by: -500 },
        commands: 9,
        start: SessionMode::Constrained { figure: 5 },
        visit: VisitInput {
            presence: Presence::Off,
            is_used: true,
            command: VisitCommand::Badge { number: 0x0701_0203 },
        },
    };
    let mut bytes = [0; TickInput::BYTES];
    input.write(&mut ByteWriter::new(&mut bytes));
    let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let golden: String = INPUT.split_whitespace().collect();
    assert_eq!(text, golden);
    assert_eq!(TickInput::BYTES, 122);
}
