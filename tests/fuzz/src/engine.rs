//! The fuzzing loop: makes an input, runs the target, and keeps the input if it reached something new.
//!
//! As a test it makes a fixed number of runs from a fixed seed. Environment variables:
//! - `PAROS_FUZZ_SECONDS`: runs for this time instead, from a seed that it prints, and keeps its corpus in
//!   `target/tmp/fuzz/NAME/` between runs;
//! - `PAROS_FUZZ_SEED`: the seed;
//! - `PAROS_FUZZ_INPUT`: a file, on which the target is run once.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{Seek, Write};
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use paros_core::internals::checksum;
use paros_models::random_visitor::RandomSource;

use crate::coverage::{self, CoverageMap};
use crate::mutation::mutate;

/// A target to fuzz.
#[derive(Clone, Copy, Debug)]
pub struct FuzzTarget {
    /// Its name, made of letters.
    pub name: &'static str,
    /// Returns the initial inputs.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Dictionary of tokens for building inputs.
    pub words: &'static [&'static [u8]],
    /// Maximum length of an input, in bytes.
    pub longest: usize,
    /// Number of runs as a test.
    pub runs: u64,
    /// Runs an input and returns its outcome; digits in it are ignored. Panics if an invariant is broken.
    pub run: fn(&[u8]) -> String,
}

/// The summary of a fuzzer's work.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FuzzSummary {
    /// Number of runs.
    pub runs: u64,
    /// Number of different outcomes.
    pub outcomes: usize,
    /// Number of inputs kept, seeds included.
    pub kept: usize,
}

/// Makes one test of each target, in their order, and a test that none is left out.
#[macro_export]
macro_rules! fuzz_tests {
    ($targets:expr => $($name:ident)*) => {
        $(#[test]
        fn $name() {
            let target = $targets.iter().find(|target| target.name == stringify!($name));
            let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
            let summary = $crate::engine::fuzz(target.expect("a target"), folder);
            let $crate::engine::FuzzSummary { runs, outcomes, kept } = summary;
            // With equal outcomes for all inputs, the target would test nothing.
            assert!(runs == 1 || outcomes > 1 && kept > 1, "{outcomes} outcomes, {kept} inputs kept");
        })*

        #[test]
        fn every_target_is_a_test() {
            assert_eq!($targets.map(|target| target.name), [$(stringify!($name)),*]);
        }
    };
}

/// Timeout of a run: a longer run is reported as a fault.
const LONGEST_RUN: Duration = Duration::from_secs(20);

struct Fuzzer<'a> {
    target: &'a FuzzTarget,
    /// The folder for failures.
    folder: PathBuf,
    /// A file with the current input, in runs that keep a corpus. It remains after failures that can't be
    /// caught, such as a stack overflow.
    running: Option<File>,
    coverage: CoverageMap,
    outcomes: HashSet<u64>,
    corpus: Vec<Vec<u8>>,
    runs: u64,
}

/// Runs a target as the environment variables specify, with files below `folder`.
///
/// # Panics
/// The target fails. The message names the file with the input.
pub fn fuzz(target: &FuzzTarget, folder: &Path) -> FuzzSummary {
    // The program has only one set of counters.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let setting = |name: &str| std::env::var(format!("PAROS_FUZZ_{name}")).ok();
    if let Some(file) = setting("INPUT") {
        let outcome = (target.run)(&fs::read(&file).expect("PAROS_FUZZ_INPUT is a file"));
        println!("{}: {outcome}", target.name);
        return FuzzSummary { runs: 1, outcomes: 1, kept: 0 };
    }
    let number = |name: &str| setting(name).and_then(|value| value.parse::<u64>().ok());
    let time = number("SECONDS").map(Duration::from_secs);
    let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let seed = number("SEED").unwrap_or(if time.is_some() { clock } else { 1 });
    let folder = folder.join("fuzz").join(target.name);
    fs::create_dir_all(&folder).expect("a folder for what fails");
    let mut fuzzer = Fuzzer::new(target, folder, time.is_some());
    fuzzer.run_seeds();
    let (start, mut dice) = (Instant::now(), RandomSource::new(seed));
    while time.map_or(fuzzer.runs < target.runs, |time| start.elapsed() < time) {
        let input = mutate(&mut dice, &fuzzer.corpus, target.words, target.longest);
        fuzzer.run(input);
    }
    let summary = fuzzer.summary();
    println!(
        "{}: seed {seed}, {} runs in {:.0} s, {} outcomes, {} inputs kept, {} of {} counters reached",
        target.name,
        summary.runs,
        start.elapsed().as_secs_f32(),
        summary.outcomes,
        summary.kept,
        fuzzer.coverage.reached(),
        coverage::counter_count()
    );
    summary
}

impl<'a> Fuzzer<'a> {
    fn new(target: &'a FuzzTarget, folder: PathBuf, keeps_corpus: bool) -> Self {
        let running =
            keeps_corpus.then(|| File::create(folder.join("running")).expect("room for an input"));
        Fuzzer {
            target,
            folder,
            running,
            coverage: CoverageMap::default(),
            outcomes: HashSet::new(),
            corpus: Vec::new(),
            runs: 0,
        }
    }

    /// Runs the target's seeds, which are all kept, and the stored corpus.
    fn run_seeds(&mut self) {
        for seed in (self.target.seeds)() {
            self.corpus.push(seed.clone());
            self.run(seed);
        }
        if self.running.is_some() {
            let kept = fs::read_dir(&self.folder).into_iter().flatten().flatten();
            let kept = kept.filter(|file| file.file_name().to_string_lossy().starts_with("kept-"));
            let inputs: Vec<_> = kept.filter_map(|file| fs::read(file.path()).ok()).collect();
            inputs.into_iter().for_each(|input| self.run(input));
        }
    }

    /// Runs an input, and keeps it if its outcome is new or it reached new code.
    fn run(&mut self, input: Vec<u8>) {
        self.note_running(&input);
        self.runs += 1;
        coverage::reset();
        let start = Instant::now();
        let Some(outcome) = self.run_caught(&input) else { self.report(input, "fails") };
        if start.elapsed() > LONGEST_RUN {
            self.report(input, "takes too long");
        }
        let is_new_outcome = self.outcomes.insert(hash_of_outcome(&outcome));
        if self.coverage.note() | is_new_outcome {
            if self.running.is_some() {
                self.write_input(&format!("kept-{:016x}", checksum(&input)), &input);
            }
            self.corpus.push(input);
        }
    }

    fn note_running(&mut self, input: &[u8]) {
        if let Some(file) = &mut self.running {
            // Writes in place, because some file systems sync files that are truncated and rewritten.
            let written = file.rewind().and_then(|()| file.write_all(input));
            written.and_then(|()| file.set_len(input.len() as u64)).expect("room for an input");
        }
    }

    /// Returns the target's outcome; `None` if it panics.
    fn run_caught(&self, input: &[u8]) -> Option<String> {
        panic::catch_unwind(AssertUnwindSafe(|| (self.target.run)(input))).ok()
    }

    fn report(&self, input: Vec<u8>, what: &str) -> ! {
        let input = if what == "fails" { self.shrink(input) } else { input };
        let path = self.write_input(&format!("failure-{:016x}", checksum(&input)), &input);
        panic!(
            "{} {what} on {} bytes; again with PAROS_FUZZ_INPUT={}",
            self.target.name,
            input.len(),
            path.display()
        );
    }

    /// Removes shorter and shorter stretches as long as the target still fails.
    fn shrink(&self, mut input: Vec<u8>) -> Vec<u8> {
        let mut length = input.len() / 2;
        while length > 0 {
            let mut start = 0;
            while start + length <= input.len() {
                let shorter = [&input[..start], &input[start + length..]].concat();
                if self.run_caught(&shorter).is_none() {
                    input = shorter;
                } else {
                    start += length;
                }
            }
            length /= 2;
        }
        input
    }

    fn write_input(&self, name: &str, input: &[u8]) -> PathBuf {
        let path = self.folder.join(name);
        fs::write(&path, input).expect("room for an input");
        path
    }

    fn summary(&self) -> FuzzSummary {
        let (outcomes, kept) = (self.outcomes.len(), self.corpus.len());
        FuzzSummary { runs: self.runs, outcomes, kept }
    }
}

/// Returns the hash of an outcome without its digits and quoted parts.
fn hash_of_outcome(outcome: &str) -> u64 {
    let unquoted = outcome.split(['`', '"', '\'']).step_by(2);
    let text: String = unquoted.flat_map(str::chars).filter(|c| c.is_alphabetic()).collect();
    checksum(text.as_bytes())
}
