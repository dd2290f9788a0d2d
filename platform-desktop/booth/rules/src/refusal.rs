//! Why the booth doesn't do what was asked.

use std::fmt;
use std::io;

use crate::reason::{Expected, Reason};
use crate::store::StoreError;

/// Why a request is refused. Nothing was changed.
#[derive(Debug)]
pub enum Refusal {
    /// The message isn't one.
    BadRequest(String),
    /// What a person filled in isn't what it should be.
    Unfit(Expected),
    /// No headset, account or enrolment has this token.
    UnknownToken,
    /// Who asks is known, and may not do this.
    Forbidden(Reason),
    /// There is no such thing, or not any more.
    NotFound(Reason),
    /// It contradicts what is kept.
    Conflict(Reason),
    /// It is more than is taken.
    TooLarge {
        /// What is.
        what: &'static str,
        /// How much of it is taken.
        most: u64,
    },
    /// What arrived is whole and is no sculpture.
    Undecodable(String),
    /// Too much at once: again after so many seconds.
    Busy {
        /// What there is too much of.
        what: &'static str,
        /// Seconds.
        retry_after: u32,
    },
    /// All that may wait here waits: again after so many seconds.
    Overloaded {
        /// Seconds.
        retry_after: u32,
    },
    /// The database failed.
    Store(StoreError),
    /// The disk failed.
    Files(io::Error),
}

impl Refusal {
    /// The status of HTTP that says so.
    #[must_use]
    pub const fn status(&self) -> u16 {
        match self {
            Refusal::BadRequest(_) | Refusal::Unfit(_) => 400,
            Refusal::UnknownToken => 401,
            Refusal::Forbidden(_) => 403,
            Refusal::NotFound(_) => 404,
            Refusal::Conflict(_) => 409,
            Refusal::TooLarge { .. } => 413,
            Refusal::Undecodable(_) => 422,
            Refusal::Busy { .. } => 429,
            Refusal::Overloaded { .. } | Refusal::Store(_) | Refusal::Files(_) => 503,
        }
    }

    /// Whether store or disk failed: what they say is for the log alone.
    #[must_use]
    pub const fn is_failure(&self) -> bool {
        matches!(self, Refusal::Store(_) | Refusal::Files(_))
    }

    /// Seconds after which it is worth to ask again, where it is.
    #[must_use]
    pub const fn retry_after(&self) -> Option<u32> {
        match self {
            Refusal::Busy { retry_after, .. } | Refusal::Overloaded { retry_after } => {
                Some(*retry_after)
            }
            Refusal::Store(_) | Refusal::Files(_) => Some(5),
            _ => None,
        }
    }
}

impl From<StoreError> for Refusal {
    fn from(error: StoreError) -> Self {
        Refusal::Store(error)
    }
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Refusal::Files(error)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::BadRequest(why) => f.write_str(why),
            Refusal::UnknownToken => f.write_str("no such token, or not any more"),
            Refusal::Unfit(expected) => write!(f, "{expected}"),
            Refusal::Forbidden(why) | Refusal::NotFound(why) | Refusal::Conflict(why) => {
                f.write_str(why.text())
            }
            Refusal::TooLarge { what, most } => write!(f, "{what}: at most {most} are taken"),
            Refusal::Undecodable(why) => write!(f, "no sculpture: {why}"),
            Refusal::Busy { what, retry_after } => {
                write!(f, "too many {what}; again in {retry_after} s")
            }
            Refusal::Overloaded { retry_after } => {
                write!(f, "the booth is busy; again in {retry_after} s")
            }
            Refusal::Store(error) => write!(f, "{error}"),
            Refusal::Files(error) => write!(f, "the booth's files: {error}"),
        }
    }
}

impl std::error::Error for Refusal {}
