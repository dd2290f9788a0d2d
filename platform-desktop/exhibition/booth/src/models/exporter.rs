//! The thread that makes each sculpture's mesh and picture, one after the other.

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

/// How long a mesh may take: a hundred times what one at 256 does.
const MAX_EXPORT_TIME: Duration = Duration::from_secs(60);

/// Bytes of a mesh at most: at 256 it has some 16 MB, and four times as many where every voxel is rough.
const MAX_MESH_BYTES: usize = 64 << 20;

/// How often the thread looks for work that nobody told it of, as what was left by a start before.
const LOOK_AGAIN: Duration = Duration::from_secs(30);

/// Makes the next mesh, if one is due. Returns for how long there is nothing to do.
pub(crate) fn export_next(booth: &Booth) -> Duration {
    let made = booth.next_export(booth_time()).and_then(|next| {
        let Some(sculpture) = next else { return Ok(LOOK_AGAIN) };
        check_export(booth, &sculpture).map(|()| Duration::ZERO)
    });
    made.unwrap_or_else(|error| {
        // Disk and database may be well again later.
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

/// Makes the mesh of a kept sculpture and checks it.
fn check_kept(kept: &[u8]) -> Result<MeshReport, String> {
    let stl = make_stl(kept)?;
    let mut check = MeshCheck::new();
    // In pieces, as it copies them.
    stl.chunks(1 << 16).for_each(|bytes| check.look_at(bytes));
    check.finish()
}

/// The STL of a kept sculpture.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn make_stl(kept: &[u8]) -> Result<Vec<u8>, String> {
    let (facts, volume) = read_kept(kept)?;
    export_volume(&facts, &volume)
}

/// The facts and the volume of a kept sculpture.
fn read_kept(kept: &[u8]) -> Result<(UploadFacts, Vec<u8>), String> {
    let (facts, packed) = UploadFacts::split_head(kept).map_err(|why| why.to_string())?;
    let volume = unpack_volume(&facts, packed)?;
    Ok((facts, volume))
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
        if started.elapsed() > MAX_EXPORT_TIME || exporter.bytes_made() > MAX_MESH_BYTES {
            return Err("its mesh takes too long, or too much".into());
        }
    }
}
