//! Messages and parcels of headsets, for tests.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::sync::OnceLock;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use paros_core::TickInput;
use paros_core::badge::BadgeNumber;
use paros_core::codec::trace::{HEADER_BYTES, RECORD_BYTES};
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::Grid;
use paros_protocol::ContentHash;
use paros_protocol::*;
use paros_shell::rmap;
use paros_shell::statics::Resident;
use paros_shell::stl_export::StlExporter;
use paros_shell::tick_runner::with_fresh_world;

/// Makes the heartbeat of a headset that isn't worn.
pub(crate) fn heartbeat(headset: u32) -> Heartbeat {
    let status = HeadsetStatus { battery_percent: Some(70), ..HeadsetStatus::default() };
    let badges = BadgeReport { epoch: 1, blocks: Vec::new() };
    Heartbeat { status, ..Heartbeat::first(headset, 1, badges) }
}

const SOME_TRACE: &[u8] = include_bytes!("../../../../../core/examples/replay/groove.trace");

/// The offset of the number of ticks in a trace's header.
const TICKS_AT: usize = 12;

/// The length of a long trace in bytes, at least: its parcel counts as large.
const LARGE_TRACE_BYTES: usize = 3 << 20;

/// The files of a sculpture.
pub(crate) struct Figure {
    pub(crate) rmap: Vec<u8>,
    pub(crate) stl: Vec<u8>,
}

/// Returns the toy figure from which a creative session starts.
pub(crate) fn figure() -> &'static Figure {
    static FIGURE: OnceLock<Figure> = OnceLock::new();
    FIGURE.get_or_init(|| {
        with_fresh_world::<128, INTERVALS, _>(|mut runner| {
            runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
            let volume = runner.world().volume();
            let mut buffers = <Grid<128> as Resident<128, INTERVALS>>::lock_stl_buffers();
            let mut exporter = StlExporter::of_default_height(&mut buffers);
            exporter.begin_export(volume.rows(), runner.world().mask());
            let stl = exporter.run_export_to_end().expect("a mesh").bytes;
            Figure { rmap: rmap::encode(volume.maps()), stl }
        })
    })
}

/// A parcel of a headset.
#[derive(Clone)]
pub(crate) struct Parcel {
    pub(crate) facts: UploadFacts,
    pub(crate) hash: ContentHash,
    pub(crate) bytes: Vec<u8>,
}

impl Parcel {
    /// Makes a parcel of the toy under an id.
    pub(crate) fn volume(id: u32) -> Self {
        let rmap = &figure().rmap;
        let mut bytes = [7; 16];
        bytes[..4].copy_from_slice(&id.to_le_bytes());
        let facts = UploadFacts {
            id: SculptureId(bytes),
            badge: BadgeNumber::new(id),
            badge_serial: Some(BlockSerial([9; 8])),
            core_version: paros_core::codec::trace::CORE_VERSION,
            side: 128,
            cause: FinishCause::Finished,
            language: *b"en",
            mode: SessionMode::Creative,
            age_group: AgeGroup::Unknown,
            sculpting_seconds: 300,
            finished_at: 1_790_000_000,
            height_mm_tenths: 1200,
            volume_bytes: 0,
            volume_raw_bytes: rmap.len() as u32,
            trace_bytes: 0,
            trace_raw_bytes: 0,
        };
        static PACKED: OnceLock<Vec<u8>> = OnceLock::new();
        let packed = PACKED.get_or_init(|| deflate(rmap));
        Parcel::of_packed(UploadFacts { volume_bytes: packed.len() as u32, ..facts }, packed, &[])
    }

    /// Makes a parcel with a long trace, which is stored without compression.
    pub(crate) fn large(id: u32) -> Self {
        static TRACE: OnceLock<[Vec<u8>; 2]> = OnceLock::new();
        let [raw, stored] = TRACE.get_or_init(|| {
            let (head, records) = SOME_TRACE.split_at(HEADER_BYTES);
            let times = LARGE_TRACE_BYTES.div_ceil(records.len());
            let ticks = (times * records.len() / RECORD_BYTES) as u32;
            let mut raw = [head, &records.repeat(times)].concat();
            raw[TICKS_AT..][..4].copy_from_slice(&ticks.to_le_bytes());
            let stored = deflate_by(&raw, Compression::none());
            [raw, stored]
        });
        let parcel = Parcel::volume(id);
        let facts = parcel.facts;
        let facts = UploadFacts {
            trace_bytes: stored.len() as u32,
            trace_raw_bytes: raw.len() as u32,
            ..facts
        };
        Parcel::of_packed(facts, parcel.packed(), stored)
    }

    /// Makes a parcel with the trace of a session.
    pub(crate) fn with_trace(id: u32) -> Self {
        let facts = Parcel::volume(id).facts;
        Parcel::pack(facts, &figure().rmap, SOME_TRACE)
    }

    /// Compresses files, and sets their lengths in the head.
    pub(crate) fn pack(facts: UploadFacts, first: &[u8], trace: &[u8]) -> Self {
        let (first, packed_trace) = (deflate(first), deflate(trace));
        let packed_trace = if trace.is_empty() { Vec::new() } else { packed_trace };
        let facts = UploadFacts {
            volume_bytes: first.len() as u32,
            trace_bytes: packed_trace.len() as u32,
            trace_raw_bytes: trace.len() as u32,
            ..facts
        };
        Parcel::of_packed(facts, &first, &packed_trace)
    }

    /// Returns `true` if a booth's folder has the files of this parcel.
    pub(crate) fn is_kept_in(&self, folder: &Path) -> bool {
        let read = |end| {
            let name = format!("{}-{}.{end}", self.facts.id, self.hash);
            fs::read(folder.join(name)).unwrap_or_default()
        };
        [read("sculpture"), read("trace")].concat() == self.bytes
    }

    /// Returns the parcel with its hash, as headsets send it.
    pub(crate) fn file(&self) -> Vec<u8> {
        [&self.bytes[..], &self.hash.0].concat()
    }

    /// Returns the compressed files.
    pub(crate) fn packed(&self) -> &[u8] {
        &self.bytes[self.facts.to_head().len()..]
    }

    /// Makes a parcel with the same files and another head.
    pub(crate) fn with_facts(&self, facts: UploadFacts) -> Self {
        Parcel::of_packed(facts, self.packed(), &[])
    }

    pub(crate) fn of_packed(facts: UploadFacts, first: &[u8], trace: &[u8]) -> Self {
        let bytes = [&facts.to_head()[..], first, trace].concat();
        Parcel { facts, hash: ContentHash::of(&bytes), bytes }
    }
}

pub(crate) fn deflate(bytes: &[u8]) -> Vec<u8> {
    deflate_by(bytes, Compression::fast())
}

fn deflate_by(bytes: &[u8], level: Compression) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), level);
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory")
}
