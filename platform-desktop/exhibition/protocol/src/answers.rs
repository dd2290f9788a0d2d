//! The answers to uploaded parcels, and the times within which a request is answered.

use std::time::Duration;

use crate::limits::MAX_COMMAND_MS;

/// Milliseconds without an answer after which a heartbeat has failed: a command in it would be dead.
pub const HEARTBEAT_TIMEOUT_MS: u64 = MAX_COMMAND_MS as u64;

/// How long the largest parcel may take.
const LONGEST_UPLOAD: Duration = Duration::from_secs(600);

/// The booth's outcome of a parcel that is none of refusal, failure or delay.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParcelOutcome {
    /// The booth keeps the sculpture.
    Kept,
    /// The sculpture was kept and then deleted: the headset deletes it too.
    Deleted,
}

/// How long an answer is waited for, from when its request begins.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LinkTimes {
    /// For a parcel, but for its bytes: a second more for each 4 KiB, as over a radio link of 35 kbit/s, up to ten minutes
    /// in all.
    pub put: Duration,
    /// For any other request.
    pub small: Duration,
}

impl ParcelOutcome {
    /// The answer's status of HTTP.
    #[must_use]
    pub const fn status(self) -> u16 {
        match self {
            ParcelOutcome::Kept => 200,
            ParcelOutcome::Deleted => 410,
        }
    }

    /// The answer's body: no proxy and no captive portal answers with this.
    #[must_use]
    pub const fn body(self) -> &'static [u8] {
        match self {
            ParcelOutcome::Kept => b"kept\n",
            ParcelOutcome::Deleted => b"deleted\n",
        }
    }

    /// Reads an answer. Returns `None` if it is another one, or not the booth's.
    #[must_use]
    pub fn of_answer(status: u16, body: &[u8]) -> Option<Self> {
        let all = [ParcelOutcome::Kept, ParcelOutcome::Deleted];
        all.into_iter().find(|outcome| (outcome.status(), outcome.body()) == (status, body))
    }
}

impl Default for LinkTimes {
    fn default() -> Self {
        // A little less than the sender waits, so that no request waits for one that was given up.
        let small = Duration::from_millis(HEARTBEAT_TIMEOUT_MS - HEARTBEAT_TIMEOUT_MS / 10);
        LinkTimes { put: Duration::from_secs(60), small }
    }
}

impl LinkTimes {
    /// How long the answer to a parcel of so many bytes is waited for.
    #[must_use]
    pub fn of_parcel(&self, bytes: usize) -> Duration {
        (self.put + Duration::from_secs(bytes as u64 / 4096)).min(LONGEST_UPLOAD)
    }
}
