//! A fuzzer and its targets: functions of bytes that panic if an invariant is broken.
//!
//! [`engine`] runs a target on inputs that [`mutation`] derives from its seeds, and keeps those with a new
//! outcome or, if the build counts it, with new code coverage ([`coverage`]). Targets check invariants;
//! nothing here classifies inputs as right or wrong.

pub mod coverage;
pub mod engine;
pub mod mutation;
pub mod targets;
