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
        let bytes = object_of(symbols.of(library, level), Side::Defines)?;
        fs::write(&object, bytes).map_err(fail)?;
        let shared = folder.join(format!("{library}.so"));
        let soname = format!("-soname={library}.so");
        let mut link = Command::new(linker);
        link.args(["-flavor", "gnu", "-shared", &soname, "-o"]).args([&shared, &object]);
        tools::run(&format!("stub of {library}"), &mut link)?;
    }
    fs::write(folder.join("libunwind.a"), "!<arch>\n").map_err(fail)
}

/// Whether an object has its names or wants them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Side {
    Defines,
    #[cfg(test)]
    Wants,
}

/// An object file of names alone.
fn object_of<'a>(names: impl Iterator<Item = &'a str>, side: Side) -> Result<Vec<u8>, Error> {
    let mut object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
    let text = object.add_section(Vec::new(), b".text".to_vec(), SectionKind::Text);
    object.append_section_data(text, &[0; 4], 4);
    let section = match side {
        Side::Defines => SymbolSection::Section(text),
        #[cfg(test)]
        Side::Wants => SymbolSection::Undefined,
    };
    for name in names {
        object.add_symbol(Symbol {
            name: name.into(),
            value: 0,
            size: 0,
            kind: SymbolKind::Text,
            scope: SymbolScope::Dynamic,
            weak: false,
            section,
            flags: SymbolFlags::None,
        });
    }
    object.write().map_err(Error::failure)
}

#[cfg(test)]
pub(crate) mod tests {
    use std::path::PathBuf;
    use std::process::Command;
    use std::{env, fs};

    use super::{Side, object_of, write};
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
        let linker = paros_shell::require::require(Toolchain::find()).expect("rustup target")?.linker;
        let stubs = folder.at("stubs");
        write(symbols, level, &linker, &stubs).expect("stubs");
        let [ours, theirs, library] = ["ours.o", "theirs.o", "library.so"].map(|name| folder.at(name));
        let of = |names: &[&str], side| object_of(names.iter().copied(), side).expect("an object");
        fs::write(&ours, of(defines, Side::Defines)).expect("room on the disk");
        fs::write(&theirs, of(wants, Side::Wants)).expect("room on the disk");
        let mut link = Command::new(&linker);
        link.args(["-flavor", "gnu", "-shared", "-o"]).args([&library, &ours, &theirs]);
        link.arg("-L").arg(&stubs).args(library::LINK_ARGUMENTS);
        link.args(symbols.libraries().iter().map(|name| format!("-l{}", &name[3..])));
        let output = link.output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        Some(if output.status.success() { Ok(library) } else { Err(said) })
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
        let why = linked(&less, 29, names, &folder).expect("as before").expect_err("one is missing");
        assert!(why.contains("undefined symbol: dlopen") && !why.contains("getrandom"), "{why}");
        // Not there yet at that level.
        let why = linked(&Symbols::all(), 27, names, &folder).expect("as before");
        assert!(why.expect_err("it came with 28").contains("undefined symbol: getrandom"));
    }
}
