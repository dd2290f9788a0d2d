//! The outbox: what a headset owes the booth, until the booth has signed for it.
//!
//! Takes what a visit leaves, times of a clock that nobody sets, random bits and the booth's answers; gives what to
//! store, send, announce and delete. Doesn't know files, networks or cryptography: shells bring these. [`messages`]
//! has all that headset and booth tell each other, as bytes of fixed width.

pub mod messages;
