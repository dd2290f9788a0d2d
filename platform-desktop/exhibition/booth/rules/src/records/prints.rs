//! What is to be printed.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// How far a print has come. The ways between them are those of `PrintState::after`.
    pub enum PrintState {
        /// It waits to be sliced, or for somebody who starts it.
        Ordered = 0,
        /// A printer is at it.
        Printing = 1,
        /// It is there.
        Done = 2,
        /// It came to nothing.
        Failed = 3,
        /// Staff took it back.
        Cancelled = 4,
        /// Its time and material are known; it waits for a printer.
        Sliced = 5,
    }
}

stored_enum! {
    /// What is known of a print's time and material.
    pub enum EstimateState {
        /// The slicer is yet to tell.
        Waiting = 0,
        /// They stand in the order.
        Known = 1,
        /// Nothing: there is no slicer, or it failed.
        Unknown = 2,
    }
}

record! {
    /// A sculpture that somebody wants printed.
    pub struct PrintOrder in "print_orders", key 1 {
        /// Its random number.
        pub order: u64,
        /// What to print.
        pub sculpture: [u8; 16],
        /// How high, in tenths of a millimetre. 0 where that is yet to be found, by the time that it may take.
        pub height_tenths_mm: u32,
        /// Of which colour.
        pub filament: String,
        /// What else staff noted.
        pub note: String,
        /// When it was asked for.
        pub asked_at: BoothTime,
        /// How far it has come.
        pub state: PrintState,
        /// How long it may take, where its height follows from that.
        pub most_minutes: Option<u32>,
        /// What is known of its time and material.
        pub estimate: EstimateState,
        /// How long it takes.
        pub minutes: Option<u32>,
        /// How much filament it takes, in tenths of a gram.
        pub tenths_gram: Option<u32>,
        /// The printer that it goes to; nothing where somebody sees to it by hand.
        pub printer: Option<String>,
        /// What it is called at the printer, once that may have it.
        pub job: Option<String>,
        /// When it came to this state.
        pub changed_at: BoothTime,
        /// Why it failed, or has no estimate.
        pub why: String,
    }
}
