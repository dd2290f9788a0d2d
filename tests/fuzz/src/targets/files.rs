//! Volume files, trace files and inputs: rejected at an offset inside the bytes, or unchanged by a round
//! trip.

use paros_core::codec::ByteReader;
use paros_core::codec::trace::{HEADER_BYTES, RECORD_BYTES, TraceHeader};
use paros_core::internals::ByteWriter;
use paros_core::volume::BitGrid;
use paros_core::{RangeMaps, TickInput, Volume};
use paros_models::random_visitor::{RandomSource, arbitrary_input};
use paros_shell::figures::Figure;
use paros_shell::rmap;
use paros_shell::trace::Trace;

use crate::engine::FuzzTarget;

pub(super) const RMAP: FuzzTarget = FuzzTarget {
    name: "rmap",
    seeds: rmap_seeds,
    words: &[
        b"RMAP\x01\0\x10\0\x01\0\0\0",
        b"RMAP\x02\0\x10\0\x02\0\0\0",
        b"\x10\0",
        b"\xff\x0f",
        b"\xff\0",
        b"\0\0",
    ],
    longest: 6200,
    runs: 1200,
    run: |bytes| {
        let as_it_is = decode(bytes);
        let mut mended = bytes.to_vec();
        if let Some(at) = mended.len().checked_sub(4) {
            let sum = crc32(&mended[..at]);
            mended[at..].copy_from_slice(&sum.to_le_bytes());
        }
        format!("{as_it_is}; {}", decode(&mended))
    },
};

pub(super) const TRACE: FuzzTarget = FuzzTarget {
    name: "trace",
    seeds: trace_seeds,
    words: &[b"PTRC", b"\x80\0", b"\0\x01"],
    longest: HEADER_BYTES + 4 * RECORD_BYTES,
    runs: 8000,
    run: |bytes| match Trace::decode(bytes) {
        Err(fault) => {
            assert!(fault.bad.offset <= bytes.len());
            fault.bad.expected.into()
        }
        Ok(trace) => {
            let mut again = vec![0; bytes.len()];
            let mut to = ByteWriter::new(&mut again);
            trace.header().write(&mut to);
            trace.records().for_each(|record| record.write(&mut to));
            assert!(to.len() == bytes.len());
            // One interval may be encoded as 0 or 1.
            assert!(again[HEADER_BYTES..] == bytes[HEADER_BYTES..]);
            "a trace".into()
        }
    },
};

pub(super) const INPUT: FuzzTarget = FuzzTarget {
    name: "input",
    seeds: || {
        let input = |seed| input_bytes(&arbitrary_input(&mut RandomSource::new(seed)));
        (0..8).map(input).collect()
    },
    words: &[],
    longest: TickInput::BYTES + 1,
    runs: 8000,
    run: |bytes| match TickInput::read(&mut ByteReader::new(bytes)) {
        Err(bad) => bad.expected.into(),
        Ok(input) => {
            assert_eq!(input_bytes(&input), bytes[..TickInput::BYTES]);
            "an input".into()
        }
    },
};

fn input_bytes(input: &TickInput) -> Vec<u8> {
    let mut bytes = vec![0; TickInput::BYTES];
    input.write(&mut ByteWriter::new(&mut bytes));
    bytes
}

fn trace_seeds() -> Vec<Vec<u8>> {
    let mut dice = RandomSource::new(1);
    let header =
        TraceHeader { side: 128, intervals: 2, ticks: 2, starts_digest: 1, first_digest: 2 };
    let mut bytes = vec![0; HEADER_BYTES];
    header.write(&mut ByteWriter::new(&mut bytes));
    for _ in 0..header.ticks {
        bytes.extend(input_bytes(&arbitrary_input(&mut dice)));
        bytes.resize(bytes.len() + RECORD_BYTES - TickInput::BYTES, 7);
    }
    vec![bytes]
}

fn rmap_seeds() -> Vec<Vec<u8>> {
    fn of<const K: usize>(figure: Figure) -> Vec<u8> {
        let mut maps = RangeMaps::<16, K>::new();
        figure.rasterize_into(&mut maps, &mut BitGrid::new());
        rmap::encode(&maps)
    }
    vec![of::<1>(Figure::Toy), of::<2>(Figure::Toy), of::<4>(Figure::Toy), of::<2>(Figure::Cat)]
}

/// Decodes as a volume of each supported number of intervals.
fn decode(bytes: &[u8]) -> String {
    format!("{}; {}; {}", decode_as::<1>(bytes), decode_as::<2>(bytes), decode_as::<4>(bytes))
}

fn decode_as<const K: usize>(bytes: &[u8]) -> String {
    let mut maps = RangeMaps::<16, K>::new();
    let mut volume = Volume::<16, K>::new();
    let mut check = |maps: &RangeMaps<16, K>| {
        volume.set_maps(maps);
        assert!(volume.are_ranges_tight() && volume.is_saturated());
    };
    let closed = rmap::decode_closed(bytes, &mut maps).is_ok();
    check(&maps);
    maps.clear();
    match rmap::decode(bytes, &mut maps) {
        Err(found) => {
            assert!(found.offset <= bytes.len() && maps.is_empty());
            format!("{} {closed}", found.fault)
        }
        Ok(()) => {
            assert!(closed, "what is read is read and closed too");
            check(&maps);
            if usize::from(bytes[8]) == K {
                assert!(rmap::encode(&maps) == bytes, "another file of the same volume");
            }
            "a volume".into()
        }
    }
}

/// Computes the CRC-32 of IEEE 802.3.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}
