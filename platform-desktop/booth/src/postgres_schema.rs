//! The tables of PostgreSQL: made of the records themselves, and of a table of one row that says of which version they
//! are, and whose.

use paros_booth_rules::records::TABLES;
use paros_booth_rules::{Column, ColumnKind, StoreError, Table};
use postgres::{Client, GenericClient};

use crate::migrations::VERSION;
use crate::sqlite_store::{name, quote};

/// What processes lock that make tables at once: "paros".
const MIGRATION_LOCK: i64 = 0x70_6172_6f73;

/// Whose records a database has, and where their files are: what all processes have to agree upon.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct SiteRow {
    /// The site's name.
    pub(crate) site: Vec<u8>,
    /// By which receipts are checked.
    pub(crate) receipt_key: Vec<u8>,
    /// SHA-256 of the authority's certificate.
    pub(crate) ca_hash: Vec<u8>,
    /// As the command line names it.
    pub(crate) files: String,
}

/// Brings a database to this program's version. Tables and columns that are missing are made; columns are empty then,
/// or 0. What does more than that in SQLite needs a step of its own here too.
///
/// # Errors
/// What PostgreSQL says, or that a newer program made the tables. They are as they were then.
pub(crate) fn migrate(client: &mut Client) -> Result<(), MigrationError> {
    let mut transaction = client.transaction()?;
    transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&MIGRATION_LOCK])?;
    transaction.batch_execute(
        "CREATE TABLE IF NOT EXISTS paros_booth (
            is_only BOOLEAN PRIMARY KEY DEFAULT true CHECK (is_only), version BIGINT NOT NULL,
            site BYTEA, receipt_key BYTEA, ca_hash BYTEA, files TEXT)",
    )?;
    let row = transaction.query_opt("SELECT version FROM paros_booth", &[])?;
    let version = row.map(|row| row.try_get::<_, i64>(0)).transpose()?;
    match version {
        Some(version) if version == VERSION => return Ok(()),
        Some(version) if version > VERSION => {
            let why =
                format!("its tables have version {version}; this program knows up to {VERSION}");
            return Err(MigrationError::Other(StoreError::Failed(why.into())));
        }
        Some(_) | None => {}
    }
    for table in TABLES {
        make_table(&mut transaction, table)?;
    }
    let note = "INSERT INTO paros_booth (version) VALUES ($1)
        ON CONFLICT (is_only) DO UPDATE SET version = EXCLUDED.version";
    transaction.execute(note, &[&VERSION])?;
    Ok(transaction.commit()?)
}

/// The site whose records these are, if one has claimed them.
pub(crate) fn read_site(
    client: &mut impl GenericClient,
) -> Result<Option<SiteRow>, postgres::Error> {
    let query = "SELECT site, receipt_key, ca_hash, files FROM paros_booth WHERE site IS NOT NULL";
    let Some(row) = client.query_opt(query, &[])? else { return Ok(None) };
    Ok(Some(SiteRow {
        site: row.try_get(0)?,
        receipt_key: row.try_get(1)?,
        ca_hash: row.try_get(2)?,
        files: row.try_get(3)?,
    }))
}

/// Claims the records for a site unless one has, and returns whose they are.
pub(crate) fn claim_site(client: &mut Client, site: &SiteRow) -> Result<SiteRow, postgres::Error> {
    let SiteRow { site: name, receipt_key, ca_hash, files } = site;
    let claim = "UPDATE paros_booth SET site = $1, receipt_key = $2, ca_hash = $3, files = $4
        WHERE site IS NULL";
    client.execute(claim, &[name, receipt_key, ca_hash, files])?;
    Ok(read_site(client)?.unwrap_or_else(|| site.clone()))
}

/// Why tables could not be made.
pub(crate) enum MigrationError {
    /// What PostgreSQL says.
    Database(postgres::Error),
    /// Anything else.
    Other(StoreError),
}

impl MigrationError {
    /// As a store's error, where PostgreSQL's are made one.
    pub(crate) fn or_else(self, make: impl FnOnce(postgres::Error) -> StoreError) -> StoreError {
        match self {
            MigrationError::Database(error) => make(error),
            MigrationError::Other(error) => error,
        }
    }
}

impl From<postgres::Error> for MigrationError {
    fn from(error: postgres::Error) -> Self {
        MigrationError::Database(error)
    }
}

fn make_table(client: &mut impl GenericClient, table: &Table) -> Result<(), postgres::Error> {
    let key: Vec<String> =
        table.columns[..table.key_columns].iter().map(|column| quote(column.name)).collect();
    let columns: Vec<String> = table.columns.iter().map(write_column).collect();
    let mut script = format!(
        "CREATE TABLE IF NOT EXISTS {} ({}, PRIMARY KEY ({}));",
        name(table),
        columns.join(", "),
        key.join(", ")
    );
    for column in &columns {
        script += &format!("ALTER TABLE {} ADD COLUMN IF NOT EXISTS {column};", name(table));
    }
    for column in table.indexed {
        let index = quote(&format!("{}_{column}", table.name));
        script +=
            &format!("CREATE INDEX IF NOT EXISTS {index} ON {} ({});", name(table), quote(column));
    }
    client.batch_execute(&script)
}

/// A column with what it holds in rows that were there before it.
fn write_column(column: &Column) -> String {
    let (kind, default) = match column.kind {
        ColumnKind::Number => ("BIGINT", "0"),
        ColumnKind::Bytes => ("BYTEA", r"''"),
        // Compared byte by byte, as everywhere else.
        ColumnKind::Text => ("TEXT COLLATE \"C\"", "''"),
    };
    let rest =
        if column.is_nullable { String::new() } else { format!(" NOT NULL DEFAULT {default}") };
    format!("{} {kind}{rest}", quote(column.name))
}
