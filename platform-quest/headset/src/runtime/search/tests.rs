//! The order of calls and the reported failures, for scripted libraries.

use std::path::PathBuf;

use super::{Candidate, RuntimeCalls, RuntimeLibrary, RuntimeSearch};

/// Libraries whose behaviour follows from their names; each call is logged. `twin.so` is `deaf.so` by another
/// name.
#[derive(Default)]
struct ScriptedLibraries {
    calls: Vec<String>,
}

impl ScriptedLibraries {
    fn log(&mut self, call: &str, library: &str) {
        self.calls.push(format!("{call} {library}"));
    }
}

impl RuntimeCalls for ScriptedLibraries {
    type Library = &'static str;
    type Functions = &'static str;
    type Entry = &'static str;
    type Error = &'static str;

    fn open(&mut self, library: &RuntimeLibrary) -> Result<&'static str, &'static str> {
        self.log("open", &library.path.display().to_string());
        let known = [
            ("plain.so", "plain.so"),
            ("exporter.so", "exporter.so"),
            ("deaf.so", "deaf.so"),
            ("twin.so", "deaf.so"),
        ];
        let known = known.iter().find(|(name, _)| library.path == PathBuf::from(name));
        known.map(|(_, library)| *library).ok_or("not there")
    }

    fn initialize_by_export(&mut self, library: &&'static str) -> Result<bool, &'static str> {
        self.log("export", library);
        match *library {
            "deaf.so" => Err("initialisation failed"),
            library => Ok(library == "exporter.so"),
        }
    }

    fn negotiate(&mut self, library: &&'static str) -> Result<&'static str, &'static str> {
        self.log("negotiate", library);
        Ok(library)
    }

    fn initialize_by_functions(&mut self, functions: &'static str) -> Result<(), &'static str> {
        self.log("function", functions);
        Ok(())
    }

    fn make_entry(&mut self, functions: &'static str) -> Result<&'static str, &'static str> {
        Ok(functions)
    }
}

fn candidates(names: &'static [&str]) -> impl Iterator<Item = Candidate> {
    names.iter().map(|name| Candidate {
        source: "a broker".into(),
        library: Ok(RuntimeLibrary::runtime(name.into())),
    })
}

#[test]
fn an_exported_initialisation_is_the_only_one() {
    let mut script = ScriptedLibraries::default();
    let found = RuntimeSearch::new().find_once(&mut script, candidates(&["exporter.so"]));
    assert_eq!(found.expect("a runtime").entry, "exporter.so");
    assert_eq!(script.calls, ["open exporter.so", "export exporter.so", "negotiate exporter.so"]);
    script.calls.clear();
    let found = RuntimeSearch::new().find_once(&mut script, candidates(&["plain.so"]));
    assert_eq!(found.expect("a runtime").entry, "plain.so");
    assert_eq!(script.calls[2..], ["negotiate plain.so", "function plain.so"]);
}

#[test]
fn what_was_found_once_serves_every_session() {
    let (mut script, mut search) = (ScriptedLibraries::default(), RuntimeSearch::new());
    let first = search.find_once(&mut script, candidates(&["gone.so", "plain.so", "exporter.so"]));
    let first = first.expect("a runtime");
    assert_eq!(first.entry, "plain.so");
    let told = "tried gone.so, named by a broker: not there";
    assert_eq!(first.tried[0].to_string(), told);
    assert!(!script.calls.contains(&"open exporter.so".into()));
    script.calls.clear();
    let nobody = std::iter::from_fn(|| -> Option<Candidate> { panic!("nobody is asked again") });
    let later = search.find_once(&mut script, nobody).expect("a runtime");
    assert_eq!((later.entry, later.tried.len()), ("plain.so", 0));
    assert_eq!(script.calls, [""; 0]);
}

#[test]
fn a_library_that_failed_is_not_called_again() {
    let (mut script, mut search) = (ScriptedLibraries::default(), RuntimeSearch::new());
    for _ in 0..2 {
        let why = search.find_once(&mut script, candidates(&["deaf.so", "twin.so"]));
        let why = why.expect_err("none succeeds").to_string();
        let failed = "named by a broker: initialisation failed";
        assert_eq!(
            why,
            format!("no OpenXR runtime; tried deaf.so, {failed}; tried twin.so, {failed}")
        );
    }
    let exports = script.calls.iter().filter(|call| call.starts_with("export")).count();
    assert_eq!(exports, 1);
}

#[test]
fn a_source_that_names_nothing_is_told_too() {
    let nothing = Candidate { source: "a broker".into(), library: Err("no answer".into()) };
    let why = RuntimeSearch::new().find_once(&mut ScriptedLibraries::default(), [nothing]);
    let why = why.expect_err("there is none").to_string();
    assert_eq!(why, "no OpenXR runtime; tried a broker: no answer");
}
