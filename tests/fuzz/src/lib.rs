//! A fuzzer and its targets: functions of bytes that panic where a promise is broken.
//!
//! [`engine`] runs a target on inputs that [`mutation`] makes of its seeds, and keeps those that led
//! somewhere new: to another outcome or, where the build counts that, to other code ([`coverage`]).
//! Targets know what must hold; nothing here knows what is wrong.

pub mod coverage;
pub mod engine;
pub mod mutation;
pub mod targets;
