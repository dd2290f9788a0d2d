//! Serialization and digests. The lower layer encodes single values; the upper layer a whole world
//! ([`World::save`](crate::World::save)) and a recorded session ([`trace`]).
//!
//! Inputs: values, or untrusted bytes. Outputs: bytes, or the values, or the offset and reason of an error.
//! Independent of files: the caller owns every buffer.

pub(crate) mod bad_save;
pub(crate) mod bytes;
pub(crate) mod digest;
pub(crate) mod save;
pub mod trace;
pub(crate) mod vectors;

pub use bad_save::BadSave;
pub use bytes::{BadBytes, ByteReader};
pub use save::session_of_save;
