//! The thread that makes each sculpture's mesh anew, one after the other, and compares it with the headset's.

use std::time::{Duration, Instant};

use paros_booth_rules::records::{MeshComparison, Sculpture};
use paros_booth_rules::{Booth, Refusal};
use paros_core::convert::HEIGHT_RANGE_MM;
use paros_core::limits::MAX_PARCEL_MESH_BYTES;
use paros_core::outbox::messages::{ParcelKind, SculptureId, UploadFacts};
use paros_core::volume::{Grid, Size};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::stl_export::StlExporter;
use paros_shell::{with_intervals, with_size};
use tracing::{info, warn};

use crate::clock::booth_time;
use crate::mesh_check::{MeshCheck, MeshReport};
use crate::parcel_decode::{check_mesh, unpack_volume};
use crate::picture::draw_volume;

/// How long a mesh may take: a hundred times what one at 256 does.
const MAX_EXPORT_TIME: Duration = Duration::from_secs(60);

/// How often the thread looks for work that nobody told it of, as what was left by a start before.
const LOOK_AGAIN: Duration = Duration::from_secs(30);

/// Compares the next mesh, if there is one. Returns for how long there is nothing to do.
pub(crate) fn export_next(booth: &Booth) -> Duration {
    let compared = booth.next_export(booth_time()).and_then(|next| {
        let Some(sculpture) = next else { return Ok(LOOK_AGAIN) };
        compare(booth, &sculpture).map(|()| Duration::ZERO)
    });
    compared.unwrap_or_else(|error| {
        // Disk and database may be well again later.
        warn!(%error, "a mesh could not be compared");
        LOOK_AGAIN
    })
}

fn compare(booth: &Booth, sculpture: &Sculpture) -> Result<(), Refusal> {
    let id = SculptureId(sculpture.id);
    let kept = booth.read_kept(sculpture)?;
    let started = Instant::now();
    let state = match check_kept(&kept) {
        Ok((facts, mesh)) if mesh.hash != facts.stl_hash => MeshComparison::Different,
        Ok((_, mesh)) if mesh.is_closed && mesh.triangles > 0 => MeshComparison::Equal,
        Ok(_) => {
            warn!(%id, "the mesh isn't closed, or empty");
            MeshComparison::Failed
        }
        Err(error) => {
            warn!(%id, error, "no mesh");
            MeshComparison::Failed
        }
    };
    if let Some(png) = draw_kept(&kept) {
        booth.keep_picture(sculpture, &png)?;
    }
    let millis = started.elapsed().as_millis() as u64;
    info!(%id, ?state, millis, "mesh compared");
    booth.note_export(&id, state)
}

/// The head of a kept sculpture, and what its mesh is: the one that came, or that of its volume.
fn check_kept(kept: &[u8]) -> Result<(UploadFacts, MeshReport), String> {
    let (head, packed) = kept.split_at_checked(UploadFacts::BYTES).ok_or("it has no head")?;
    let facts = UploadFacts::from_bytes(head)
        .map_err(|bad| format!("its head at byte {}: expected {}", bad.offset, bad.expected))?;
    let report = match facts.kind {
        ParcelKind::Mesh => check_mesh(&facts, packed)?,
        ParcelKind::Volume => {
            let stl = export_volume(&facts, &unpack_volume(&facts, packed)?)?;
            let mut check = MeshCheck::new();
            // In pieces, as it copies them.
            stl.chunks(1 << 16).for_each(|bytes| check.look_at(bytes));
            check.finish()?
        }
    };
    Ok((facts, report))
}

/// A picture of a kept volume. A mesh has none.
fn draw_kept(kept: &[u8]) -> Option<Vec<u8>> {
    let (head, packed) = kept.split_at_checked(UploadFacts::BYTES)?;
    let facts = UploadFacts::from_bytes(head).ok()?;
    if facts.kind != ParcelKind::Volume {
        return None;
    }
    let drawn = unpack_volume(&facts, packed).and_then(|volume| draw_volume(&volume));
    drawn.map_err(|error| warn!(id = %facts.id, error, "no picture")).ok()
}

/// The STL of a kept sculpture: the one that came, or that of its volume.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn make_stl(kept: &[u8]) -> Result<Vec<u8>, String> {
    let (head, packed) = kept.split_at_checked(UploadFacts::BYTES).ok_or("it has no head")?;
    let facts = UploadFacts::from_bytes(head).map_err(|bad| format!("byte {}", bad.offset))?;
    // A mesh's length is bounded by its head as well.
    let first = unpack_volume(&facts, packed)?;
    match facts.kind {
        ParcelKind::Mesh => Ok(first),
        ParcelKind::Volume => export_volume(&facts, &first),
    }
}

/// The STL of a volume, in so many millimetres as its facts say.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn export_volume(facts: &UploadFacts, bytes: &[u8]) -> Result<Vec<u8>, String> {
    let height_mm = f32::from(facts.height_mm_tenths) / 10.0;
    if !HEIGHT_RANGE_MM.contains(&height_mm) {
        return Err(format!("a height of {height_mm} mm"));
    }
    let header = rmap::parse_header(bytes).map_err(|fault| fault.to_string())?;
    let other = || Err("a size that is unknown here".to_owned());
    with_size!(header.grid_side, N => with_intervals!(
        header.intervals_per_column, K => export::<N, K>(bytes, height_mm), else other(),
    ), else other())
}

fn export<const N: usize, const K: usize>(bytes: &[u8], height_mm: f32) -> Result<Vec<u8>, String>
where
    Grid<N>: Size + Resident<N, K>,
{
    // The maps are given back at once: uploads are decoded in them.
    let mut bit_grid = Grid::<N>::lock_bit_grid();
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    rmap::decode(bytes, &mut maps).map_err(|fault| fault.to_string())?;
    bit_grid.set_from_maps(&maps);
    maps.clear();
    let mut stl_buffers = Grid::<N>::lock_stl_buffers();
    let mut exporter =
        StlExporter::new(&mut stl_buffers, height_mm).map_err(|_| "a height out of range")?;
    exporter.begin_export(&bit_grid, &maps);
    drop((maps, bit_grid));
    let started = Instant::now();
    loop {
        if let Some(stl) = exporter.advance_export_step() {
            return Ok(stl.bytes);
        }
        if started.elapsed() > MAX_EXPORT_TIME
            || exporter.bytes_made() > MAX_PARCEL_MESH_BYTES as usize
        {
            return Err("its mesh takes too long, or too much".into());
        }
    }
}
