//! The export thread: makes the mesh and the picture of each sculpture, one sculpture after the other.

use std::time::{Duration, Instant};

use paros_booth_rules::records::{ExportState, Sculpture};
use paros_booth_rules::{Booth, Refusal};
use paros_core::convert::HEIGHT_RANGE_MM;
use paros_core::volume::{Grid, Size};
use paros_protocol::{SculptureId, UploadFacts};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::stl_export::StlExporter;
use paros_shell::{with_intervals, with_size};
use tracing::{info, warn};

use crate::clock::booth_time;
use crate::models::mesh_check::{MeshCheck, MeshReport};
use crate::models::parcel_decode::unpack_volume;
use crate::models::picture::draw_volume;

/// The timeout of a mesh: a hundred times the time of one with 256 voxels a side.
const MAX_EXPORT_TIME: Duration = Duration::from_secs(60);

/// The most bytes of a mesh: one with 256 voxels a side has 16 MB, and up to 64 MB if every voxel is rough.
const MAX_MESH_BYTES: usize = 64 << 20;

/// The poll interval for work without a notification, such as work left over from before a restart.
const LOOK_AGAIN: Duration = Duration::from_secs(30);

/// Makes the next mesh, if one is due. Returns the time until the next look for work.
pub(crate) fn export_next(booth: &Booth) -> Duration {
    let made = booth.next_export(booth_time()).and_then(|next| {
        let Some(sculpture) = next else { return Ok(LOOK_AGAIN) };
        check_export(booth, &sculpture).map(|()| Duration::ZERO)
    });
    made.unwrap_or_else(|error| {
        // Retry later: the error of the disk or the database may be temporary.
        warn!(%error, "a mesh could not be made");
        LOOK_AGAIN
    })
}

fn check_export(booth: &Booth, sculpture: &Sculpture) -> Result<(), Refusal> {
    let id = SculptureId(sculpture.id);
    let kept = booth.read_kept(sculpture)?;
    let started = Instant::now();
    let state = match check_kept(&kept) {
        Ok(mesh) if mesh.is_closed && mesh.triangles > 0 => ExportState::Made,
        Ok(_) => {
            warn!(%id, "the mesh isn't closed, or empty");
            ExportState::Failed
        }
        Err(error) => {
            warn!(%id, error, "no mesh");
            ExportState::Failed
        }
    };
    match read_kept(&kept).and_then(|(_, volume)| draw_volume(&volume)) {
        Ok(png) => booth.keep_picture(sculpture, &png)?,
        Err(error) => warn!(%id, error, "no picture"),
    }
    let millis = started.elapsed().as_millis() as u64;
    info!(%id, ?state, millis, "mesh made");
    booth.note_export(&id, state)
}

/// Makes the mesh of a kept sculpture, and checks it.
fn check_kept(kept: &[u8]) -> Result<MeshReport, String> {
    let stl = make_stl(kept)?;
    let mut check = MeshCheck::new();
    // Checks in pieces, as the check copies each piece.
    stl.chunks(1 << 16).for_each(|bytes| check.look_at(bytes));
    check.finish()
}

/// Makes the STL of a kept sculpture.
///
/// # Errors
/// A description of what is wrong with the sculpture's file.
pub(crate) fn make_stl(kept: &[u8]) -> Result<Vec<u8>, String> {
    let (facts, volume) = read_kept(kept)?;
    export_volume(&facts, &volume)
}

/// Reads the facts and the volume from a kept sculpture's file.
fn read_kept(kept: &[u8]) -> Result<(UploadFacts, Vec<u8>), String> {
    let (facts, packed) = UploadFacts::split_head(kept).map_err(|why| why.to_string())?;
    let volume = unpack_volume(&facts, packed)?;
    Ok((facts, volume))
}

/// Makes the STL of a volume, scaled to the height in its facts.
///
/// # Errors
/// A description of what is wrong with the facts or the volume.
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
    // Release the shared maps at once: uploads are decoded in them too.
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
        if started.elapsed() > MAX_EXPORT_TIME || exporter.bytes_made() > MAX_MESH_BYTES {
            return Err("its mesh takes too long, or too much".into());
        }
    }
}
