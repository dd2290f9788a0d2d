//! Carves a ball out of the top of the solid block and writes the result as binary STL.
//!
//! `cargo run -p paros-core --example carve_ball -- bowl.stl`

use std::error::Error;
use std::sync::Mutex;

use paros_core::convert::ExportPhase;
use paros_core::edit::{EditOperation, EditScratch, SUBUNITS_PER_VOXEL};
use paros_core::glam::IVec3;
use paros_core::{Brush, Edit, Exporter, RangeMaps, Volume, apply_edit};

/// Voxels along a side of the block.
const SIDE: usize = 128;

// All zero bytes at first: they are in statics and never move.
static VOLUME: Mutex<Volume<SIDE>> = Mutex::new(Volume::new());
static BLOCK: Mutex<RangeMaps<SIDE>> = Mutex::new(RangeMaps::new());
static SCRATCH: Mutex<EditScratch<SIDE>> = Mutex::new(EditScratch::new());
static EXPORTER: Mutex<Exporter<SIDE>> = Mutex::new(Exporter::new());

/// Removes a ball of voxels and returns their number. `centre` and `radius` are in voxels.
fn carve_ball(volume: &mut Volume<SIDE>, centre: IVec3, radius: i32) -> u32 {
    // Brushes are in fixed point, 256ths of a voxel.
    let brush = Brush::sphere(centre * SUBUNITS_PER_VOXEL, radius * SUBUNITS_PER_VOXEL);
    // One edit removes a shell of four voxels at most, so a large ball takes several.
    let edit =
        Edit { brush: &brush, operation: EditOperation::Carve { depth: 4 }, mirrored: false };
    let no_mask = RangeMaps::<SIDE>::new();
    let mut scratch = SCRATCH.lock().unwrap();
    let mut removed = 0;
    loop {
        // The unit journal records nothing; pass an undo history or dirty rectangles to record changes.
        let report = apply_edit(volume, &no_mask, &edit, &mut scratch, &mut ());
        match report {
            Ok(report) if report.changed_volume() => removed += report.removed,
            _ => return removed,
        }
    }
}

/// Returns the volume as binary STL, `height_mm` high.
fn export_stl(volume: &Volume<SIDE>, height_mm: f32) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut exporter = EXPORTER.lock().unwrap();
    exporter.start_export(height_mm).map_err(|_| "a height that no model can have")?;
    let no_mask = RangeMaps::<SIDE>::new();
    let (mut stl, mut buffer) = (Vec::new(), vec![0; 1 << 16]);
    loop {
        // At most 10,000 units of work a call, so that a frame could be drawn between two calls.
        let progress = exporter.advance_export(volume.rows(), &no_mask, 10_000, &mut buffer);
        stl.extend(&buffer[..progress.written]);
        if progress.phase == ExportPhase::Done {
            return Ok(stl);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: carve_ball FILE.stl")?;
    let (mut volume, mut block) = (VOLUME.lock().unwrap(), BLOCK.lock().unwrap());
    block.fill_block();
    volume.set_maps(&block);
    let top = SIDE as i32;
    let removed = carve_ball(&mut volume, IVec3::new(top / 2, top, top / 2), 48);
    let stl = export_stl(&volume, 120.0)?;
    std::fs::write(&file, &stl)?;
    println!("{removed} voxels removed, {} triangles in {file}", (stl.len() - 84) / 50);
    Ok(())
}
