//! Why the booth doesn't do what was asked.

use std::io;

use crate::reason::{Expected, Reason};
use crate::store::StoreError;

/// Why a request is refused. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The message isn't one.
    #[error("{0}")]
    BadRequest(String),
    /// What a person filled in isn't what it should be.
    #[error("{0}")]
    Unfit(Expected),
    /// No headset, account or enrolment has this token.
    #[error("no such token, or not any more")]
    UnknownToken,
    /// Who asks is known, and may not do this.
    #[error("{}", .0.text())]
    Forbidden(Reason),
    /// There is no such thing, or not any more.
    #[error("{}", .0.text())]
    NotFound(Reason),
    /// It contradicts what is kept.
    #[error("{}", .0.text())]
    Conflict(Reason),
    /// It is more than is taken.
    #[error("{what}: at most {most} are taken")]
    TooLarge {
        /// What is.
        what: &'static str,
        /// How much of it is taken.
        most: u64,
    },
    /// What arrived is whole and is no sculpture.
    #[error("no sculpture: {0}")]
    Undecodable(String),
    /// Too much at once: again after so many seconds.
    #[error("too many {what}; again in {retry_after} s")]
    Busy {
        /// What there is too much of.
        what: &'static str,
        /// Seconds.
        retry_after: u32,
    },
    /// All that may wait here waits: again after so many seconds.
    #[error("the booth is busy; again in {retry_after} s")]
    Overloaded {
        /// Seconds.
        retry_after: u32,
    },
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The disk failed.
    #[error("the booth's files: {0}")]
    Files(#[from] io::Error),
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
