//! Libraries that hold Android's names and no code, to link against where there is no NDK.

use std::fs;
use std::path::Path;
use std::process::Command;

use object::write::{Object, Symbol, SymbolSection};
use object::{
    Architecture, BinaryFormat, Endianness, SectionKind, SymbolFlags, SymbolKind, SymbolScope,
};

use crate::error::Error;
use crate::symbols::Symbols;
use crate::tools;

/// Makes the stubs of every library at an API level in a folder, and the empty `libunwind.a` that
/// `std` names.
///
/// # Errors
/// The disk refuses, or the linker.
pub(crate) fn write(
    symbols: &Symbols,
    level: u32,
    linker: &Path,
    folder: &Path,
) -> Result<(), Error> {
    let fail = |e| Error::Failure(format!("{}: {e}", folder.display()));
    fs::create_dir_all(folder).map_err(fail)?;
    for library in symbols.libraries() {
        let object = folder.join(format!("{library}.o"));
        let bytes = object_of(symbols.of(library, level))?;
        fs::write(&object, bytes).map_err(fail)?;
        let shared = folder.join(format!("{library}.so"));
        let soname = format!("-soname={library}.so");
        let mut link = Command::new(linker);
        link.args(["-flavor", "gnu", "-shared", &soname, "-o"]).args([&shared, &object]);
        tools::run(&format!("stub of {library}"), &mut link)?;
    }
    fs::write(folder.join("libunwind.a"), "!<arch>\n").map_err(fail)
}

/// An object file that has names alone.
fn object_of<'a>(names: impl Iterator<Item = &'a str>) -> Result<Vec<u8>, Error> {
    let mut object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
    let text = object.add_section(Vec::new(), b".text".to_vec(), SectionKind::Text);
    object.append_section_data(text, &[0; 4], 4);
    for name in names {
        object.add_symbol(symbol(name, SymbolSection::Section(text)));
    }
    object.write().map_err(Error::failure)
}

fn symbol(name: &str, section: SymbolSection) -> Symbol {
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
pub(crate) mod tests {
    use std::path::PathBuf;
    use std::process::Command;
    use std::{env, fs};

    use object::write::{Object, Relocation, SymbolSection};
    use object::{
        Architecture, BinaryFormat, Endianness, RelocationEncoding, RelocationFlags,
        RelocationKind, SectionKind,
    };

    use super::{object_of, symbol, write};
    use crate::library;
    use crate::symbols::Symbols;
    use crate::tools::{Scratch, Toolchain};

    /// Links a library that has some names and wants others, as the package's is linked.
    pub(crate) fn linked(
        symbols: &Symbols,
        level: u32,
        [defines, wants]: [&[&str]; 2],
        folder: &Scratch,
    ) -> Option<Result<PathBuf, String>> {
        let linker =
            paros_shell::require::require(Toolchain::find()).expect("rustup target")?.linker;
        let stubs = folder.at("stubs");
        write(symbols, level, &linker, &stubs).expect("stubs");
        let [ours, theirs, library] =
            ["ours.o", "theirs.o", "library.so"].map(|name| folder.at(name));
        let defines = object_of(defines.iter().copied()).expect("an object");
        fs::write(&ours, defines).expect("room on the disk");
        fs::write(&theirs, wanting(wants)).expect("room on the disk");
        let mut link = Command::new(&linker);
        link.args(["-flavor", "gnu", "-shared", "-o"]).args([&library, &ours, &theirs]);
        link.arg("-L").arg(&stubs).args(library::LINK_ARGUMENTS);
        link.args(symbols.libraries().iter().map(|name| format!("-l{}", &name[3..])));
        let output = link.output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        Some(if output.status.success() { Ok(library) } else { Err(said) })
    }

    /// An object file whose data are the addresses of names that it hasn't.
    fn wanting(names: &[&str]) -> Vec<u8> {
        let mut object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
        let data = object.add_section(Vec::new(), b".data".to_vec(), SectionKind::Data);
        for name in names {
            let symbol = object.add_symbol(symbol(name, SymbolSection::Undefined));
            let offset = object.append_section_data(data, &[0; 8], 8);
            let (kind, encoding) = (RelocationKind::Absolute, RelocationEncoding::Generic);
            let flags = RelocationFlags::Generic { kind, encoding, size: 64 };
            let relocation = Relocation { offset, symbol, addend: 0, flags };
            object.add_relocation(data, relocation).expect("a kind that arm64 has");
        }
        object.write().expect("an object")
    }

    pub(crate) fn scratch(name: &str) -> Scratch {
        Scratch::within(&env::temp_dir(), &format!("paros-{name}")).expect("room on the disk")
    }

    #[test]
    fn a_name_less_fails_the_link() {
        let folder = scratch("stubs");
        let names: [&[&str]; 2] = [&["ANativeActivity_onCreate"], &["getrandom", "dlopen"]];
        let Some(whole) = linked(&Symbols::all(), 29, names, &folder) else { return };
        whole.expect("all names are listed");
        let less = Symbols::all().without("dlopen");
        let why =
            linked(&less, 29, names, &folder).expect("as before").expect_err("one is missing");
        assert!(why.contains("undefined symbol: dlopen") && !why.contains("getrandom"), "{why}");
        // Not there yet at that level.
        let why = linked(&Symbols::all(), 27, names, &folder).expect("as before");
        assert!(why.expect_err("it came with 28").contains("undefined symbol: getrandom"));
    }
}
