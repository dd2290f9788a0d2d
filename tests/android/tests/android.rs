//! The Android library gives the same digests as the host, under qemu and glibc.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{env, fs};

use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::{Grid, Size};
use paros_models::random_visitor::RandomVisitor;
use paros_shell::replay::write_replay_digests;
use paros_shell::require::require_or_skip;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::tick_runner;
use paros_tests_android::check_parts;

/// Serialises the tests: the process has one world for recording and replaying, and timed runs must not share
/// the host with another emulated program.
pub(crate) static TURN: Mutex<()> = Mutex::new(());

/// Replays a trace on the Android library, which `cargo run -p paros-package` builds.
fn replay_on_android(trace: &Path, digests_out: &Path) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bionic/replay");
    Command::new("bash").arg(script).args([trace, digests_out]).output().expect("bash starts")
}

/// Records a session of a random visitor.
fn record_random_session<const N: usize>(ticks: u32) -> Vec<u8>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    tick_runner::with_fresh_world::<N, INTERVALS, _>(|mut stage| {
        stage.start_recording();
        stage.run_tick(&TickInput {
            start: SessionMode::Constrained { figure: 1 },
            ..TickInput::default()
        });
        let mut visitor = RandomVisitor::new(2024);
        (1..ticks).for_each(|_| stage.run_tick(&visitor.next_input()));
        stage.end_recording_to_bytes().expect("a recording")
    })
}

/// Locks the world in which traces are replayed on the host.
fn replayed_world() -> MutexGuard<'static, WorldWithStarts<128, INTERVALS>> {
    Grid::<128>::lock_world()
}

/// The paths of a trace and of the digests of its replay.
struct ReplayFiles {
    trace: PathBuf,
    digests: PathBuf,
}

/// Writes a trace of a random visitor's session.
fn write_random_trace<const N: usize>(name: &str, ticks: u32) -> ReplayFiles
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [trace, digests] = ["trace", "digests"].map(|end| folder.join(format!("{name}.{end}")));
    fs::write(&trace, record_random_session::<N>(ticks)).expect("room on the disk");
    let _ = fs::remove_file(&digests);
    ReplayFiles { trace, digests }
}

#[test]
fn a_replay_writes_a_digest_for_each_tick_or_nothing() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let ReplayFiles { trace, digests } = write_random_trace::<128>("short", 200);
    write_replay_digests(&trace, &digests).expect("it was just recorded");
    let written = fs::read_to_string(&digests).expect("it was written");
    assert_eq!(written.lines().count(), 200);
    let last = format!("{:016x}", replayed_world().world.digest());
    assert_eq!(written.lines().last(), Some(&*last));

    fs::remove_file(&digests).expect("it was written");
    let mut bytes = fs::read(&trace).expect("it was written");
    // Corrupts the last digest of the trace.
    *bytes.last_mut().expect("a trace") ^= 1;
    fs::write(&trace, bytes).expect("room on the disk");
    let why = write_replay_digests(&trace, &digests).expect_err("it is another trace").to_string();
    let part = replayed_world().world.part_digests().last().expect("some parts").0;
    assert!(why.contains(&format!("tick 199: another state of {part} (")), "{why}");
    assert!(!digests.exists());
    if require_or_skip(check_parts(&[])).expect("the package is made before the tests").is_some() {
        let output = replay_on_android(&trace, &digests);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(String::from_utf8_lossy(&output.stderr).trim_end(), why);
        assert!(!digests.exists());
    }
}
