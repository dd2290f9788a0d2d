//! The booth's records: one struct for each table.

mod badges;
mod devices;
mod people;
mod prints;
mod sculptures;
mod work;

pub use badges::{BadgeBlock, BadgeCursor};
pub use devices::{Announcement, Command, CommandState, Device, EnrolToken};
pub use people::{Account, AuditEntry, MailOrder, MailState, StaffRole, StaffSession};
pub use prints::{EstimateState, PrintOrder, PrintState};
pub use sculptures::{ExportState, Sculpture, Tombstone};
pub use work::{SeenTime, WorkKind, WorkLease};

/// The version of the schema. A change of a record raises it.
pub const SCHEMA_VERSION: i64 = 2;

/// The SQLite statements that create the tables.
pub const SCHEMA: &str = include_str!("schema.sql");
