mod elf;
mod error;
mod library;
mod stubs;
mod symbols;
mod tools;
fn main() -> std::process::ExitCode {
    let symbols = symbols::Symbols::all();
    match library::build(&symbols, 29) {
        Ok(path) => { println!("{} {:?}", path.display(), elf::faults(&std::fs::read(&path).unwrap(), &symbols, 29)); std::process::ExitCode::SUCCESS }
        Err(e) => { eprintln!("{e}"); e.exit_code() }
    }
}
