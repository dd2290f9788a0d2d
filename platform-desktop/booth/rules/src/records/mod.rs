//! What the booth keeps: a struct a table.

mod devices;
mod grants;
mod people;
mod prints;
mod sculptures;
mod work;

pub use devices::{Announcement, Command, CommandState, Device, EnrolToken, LedgerSave};
pub use grants::BlockGrant;
pub use people::{Account, AuditEntry, MailOrder, MailState, StaffRole, StaffSession};
pub use prints::{EstimateState, PrintOrder, PrintState};
pub use sculptures::{BadgeClaim, ExportState, Sculpture, Tombstone};
pub use work::{WorkKind, WorkLease};

use crate::table::{Record, Table};

/// All tables that a store has.
pub const TABLES: [&Table; 14] = [
    Device::TABLE,
    EnrolToken::TABLE,
    Command::TABLE,
    Announcement::TABLE,
    LedgerSave::TABLE,
    Sculpture::TABLE,
    Tombstone::TABLE,
    Account::TABLE,
    StaffSession::TABLE,
    MailOrder::TABLE,
    PrintOrder::TABLE,
    AuditEntry::TABLE,
    BlockGrant::TABLE,
    WorkLease::TABLE,
];
