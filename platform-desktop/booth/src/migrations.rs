//! The database's versions: each step is a script that is never changed once it was released.

use paros_booth_rules::StoreError;
use rusqlite::{Connection, TransactionBehavior};

use crate::sqlite_store::store_error;

/// From version k to k + 1.
const STEPS: [&str; 5] = [
    include_str!("schema/001.sql"),
    include_str!("schema/002.sql"),
    include_str!("schema/003.sql"),
    include_str!("schema/004.sql"),
    include_str!("schema/005.sql"),
];

/// The newest version, of any database.
pub(crate) const VERSION: i64 = STEPS.len() as i64;

/// Brings a database to this program's version.
///
/// # Errors
/// What SQLite says, or that a newer program wrote the database. It is as it was then.
pub(crate) fn migrate(connection: &mut Connection) -> Result<(), StoreError> {
    // Two processes may start at once: the second one finds the first one's work.
    let transaction = connection
        .transaction_with_behavior(TransactionBehavior::Immediate)
        .map_err(store_error)?;
    let version: i64 = transaction
        .pragma_query_value(None, "user_version", |row| row.get(0))
        .map_err(store_error)?;
    let steps = usize::try_from(version).ok().and_then(|version| STEPS.get(version..));
    let Some(steps) = steps else {
        let newest = STEPS.len();
        let why = format!("its database has version {version}; this program knows up to {newest}");
        return Err(StoreError::Failed(why.into()));
    };
    for step in steps {
        transaction.execute_batch(step).map_err(store_error)?;
    }
    transaction.pragma_update(None, "user_version", VERSION).map_err(store_error)?;
    transaction.commit().map_err(store_error)
}
