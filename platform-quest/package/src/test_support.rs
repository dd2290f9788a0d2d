//! Support for the packager's tests: scratch folders, and libraries that are linked like the package's.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

use object::write::{Object, Relocation, SymbolSection};
use object::{
    Architecture, BinaryFormat, Endianness, RelocationEncoding, RelocationFlags, RelocationKind,
    SectionKind,
};

use crate::library;
use crate::stubs::{dynamic_symbol, object_defining, write_stub_libraries};
use crate::symbols::Symbols;
use crate::tools::{Scratch, Toolchain};

/// The symbols that a library defines, and the ones that it imports.
#[derive(Clone, Copy)]
pub(crate) struct LibraryNames<'a> {
    pub(crate) defined: &'a [&'a str],
    pub(crate) needed: &'a [&'a str],
}

/// Links a library in the same way as the package's library. Returns its path, or the linker's error; `None`
/// if the toolchain is missing.
pub(crate) fn link_library_if_toolchain(
    symbols: &Symbols,
    api_level: u32,
    names: LibraryNames<'_>,
    scratch: &Scratch,
) -> Option<Result<PathBuf, String>> {
    let linker =
        paros_shell::require::require_or_skip(Toolchain::find()).expect("rustup target")?.linker;
    let stubs = scratch.at("stubs");
    write_stub_libraries(symbols, api_level, &linker, &stubs).expect("stubs");
    let [ours, theirs, library] = ["ours.o", "theirs.o", "library.so"].map(|name| scratch.at(name));
    let defines = object_defining(names.defined.iter().copied()).expect("an object");
    fs::write(&ours, defines).expect("room on the disk");
    fs::write(&theirs, object_needing(names.needed)).expect("room on the disk");
    let mut link = Command::new(&linker);
    link.args(["-flavor", "gnu", "-shared", "-o"]).args([&library, &ours, &theirs]);
    link.arg("-L").arg(&stubs).args(library::LINK_ARGUMENTS);
    link.args(symbols.libraries().iter().map(|name| format!("-l{}", &name[3..])));
    let output = link.output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Some(if output.status.success() { Ok(library) } else { Err(said) })
}

/// Writes an object file whose data are the addresses of undefined symbols with these names.
fn object_needing(names: &[&str]) -> Vec<u8> {
    let mut object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
    let data = object.add_section(Vec::new(), b".data".to_vec(), SectionKind::Data);
    for name in names {
        let symbol = object.add_symbol(dynamic_symbol(name, SymbolSection::Undefined));
        let offset = object.append_section_data(data, &[0; 8], 8);
        let (kind, encoding) = (RelocationKind::Absolute, RelocationEncoding::Generic);
        let flags = RelocationFlags::Generic { kind, encoding, size: 64 };
        let relocation = Relocation { offset, symbol, addend: 0, flags };
        object.add_relocation(data, relocation).expect("a kind that arm64 has");
    }
    object.write().expect("an object")
}

/// Creates an empty folder for a test.
pub(crate) fn scratch_folder(name: &str) -> Scratch {
    Scratch::within(&env::temp_dir(), &format!("paros-{name}")).expect("room on the disk")
}
