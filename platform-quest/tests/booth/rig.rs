//! The parcels that a headset sends, and the check that a booth has stored them.

use std::fs;

use paros_booth_process::BoothProcess;
use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_protocol::{AgeGroup, FinishCause, SculptureId, UploadFacts};
use paros_shell::rmap;
use paros_shell::tick_runner::with_fresh_world;
use paros_upload::courier::ParcelDraft;

/// Returns `true` if a booth has stored a sculpture and made its mesh.
pub(crate) fn is_kept(booth: &BoothProcess, id: SculptureId) -> bool {
    let entries = fs::read_dir(booth.data().join("sculptures")).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string());
    let is_its = |name: String| name.starts_with(&id.to_string()) && name.ends_with(".sculpture");
    let made = format!("mesh made id={id} state=Made");
    booth.read_log().contains(&made) && names.flatten().any(is_its)
}

/// Makes a parcel with the toy from which a creative session starts; `number` makes its id.
pub(crate) fn make_draft(number: u8) -> ParcelDraft {
    let volume = with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
        rmap::encode(runner.world().volume().maps())
    });
    let facts = UploadFacts {
        id: SculptureId([number; 16]),
        badge: None,
        badge_serial: None,
        core_version: paros_core::codec::trace::CORE_VERSION,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"el",
        mode: SessionMode::Creative,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 300,
        finished_at: 1_790_000_000,
        height_mm_tenths: 1200,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    ParcelDraft { facts, volume, trace: None }
}
