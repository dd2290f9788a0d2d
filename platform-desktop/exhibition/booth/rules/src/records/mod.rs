//! What the booth keeps: a struct a table.

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
pub use work::{WorkKind, WorkLease};

use crate::table::{Record, Table};

/// All tables that a store has.
pub const TABLES: [&Table; 14] = [
    Device::TABLE,
    EnrolToken::TABLE,
    Command::TABLE,
    Announcement::TABLE,
    BadgeBlock::TABLE,
    BadgeCursor::TABLE,
    Sculpture::TABLE,
    Tombstone::TABLE,
    Account::TABLE,
    StaffSession::TABLE,
    MailOrder::TABLE,
    PrintOrder::TABLE,
    AuditEntry::TABLE,
    WorkLease::TABLE,
];
