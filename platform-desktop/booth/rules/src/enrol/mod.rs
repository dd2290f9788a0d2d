//! How devices become headsets: by the token of a fleet's file, or by hand.

mod by_hand;
mod fleet;

pub use by_hand::{AttemptView, EnrolBits};
