//! The booth's rules on a database in memory. `platform-desktop/exhibition/booth/tests/databases` runs these
//! modules on databases.

mod badges;
mod clock;
mod common;
mod enrol;
mod find;
mod heartbeat;
mod lifecycle;
mod list;
mod mail;
mod printers;
mod prints;
mod privacy;
mod promises;
mod restore;
mod staff;
mod store;
mod upload;
mod work;

use std::sync::Arc;

use paros_booth_rules::Store;
use paros_booth_sqlite::SqliteStore;

/// Number of random event sequences in a property test.
pub(crate) const PLAYS: u32 = 400;

/// A store without rows.
pub(crate) fn new_store() -> Arc<dyn Store> {
    Arc::new(SqliteStore::in_memory().expect("memory"))
}
