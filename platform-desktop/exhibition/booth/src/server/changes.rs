//! Notifications of changes in the records, so that open pages can follow them.

use std::sync::Arc;

use paros_booth_rules::{Access, Row, Store, StoreError, Transaction, Value};
use tokio::sync::watch;

/// The tables that pages show, and the table of logins, as pages end with their login. Heartbeats change
/// other tables several times a second.
const SHOWN: [&str; 6] =
    ["announcements", "commands", "mail_orders", "print_orders", "sculptures", "staff_sessions"];

/// Notifies of changes that this process has committed to the tables that pages show, and of the program's
/// end.
#[derive(Clone)]
pub(crate) struct Changes(watch::Sender<bool>);

/// A receiver of the notifications.
pub(crate) struct ChangeWatch(watch::Receiver<bool>);

impl Changes {
    #[must_use]
    pub(crate) fn new() -> Self {
        Changes(watch::Sender::default())
    }

    /// Wraps a store, so that its changes are notified here.
    #[must_use]
    pub(crate) fn watch_store(&self, store: Arc<dyn Store>) -> Arc<dyn Store> {
        Arc::new(WatchedStore { store, changes: self.clone() })
    }

    /// Returns a receiver of changes from now on.
    #[must_use]
    pub(crate) fn watch(&self) -> ChangeWatch {
        ChangeWatch(self.0.subscribe())
    }

    /// Ends all waiting, as the program ends.
    pub(crate) fn end(&self) {
        self.0.send_replace(true);
    }

    /// Wakes all receivers.
    fn tell(&self) {
        self.0.send_modify(|_| {});
    }
}

impl ChangeWatch {
    /// Waits for a change since the last call. Returns `false` if the program ends.
    pub(crate) async fn changed(&mut self) -> bool {
        self.0.changed().await.is_ok() && !*self.0.borrow_and_update()
    }
}

/// A store that notifies of its changes.
struct WatchedStore {
    store: Arc<dyn Store>,
    changes: Changes,
}

struct WatchedTransaction<'a> {
    transaction: Box<dyn Transaction + 'a>,
    changes: &'a Changes,
    is_change: bool,
}

impl Store for WatchedStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let transaction = self.store.begin(access)?;
        Ok(match access {
            Access::Read => transaction,
            Access::Write => Box::new(WatchedTransaction {
                transaction,
                changes: &self.changes,
                is_change: false,
            }),
        })
    }
}

impl Transaction for WatchedTransaction<'_> {
    fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, StoreError> {
        self.is_change |= changes_what_is_shown(sql);
        self.transaction.query(sql, values)
    }

    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        let WatchedTransaction { transaction, changes, is_change } = *self;
        transaction.commit()?;
        if is_change {
            changes.tell();
        }
        Ok(())
    }

    fn is_in_conflict(&self) -> bool {
        self.transaction.is_in_conflict()
    }
}

/// Returns `true` for a statement that changes a table that pages show.
fn changes_what_is_shown(sql: &str) -> bool {
    let mut words = sql.split_whitespace();
    let table = match words.next() {
        Some("INSERT" | "DELETE") => words.nth(1),
        Some("UPDATE") => words.next(),
        _ => None,
    };
    table.is_some_and(|table| SHOWN.contains(&table))
}

#[cfg(test)]
mod tests {
    use super::{SHOWN, changes_what_is_shown};
    use paros_booth_rules::records::SCHEMA;

    #[test]
    fn statements_that_change_what_is_shown_are_told_from_others() {
        for sql in [
            "INSERT INTO sculptures (id) VALUES (?1)",
            "DELETE FROM announcements WHERE headset = ?1",
            "UPDATE print_orders SET why = ''",
        ] {
            assert!(changes_what_is_shown(sql), "{sql}");
        }
        for sql in ["SELECT id FROM sculptures", "INSERT INTO devices (headset) VALUES (1)", ""] {
            assert!(!changes_what_is_shown(sql), "{sql}");
        }
        for table in SHOWN {
            assert!(SCHEMA.contains(&format!("CREATE TABLE {table} ")), "{table}");
        }
    }
}
