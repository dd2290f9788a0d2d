//! Print orders.

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// The state of a print. `PrintState::after` defines the transitions.
    pub enum PrintState {
        /// The print waits for the slicer, or to be started by hand.
        Ordered = 0,
        /// The print is running.
        Printing = 1,
        /// The print is finished.
        Done = 2,
        /// The print failed.
        Failed = 3,
        /// Staff cancelled the print.
        Cancelled = 4,
        /// The print is sliced and waits for a printer.
        Sliced = 5,
    }
}

stored_enum! {
    /// The state of a print's estimate of duration and material.
    pub enum EstimateState {
        /// The slicer hasn't made the estimate yet.
        Waiting = 0,
        /// The estimate is in the order.
        Known = 1,
        /// There is no estimate: there is no slicer, or it failed.
        Unknown = 2,
    }
}

record! {
    /// An order of a print of a sculpture.
    pub struct PrintOrder in "print_orders", key 1 {
        /// The random number of the order.
        pub order: u64,
        /// The id of the sculpture.
        pub sculpture: [u8; 16],
        /// The height in tenths of a millimetre; 0 until it is found from `most_minutes`.
        pub height_tenths_mm: u32,
        /// The colour of the filament.
        pub filament: String,
        /// A note of staff.
        pub note: String,
        /// The time of the order.
        pub asked_at: BoothTime,
        /// The state of the print.
        pub state: PrintState,
        /// The longest duration in minutes, if the height is to be found from it.
        pub most_minutes: Option<u32>,
        /// The state of the estimate.
        pub estimate: EstimateState,
        /// The estimated duration in minutes.
        pub minutes: Option<u32>,
        /// The estimated filament in tenths of a gram.
        pub tenths_gram: Option<u32>,
        /// The printer on the network; `None` if a person prints it by hand.
        pub printer: Option<String>,
        /// The job name at the printer, from when the printer may have received the print.
        pub job: Option<String>,
        /// The time of the last change of the state.
        pub changed_at: BoothTime,
        /// The reason why the print failed or has no estimate.
        pub why: String,
    }
}
