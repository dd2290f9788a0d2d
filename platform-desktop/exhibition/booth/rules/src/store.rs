//! Where records are kept: a database of transactions, of which this crate needs to know no more than this.

use crate::table::{Record, Row, Table};
use crate::value::{Field, Value};

/// How often [`update`] tries work that is in conflict with another transaction's.
const MOST_TRIES: u32 = 16;

/// A database with the tables of [`TABLES`](crate::records::TABLES).
pub trait Store: Send + Sync {
    /// Begins a transaction. It sees what was committed before, and its own changes; nobody sees these before they are
    /// committed. Dropped, it leaves no trace. Transactions that are committed are as if one came after the other.
    ///
    /// # Errors
    /// What the database says.
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError>;
}

/// What a transaction may do.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Access {
    /// Look. Nothing is ever committed.
    Read,
    /// Change.
    Write,
}

/// A transaction of a [`Store`].
pub trait Transaction {
    /// The row of a key.
    ///
    /// # Errors
    /// What the database says.
    fn get_row(&mut self, table: &'static Table, key: &[Value]) -> Result<Option<Row>, StoreError>;

    /// Rows, in the query's order.
    ///
    /// # Errors
    /// What the database says.
    fn find_rows(&mut self, query: &Query) -> Result<Vec<Row>, StoreError>;

    /// How many rows a query finds, without regard to its limit.
    ///
    /// # Errors
    /// What the database says.
    fn count_rows(&mut self, query: &Query) -> Result<u64, StoreError>;

    /// Keeps a row, instead of that with its key if there is one.
    ///
    /// # Errors
    /// What the database says, as that this transaction may only read.
    fn put_row(&mut self, table: &'static Table, row: Row) -> Result<(), StoreError>;

    /// Removes the row of a key, if there is one.
    ///
    /// # Errors
    /// What the database says, as that this transaction may only read.
    fn remove_row(&mut self, table: &'static Table, key: &[Value]) -> Result<(), StoreError>;

    /// Makes all changes at once. They outlive a power cut from when this returns.
    ///
    /// # Errors
    /// What the database says. Then nothing was changed; or, where the link to it broke, all or nothing.
    fn commit(self: Box<Self>) -> Result<(), StoreError>;

    /// Whether a call failed with [`StoreError::Conflict`], after which it can't be committed any more. Never, where
    /// no other transaction changes anything meanwhile.
    fn is_in_conflict(&self) -> bool {
        false
    }
}

/// Which rows to find.
#[derive(Clone, Debug)]
pub struct Query {
    /// Where.
    pub table: &'static Table,
    /// All of these hold.
    pub conditions: Vec<Condition>,
    /// By which column the rows are ordered, and then by their key.
    pub order: Option<(&'static str, RowOrder)>,
    /// How many are found at most.
    pub limit: usize,
}

/// What holds of a column: its name, and the value that it is compared with. Nothing compares with [`Value::Null`]
/// but by [`Condition::Equal`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Condition {
    /// It is this, or holds nothing where this is [`Value::Null`].
    Equal(&'static str, Value),
    /// It is less than this.
    Below(&'static str, Value),
    /// It is this or more.
    AtLeast(&'static str, Value),
    /// It holds something.
    Present(&'static str),
}

/// Which rows come first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RowOrder {
    /// Those of the least.
    Ascending,
    /// Those of the greatest.
    Descending,
}

/// Why a store failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Another transaction changed what this one is about: it is tried again.
    #[error("others changed the same records too often")]
    Conflict,
    /// A row that was kept is no record.
    #[error("table {table}, column {column}: a value that was never kept there")]
    BadRow {
        /// Where.
        table: &'static str,
        /// What of it.
        column: &'static str,
    },
    /// What the database says.
    #[error("the database: {0}")]
    Failed(Box<dyn std::error::Error + Send + Sync>),
}

impl Query {
    /// All rows of records of a type.
    #[must_use]
    pub fn all<R: Record>() -> Self {
        Query { table: R::TABLE, conditions: Vec::new(), order: None, limit: usize::MAX }
    }

    /// Those of them that have this in a column.
    #[must_use]
    pub fn equal(mut self, column: &'static str, value: &impl Field) -> Self {
        self.conditions.push(Condition::Equal(column, value.to_value()));
        self
    }

    /// Those of them that hold nothing in a column.
    #[must_use]
    pub fn absent(mut self, column: &'static str) -> Self {
        self.conditions.push(Condition::Equal(column, Value::Null));
        self
    }

    /// Those of them that hold something in a column.
    #[must_use]
    pub fn present(mut self, column: &'static str) -> Self {
        self.conditions.push(Condition::Present(column));
        self
    }

    /// Those of them that have less than this in a column.
    #[must_use]
    pub fn below(mut self, column: &'static str, value: &impl Field) -> Self {
        self.conditions.push(Condition::Below(column, value.to_value()));
        self
    }

    /// Those of them that have this or more in a column.
    #[must_use]
    pub fn at_least(mut self, column: &'static str, value: &impl Field) -> Self {
        self.conditions.push(Condition::AtLeast(column, value.to_value()));
        self
    }

    /// In this order.
    #[must_use]
    pub fn ordered(mut self, column: &'static str, order: RowOrder) -> Self {
        self.order = Some((column, order));
        self
    }

    /// The first `count` of them.
    #[must_use]
    pub fn first(mut self, count: usize) -> Self {
        self.limit = count;
        self
    }
}

impl dyn Transaction + '_ {
    /// The record of a key, which has the fields that the table's key has.
    ///
    /// # Errors
    /// What the database says, or that the row is no such record.
    pub fn get<R: Record>(&mut self, key: &[Value]) -> Result<Option<R>, StoreError> {
        self.get_row(R::TABLE, key)?.as_deref().map(read_record).transpose()
    }

    /// The records that a query finds. Its table is theirs.
    ///
    /// # Errors
    /// What the database says, or that a row is no such record.
    pub fn find<R: Record>(&mut self, query: &Query) -> Result<Vec<R>, StoreError> {
        self.find_rows(query)?.iter().map(|row| read_record(row)).collect()
    }

    /// The first record that a query finds.
    ///
    /// # Errors
    /// What the database says, or that the row is no such record.
    pub fn find_first<R: Record>(&mut self, query: Query) -> Result<Option<R>, StoreError> {
        Ok(self.find(&query.first(1))?.pop())
    }

    /// Keeps a record, instead of that with its key if there is one.
    ///
    /// # Errors
    /// What the database says.
    pub fn put<R: Record>(&mut self, record: &R) -> Result<(), StoreError> {
        self.put_row(R::TABLE, record.to_row())
    }

    /// Removes the record of a key, if there is one.
    ///
    /// # Errors
    /// What the database says.
    pub fn remove<R: Record>(&mut self, key: &[Value]) -> Result<(), StoreError> {
        self.remove_row(R::TABLE, key)
    }
}

/// Does work in a transaction, which is committed if the work succeeds, and tried again where another one was in
/// its way.
///
/// # Errors
/// The work's, or the store's. Then nothing was changed.
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
            // What the work makes of a conflict doesn't count: it saw what it couldn't change.
            Err(_) if transaction.is_in_conflict() && tries < MOST_TRIES => {}
            Err(error) => return Err(error),
        }
        tries += 1;
    }
}

/// Looks at what a store holds.
///
/// # Errors
/// The work's, or the store's.
pub fn view<T, E: From<StoreError>>(
    store: &dyn Store,
    work: impl FnOnce(&mut (dyn Transaction + '_)) -> Result<T, E>,
) -> Result<T, E> {
    work(store.begin(Access::Read)?.as_mut())
}

fn read_record<R: Record>(row: &[Value]) -> Result<R, StoreError> {
    R::from_row(row).map_err(|column| StoreError::BadRow { table: R::TABLE.name, column })
}
