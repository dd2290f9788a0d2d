//! Optional parts of a machine: a library to compare with, a device, a tool. A test that lacks one is
//! skipped with a message; where the environment variable `PAROS_REQUIRE` is `all` it fails.

use std::fmt::{self, Display};
use std::io::{self, Write};

/// A required part is missing. Holds the reason.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Required(pub String);

/// The part, or `None` after a message `skipped: REASON` on standard error.
///
/// # Errors
/// It is missing, and `PAROS_REQUIRE` is `all`.
pub fn require<T, E: Display>(part: Result<T, E>) -> Result<Option<T>, Required> {
    let all = std::env::var_os("PAROS_REQUIRE").is_some_and(|parts| parts == "all");
    require_if(all, part)
}

fn require_if<T, E: Display>(all: bool, part: Result<T, E>) -> Result<Option<T>, Required> {
    match part {
        Ok(part) => Ok(Some(part)),
        Err(why) => {
            // Nobody may be listening there.
            let _ = writeln!(io::stderr(), "skipped: {why}");
            if all { Err(Required(why.to_string())) } else { Ok(None) }
        }
    }
}

impl Display for Required {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, and PAROS_REQUIRE is all", self.0)
    }
}

impl std::error::Error for Required {}

#[cfg(test)]
mod tests {
    use super::{Required, require_if};

    #[test]
    fn what_is_missing_is_skipped_unless_all_is_required() {
        for all in [false, true] {
            assert_eq!(require_if(all, Ok::<_, &str>(7)), Ok(Some(7)));
        }
        assert_eq!(require_if::<(), _>(false, Err("no harp")), Ok(None));
        let required = require_if::<(), _>(true, Err("no harp"));
        assert_eq!(required, Err(Required("no harp".into())));
        assert_eq!(required.unwrap_err().to_string(), "no harp, and PAROS_REQUIRE is all");
    }
}
