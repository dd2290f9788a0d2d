//! Seeds of the fuzz targets, and their helpers.

use std::fs;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::DeflateEncoder;
use paros_core::codec::trace::CORE_VERSION;
use paros_core::session::SessionMode;
use paros_protocol::*;
use paros_shell::rmap;
use paros_shell::statics::Resident;

/// Lists all files below a folder.
pub(crate) fn list(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        match entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            true => found.extend(list(&entry.path())),
            false => found.push(entry.path()),
        }
    }
    found
}

/// Makes a ZIP archive of files.
pub(crate) fn archive(files: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        let options = zip::write::SimpleFileOptions::default();
        zip.start_file(*name, options).expect("memory");
        zip.write_all(text.as_bytes()).expect("memory");
    }
    zip.finish().expect("memory").into_inner()
}

/// Compresses bytes as parcels do.
pub(crate) fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut packed = DeflateEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(bytes).expect("memory");
    packed.finish().expect("memory")
}

/// Makes a closed mesh of four triangles.
pub(crate) fn tetrahedron() -> Vec<u8> {
    let corners = [[0.0f32, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
    let mut stl = vec![0; 80];
    stl.extend(4u32.to_le_bytes());
    for triangle in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        stl.extend([0; 12]);
        for place in triangle.iter().flat_map(|&corner: &usize| corners[corner]) {
            stl.extend(place.to_le_bytes());
        }
        stl.extend([0; 2]);
    }
    stl
}

/// Makes a parcel's head, with an uncompressed volume.
pub(crate) fn upload_seed() -> Vec<u8> {
    let first =
        rmap::encode(&<paros_core::volume::Grid<128> as Resident<128, 2>>::lock_range_maps());
    let facts = UploadFacts {
        id: SculptureId([1; 16]),
        badge: None,
        badge_serial: None,
        core_version: CORE_VERSION,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"el",
        mode: SessionMode::FreeForm,
        age_group: AgeGroup::OfAge,
        sculpting_seconds: 540,
        finished_at: 1_790_000_000,
        height_mm_tenths: 1200,
        volume_bytes: 20,
        volume_raw_bytes: first.len() as u32,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    [&facts.to_head()[..], &first].concat()
}
