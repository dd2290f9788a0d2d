//! The messages between headsets and the booth.

pub mod messages;
