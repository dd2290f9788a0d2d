//! A store in memory, for tests and simulations: obviously right, and lost with the process.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::store::{Access, Condition, Query, RowOrder, Store, StoreError, Transaction};
use crate::table::{Row, Table};
use crate::value::Value;

/// A table's name and a key in it.
type RowName = (&'static str, Vec<Value>);

/// Keys by a table's name, the place of an indexed column and its value.
type Index = BTreeMap<(&'static str, usize, Value), BTreeSet<Vec<Value>>>;

/// At least as great as any value of a number's or bytes' column.
static GREATEST: Value = Value::Text(String::new());

#[derive(Clone, Debug, Default)]
struct Rows {
    rows: BTreeMap<RowName, Row>,
    index: Index,
}

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
    undo: Vec<(&'static Table, Vec<Value>, Option<Row>)>,
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

impl Rows {
    /// Replaces or removes a row, and returns the one before.
    fn set(&mut self, table: &'static Table, key: &[Value], row: Option<&Row>) -> Option<Row> {
        let name = (table.name, key.to_vec());
        let before = match row {
            Some(row) => self.rows.insert(name, row.clone()),
            None => self.rows.remove(&name),
        };
        for column in table.indexed.iter().chain(table.unique) {
            let Some(column) = table.find_column(column) else { continue };
            let keys_with = |row: &Row| (table.name, column, row[column].clone());
            if let Some(before) = &before
                && let Some(keys) = self.index.get_mut(&keys_with(before))
            {
                keys.remove(key);
            }
            if let Some(row) = row {
                self.index.entry(keys_with(row)).or_default().insert(key.to_vec());
            }
        }
        before
    }

    /// Keys of rows among which are all that a query finds; `None` for all of its table.
    fn candidates(&self, query: &Query) -> Option<BTreeSet<&Vec<Value>>> {
        let table = query.table;
        let mut ranges = query.conditions.iter().filter_map(|condition| range_of(table, condition));
        let (column, first, last) = ranges.next()?;
        let of_column = ranges.filter(|(other, ..)| *other == column);
        let (first, last) =
            of_column.fold((first, last), |(first, last), (_, other_first, other_last)| {
                (first.max(other_first), last.min(other_last))
            });
        if first > last {
            return Some(BTreeSet::new());
        }
        let in_index = (table.name, column, first.clone())..=(table.name, column, last.clone());
        Some(self.index.range(in_index).flat_map(|(_, keys)| keys).collect())
    }
}

impl MemoryTransaction<'_> {
    fn change(
        &mut self,
        table: &'static Table,
        key: &[Value],
        row: Option<&Row>,
    ) -> Result<(), StoreError> {
        if self.access == Access::Read {
            return Err(StoreError::Failed("this transaction may only read".into()));
        }
        let before = self.rows.set(table, key, row);
        self.undo.push((table, key.to_vec(), before));
        Ok(())
    }

    /// Checks that no other row has a value of a unique column.
    fn check_unique(&self, table: &'static Table, row: &Row) -> Result<(), StoreError> {
        let key = &row[..table.key_columns];
        for name in table.unique {
            let column = column_of(table, name)?;
            let taken = self.rows.index.get(&(table.name, column, row[column].clone()));
            let is_taken = taken.is_some_and(|keys| keys.iter().any(|other| other != key));
            if row[column] != Value::Null && is_taken {
                let why = format!("table {}: {name} is another row's", table.name);
                return Err(StoreError::Failed(why.into()));
            }
        }
        Ok(())
    }

    fn find_all(&self, query: &Query) -> Result<Vec<&Row>, StoreError> {
        let (table, rows) = (query.table, &self.rows.rows);
        let candidates: Vec<&Row> = match self.rows.candidates(query) {
            Some(keys) => {
                keys.into_iter().filter_map(|key| rows.get(&(table.name, key.clone()))).collect()
            }
            None => {
                let from_first = rows.range((table.name, Vec::new())..);
                let of_table = from_first.take_while(|((name, _), _)| *name == table.name);
                of_table.map(|(_, row)| row).collect()
            }
        };
        let mut found = Vec::new();
        for row in candidates {
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
        Ok(self.rows.rows.get(&(table.name, key.to_vec())).cloned())
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
        self.check_unique(table, &row)?;
        self.change(table, &row[..table.key_columns], Some(&row))
    }

    fn remove_row(&mut self, table: &'static Table, key: &[Value]) -> Result<(), StoreError> {
        self.change(table, key, None)
    }

    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        self.undo.clear();
        Ok(())
    }
}

impl Drop for MemoryTransaction<'_> {
    fn drop(&mut self) {
        while let Some((table, key, before)) = self.undo.pop() {
            self.rows.set(table, &key, before.as_ref());
        }
    }
}

/// The place of an indexed column, and the least and the greatest value that a condition asks for.
fn range_of<'a>(table: &Table, condition: &'a Condition) -> Option<(usize, &'a Value, &'a Value)> {
    let (name, first, last) = match condition {
        Condition::Equal(name, value) => (name, value, value),
        Condition::AtLeast(name, value) => (name, value, &GREATEST),
        Condition::Below(name, value) => (name, &Value::Null, value),
        Condition::Present(_) => return None,
    };
    let is_indexed = table.indexed.contains(name) || table.unique.contains(name);
    Some((table.find_column(name).filter(|_| is_indexed)?, first, last))
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
            *found != Value::Null && *value != Value::Null && found < value
        }
        Condition::AtLeast(column, value) => {
            let found = &row[column_of(table, column)?];
            *found != Value::Null && *value != Value::Null && found >= value
        }
    })
}

fn column_of(table: &Table, name: &str) -> Result<usize, StoreError> {
    let unknown = || StoreError::Failed(format!("table {}: no column {name}", table.name).into());
    table.find_column(name).ok_or_else(unknown)
}
