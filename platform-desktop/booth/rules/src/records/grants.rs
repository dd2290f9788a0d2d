//! Whose numbers of badges are.

use crate::table::record;

record! {
    /// Places of a block of numbers that a headset was handed: from this one up to the next one of the block's that has
    /// a row.
    pub struct BlockGrant in "block_grants", key 2, indexed [] {
        /// The block.
        pub block: u32,
        /// The first of the places.
        pub first_place: u8,
        /// Whose they are.
        pub headset: u32,
    }
}
