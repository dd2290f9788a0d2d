//! Tests of the validation of parcels.

use std::io::{Read as _, Write as _};
use std::sync::OnceLock;

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use paros_booth::check_parcel;
use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_protocol::*;
use paros_shell::rmap;
use paros_shell::tick_runner::with_fresh_world;
use proptest::prelude::*;

const TRACE: &[u8] = include_bytes!("../../../../core/examples/replay/groove.trace");

fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory")
}

fn inflate(bytes: &[u8]) -> Vec<u8> {
    let mut unpacked = Vec::new();
    DeflateDecoder::new(bytes).read_to_end(&mut unpacked).expect("it is packed");
    unpacked
}

/// Returns the `.rmap` file of the toy figure.
fn toy() -> &'static [u8] {
    static TOY: OnceLock<Vec<u8>> = OnceLock::new();
    TOY.get_or_init(|| {
        with_fresh_world::<128, INTERVALS, _>(|mut runner| {
            runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
            rmap::encode(runner.world().volume().maps())
        })
    })
}

fn facts_of(first: &[u8], trace: &[u8]) -> UploadFacts {
    UploadFacts {
        id: SculptureId([1; 16]),
        badge: None,
        badge_serial: None,
        core_version: 1,
        side: 128,
        cause: FinishCause::Left,
        language: *b"el",
        mode: SessionMode::Creative,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 1,
        finished_at: 1,
        height_mm_tenths: 1200,
        volume_bytes: 1,
        volume_raw_bytes: first.len() as u32,
        trace_bytes: u32::from(!trace.is_empty()),
        trace_raw_bytes: trace.len() as u32,
    }
}

/// Compresses files, and checks them as a parcel.
fn check(first: &[u8], trace: &[u8]) -> Result<(), String> {
    check_parcel(&facts_of(first, trace), &deflate(first), &deflate(trace))
}

#[test]
fn volumes_and_traces_are_taken() {
    assert_eq!(check(toy(), &[]), Ok(()));
    assert_eq!(check(toy(), TRACE), Ok(()));
}

/// Packed and unpacked lengths must match the head, without extra bytes.
#[test]
fn lengths_are_those_of_the_head() {
    let (facts, packed) = (facts_of(toy(), TRACE), deflate(toy()));
    let trace = deflate(TRACE);
    for raw in [0, 1, facts.volume_raw_bytes - 1, facts.volume_raw_bytes + 1, u32::MAX] {
        let facts = UploadFacts { volume_raw_bytes: raw, ..facts };
        assert!(check_parcel(&facts, &packed, &trace).is_err(), "{raw}");
    }
    for raw in [0, 1, facts.trace_raw_bytes - 1, facts.trace_raw_bytes + 1] {
        let facts = UploadFacts { trace_raw_bytes: raw, ..facts };
        assert!(check_parcel(&facts, &packed, &trace).is_err(), "{raw}");
    }
    let longer = |bytes: &[u8]| [bytes, &[0]].concat();
    assert!(check_parcel(&facts, &longer(&packed), &trace).is_err());
    assert!(check_parcel(&facts, &packed, &longer(&trace)).is_err());
    assert!(check_parcel(&facts, &packed[..packed.len() - 1], &trace).is_err());
    assert!(check_parcel(&facts, &packed, &trace[..trace.len() - 1]).is_err());
}

#[test]
fn each_file_is_what_its_head_says() {
    assert!(check(TRACE, &[]).is_err());
    assert!(check(toy(), toy()).is_err());
    let other_side = UploadFacts { side: 256, ..facts_of(toy(), &[]) };
    assert!(check_parcel(&other_side, &deflate(toy()), &[]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A changed byte in a packed or unpacked file is rejected, without a panic.
    #[test]
    fn spoilt_files_are_refused(place: prop::sample::Index, flip in 1..=255u8, is_packed: bool) {
        let facts = facts_of(toy(), &[]);
        let mut bytes = if is_packed { deflate(toy()) } else { toy().to_vec() };
        let place = place.index(bytes.len());
        bytes[place] ^= flip;
        let packed = if is_packed { bytes } else { deflate(&bytes) };
        // Deflate can pack the same bytes in several ways, by spare bits and back references.
        if let Ok(()) = check_parcel(&facts, &packed, &[]) {
            prop_assert!(is_packed && inflate(&packed) == toy(), "byte {place} of {}", packed.len());
        }
    }

    #[test]
    fn noise_is_refused(noise in prop::collection::vec(any::<u8>(), 0..2000)) {
        prop_assert!(check_parcel(&facts_of(toy(), &[]), &noise, &[]).is_err());
        prop_assert!(check(&noise, &[]).is_err());
        prop_assert!(check(toy(), &[&[0], &noise[..]].concat()).is_err());
    }
}
