//! Stub libraries: Android's symbols without code, to link against if there is no NDK.

use std::fs;
use std::path::Path;
use std::process::Command;

use object::write::{Object, Symbol, SymbolSection};
use object::{
    Architecture, BinaryFormat, Endianness, SectionKind, SymbolFlags, SymbolKind, SymbolScope,
};

use crate::error::PackageError;
use crate::symbols::Symbols;
use crate::tools;

/// Writes the stub libraries of an API level into a folder, and the empty `libunwind.a` that `std` links to.
///
/// # Errors
/// A file can't be written, or the linker fails.
pub(crate) fn write_stub_libraries(
    symbols: &Symbols,
    api_level: u32,
    linker: &Path,
    folder: &Path,
) -> Result<(), PackageError> {
    let fail = |e| PackageError::Failure(format!("{}: {e}", folder.display()));
    fs::create_dir_all(folder).map_err(fail)?;
    for library in symbols.libraries() {
        let object = folder.join(format!("{library}.o"));
        let bytes = object_defining(symbols.exported_by(library, api_level))?;
        fs::write(&object, bytes).map_err(fail)?;
        let shared = folder.join(format!("{library}.so"));
        let soname = format!("-soname={library}.so");
        let mut link = Command::new(linker);
        link.args(["-flavor", "gnu", "-shared", &soname, "-o"]).args([&shared, &object]);
        tools::run_tool(&format!("stub of {library}"), &mut link)?;
    }
    fs::write(folder.join("libunwind.a"), "!<arch>\n").map_err(fail)
}

/// Writes an object file that defines only these symbols.
pub(crate) fn object_defining<'a>(
    names: impl Iterator<Item = &'a str>,
) -> Result<Vec<u8>, PackageError> {
    let mut object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
    let text = object.add_section(Vec::new(), b".text".to_vec(), SectionKind::Text);
    object.append_section_data(text, &[0; 4], 4);
    for name in names {
        object.add_symbol(dynamic_symbol(name, SymbolSection::Section(text)));
    }
    object.write().map_err(PackageError::failure)
}

pub(crate) fn dynamic_symbol(name: &str, section: SymbolSection) -> Symbol {
    Symbol {
        name: name.into(),
        value: 0,
        size: 0,
        kind: SymbolKind::Text,
        scope: SymbolScope::Dynamic,
        weak: false,
        section,
        flags: SymbolFlags::None,
    }
}

#[cfg(test)]
mod tests {
    use crate::symbols::Symbols;
    use crate::test_support::{LibraryNames, link_library_if_toolchain, scratch_folder};

    #[test]
    fn a_name_less_fails_the_link() {
        let folder = scratch_folder("stubs");
        let names = LibraryNames {
            defined: &["ANativeActivity_onCreate"],
            needed: &["getrandom", "dlopen"],
        };
        let Some(whole) = link_library_if_toolchain(&Symbols::load_all(), 29, names, &folder)
        else {
            return;
        };
        whole.expect("all names are listed");
        let less = Symbols::load_all().without("dlopen");
        let why = link_library_if_toolchain(&less, 29, names, &folder)
            .expect("as before")
            .expect_err("one is missing");
        assert!(why.contains("undefined symbol: dlopen") && !why.contains("getrandom"), "{why}");
        // The symbol doesn't exist at that level yet.
        let why =
            link_library_if_toolchain(&Symbols::load_all(), 27, names, &folder).expect("as before");
        assert!(why.expect_err("it came with 28").contains("undefined symbol: getrandom"));
    }
}
