//! Optional dependencies of tests: a library to compare with, a device, a tool. A test that lacks one is
//! skipped with a message; where the environment variable `PAROS_REQUIRE` is `all` it fails.

use std::fmt::{self, Display};
use std::io::{self, Write};

/// A required dependency is missing. Holds the reason.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MissingDependency(pub String);

/// The dependency, or `None` after a message `skipped: REASON` on standard error.
///
/// # Errors
/// It is missing, and `PAROS_REQUIRE` is `all`.
pub fn require_or_skip<T, E: Display>(
    dependency: Result<T, E>,
) -> Result<Option<T>, MissingDependency> {
    let all = std::env::var_os("PAROS_REQUIRE").is_some_and(|parts| parts == "all");
    let if_missing = if all { IfMissing::Fail } else { IfMissing::Skip };
    require_or_skip_by(if_missing, dependency)
}

/// What is done where a dependency is missing.
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
            // Nobody may be listening there.
            let _ = writeln!(io::stderr(), "skipped: {why}");
            match if_missing {
                IfMissing::Fail => Err(MissingDependency(why.to_string())),
                IfMissing::Skip => Ok(None),
            }
        }
    }
}

impl Display for MissingDependency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, and PAROS_REQUIRE is all", self.0)
    }
}

impl std::error::Error for MissingDependency {}

#[cfg(test)]
mod tests {
    use super::{IfMissing, MissingDependency, require_or_skip_by};

    #[test]
    fn what_is_missing_is_skipped_unless_all_is_required() {
        for if_missing in [IfMissing::Skip, IfMissing::Fail] {
            assert_eq!(require_or_skip_by(if_missing, Ok::<_, &str>(7)), Ok(Some(7)));
        }
        assert_eq!(require_or_skip_by::<(), _>(IfMissing::Skip, Err("no harp")), Ok(None));
        let required = require_or_skip_by::<(), _>(IfMissing::Fail, Err("no harp"));
        assert_eq!(required, Err(MissingDependency("no harp".into())));
        assert_eq!(required.unwrap_err().to_string(), "no harp, and PAROS_REQUIRE is all");
    }
}
