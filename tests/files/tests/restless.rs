//! Sessions of restless visitors, and of those whose work is hard, are recorded and lead to the same digests
//! when they are played again.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use paros_core::TickInput;
use paros_core::codec::trace::CORE_VERSION;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, TICK_RATE};
use paros_core::volume::{Grid, Size};
use paros_models::hard_work::HardVisitor;
use paros_models::random_visitor::RandomVisitor;
use paros_shell::replay::write_replay_digests;
use paros_shell::statics::Resident;
use paros_shell::tick_runner;

/// The one world of the process is recorded and played by one test after the other.
static TURN: Mutex<()> = Mutex::new(());

/// Ten minutes.
const TICKS: u32 = 600 * TICK_RATE;

/// A session of so many ticks of a restless visitor.
fn record_restless<const N: usize, const K: usize>(ticks: u32) -> Vec<u8>
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
        runner.end_recording_to_bytes().expect("a recording")
    })
}

/// Visits of both hands that do what costs a tick most.
fn record_hard_work<const N: usize>() -> Vec<u8>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    tick_runner::with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let figures = [0, 1, 2].map(|figure| SessionMode::Constrained { figure });
        let modes = [SessionMode::FreeForm].into_iter().chain(figures).cycle();
        for (seed, mode) in modes.take(48).enumerate() {
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

/// Writes a trace, and returns it and where its digests go.
fn write_trace(name: &str, bytes: &[u8]) -> [PathBuf; 2] {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [trace, digests] = ["trace", "digests"].map(|end| folder.join(format!("{name}.{end}")));
    fs::write(&trace, bytes).expect("room on the disk");
    let _ = fs::remove_file(&digests);
    [trace, digests]
}

/// `.ci/run` plays what this leaves in the other builds and shells, and on Android's library.
#[test]
fn ten_restless_minutes_lead_to_the_same_digests() {
    leads_to_the_same_digests::<128, INTERVALS>("restless", TICKS);
}

/// Its ticks are counted there.
#[test]
fn a_restless_minute_at_256_leads_to_the_same_digests() {
    leads_to_the_same_digests::<256, INTERVALS>("restless-256", TICKS / 10);
}

/// Digests at this `CORE_VERSION`: what raises that changes them.
#[test]
fn restless_minutes_of_one_interval_keep_their_digests() {
    let last = leads_to_the_same_digests::<128, 1>("restless-of-one", TICKS / 10);
    assert_eq!((last.as_str(), CORE_VERSION), ("1337d1903d374a3b", 13));
    let last = leads_to_the_same_digests::<256, 1>("restless-of-one-256", TICKS / 10);
    assert_eq!((last.as_str(), CORE_VERSION), ("8ef3b144e67f41f1", 13));
}

/// The ticks of these are counted there too: none may take more than a tick may.
#[test]
fn hard_work_leads_to_the_same_digests() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let [of_128, of_256] = [record_hard_work::<128>(), record_hard_work::<256>()];
    for (name, bytes) in [("ledger-128", of_128), ("ledger-256", of_256)] {
        let [trace, digests] = write_trace(name, &bytes);
        write_replay_digests(&trace, &digests).expect("it was just recorded");
    }
}

/// Returns the last tick's digest.
fn leads_to_the_same_digests<const N: usize, const K: usize>(name: &str, ticks: u32) -> String
where
    Grid<N>: Size + Resident<N, K>,
{
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let [trace, digests] = write_trace(name, &record_restless::<N, K>(ticks));
    write_replay_digests(&trace, &digests).expect("it was just recorded");
    let digests = fs::read_to_string(&digests).expect("it was written");
    assert_eq!(digests.lines().count(), ticks as usize);
    digests.lines().last().expect("a tick").into()
}
