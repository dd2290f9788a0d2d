//! The embedded store: SQLite in a file, with a write-ahead log that is synced at each commit.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use paros_booth_rules::{
    Access, Condition, Query, Row, RowOrder, Store, StoreError, Table, Transaction, Value,
};
use rusqlite::types::{ToSqlOutput, ValueRef};
use rusqlite::{
    Connection, ErrorCode, OpenFlags, OptionalExtension as _, ToSql, TransactionBehavior,
    params_from_iter,
};

use crate::schema::{Dialect, VERSION, refuse_version, write_put, write_script};

/// Connections that only read: a commit that waits for the disk holds none of them up.
const READERS: usize = 3;

/// The application that wrote the file, as SQLite's header has it: "paro".
const APPLICATION: i64 = 0x7061_726f;

const DIALECT: Dialect =
    Dialect { number: "INTEGER", bytes: "BLOB", text: "TEXT", table_end: " STRICT" };

/// How long a transaction waits for another process, as for one that makes a token.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// A store in a file of SQLite. Several processes may have it open.
pub struct SqliteStore {
    writer: Mutex<Connection>,
    readers: [Mutex<Connection>; READERS],
}

struct SqliteTransaction<'a> {
    connection: MutexGuard<'a, Connection>,
    is_open: bool,
}

impl SqliteStore {
    /// Opens the file, and makes it where there is none.
    ///
    /// # Errors
    /// SQLite's error, or the file has another version.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let mut writer = open_connection(path, OpenFlags::default())?;
        // First: a file of another version stays as it is.
        make_tables(&mut writer)?;
        writer.pragma_update(None, "journal_mode", "WAL").map_err(store_error)?;
        // The log is on the disk before a commit returns.
        writer.pragma_update(None, "synchronous", "FULL").map_err(store_error)?;
        writer.pragma_update(None, "foreign_keys", "ON").map_err(store_error)?;
        // What was deleted isn't left in what the file has free.
        writer.pragma_update(None, "secure_delete", "ON").map_err(store_error)?;
        let open_reader = || -> Result<_, StoreError> {
            let reader = open_connection(path, OpenFlags::default())?;
            reader.pragma_update(None, "query_only", "ON").map_err(store_error)?;
            Ok(Mutex::new(reader))
        };
        let readers = [open_reader()?, open_reader()?, open_reader()?];
        Ok(SqliteStore { writer: Mutex::new(writer), readers })
    }

    /// A reader that nobody has, or the first that is given back.
    fn lock_reader(&self) -> MutexGuard<'_, Connection> {
        let free = self.readers.iter().find_map(|reader| reader.try_lock().ok());
        free.unwrap_or_else(|| lock(&self.readers[0]))
    }
}

impl Store for SqliteStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let (connection, begin) = match access {
            Access::Read => (self.lock_reader(), "BEGIN DEFERRED"),
            Access::Write => (lock(&self.writer), "BEGIN IMMEDIATE"),
        };
        connection.execute_batch(begin).map_err(store_error)?;
        Ok(Box::new(SqliteTransaction { connection, is_open: true }))
    }
}

impl SqliteTransaction<'_> {
    fn execute(&self, sql: &str, values: &[Value]) -> Result<(), StoreError> {
        let mut statement = self.connection.prepare_cached(sql).map_err(store_error)?;
        statement.execute(params_from_iter(values.iter().map(SqliteValue))).map_err(store_error)?;
        Ok(())
    }
}

impl Transaction for SqliteTransaction<'_> {
    fn get_row(&mut self, table: &'static Table, key: &[Value]) -> Result<Option<Row>, StoreError> {
        let sql = format!("SELECT {} FROM {} WHERE {}", columns(table), name(table), key_of(table));
        let mut statement = self.connection.prepare_cached(&sql).map_err(store_error)?;
        let bound = params_from_iter(key.iter().map(SqliteValue));
        statement.query_row(bound, |row| read_row(table, row)).optional().map_err(store_error)
    }

    fn find_rows(&mut self, query: &Query) -> Result<Vec<Row>, StoreError> {
        let (condition, values) = write_conditions(query)?;
        let table = query.table;
        let limit = i64::try_from(query.limit).unwrap_or(i64::MAX);
        let sql = format!(
            "SELECT {} FROM {} WHERE {condition} ORDER BY {} LIMIT {limit}",
            columns(table),
            name(table),
            write_order(query)?
        );
        let mut statement = self.connection.prepare_cached(&sql).map_err(store_error)?;
        let bound = params_from_iter(values.into_iter().map(SqliteValue));
        let rows = statement.query_map(bound, |row| read_row(table, row)).map_err(store_error)?;
        rows.collect::<Result<_, _>>().map_err(store_error)
    }

    fn count_rows(&mut self, query: &Query) -> Result<u64, StoreError> {
        let (condition, values) = write_conditions(query)?;
        let sql = format!("SELECT count(*) FROM {} WHERE {condition}", name(query.table));
        let mut statement = self.connection.prepare_cached(&sql).map_err(store_error)?;
        let bound = params_from_iter(values.into_iter().map(SqliteValue));
        let count: i64 = statement.query_row(bound, |row| row.get(0)).map_err(store_error)?;
        Ok(count.cast_unsigned())
    }

    fn put_row(&mut self, table: &'static Table, row: Row) -> Result<(), StoreError> {
        if !table.fits(&row) {
            return Err(StoreError::Failed(format!("table {}: no row of it", table.name).into()));
        }
        self.execute(&write_put(table, '?'), &row)
    }

    fn remove_row(&mut self, table: &'static Table, key: &[Value]) -> Result<(), StoreError> {
        self.execute(&format!("DELETE FROM {} WHERE {}", name(table), key_of(table)), key)
    }

    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        self.connection.execute_batch("COMMIT").map_err(store_error)?;
        self.is_open = false;
        Ok(())
    }
}

impl Drop for SqliteTransaction<'_> {
    fn drop(&mut self) {
        if self.is_open {
            // Where SQLite has rolled it back by itself there is nothing to roll back.
            let _ = self.connection.execute_batch("ROLLBACK");
        }
    }
}

/// A value as SQLite takes it.
struct SqliteValue<'a>(&'a Value);

impl ToSql for SqliteValue<'_> {
    fn to_sql(&self) -> rusqlite::Result<ToSqlOutput<'_>> {
        Ok(ToSqlOutput::Borrowed(match self.0 {
            Value::Null => ValueRef::Null,
            Value::Number(number) => ValueRef::Integer(*number),
            Value::Bytes(bytes) => ValueRef::Blob(bytes),
            Value::Text(text) => ValueRef::Text(text.as_bytes()),
        }))
    }
}

fn open_connection(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(path, flags).map_err(store_error)?;
    connection.busy_timeout(BUSY_TIMEOUT).map_err(store_error)?;
    Ok(connection)
}

/// Makes the tables of a database that has none.
fn make_tables(connection: &mut Connection) -> Result<(), StoreError> {
    // Two processes may start at once: the second one finds the first one's work.
    let transaction = connection
        .transaction_with_behavior(TransactionBehavior::Immediate)
        .map_err(store_error)?;
    let read =
        |name| transaction.pragma_query_value(None, name, |row| row.get(0)).map_err(store_error);
    let (application, version): (i64, i64) = (read("application_id")?, read("user_version")?);
    match (application, version) {
        (0, 0) => {
            transaction.execute_batch(&write_script(&DIALECT)).map_err(store_error)?;
            transaction.pragma_update(None, "application_id", APPLICATION).map_err(store_error)?;
            transaction.pragma_update(None, "user_version", VERSION).map_err(store_error)?;
            transaction.commit().map_err(store_error)
        }
        (APPLICATION, VERSION) => Ok(()),
        (_, other) => Err(StoreError::Failed(refuse_version(other).into())),
    }
}

/// Opens a database as it is, of whatever version.
///
/// # Errors
/// What SQLite says.
pub(crate) fn open_plain(path: &Path) -> Result<Connection, StoreError> {
    open_connection(path, OpenFlags::SQLITE_OPEN_READ_WRITE)
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn store_error(error: rusqlite::Error) -> StoreError {
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => StoreError::Conflict,
        _ => StoreError::Failed(Box::new(error)),
    }
}

/// A name in quotes: all come from the program, and some are words of SQL.
pub(crate) fn quote(name: &str) -> String {
    format!("\"{name}\"")
}

pub(crate) fn name(table: &Table) -> String {
    quote(table.name)
}

pub(crate) fn columns(table: &Table) -> String {
    let names: Vec<String> = table.columns.iter().map(|column| quote(column.name)).collect();
    names.join(", ")
}

fn key_of(table: &Table) -> String {
    let key = &table.columns[..table.key_columns];
    let equal: Vec<String> = key.iter().map(|column| format!("\"{}\" = ?", column.name)).collect();
    equal.join(" AND ")
}

pub(crate) fn check_column(table: &Table, column: &str) -> Result<(), StoreError> {
    let unknown = || StoreError::Failed(format!("table {}: no column {column}", table.name).into());
    table.find_column(column).map(drop).ok_or_else(unknown)
}

fn write_conditions(query: &Query) -> Result<(String, Vec<&Value>), StoreError> {
    let (mut terms, mut values) = (vec!["1".to_owned()], Vec::new());
    for condition in &query.conditions {
        let (column, term, value) = match condition {
            Condition::Equal(column, value) => (column, "IS ?", Some(value)),
            Condition::Below(column, value) => (column, "< ?", Some(value)),
            Condition::AtLeast(column, value) => (column, ">= ?", Some(value)),
            Condition::Present(column) => (column, "IS NOT NULL", None),
        };
        check_column(query.table, column)?;
        terms.push(format!("\"{column}\" {term}"));
        values.extend(value);
    }
    Ok((terms.join(" AND "), values))
}

fn write_order(query: &Query) -> Result<String, StoreError> {
    let mut order = Vec::new();
    if let Some((column, direction)) = query.order {
        check_column(query.table, column)?;
        let direction = match direction {
            RowOrder::Ascending => "ASC",
            RowOrder::Descending => "DESC",
        };
        order.push(format!("\"{column}\" {direction}"));
    }
    let key = &query.table.columns[..query.table.key_columns];
    order.extend(key.iter().map(|column| quote(column.name)));
    Ok(order.join(", "))
}

fn read_row(table: &Table, row: &rusqlite::Row<'_>) -> rusqlite::Result<Row> {
    let read = |column| {
        Ok(match row.get_ref(column)? {
            ValueRef::Null => Value::Null,
            ValueRef::Integer(number) => Value::Number(number),
            ValueRef::Blob(bytes) => Value::Bytes(bytes.to_vec()),
            ValueRef::Text(text) => Value::Text(String::from_utf8_lossy(text).into_owned()),
            // No column of a strict table holds one.
            ValueRef::Real(_) => Value::Null,
        })
    };
    (0..table.columns.len()).map(read).collect()
}
