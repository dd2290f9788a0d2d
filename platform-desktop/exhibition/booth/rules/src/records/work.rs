//! Leases of work that several processes share.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// A kind of work that one process does at a time.
    pub enum WorkKind {
        /// Checks a sculpture's mesh. The subject is the sculpture's id.
        Export = 0,
        /// Sends a mail. The subject is the order's number.
        Mail = 1,
        /// Slices a print. The subject is the order's number.
        Slice = 2,
        /// Controls a printer. The subject is the printer's name.
        Printer = 3,
    }
}

record! {
    /// The time that the booth has seen pass: a single row.
    pub struct SeenTime in "seen_time", key 1 {
        /// Always 0.
        pub row: u8,
        /// The system clock's time at the last sweep without a clock jump.
        pub seen_at: BoothTime,
    }
}

record! {
    /// A lease of a piece of work: other processes skip it.
    pub struct WorkLease in "work_leases", key 2 {
        /// The kind of the work.
        pub kind: WorkKind,
        /// The subject of the work.
        pub subject: Vec<u8>,
        /// The process that holds the lease: random bits, drawn at each start.
        pub worker: u64,
        /// The time from which another process may take the work.
        pub until: BoothTime,
    }
}
