//! A store in memory, for tests and simulations: obviously right, and lost with the process.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::store::{Access, Condition, Query, RowOrder, Store, StoreError, Transaction};
use crate::table::{Row, Table};
use crate::value::Value;

/// Rows by their table's name and their key.
type Rows = BTreeMap<RowName, Row>;

/// A table's name and a key in it.
type RowName = (&'static str, Vec<Value>);

/// A store in memory. One transaction at a time; each changes it in place and takes its changes back unless they are
/// committed.
#[derive(Debug, Default)]
pub struct MemoryStore {
    rows: Mutex<Rows>,
}

struct MemoryTransaction<'a> {
    rows: MutexGuard<'a, Rows>,
    access: Access,
    /// What was there before each change.
    undo: Vec<(RowName, Option<Row>)>,
}

impl MemoryStore {
    /// Without rows.
    #[must_use]
    pub fn new() -> Self {
        MemoryStore::default()
    }

    /// All that it holds, as a second store.
    #[must_use]
    pub fn copy(&self) -> Self {
        MemoryStore { rows: Mutex::new(self.lock().clone()) }
    }

    fn lock(&self) -> MutexGuard<'_, Rows> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store for MemoryStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        Ok(Box::new(MemoryTransaction { rows: self.lock(), access, undo: Vec::new() }))
    }
}

impl MemoryTransaction<'_> {
    fn change(&mut self, key: RowName, row: Option<Row>) -> Result<(), StoreError> {
        if self.access == Access::Read {
            return Err(StoreError::Failed("this transaction may only read".into()));
        }
        let before = match row {
            Some(row) => self.rows.insert(key.clone(), row),
            None => self.rows.remove(&key),
        };
        self.undo.push((key, before));
        Ok(())
    }

    fn find_all(&self, query: &Query) -> Result<Vec<&Row>, StoreError> {
        let table = query.table;
        let from_first = self.rows.range((table.name, Vec::new())..);
        let mut found = Vec::new();
        for (_, row) in from_first.take_while(|((name, _), _)| *name == table.name) {
            let mut holds = true;
            for condition in &query.conditions {
                holds &= condition_holds(table, condition, row)?;
            }
            if holds {
                found.push(row);
            }
        }
        if let Some((column, order)) = query.order {
            let column = column_of(table, column)?;
            // Rows are ordered by their key before, and stay so where they are equal.
            found.sort_by(|a, b| match order {
                RowOrder::Ascending => a[column].cmp(&b[column]),
                RowOrder::Descending => b[column].cmp(&a[column]),
            });
        }
        Ok(found)
    }
}

impl Transaction for MemoryTransaction<'_> {
    fn get_row(&mut self, table: &'static Table, key: &[Value]) -> Result<Option<Row>, StoreError> {
        Ok(self.rows.get(&(table.name, key.to_vec())).cloned())
    }

    fn find_rows(&mut self, query: &Query) -> Result<Vec<Row>, StoreError> {
        Ok(self.find_all(query)?.into_iter().take(query.limit).cloned().collect())
    }

    fn count_rows(&mut self, query: &Query) -> Result<u64, StoreError> {
        Ok(self.find_all(query)?.len() as u64)
    }

    fn put_row(&mut self, table: &'static Table, row: Row) -> Result<(), StoreError> {
        if !table.fits(&row) {
            return Err(StoreError::Failed(format!("table {}: no row of it", table.name).into()));
        }
        self.change((table.name, row[..table.key_columns].to_vec()), Some(row))
    }

    fn remove_row(&mut self, table: &'static Table, key: &[Value]) -> Result<(), StoreError> {
        self.change((table.name, key.to_vec()), None)
    }

    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        self.undo.clear();
        Ok(())
    }
}

impl Drop for MemoryTransaction<'_> {
    fn drop(&mut self) {
        while let Some((key, before)) = self.undo.pop() {
            match before {
                Some(row) => drop(self.rows.insert(key, row)),
                None => drop(self.rows.remove(&key)),
            }
        }
    }
}

fn condition_holds(
    table: &Table,
    condition: &Condition,
    row: &[Value],
) -> Result<bool, StoreError> {
    Ok(match condition {
        Condition::Equal(column, value) => row[column_of(table, column)?] == *value,
        Condition::Present(column) => row[column_of(table, column)?] != Value::Null,
        Condition::Below(column, value) => {
            let found = &row[column_of(table, column)?];
            *found != Value::Null && *value != Value::Null && found.cmp(value) == Ordering::Less
        }
    })
}

fn column_of(table: &Table, name: &str) -> Result<usize, StoreError> {
    let unknown = || StoreError::Failed(format!("table {}: no column {name}", table.name).into());
    table.find_column(name).ok_or_else(unknown)
}
