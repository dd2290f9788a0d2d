//! Live previews under a host, which run only while a start is chosen.

use std::collections::BTreeSet;
use std::thread;
use std::time::{Duration, Instant};

use paros_core::visit::{Presence, VisitPhase};

use super::{ButtonAction, HostRig, Press, options, with_rig};

/// A timeout longer than any picture takes beside other tests.
const PATIENCE: Duration = Duration::from_secs(60);

/// Goes to the choice, through the welcome.
fn go_to_choice(rig: &mut HostRig<'_, '_>) {
    rig.presence = Presence::Worn;
    rig.wait(2);
    assert!(!rig.host.previews.is_running(), "at the welcome");
    assert!(rig.press(ButtonAction::Press(Press::Confirm)));
    assert_eq!(rig.phase(), VisitPhase::Choice);
}

/// Runs ticks in real time until a condition holds.
fn tick_until(rig: &mut HostRig<'_, '_>, mut is_so: impl FnMut(&mut HostRig<'_, '_>) -> bool) {
    let begun = Instant::now();
    while !is_so(rig) {
        assert!(begun.elapsed() < PATIENCE, "in vain");
        rig.wait(1);
        thread::sleep(Duration::from_millis(2));
    }
}

fn wait_for_pictures(rig: &mut HostRig<'_, '_>) {
    let mut cells = BTreeSet::new();
    tick_until(rig, |rig| {
        rig.host.hand_over_previews(|cell, _| {
            cells.insert(cell);
            true
        });
        cells.len() == options().starts.len()
    });
    assert_eq!(cells.into_iter().collect::<Vec<_>>(), [0, 1, 2]);
}

#[test]
fn previews_live_while_there_is_something_to_choose() {
    with_rig(|rig| {
        go_to_choice(rig);
        assert!(rig.host.previews.is_running());
        wait_for_pictures(rig);
        let before = rig.world().tick();
        rig.wait(30);
        assert_eq!(rig.world().tick(), before + 30, "no tick waits for them");
        assert!(rig.press(ButtonAction::Choose(options().starts[1])));
        assert_eq!(rig.phase(), VisitPhase::Guided);
        assert!(!rig.host.previews.is_open(), "they end with the choice");
        rig.host.hand_over_previews(|cell, _| panic!("a picture for cell {cell}"));
        tick_until(rig, |rig| !rig.host.previews.is_running());
        rig.wait(20);
        assert!(!rig.host.previews.is_running());
    });
}

/// The frame's thread doesn't wait for pictures, neither in a tick nor at the end of the choice: the pictures
/// of these ticks take many times as long.
#[test]
fn a_tick_waits_for_no_picture() {
    with_rig(|rig| {
        go_to_choice(rig);
        wait_for_pictures(rig);
        let (previews, starts) = (&mut rig.host.previews, options().starts);
        let begun = Instant::now();
        (0..1000).for_each(|_| previews.follow_tick(VisitPhase::Choice, &starts));
        previews.follow_tick(VisitPhase::Guided, &starts);
        assert!(previews.is_running(), "it is at its last ticks");
        let taken = begun.elapsed();
        assert!(taken < Duration::from_secs(2), "{taken:?}");
    });
}

/// The thread ends with the host, even in the middle of a choice.
#[test]
fn a_host_leaves_no_thread() {
    with_rig(|rig| {
        go_to_choice(rig);
        wait_for_pictures(rig);
        assert_eq!(count_threads_of_previews(), 1);
        rig.host = super::VisitHost::new(options(), rig.world().visit());
        // The system still lists a thread for a moment after it was joined.
        let begun = Instant::now();
        while count_threads_of_previews() > 0 {
            assert!(begun.elapsed() < PATIENCE, "a thread outlives its host");
            thread::yield_now();
        }
    });
}

/// Counts the threads of previews. Other tests have hosts only while they hold the world, as this test does.
fn count_threads_of_previews() -> usize {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux tells of threads");
    let name = |task: std::io::Result<std::fs::DirEntry>| {
        // A thread that has just ended has no name.
        std::fs::read_to_string(task.ok()?.path().join("comm")).ok()
    };
    tasks.filter_map(name).filter(|name| name.trim() == "previews").count()
}

#[test]
fn one_start_alone_needs_no_preview() {
    with_rig(|rig| {
        rig.host.options.starts.truncate(1);
        rig.presence = Presence::Worn;
        rig.wait(2);
        assert!(rig.press(ButtonAction::Press(Press::Confirm)));
        for _ in 0..20 {
            assert!(!rig.host.previews.is_running());
            rig.wait(1);
        }
        assert_eq!(rig.phase(), VisitPhase::Guided);
    });
}
