//! The interface to the database: transactions of SQL statements.
//!
//! The statements use the SQL that SQLite and PostgreSQL share, with parameters `?1`, `?2`. A text with a NUL
//! can't be stored, as PostgreSQL doesn't support it: such a parameter matches no row, and
//! [`put`](Transaction#method.put) rejects it.

use crate::record::{Record, Row};
use crate::records::SCHEMA_VERSION;
use crate::value::{ToValue, Value};

/// Largest number of tries of [`update`] when transactions conflict.
const MOST_TRIES: u32 = 16;

/// A database with the tables of [`SCHEMA`](crate::records::SCHEMA).
pub trait Store: Send + Sync {
    /// Begins a transaction. Transactions are serializable. A transaction that is dropped is rolled back.
    ///
    /// # Errors
    /// The database's error.
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError>;
}

/// The access mode of a transaction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Access {
    /// Only read. Statements that write fail.
    Read,
    /// Read and write.
    Write,
}

/// A transaction of a [`Store`].
pub trait Transaction {
    /// Runs a statement, and returns its rows: of a `SELECT` or of a `RETURNING`.
    ///
    /// # Errors
    /// The database's error, or a write in a read-only transaction.
    fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, StoreError>;

    /// Commits. The changes survive a power cut after this returns.
    ///
    /// # Errors
    /// The database's error. Nothing was changed then; or all or nothing, if the connection broke.
    fn commit(self: Box<Self>) -> Result<(), StoreError>;

    /// Returns `true` if a call failed with [`StoreError::Conflict`], after which the transaction can't be
    /// committed. Always `false` for a store without concurrent writers.
    fn is_in_conflict(&self) -> bool {
        false
    }
}

/// The reason why a store failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Another transaction changed the same records. The transaction is retried.
    #[error("others changed the same records too often")]
    Conflict,
    /// A stored row isn't a valid record.
    #[error("table {table}, column {column}: a value that was never stored there")]
    BadRow {
        /// The name of the table.
        table: &'static str,
        /// The name of the column.
        column: &'static str,
    },
    /// The tables have an unsupported version.
    #[error(
        "the database: its tables have version {0}, and this program reads version {SCHEMA_VERSION}; \
         start it on a new folder or database, or run the program that made this one"
    )]
    OtherVersion(i64),
    /// The database is damaged; with the finding.
    #[error(
        "the database is damaged ({0}) and left as it is; restore a backup into another folder \
         (paros-booth restore), or, without a backup, make a booth of the sculptures' files (paros-booth rescue)"
    )]
    Damaged(String),
    /// The database's error.
    #[error("the database: {0}")]
    Failed(Box<dyn std::error::Error + Send + Sync>),
}

impl dyn Transaction + '_ {
    /// Runs a statement, and returns its rows: of a `SELECT` or of a `RETURNING`.
    ///
    /// # Errors
    /// The database's error.
    pub fn run(&mut self, sql: &str, values: &[&dyn ToValue]) -> Result<Vec<Row>, StoreError> {
        let values: Vec<Value> = values.iter().map(|value| value.to_value()).collect();
        self.query(sql, &values)
    }

    /// Finds records. `rest` is the SQL after `SELECT ... FROM table`.
    ///
    /// # Errors
    /// The database's error, or a row isn't a valid record.
    pub fn find<R: Record>(
        &mut self,
        rest: &str,
        values: &[&dyn ToValue],
    ) -> Result<Vec<R>, StoreError> {
        let sql = format!("SELECT {} FROM {} {rest}", R::COLUMNS, R::TABLE);
        let read =
            |row| R::from_row(row).map_err(|column| StoreError::BadRow { table: R::TABLE, column });
        self.run(&sql, values)?.into_iter().map(read).collect()
    }

    /// Finds the first record. `rest` is the SQL after `SELECT ... FROM table`, without a limit.
    ///
    /// # Errors
    /// The database's error, or the row isn't a valid record.
    pub fn find_first<R: Record>(
        &mut self,
        rest: &str,
        values: &[&dyn ToValue],
    ) -> Result<Option<R>, StoreError> {
        Ok(self.find(&format!("{rest} LIMIT 1"), values)?.pop())
    }

    /// Counts records. `rest` is the SQL after `SELECT count(*) FROM table`.
    ///
    /// # Errors
    /// The database's error.
    pub fn count<R: Record>(
        &mut self,
        rest: &str,
        values: &[&dyn ToValue],
    ) -> Result<u64, StoreError> {
        let rows = self.run(&format!("SELECT count(*) FROM {} {rest}", R::TABLE), values)?;
        match rows.first().map(Vec::as_slice) {
            Some([Value::Number(count)]) => Ok(count.cast_unsigned()),
            _ => Ok(0),
        }
    }

    /// Returns the record with a primary key.
    ///
    /// # Errors
    /// The database's error, or the row isn't a valid record.
    pub fn get<R: Record>(&mut self, key: &[&dyn ToValue]) -> Result<Option<R>, StoreError> {
        let columns = R::COLUMNS.split(", ").take(R::KEY_COLUMNS).zip(1..);
        let terms: Vec<String> = columns.map(|(name, k)| format!("{name} = ?{k}")).collect();
        Ok(self.find(&format!("WHERE {}", terms.join(" AND ")), key)?.pop())
    }

    /// Inserts a record, or replaces the record with the same primary key.
    ///
    /// # Errors
    /// The database's error, a violated unique constraint, or a text with a NUL.
    pub fn put<R: Record>(&mut self, record: &R) -> Result<(), StoreError> {
        let row = record.to_row();
        if row.iter().any(has_nul) {
            return Err(StoreError::Failed(format!("{}: a text with a NUL", R::TABLE).into()));
        }
        let (table, columns) = (R::TABLE, R::COLUMNS);
        let places: Vec<String> = (1..=row.len()).map(|k| format!("?{k}")).collect();
        let key: Vec<&str> = columns.split(", ").take(R::KEY_COLUMNS).collect();
        let sql = format!(
            "INSERT INTO {table} ({columns}) VALUES ({}) \
             ON CONFLICT ({}) DO UPDATE SET ({columns}) = (excluded.{})",
            places.join(", "),
            key.join(", "),
            columns.replace(", ", ", excluded.")
        );
        self.query(&sql, &row).map(drop)
    }
}

/// Returns `true` for a text with a NUL, which can't be stored.
#[must_use]
pub fn has_nul(value: &Value) -> bool {
    matches!(value, Value::Text(text) if text.contains('\0'))
}

/// Runs `work` in a transaction and commits it if the work succeeds. Retries after a conflict.
///
/// # Errors
/// The error of the work or of the store. Nothing was changed then.
pub fn update<T, E: From<StoreError>>(
    store: &dyn Store,
    mut work: impl FnMut(&mut (dyn Transaction + '_)) -> Result<T, E>,
) -> Result<T, E> {
    let mut tries = 1;
    loop {
        let mut transaction = store.begin(Access::Write)?;
        match work(transaction.as_mut()) {
            Ok(done) => match transaction.commit() {
                Ok(()) => return Ok(done),
                Err(StoreError::Conflict) if tries < MOST_TRIES => {}
                Err(error) => return Err(error.into()),
            },
            // After a conflict the result of the work doesn't count, as it may rest on outdated reads.
            Err(_) if transaction.is_in_conflict() && tries < MOST_TRIES => {}
            Err(error) => return Err(error),
        }
        tries += 1;
    }
}

/// Runs `work` in a read-only transaction.
///
/// # Errors
/// The error of the work or of the store.
pub fn view<T, E: From<StoreError>>(
    store: &dyn Store,
    work: impl FnOnce(&mut (dyn Transaction + '_)) -> Result<T, E>,
) -> Result<T, E> {
    work(store.begin(Access::Read)?.as_mut())
}
