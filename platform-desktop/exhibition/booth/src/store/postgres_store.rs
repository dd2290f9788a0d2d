//! The store of several booths: a PostgreSQL database with serializable transactions.

use std::collections::HashMap;
use std::error::Error as _;
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use bytes::BytesMut;
use paros_booth_rules::records::SCHEMA_VERSION;
use paros_booth_rules::{Access, Row, Store, StoreError, Transaction, Value, has_nul};
use postgres::error::SqlState;
use postgres::types::{IsNull, ToSql, Type, to_sql_checked};
use postgres::{Client, Statement};

use crate::random::random_bytes;
use crate::store::postgres_link::PostgresAddress;
use crate::store::postgres_schema::{SiteRow, claim_site, make_tables, read_site};

/// The longest random pause after a conflict. A transaction takes a few milliseconds, and two that are
/// retried at once would conflict again.
const MAX_PAUSE_MS: u16 = 16;

/// A store in a PostgreSQL database. Several processes may have it open.
///
/// Within a process, write transactions run one at a time, as with SQLite: concurrent ones would mostly
/// conflict. Between processes, PostgreSQL detects conflicts.
pub struct PostgresStore {
    address: PostgresAddress,
    /// Idle connections: as many as there were concurrent transactions.
    idle: Mutex<Vec<PostgresConnection>>,
    writers: Mutex<()>,
}

/// A connection to the database, with its prepared statements.
struct PostgresConnection {
    client: Client,
    statements: HashMap<String, Statement>,
}

struct PostgresTransaction<'a> {
    store: &'a PostgresStore,
    /// `None` after the transaction has ended.
    link: Option<PostgresConnection>,
    has_conflict: bool,
    /// `true` after a failed call. Then PostgreSQL accepts no more calls, and COMMIT would roll back but
    /// report success.
    has_failed: bool,
    turn: Option<MutexGuard<'a, ()>>,
}

impl PostgresStore {
    /// Connects, and makes the tables if there are none.
    ///
    /// # Errors
    /// PostgreSQL's error, or the tables have another version.
    pub fn open(address: PostgresAddress) -> Result<Self, StoreError> {
        let store = PostgresStore { address, idle: Mutex::default(), writers: Mutex::default() };
        let mut link = store.connect()?;
        let version = make_tables(&mut link.client).map_err(store_error)?;
        store.give_back(link);
        if version == SCHEMA_VERSION { Ok(store) } else { Err(StoreError::OtherVersion(version)) }
    }

    /// Returns the site that owns the records; `None` if no booth has claimed them.
    ///
    /// # Errors
    /// PostgreSQL's error.
    pub(crate) fn site(&self) -> Result<Option<SiteRow>, StoreError> {
        let mut link = self.connect()?;
        let site = read_site(&mut link.client).map_err(store_error)?;
        self.give_back(link);
        Ok(site)
    }

    /// Claims the records for a site, unless one has claimed them. Returns the owner.
    ///
    /// # Errors
    /// PostgreSQL's error.
    pub(crate) fn claim_site(&self, site: &SiteRow) -> Result<SiteRow, StoreError> {
        let mut link = self.connect()?;
        let claimed = claim_site(&mut link.client, site).map_err(store_error)?;
        self.give_back(link);
        Ok(claimed)
    }

    fn connect(&self) -> Result<PostgresConnection, StoreError> {
        let client = self.address.connect().map_err(store_error)?;
        Ok(PostgresConnection { client, statements: HashMap::new() })
    }

    fn give_back(&self, link: PostgresConnection) {
        lock(&self.idle).push(link);
    }

    /// Begins a transaction on an idle connection that still works, or on a new one.
    fn begin_on_link(&self, begin: &str) -> Result<PostgresConnection, StoreError> {
        // `while let` would hold the lock during the loop's body.
        loop {
            let Some(mut link) = lock(&self.idle).pop() else { break };
            match link.client.batch_execute(begin) {
                Ok(()) => return Ok(link),
                Err(error) if is_link_broken(&error, &link.client) => {}
                Err(error) => return Err(store_error(error)),
            }
        }
        let mut link = self.connect()?;
        link.client.batch_execute(begin).map_err(store_error)?;
        Ok(link)
    }
}

impl Store for PostgresStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let (begin, turn) = match access {
            // A read transaction sees a consistent snapshot, and never conflicts.
            Access::Read => ("BEGIN ISOLATION LEVEL REPEATABLE READ, READ ONLY", None),
            Access::Write => {
                ("BEGIN ISOLATION LEVEL SERIALIZABLE, READ WRITE", Some(lock(&self.writers)))
            }
        };
        let link = Some(self.begin_on_link(begin)?);
        let (has_conflict, has_failed) = (false, false);
        Ok(Box::new(PostgresTransaction { store: self, link, has_conflict, has_failed, turn }))
    }
}

impl PostgresTransaction<'_> {
    /// Notes that a call failed. After a conflict, also rolls back.
    fn fail(&mut self, error: postgres::Error) -> StoreError {
        let error = store_error(error);
        self.has_failed = true;
        if matches!(error, StoreError::Conflict) {
            self.has_conflict = true;
            // Lets other transactions run before the retry.
            self.roll_back();
            self.turn = None;
            pause();
        }
        error
    }

    fn roll_back(&mut self) {
        if let Some(mut link) = self.link.take()
            && link.client.batch_execute("ROLLBACK").is_ok()
        {
            self.store.give_back(link);
        }
    }
}

impl Transaction for PostgresTransaction<'_> {
    fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, StoreError> {
        let Some(link) = &mut self.link else {
            return Err(StoreError::Failed("a conflict ended this transaction".into()));
        };
        if values.iter().any(has_nul) {
            return Ok(Vec::new());
        }
        let bound: Vec<PostgresValue<'_>> = values.iter().map(PostgresValue).collect();
        let bound: Vec<_> = bound.iter().map(|value| value as &(dyn ToSql + Sync)).collect();
        let found = link.prepare(sql).and_then(|statement| link.client.query(&statement, &bound));
        let read = |row: &postgres::Row| (0..row.len()).map(|k| read_value(row, k)).collect();
        let rows = found.and_then(|rows| rows.iter().map(read).collect());
        rows.map_err(|error| self.fail(error))
    }

    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        if self.has_conflict {
            return Err(StoreError::Conflict);
        }
        let Some(mut link) = self.link.take_if(|_| !self.has_failed) else {
            return Err(StoreError::Failed("a call of this transaction failed before".into()));
        };
        match link.client.batch_execute("COMMIT") {
            Ok(()) => {
                self.store.give_back(link);
                Ok(())
            }
            Err(error) => {
                self.link = Some(link);
                Err(self.fail(error))
            }
        }
    }

    fn is_in_conflict(&self) -> bool {
        self.has_conflict
    }
}

impl Drop for PostgresTransaction<'_> {
    fn drop(&mut self) {
        self.roll_back();
    }
}

impl PostgresConnection {
    fn prepare(&mut self, sql: &str) -> Result<Statement, postgres::Error> {
        if let Some(statement) = self.statements.get(sql) {
            return Ok(statement.clone());
        }
        let statement = self.client.prepare(&sql.replace('?', "$"))?;
        self.statements.insert(sql.to_owned(), statement.clone());
        Ok(statement)
    }
}

fn read_value(row: &postgres::Row, column: usize) -> Result<Value, postgres::Error> {
    let value = match *row.columns()[column].type_() {
        Type::INT8 => row.try_get::<_, Option<i64>>(column)?.map(Value::Number),
        Type::BYTEA => row.try_get::<_, Option<Vec<u8>>>(column)?.map(Value::Bytes),
        _ => row.try_get::<_, Option<String>>(column)?.map(Value::Text),
    };
    Ok(value.unwrap_or(Value::Null))
}

/// A parameter of a statement.
struct PostgresValue<'a>(&'a Value);

impl ToSql for PostgresValue<'_> {
    fn to_sql(
        &self,
        kind: &Type,
        out: &mut BytesMut,
    ) -> Result<IsNull, Box<dyn std::error::Error + Sync + Send>> {
        match self.0 {
            Value::Null => Ok(IsNull::Yes),
            Value::Number(number) => number.to_sql_checked(kind, out),
            Value::Bytes(bytes) => bytes.to_sql_checked(kind, out),
            Value::Text(text) => text.to_sql_checked(kind, out),
        }
    }

    /// Each value checks its type itself.
    fn accepts(_kind: &Type) -> bool {
        true
    }

    to_sql_checked!();
}

/// An error of the database, with its causes. It never contains the password.
#[derive(Debug)]
struct DatabaseError(postgres::Error);

impl fmt::Display for DatabaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)?;
        let mut source = self.0.source();
        while let Some(why) = source {
            write!(f, ": {why}")?;
            source = why.source();
        }
        Ok(())
    }
}

impl std::error::Error for DatabaseError {}

impl fmt::Debug for PostgresValue<'_> {
    /// Hides the value, as it may be an address.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }
}

/// Converts an error of the database.
fn store_error(error: postgres::Error) -> StoreError {
    let conflicts = [
        SqlState::T_R_SERIALIZATION_FAILURE,
        SqlState::T_R_DEADLOCK_DETECTED,
        SqlState::LOCK_NOT_AVAILABLE,
    ];
    if error.code().is_some_and(|code| conflicts.contains(code)) {
        return StoreError::Conflict;
    }
    StoreError::Failed(Box::new(DatabaseError(error)))
}

/// Returns `true` if a connection is broken, for example after a restart of the database.
fn is_link_broken(error: &postgres::Error, client: &Client) -> bool {
    let is_ending = error.code().is_some_and(|code| code.code().starts_with("57P"));
    is_ending || error.code().is_none() || client.is_closed()
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn pause() {
    let bits = random_bytes::<2>().map_or(MAX_PAUSE_MS, u16::from_le_bytes);
    thread::sleep(Duration::from_millis(u64::from(bits % (MAX_PAUSE_MS + 1))));
}
