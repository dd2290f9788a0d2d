//! What a headset sends, and whether a booth keeps it.

use std::fs;

use paros_booth_process::BoothProcess;
use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::outbox::messages::{
    AgeGroup, ContentHash, FinishCause, ParcelKind, SculptureId, UploadFacts,
};
use paros_core::session::SessionMode;
use paros_core::volume::Grid;
use paros_shell::outbox::courier::ParcelDraft;
use paros_shell::statics::Resident;
use paros_shell::stl_export::StlExporter;
use paros_shell::tick_runner::with_fresh_world;
use sha2::{Digest as _, Sha256};

/// Whether a booth keeps a sculpture, whose mesh it has made anew to the same bytes.
pub(crate) fn is_kept(booth: &BoothProcess, id: SculptureId) -> bool {
    let entries = fs::read_dir(booth.data().join("sculptures")).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string());
    let is_its = |name: String| name.starts_with(&id.to_string()) && name.ends_with(".sculpture");
    let compared = format!("mesh compared id={id} state=Equal");
    booth.read_log().contains(&compared) && names.flatten().any(is_its)
}

/// The toy that a creative session starts from, as the mesh that a headset exported; `number` makes its id.
pub(crate) fn make_draft(headset: u32, number: u8) -> ParcelDraft {
    let stl = with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
        let mut buffers = <Grid<128> as Resident<128, INTERVALS>>::lock_stl_buffers();
        let mut exporter = StlExporter::new(&mut buffers, 120.0).expect("a height");
        exporter.begin_export(runner.world().volume().rows(), runner.world().mask());
        exporter.run_export_to_end().expect("a mesh").bytes.to_vec()
    });
    let facts = UploadFacts {
        kind: ParcelKind::Mesh,
        id: SculptureId([number; 16]),
        headset,
        badge: None,
        core_version: paros_core::codec::trace::CORE_VERSION,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"el",
        mode: SessionMode::Creative,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 300,
        finished_at: 1_790_000_000,
        height_mm_tenths: 1200,
        stl_hash: ContentHash(Sha256::digest(&stl).into()),
        stl_bytes: stl.len() as u64,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    ParcelDraft { facts, first_file: stl, trace: None }
}
