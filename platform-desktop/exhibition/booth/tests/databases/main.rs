//! Runs the tests of the rules over real databases, and tests PostgreSQL, buckets and folders as stores.

#[path = "../common/postgres_server.rs"]
mod postgres_server;
#[path = "../common/s3_server.rs"]
mod s3_server;

mod files;
mod postgres_store;
mod rules;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth::{PostgresAddress, PostgresStore};
use paros_booth_rules::Store;
use paros_booth_sqlite::SqliteStore;

/// The number of random event sequences that a test runs: few, as databases are slow.
pub(crate) const PLAYS: u32 = 12;

/// The environment variable with the PostgreSQL address, for the process that runs the tests of `rules` over
/// it.
pub(crate) const DATABASE: &str = "PAROS_TEST_DATABASE";

/// Makes an empty store: in SQLite, or in PostgreSQL if a database is named.
pub(crate) fn new_store() -> Arc<dyn Store> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    if let Ok(database) = std::env::var(DATABASE) {
        let schema = format!("rules_{number}");
        let mut client =
            postgres::Client::connect(&database, postgres::NoTls).expect("it is there");
        client.batch_execute(&format!("CREATE SCHEMA {schema}")).expect("a new name");
        let address = format!("{database}&options=-csearch_path%3D{schema}");
        let address = PostgresAddress::new(&address, None, None).expect("an address");
        return Arc::new(PostgresStore::open(address).expect("a new schema"));
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("rules-{number}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("room on the disk");
    Arc::new(SqliteStore::open(&folder.join("booth.sqlite")).expect("a new database"))
}
