//! The tables in PostgreSQL, and a table with one row: the tables' version, and the site that owns them.

use paros_booth_rules::records::{SCHEMA, SCHEMA_VERSION};
use postgres::{Client, GenericClient};

/// The key of the advisory lock that serialises the creation of tables: "paros".
const SCHEMA_LOCK: i64 = 0x70_6172_6f73;

/// The site that owns a database's records, and the location of its files. All processes must agree on these.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct SiteRow {
    /// The site's name.
    pub(crate) site: Vec<u8>,
    /// SHA-256 of the authority's certificate.
    pub(crate) ca_hash: Vec<u8>,
    /// The files' location, as on the command line.
    pub(crate) files: String,
}

/// Replacements of the schema's SQLite types by PostgreSQL's. Text is compared byte by byte, as in SQLite.
const WORDS: [(&str, &str); 4] =
    [("INTEGER", "BIGINT"), ("BLOB", "BYTEA"), ("TEXT", "TEXT COLLATE \"C\""), (" STRICT", "")];

/// Makes the tables if there are none. Returns the version of the existing tables.
pub(crate) fn make_tables(client: &mut Client) -> Result<i64, postgres::Error> {
    let mut transaction = client.transaction()?;
    transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&SCHEMA_LOCK])?;
    transaction.batch_execute(
        "CREATE TABLE IF NOT EXISTS paros_booth (
            is_only BOOLEAN PRIMARY KEY DEFAULT true CHECK (is_only), version BIGINT NOT NULL,
            site BYTEA, ca_hash BYTEA, files TEXT)",
    )?;
    if let Some(row) = transaction.query_opt("SELECT version FROM paros_booth", &[])? {
        return row.try_get(0);
    }
    let replace = |schema: String, (here, there): &(&str, &str)| schema.replace(here, there);
    transaction.batch_execute(&WORDS.iter().fold(SCHEMA.to_owned(), replace))?;
    transaction.execute("INSERT INTO paros_booth (version) VALUES ($1)", &[&SCHEMA_VERSION])?;
    transaction.commit()?;
    Ok(SCHEMA_VERSION)
}

/// Reads the site that owns the records, if one has claimed them.
pub(crate) fn read_site(
    client: &mut impl GenericClient,
) -> Result<Option<SiteRow>, postgres::Error> {
    let query = "SELECT site, ca_hash, files FROM paros_booth WHERE site IS NOT NULL";
    let Some(row) = client.query_opt(query, &[])? else { return Ok(None) };
    Ok(Some(SiteRow { site: row.try_get(0)?, ca_hash: row.try_get(1)?, files: row.try_get(2)? }))
}

/// Claims the records for a site, unless one has claimed them. Returns the owner.
pub(crate) fn claim_site(client: &mut Client, site: &SiteRow) -> Result<SiteRow, postgres::Error> {
    let SiteRow { site: name, ca_hash, files } = site;
    let claim = "UPDATE paros_booth SET site = $1, ca_hash = $2, files = $3
        WHERE site IS NULL";
    client.execute(claim, &[name, ca_hash, files])?;
    Ok(read_site(client)?.unwrap_or_else(|| site.clone()))
}
