//! Kills booth and shell at random, and checks that the visitors' messages stay true.

use std::collections::BTreeSet;
use std::io::{BufRead as _, BufReader};
use std::net::TcpListener;
use std::thread;
use std::time::Duration;

use paros_booth_process::find_booth;
use paros_models::random_visitor::RandomSource;

use crate::rig::{Place, Told};

/// Number of kills of each program, overridden by `PAROS_KILLS`.
const KILLS: u32 = 6;

/// Visits that a shell is started with: more than it can finish before it is killed.
const VISITS: u32 = 50;

/// Finds a free port outside the range of ephemeral ports, so that no other program gets it while the booth
/// is dead.
fn find_kept_place() -> String {
    let mut ports = 20_000..30_000;
    let is_free = |port: &u16| TcpListener::bind(("127.0.0.1", *port)).is_ok();
    format!("127.0.0.1:{}", ports.find(is_free).expect("a free port"))
}

#[test]
fn killed_at_any_moment_nothing_that_was_kept_is_lost_and_nothing_is_kept_twice() {
    let Some(program) = find_booth() else { return };
    let kills = std::env::var("PAROS_KILLS").ok().and_then(|kills| kills.parse().ok());
    let kills: u32 = kills.unwrap_or(KILLS);
    let place = Place::new("kills", program);
    let listen = find_kept_place();
    let mut booth = place.start_booth_at(&listen);
    place.enrol_by_fleet_file(&booth);
    let mut dice = RandomSource::new(u64::from(kills));
    let mut told = Told::default();
    for round in 0..kills {
        let mut shell = place.start_shell(VISITS, u64::from(round));
        let lines = BufReader::new(shell.stdout.take().expect("a pipe")).lines();
        let reading = thread::spawn(move || lines.map_while(Result::ok).collect::<Vec<_>>());
        let [first, second] = [dice.below(1500), dice.below(300)].map(Duration::from_millis);
        let is_booth_first = dice.one_in(2);
        thread::sleep(first);
        if is_booth_first {
            booth.kill();
        } else {
            shell.kill().expect("it runs");
        }
        thread::sleep(second);
        if is_booth_first {
            shell.kill().expect("it runs");
        } else {
            booth.kill();
        }
        shell.wait().expect("it ends");
        booth = place.start_booth_at(&listen);
        reading.join().expect("lines").iter().for_each(|line| told.add(line));
    }
    // A last shell, which isn't killed, uploads the rest.
    let last = place.run_shell_to_the_end(1, u64::from(kills));
    told.kept.extend(last.kept);
    let parcels = place.parcels_at_booth();
    let ids: BTreeSet<_> = parcels.iter().map(|(facts, _)| facts.id.to_string()).collect();
    let lost: Vec<_> = told.kept.iter().filter(|id| !ids.contains(*id)).collect();
    assert!(lost.is_empty(), "kept and lost: {lost:?}");
    // Each visit makes a different cut, so equal volumes mean that a sculpture was stored twice.
    let volumes: BTreeSet<_> = parcels.iter().map(|(_, volume)| volume).collect();
    assert_eq!(volumes.len(), parcels.len(), "kept twice");
    assert!(parcels.len() as u32 > kills / 20, "they were hardly ever alive: {}", parcels.len());
    let (kept, came) = (told.kept.iter().collect::<BTreeSet<_>>().len(), parcels.len());
    println!("{kills} kills of each, {kept} told kept, {came} at the booth");
}
