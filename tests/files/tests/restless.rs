//! Sessions of random visitors, and of visitors with expensive actions, are recorded, and their replay gives
//! the same digests. With `PAROS_STEP_CASES=10` they have the lengths that `.ci/run` replays in the other
//! builds and shells, and in the Android library.

use std::fs;
use std::path::Path;

use paros_core::TickInput;
use paros_core::codec::trace::CORE_VERSION;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, TICK_RATE};
use paros_core::volume::{Grid, Size};
use paros_models::cases::scaled_cases;
use paros_models::hard_work::HardVisitor;
use paros_models::random_visitor::RandomVisitor;
use paros_shell::replay::write_replay_digests;
use paros_shell::statics::Resident;
use paros_shell::tick_runner;

/// Records a session of a random visitor. Returns its trace and the last digest.
fn record_restless<const N: usize, const K: usize>(ticks: u32) -> (Vec<u8>, u64)
where
    Grid<N>: Size + Resident<N, K>,
{
    tick_runner::with_fresh_world::<N, K, _>(|mut runner| {
        runner.start_recording();
        runner.run_tick(&TickInput {
            start: SessionMode::Constrained { figure: 1 },
            ..TickInput::default()
        });
        let mut visitor = RandomVisitor::new(2024);
        (1..ticks).for_each(|_| runner.run_tick(&visitor.next_input()));
        let last_digest = runner.world().digest();
        (runner.end_recording_to_bytes().expect("a recording"), last_digest)
    })
}

/// Returns the trace of visits in which both hands do the most expensive actions of a tick.
fn record_hard_work<const N: usize>(visits: usize) -> Vec<u8>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    tick_runner::with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let figures = [0, 1, 2].map(|figure| SessionMode::Constrained { figure });
        let modes = [SessionMode::FreeForm].into_iter().chain(figures).cycle();
        for (seed, mode) in modes.take(visits).enumerate() {
            let mut visitor = HardVisitor::new(seed as u64);
            visitor.begin_visit(mode).iter().for_each(|input| runner.run_tick(input));
            for tick in 0..45 {
                let input = visitor.next_input(runner.world(), tick);
                runner.run_tick(&input);
            }
        }
        runner.end_recording_to_bytes().expect("a recording")
    })
}

/// Writes a trace for `.ci/run` to replay. In the plain check, where traces are short, also replays it here
/// and returns the digests.
fn write_and_replay(name: &str, trace: &[u8]) -> Option<String> {
    let is_short = scaled_cases(1) == 1;
    let name = if is_short { format!("{name}-short") } else { name.into() };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [path, digests] = ["trace", "digests"].map(|end| folder.join(format!("{name}.{end}")));
    fs::write(&path, trace).expect("room on the disk");
    let _ = fs::remove_file(&digests);
    is_short.then(|| {
        write_replay_digests(&path, &digests).expect("it was just recorded");
        fs::read_to_string(&digests).expect("it was written")
    })
}

/// Records and replays a session. Returns the last digest.
fn check_restless<const N: usize, const K: usize>(name: &str, seconds: u32) -> u64
where
    Grid<N>: Size + Resident<N, K>,
{
    let ticks = scaled_cases(seconds * TICK_RATE);
    let (trace, last_digest) = record_restless::<N, K>(ticks);
    if let Some(digests) = write_and_replay(name, &trace) {
        assert_eq!(digests.lines().count(), ticks as usize);
        let last_line = format!("{last_digest:016x}");
        assert_eq!(digests.lines().last(), Some(&*last_line));
    }
    last_digest
}

#[test]
fn a_restless_minute_leads_to_the_same_digests() {
    check_restless::<128, INTERVALS>("restless", 60);
}

#[test]
#[ignore = "nightly: 15 s"]
fn restless_seconds_at_256_lead_to_the_same_digests() {
    check_restless::<256, INTERVALS>("restless-256", 6);
}

/// Asserts the last digest at this `CORE_VERSION`, for the check's length and for `.ci/run`'s. Raising the
/// version changes both.
fn assert_keeps_digest(last_digest: u64, of_check: u64, ten_times_as_long: u64) {
    let expected = match scaled_cases(1) {
        1 => of_check,
        10 => ten_times_as_long,
        _ => return,
    };
    assert_eq!((last_digest, CORE_VERSION), (expected, 13), "{last_digest:#018x}");
}

#[test]
fn restless_seconds_of_one_interval_keep_their_digest() {
    let last_digest = check_restless::<128, 1>("restless-of-one", 6);
    assert_keeps_digest(last_digest, 0x40a3_35c5_8147_db85, 0x1337_d190_3d37_4a3b);
}

#[test]
#[ignore = "nightly: 15 s"]
fn restless_seconds_of_one_interval_at_256_keep_their_digest() {
    let last_digest = check_restless::<256, 1>("restless-of-one-256", 6);
    assert_keeps_digest(last_digest, 0xd2de_be22_0717_9135, 0x8ef3_b144_e67f_41f1);
}

/// Returns the number of expensive visits: five in the check, 48 for `.ci/run`, which counts the ticks'
/// instructions.
fn hard_visits() -> usize {
    scaled_cases(5).min(48) as usize
}

#[test]
fn hard_work_leads_to_the_same_digests() {
    write_and_replay("ledger-128", &record_hard_work::<128>(hard_visits()));
}

#[test]
#[ignore = "nightly: 20 s"]
fn hard_work_at_256_leads_to_the_same_digests() {
    write_and_replay("ledger-256", &record_hard_work::<256>(hard_visits()));
}
