//! Checks that Android can load a library: its dependencies, entry point and layout.

use object::elf::DT_NEEDED;
use object::read::elf::ElfFile64;
use object::{Architecture, Object, ObjectKind, ObjectSegment, ObjectSymbol};

use crate::symbols::Symbols;

/// The page size for which segments are aligned; devices with pages of 4 KiB load them as well.
pub(crate) const PAGE: u64 = 16 << 10;

/// The entry point that the activity calls first.
pub(crate) const ENTRY: &str = "ANativeActivity_onCreate";

/// Finds all faults that keep the shell's library from being loaded and started by Android at an API level.
pub(crate) fn find_library_faults(bytes: &[u8], symbols: &Symbols, api_level: u32) -> Vec<String> {
    let file = match parse_library(bytes) {
        Ok(file) => file,
        Err(fault) => return vec![fault],
    };
    let mut faults = find_unavailable_dependencies(&file, symbols, api_level);
    let is_entry = |name| name == Ok(ENTRY);
    if !file.dynamic_symbols().any(|symbol| symbol.is_definition() && is_entry(symbol.name())) {
        faults.push(format!("it does not have {ENTRY}"));
    }
    faults.extend(find_misalignment(&file));
    faults
}

/// Finds a fault that keeps any other library from being loaded on a device with pages of 16 KiB.
pub(crate) fn find_layout_fault(bytes: &[u8]) -> Option<String> {
    parse_library(bytes).map_or_else(Some, |file| find_misalignment(&file))
}

/// Parses a library for arm64. An error is the reason why the bytes are not one.
fn parse_library(bytes: &[u8]) -> Result<ElfFile64<'_>, String> {
    match ElfFile64::parse(bytes) {
        Ok(file) if file.architecture() != Architecture::Aarch64 => {
            Err("it is not for arm64".into())
        }
        Ok(file) if file.kind() != ObjectKind::Dynamic => {
            Err("it is no library, but an object file or a program".into())
        }
        Ok(file) => Ok(file),
        Err(error) => Err(format!("it is no library: {error}")),
    }
}

/// Returns the dependencies that Android does not provide. A weak symbol may be missing.
fn find_unavailable_dependencies(
    file: &ElfFile64<'_>,
    symbols: &Symbols,
    api_level: u32,
) -> Vec<String> {
    let undefined =
        file.dynamic_symbols().filter(|symbol| symbol.is_undefined() && !symbol.is_weak());
    let names = undefined.filter_map(|symbol| symbol.name().ok()).filter(|name| !name.is_empty());
    let mut faults: Vec<_> = names
        .filter_map(|name| match symbols.find_origin(name) {
            None => Some(format!("it wants {name}, which Android does not offer")),
            Some(origin) if origin.since > api_level => {
                Some(format!("it wants {name}, which comes with API level {} only", origin.since))
            }
            Some(_) => None,
        })
        .collect();
    let table = match file.elf_dynamic_table() {
        Ok(table) => table,
        Err(error) => return vec![format!("it can't be linked at run time: {error}")],
    };
    for needed in table.iter().filter(|entry| entry.tag == DT_NEEDED) {
        let name = table.string(needed).map(String::from_utf8_lossy).unwrap_or_default();
        if !symbols.libraries().iter().any(|library| name == format!("{library}.so")) {
            faults.push(format!("it needs the library {name}"));
        }
    }
    faults
}

fn find_misalignment(file: &ElfFile64<'_>) -> Option<String> {
    let least = file.segments().map(|segment| segment.align()).min().unwrap_or(0);
    (least < PAGE || least % PAGE != 0)
        .then(|| format!("a segment is aligned to {least} bytes, not {PAGE}"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{ENTRY, find_library_faults};
    use crate::symbols::Symbols;
    use crate::test_support::{LibraryNames, link_library_if_toolchain, scratch_folder};

    #[test]
    fn what_android_would_not_load_is_found() {
        let (symbols, folder) = (Symbols::load_all(), scratch_folder("elf"));
        // Linked against the symbols of a later Android.
        let needed: &[&str] = &["AInputEvent_release", "dlopen", "getrandom"];
        let names = LibraryNames { defined: &[ENTRY], needed };
        let Some(library) = link_library_if_toolchain(&symbols, 31, names, &folder) else { return };
        let bytes = fs::read(library.expect("all are listed")).expect("it was linked");
        assert_eq!(find_library_faults(&bytes, &symbols, 31), [""; 0]);
        let early = "it wants AInputEvent_release, which comes with API level 31 only";
        assert_eq!(find_library_faults(&bytes, &symbols, 29), [early]);
        let unknown = "it wants dlopen, which Android does not offer";
        assert_eq!(find_library_faults(&bytes, &symbols.clone().without("dlopen"), 31), [unknown]);

        let names = LibraryNames { defined: &["main"], needed: &[] };
        let headless = link_library_if_toolchain(&symbols, 29, names, &folder).expect("as before");
        let bytes = fs::read(headless.expect("nothing is wanted")).expect("it was linked");
        assert_eq!(
            find_library_faults(&bytes, &symbols, 29),
            [format!("it does not have {ENTRY}")]
        );
    }

    #[test]
    fn what_is_no_library_for_arm64_is_told() {
        let here = fs::read(std::env::current_exe().expect("this test")).expect("readable");
        let expected =
            if cfg!(target_arch = "aarch64") { "it does not" } else { "it is not for arm64" };
        assert!(find_library_faults(&here, &Symbols::load_all(), 29)[0].starts_with(expected));
        assert!(
            find_library_faults(b"no ELF", &Symbols::load_all(), 29)[0]
                .starts_with("it is no library")
        );
    }
}
