//! Tests of the PostgreSQL store.

use std::sync::OnceLock;

use paros_booth::{PostgresAddress, PostgresStore};
use paros_booth_rules::records::{BadgeCursor, Device};
use paros_booth_rules::{Access, BoothTime, Store, StoreError, update, view};

use crate::postgres_server::{PASSWORD, PostgresServer};

/// Returns the server that all tests share.
fn server() -> Option<&'static PostgresServer> {
    static SERVER: OnceLock<Option<PostgresServer>> = OnceLock::new();
    SERVER.get_or_init(|| PostgresServer::start("postgres")).as_ref()
}

fn open(address: &str) -> PostgresStore {
    let address = PostgresAddress::new(address, None, None).expect("an address");
    PostgresStore::open(address).expect("a database")
}

fn client(address: &str) -> postgres::Client {
    postgres::Client::connect(address, postgres::NoTls).expect("a database")
}

fn device(headset: u32) -> Device {
    Device {
        headset,
        token_hash: [1; 32],
        hint: [2; 16],
        name: "Κουέστ".into(),
        enrolled_at: BoothTime(5),
        revoked_at: None,
        wiped_at: None,
        seen_at: None,
        status: vec![1, 0, 2],
    }
}

/// Runs the tests of the rules, in a separate process.
#[test]
fn the_rules_hold_over_postgres_too() {
    let Some(server) = server() else { return };
    let address = server.address_of("public").split("&options").next().map(str::to_owned);
    let done = std::process::Command::new(std::env::current_exe().expect("this program"))
        .args(["rules::", "--test-threads=2"])
        .env(crate::DATABASE, address.expect("an address"))
        .output()
        .expect("this program");
    let told = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success(), "{told}");
    assert!(
        told.contains("rules::upload::a_parcel_is_kept_once_however_often_it_comes ... ok"),
        "{told}"
    );
    let mut client = server.connect().unwrap();
    let schemas = "SELECT count(*) FROM pg_namespace WHERE nspname LIKE 'rules_%'";
    let schemas: i64 = client.query_one(schemas, &[]).unwrap().get(0);
    assert!(schemas > 30, "they ran over something else");
}

#[test]
fn two_that_start_at_once_make_the_tables_once() {
    let Some(server) = server() else { return };
    let address = server.new_schema();
    let stores = std::thread::scope(|scope| {
        [scope.spawn(|| open(&address)), scope.spawn(|| open(&address))]
            .map(|store| store.join().expect("both have the tables"))
    });
    for (number, store) in (1..).zip(&stores) {
        update(store, |tx| tx.put(&device(number))).unwrap();
        let found: Vec<Device> = view(store, |tx| tx.find("", &[])).unwrap();
        assert_eq!(found.len(), number as usize);
    }
}

#[test]
fn another_version_is_left_alone() {
    let Some(server) = server() else { return };
    let address = server.new_schema();
    open(&address);
    let mut other = client(&address);
    for version in [0, 5, 1000] {
        other.execute("UPDATE paros_booth SET version = $1", &[&i64::from(version)]).unwrap();
        other.batch_execute("DROP TABLE IF EXISTS work_leases").unwrap();
        let opened = PostgresStore::open(PostgresAddress::new(&address, None, None).unwrap());
        let error = opened.err().expect("it is another").to_string();
        assert!(error.contains(&format!("version {version}, and")), "{error}");
        assert!(other.query("SELECT 1 FROM work_leases", &[]).is_err(), "a table was made");
    }
}

#[test]
fn a_broken_link_is_made_anew() {
    let Some(server) = server() else { return };
    let address = server.new_schema();
    let store = open(&format!("{address}&application_name=broken"));
    update(&store, |tx| tx.put(&device(1))).unwrap();
    let end_all = || {
        let mut client = client(&address);
        let end = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity
            WHERE application_name = 'broken'";
        assert!(!client.query(end, &[]).unwrap().is_empty(), "nobody was there");
    };
    for headset in 2..5 {
        end_all();
        update(&store, |tx| tx.put(&device(headset))).expect("a new link");
        end_all();
        assert!(view(&store, |tx| tx.get::<Device>(&[&headset])).unwrap().is_some());
    }
    // If the connection breaks during a transaction, it fails and changes nothing.
    let cut = update(&store, |tx| {
        tx.put(&device(9))?;
        end_all();
        tx.put(&device(10))
    });
    assert!(cut.is_err());
    assert_eq!(view(&store, |tx| tx.count::<Device>("", &[])).unwrap(), 4);
}

/// Makes a row with a number, which tests change.
fn cursor(row: u8, turn: u16) -> BadgeCursor {
    BadgeCursor { row, turn, ..BadgeCursor::new() }
}

/// Two processes each change what the other reads. One of them has to retry.
#[test]
fn what_could_not_come_one_after_the_other_is_a_conflict() {
    let Some(server) = server() else { return };
    let address = server.new_schema();
    let (one, two) = (open(&address), open(&address));
    for row in [1u8, 2] {
        update(&one, |tx| tx.put(&cursor(row, 0))).unwrap();
    }
    let mut first = one.begin(Access::Write).unwrap();
    let mut second = two.begin(Access::Write).unwrap();
    let read = |tx: &mut (dyn paros_booth_rules::Transaction + '_), row: u8| {
        tx.get::<BadgeCursor>(&[&row]).unwrap().expect("it was put").turn
    };
    assert_eq!((read(first.as_mut(), 1), read(second.as_mut(), 2)), (0, 0));
    first.put(&cursor(2, 1)).unwrap();
    let put = second.put(&cursor(1, 1));
    first.commit().expect("it was first");
    let lost = put.and_then(|()| second.commit());
    assert!(matches!(lost, Err(StoreError::Conflict)), "{lost:?}");
}

/// Processes increment the same number. No increment is lost, though they conflict all the time.
#[test]
fn processes_count_in_turn() {
    const PROCESSES: usize = 3;
    const COUNTS: usize = 25;
    let Some(server) = server() else { return };
    let address = server.new_schema();
    let first = open(&address);
    update(&first, |tx| tx.put(&cursor(0, 0))).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..PROCESSES {
            scope.spawn(|| {
                let store = open(&address);
                for _ in 0..COUNTS {
                    let counted: Result<(), StoreError> = update(&store, |tx| {
                        let found = tx.get::<BadgeCursor>(&[&0u8])?;
                        let found = found.expect("it was put");
                        tx.put(&cursor(0, found.turn + 1))
                    });
                    counted.expect("it is tried again");
                }
            });
        }
    });
    let found = view(&first, |tx| tx.get::<BadgeCursor>(&[&0u8])).unwrap();
    assert_eq!(usize::from(found.expect("it was put").turn), PROCESSES * COUNTS);
}

/// The error of a call can't be ignored: PostgreSQL would roll back at COMMIT, but report success.
#[test]
fn nothing_is_committed_after_a_failure() {
    let Some(server) = server() else { return };
    let address = server.new_schema();
    let store = open(&address);
    let done: Result<(), StoreError> = update(&store, |tx| {
        tx.put(&device(1))?;
        // A value of the wrong type.
        let _ = tx.get::<Device>(&[&"one"]);
        Ok(())
    });
    assert!(done.is_err());
    assert_eq!(view(&store, |tx| tx.count::<Device>("", &[])).unwrap(), 0);
}

#[test]
fn over_the_network_certificate_and_password_are_checked() {
    let Some(server) = server() else { return };
    let address = server.address_by_tls();
    let connect = |password: &str, ca: &std::path::Path| {
        let file = server.folder().join(format!("password-{}", password.len()));
        std::fs::write(&file, format!("{password}\nanything\n")).unwrap();
        let address = PostgresAddress::new(&address, Some(&file), Some(ca)).expect("files");
        PostgresStore::open(address).map(drop).map_err(|error| error.to_string())
    };
    connect(PASSWORD, &server.ca_file()).expect("the right ones");
    let error = connect("hunter2", &server.ca_file()).unwrap_err();
    assert!(error.contains("password authentication failed"), "{error}");
    assert!(!error.contains("hunter2"), "{error}");
    let other = server.folder().join("other.crt");
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    std::fs::write(&other, made.cert.pem()).unwrap();
    let error = connect(PASSWORD, &other).unwrap_err();
    assert!(error.contains("certificate"), "{error}");
}
