//! Errors of requests to the booth.

use std::io;

use crate::reason::{Expected, Reason};
use crate::store::StoreError;

/// The reason why a request is refused. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The request is malformed.
    #[error("{0}")]
    BadRequest(String),
    /// A person entered an invalid value.
    #[error("{0}")]
    Unfit(Expected),
    /// No headset, account or enrolment has this token.
    #[error("no such token, or not any more")]
    UnknownToken,
    /// The sender is known, but may not do this.
    #[error("{}", .0.text())]
    Forbidden(Reason),
    /// The requested thing doesn't exist, or no longer does.
    #[error("{}", .0.text())]
    NotFound(Reason),
    /// The request contradicts the stored records.
    #[error("{}", .0.text())]
    Conflict(Reason),
    /// The request is too large.
    #[error("{what}: at most {most} are taken")]
    TooLarge {
        /// The thing that is too large.
        what: &'static str,
        /// The largest accepted size.
        most: u64,
    },
    /// The bytes arrived intact but aren't a sculpture.
    #[error("no sculpture: {0}")]
    Undecodable(String),
    /// There are too many requests of this kind: retry later.
    #[error("too many {what}; again in {retry_after} s")]
    Busy {
        /// The kind of the requests.
        what: &'static str,
        /// Seconds until a retry.
        retry_after: u32,
    },
    /// The booth's queue is full: retry later.
    #[error("the booth is busy; again in {retry_after} s")]
    Overloaded {
        /// Seconds until a retry.
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
    /// Returns the HTTP status of the refusal.
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

    /// `true` if the store or the disk failed. The text of such an error is only for the log.
    #[must_use]
    pub const fn is_failure(&self) -> bool {
        matches!(self, Refusal::Store(_) | Refusal::Files(_))
    }

    /// Returns the seconds until a retry makes sense; `None` if it doesn't.
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
