//! Work that several processes share.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// A kind of work that one process does at a time.
    pub enum WorkKind {
        /// To check a sculpture's mesh: by the sculpture's id.
        Export = 0,
        /// To send a mail: by its order's number.
        Mail = 1,
        /// To slice a print: by its order's number.
        Slice = 2,
        /// To see to a printer: by its name.
        Printer = 3,
    }
}

record! {
    /// The time that the booth has seen pass: a single row.
    pub struct SeenTime in "seen_time", key 1 {
        /// Always 0.
        pub row: u8,
        /// The system clock's time at the last sweep before which it didn't jump.
        pub seen_at: BoothTime,
    }
}

record! {
    /// That a process does some work, and the others leave it alone.
    pub struct WorkLease in "work_leases", key 2 {
        /// What is done.
        pub kind: WorkKind,
        /// To what.
        pub subject: Vec<u8>,
        /// The process that does it: random bits, other ones with each start.
        pub worker: u64,
        /// From when on another one may.
        pub until: BoothTime,
    }
}
