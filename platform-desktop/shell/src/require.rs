//! Optional dependencies of tests: a reference library, a device, a tool.
//!
//! A test that lacks a dependency is skipped with a message, or fails if the environment variable
//! `PAROS_REQUIRE` is `all`. `PAROS_SKIPPED` names a file that lists the skipped tests, so that they can be
//! run again once the dependency is there.

use std::env;
use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;
use std::thread;

/// A required dependency is missing, or a skipped test could not be listed. Holds the reason.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{0}")]
pub struct MissingDependency(pub String);

/// Returns the dependency, or `None` after a message `skipped: REASON` on standard error.
///
/// # Errors
/// Returns an error if the dependency is missing and `PAROS_REQUIRE` is `all`, or if it is missing and the
/// file that `PAROS_SKIPPED` names can't be written.
pub fn require_or_skip<T, E: Display>(
    dependency: Result<T, E>,
) -> Result<Option<T>, MissingDependency> {
    let all = env::var_os("PAROS_REQUIRE").is_some_and(|parts| parts == "all");
    let if_missing = if all { IfMissing::Fail } else { IfMissing::Skip };
    require_or_skip_by(if_missing, dependency)
}

/// The reaction to a missing dependency.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum IfMissing {
    Fail,
    Skip,
}

fn require_or_skip_by<T, E: Display>(
    if_missing: IfMissing,
    dependency: Result<T, E>,
) -> Result<Option<T>, MissingDependency> {
    match dependency {
        Ok(found) => Ok(Some(found)),
        Err(why) => {
            // Standard error may be closed.
            let _ = writeln!(io::stderr(), "skipped: {why}");
            match if_missing {
                IfMissing::Fail => {
                    Err(MissingDependency(format!("{why}, and PAROS_REQUIRE is all")))
                }
                IfMissing::Skip => {
                    let list = env::var_os("PAROS_SKIPPED");
                    list.map_or(Ok(()), |list| add_to_list(Path::new(&list)))?;
                    Ok(None)
                }
            }
        }
    }
}

/// Adds the calling test to a list: a line with its working folder, its program and its name, separated by
/// tabs. If this fails, the test fails, as it would never be run again.
fn add_to_list(list: &Path) -> Result<(), MissingDependency> {
    let folder = env::current_dir().unwrap_or_default();
    let program = env::current_exe().unwrap_or_default();
    // The test harness names a test's thread after the test.
    let thread = thread::current();
    let name = thread.name().unwrap_or_default();
    let line = format!("{}\t{}\t{name}\n", folder.display(), program.display());
    let file = OpenOptions::new().append(true).create(true).open(list);
    // A single write keeps the lines of parallel tests whole.
    let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
    written.map_err(|error| MissingDependency(format!("{}: {error}", list.display())))
}

#[cfg(test)]
mod tests {
    use std::{env, fs, process};

    use super::{IfMissing, add_to_list, require_or_skip_by};

    #[test]
    fn who_skips_is_listed_so_that_it_can_be_run_alone() {
        let list = env::temp_dir().join(format!("paros-skipped-{}", process::id()));
        add_to_list(&list).expect("room on the disk");
        add_to_list(&list).expect("room on the disk");
        let error = add_to_list(&list.join("no folder")).expect_err("it is a file");
        assert!(error.to_string().contains("no folder"), "{error}");
        let lines = fs::read_to_string(&list).expect("a list");
        fs::remove_file(&list).expect("a list");
        let program = env::current_exe().expect("a program");
        let name = "require::tests::who_skips_is_listed_so_that_it_can_be_run_alone";
        let folder = env!("CARGO_MANIFEST_DIR");
        let line = format!("{folder}\t{}\t{name}\n", program.display());
        assert_eq!(lines, line.repeat(2));
    }

    #[test]
    fn what_is_missing_is_skipped_unless_all_is_required() {
        for if_missing in [IfMissing::Skip, IfMissing::Fail] {
            assert_eq!(require_or_skip_by(if_missing, Ok::<_, &str>(7)), Ok(Some(7)));
        }
        assert_eq!(require_or_skip_by::<(), _>(IfMissing::Skip, Err("no harp")), Ok(None));
        let required = require_or_skip_by::<(), _>(IfMissing::Fail, Err("no harp"));
        assert_eq!(required.unwrap_err().to_string(), "no harp, and PAROS_REQUIRE is all");
    }
}
