//! The answers to uploaded parcels, and the times within which a request is answered.

use std::time::Duration;

use crate::limits::MAX_COMMAND_MS;

/// Timeout of a heartbeat in milliseconds: the longest life of a command, as a later one is dead.
pub const HEARTBEAT_TIMEOUT_MS: u64 = MAX_COMMAND_MS as u64;

/// Longest timeout of a parcel's upload.
const LONGEST_UPLOAD: Duration = Duration::from_secs(600);

/// The booth's final outcome of an upload: neither a refusal, nor an error, nor a delay.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParcelOutcome {
    /// The booth keeps the sculpture.
    Kept,
    /// The sculpture was kept and then deleted: the headset deletes it too.
    Deleted,
}

/// Request timeouts, counted from the start of the request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LinkTimes {
    /// Base timeout of a parcel. [`of_parcel`](LinkTimes::of_parcel) adds a second for each 4 KiB, as over a
    /// radio link of 35 kbit/s, up to ten minutes in all.
    pub put: Duration,
    /// Timeout of any other request.
    pub small: Duration,
}

impl ParcelOutcome {
    /// Returns the HTTP status of the answer.
    #[must_use]
    pub const fn status(self) -> u16 {
        match self {
            ParcelOutcome::Kept => 200,
            ParcelOutcome::Deleted => 410,
        }
    }

    /// Returns the body of the answer. No proxy or captive portal answers with these bytes.
    #[must_use]
    pub const fn body(self) -> &'static [u8] {
        match self {
            ParcelOutcome::Kept => b"kept\n",
            ParcelOutcome::Deleted => b"deleted\n",
        }
    }

    /// Reads an answer. Returns `None` for any other answer, such as one of a proxy.
    #[must_use]
    pub fn of_answer(status: u16, body: &[u8]) -> Option<Self> {
        let all = [ParcelOutcome::Kept, ParcelOutcome::Deleted];
        all.into_iter().find(|outcome| (outcome.status(), outcome.body()) == (status, body))
    }
}

impl Default for LinkTimes {
    fn default() -> Self {
        // Slightly shorter than the heartbeat timeout, so that this request ends before the next one starts.
        let small = Duration::from_millis(HEARTBEAT_TIMEOUT_MS - HEARTBEAT_TIMEOUT_MS / 10);
        LinkTimes { put: Duration::from_secs(60), small }
    }
}

impl LinkTimes {
    /// Returns the timeout of a parcel of `bytes` bytes.
    #[must_use]
    pub fn of_parcel(&self, bytes: usize) -> Duration {
        (self.put + Duration::from_secs(bytes as u64 / 4096)).min(LONGEST_UPLOAD)
    }
}
