//! The package's file: manifest, libraries and start volumes.

use std::fs::{self, File};
use std::io::{Cursor, Read, Write};
use std::path::Path;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::headset::package::{FIGURES_FOLDER, OPENXR_LOADER, start_volume_asset};
use paros_shell::rmap;
use paros_shell::start_volume_store::StartVolume;
use paros_shell::statics::Resident;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::elf::PAGE;
use crate::error::PackageError;

/// The maximum size of a package without a given loader and figures: a visitor's headset downloads it over a
/// museum's network.
pub(crate) const MAX_BYTES: u64 = 8 << 20;

/// The folder of the libraries for arm64.
const LIBRARIES: &str = "lib/arm64-v8a";

/// Adds everything else to a compiled manifest, and writes the unsigned package.
///
/// Entries have no dates, so the same input makes the same bytes. The libraries are stored uncompressed and
/// aligned to pages, so that Android can map them from the package.
///
/// # Errors
/// A file can't be read or written.
pub(crate) fn write_package(
    compiled_manifest: &Path,
    libraries: &[(&str, Vec<u8>)],
    own_assets: &[(String, Vec<u8>)],
    output: &Path,
) -> Result<(), PackageError> {
    let mut package = ZipWriter::new(Cursor::new(Vec::new()));
    let packed = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let plain = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    let compiled = File::open(compiled_manifest).map_err(PackageError::failure)?;
    let mut compiled = ZipArchive::new(compiled).map_err(PackageError::failure)?;
    for i in 0..compiled.len() {
        let mut entry = compiled.by_index(i).map_err(PackageError::failure)?;
        let stored = entry.compression() == CompressionMethod::Stored;
        let options = if stored { plain.with_android_alignment(4) } else { packed };
        let name = entry.name().map_err(PackageError::failure)?.into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(PackageError::failure)?;
        add_entry(&mut package, &name, options, &bytes)?;
    }
    for (name, bytes) in libraries {
        let name = format!("{LIBRARIES}/{name}");
        add_entry(&mut package, &name, plain.with_android_alignment(PAGE as u16), bytes)?;
    }
    for (name, bytes) in
        encode_start_volumes::<128>().into_iter().chain(encode_start_volumes::<256>())
    {
        add_entry(&mut package, &format!("assets/{name}"), packed, &bytes)?;
    }
    for (name, bytes) in own_assets {
        add_entry(&mut package, &format!("assets/{name}"), packed, bytes)?;
    }
    let bytes = package.finish().map_err(PackageError::failure)?.into_inner();
    fs::write(output, bytes)
        .map_err(|e| PackageError::Failure(format!("{}: {e}", output.display())))
}

/// A package's entries.
#[derive(Debug)]
pub(crate) struct PackageInspection {
    /// The faults that keep entries from being mapped or installed.
    pub(crate) faults: Vec<String>,
    /// A line for each entry: compressed bytes, bytes, name.
    pub(crate) listing: String,
}

/// Lists a package's entries, and the faults that keep them from being mapped or installed.
///
/// # Errors
/// The package can't be read.
pub(crate) fn inspect_package(package: &Path) -> Result<PackageInspection, PackageError> {
    let (mut faults, mut listing) = (Vec::new(), String::new());
    let file = File::open(package).map_err(PackageError::failure)?;
    let whole = file.metadata().map_err(PackageError::failure)?.len();
    let (loader, figures) =
        (format!("{LIBRARIES}/{OPENXR_LOADER}"), format!("assets/{FIGURES_FOLDER}"));
    let mut given_bytes = 0;
    let mut package = ZipArchive::new(file).map_err(PackageError::failure)?;
    for i in 0..package.len() {
        let entry = package.by_index(i).map_err(PackageError::failure)?;
        let name = entry.name().map_err(PackageError::failure)?;
        let at = entry.data_start().unwrap_or(u64::MAX);
        if name.starts_with(LIBRARIES)
            && (entry.compression() != CompressionMethod::Stored || at % PAGE != 0)
        {
            faults.push(format!("{name} lies at byte {at}, or packed; it can't be mapped"));
        }
        if *name == loader || name.starts_with(&figures) {
            given_bytes += entry.compressed_size();
        }
        listing += &format!("{:>9} {:>9}  {name}\n", entry.compressed_size(), entry.size());
    }
    let own = whole.saturating_sub(given_bytes);
    if own > MAX_BYTES {
        faults.push(format!(
            "the package takes {own} bytes without a loader and figures, more than {MAX_BYTES}"
        ));
    }
    listing += &format!("{whole:>9}            in all");
    Ok(PackageInspection { faults, listing })
}

fn add_entry(
    package: &mut ZipWriter<Cursor<Vec<u8>>>,
    name: &str,
    options: SimpleFileOptions,
    bytes: &[u8],
) -> Result<(), PackageError> {
    package.start_file(name, options).map_err(PackageError::failure)?;
    package.write_all(bytes).map_err(PackageError::failure)
}

/// Encodes the start volumes of a size, with the asset names that the shell uses.
fn encode_start_volumes<const N: usize>() -> Vec<(String, Vec<u8>)>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    eprintln!("start volumes of {N}");
    let mut resident = Grid::<N>::lock_world();
    resident.generate_starts();
    let named = |volume| {
        (start_volume_asset::<N>(volume), rmap::encode(resident.start_volumes.volume(volume)))
    };
    StartVolume::all().map(named).collect()
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::{MAX_BYTES, PAGE, inspect_package};
    use crate::test_support::scratch_folder;

    #[test]
    fn a_library_that_cannot_be_mapped_is_told() {
        let folder = scratch_folder("apk");
        let path = folder.at("try.apk");
        let faults = |options: SimpleFileOptions, name: &str| {
            let mut package = ZipWriter::new(File::create(&path).expect("room on the disk"));
            package.start_file(name, options).expect("an entry");
            package.finish().expect("room on the disk");
            inspect_package(&path).expect("a package").faults
        };
        let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        let packed = stored.compression_method(CompressionMethod::Deflated);
        let aligned = stored.with_android_alignment(PAGE as u16);
        assert_eq!(faults(aligned, "lib/arm64-v8a/libx.so"), [""; 0]);
        assert_eq!(faults(stored.with_android_alignment(4096), "lib/arm64-v8a/libx.so").len(), 1);
        assert_eq!(
            faults(packed.with_android_alignment(PAGE as u16), "lib/arm64-v8a/libx.so").len(),
            1
        );
        assert_eq!(faults(stored, "assets/libx.so"), [""; 0]);
    }
    #[test]
    fn a_loader_and_figures_do_not_count_among_what_a_package_may_take() {
        let folder = scratch_folder("size");
        let path = folder.at("try.apk");
        let faults = |name: &str| {
            let mut package = ZipWriter::new(File::create(&path).expect("room on the disk"));
            let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
            let aligned = stored.with_android_alignment(PAGE as u16);
            package.start_file(name, aligned).expect("an entry");
            package.write_all(&vec![0; MAX_BYTES as usize]).expect("room on the disk");
            package.finish().expect("room on the disk");
            inspect_package(&path).expect("a package").faults
        };
        assert_eq!(faults("lib/arm64-v8a/libopenxr_loader.so"), [""; 0]);
        assert_eq!(faults("assets/figures/256/lion.rmap"), [""; 0]);
        let told = faults("lib/arm64-v8a/libparos_quest.so").concat();
        assert!(told.contains("bytes without a loader and figures, more than 8388608"), "{told}");
    }
}
