//! `paros play` from a user's view: a trace is replayed, and a failed replay leaves no files.

use std::fs;
use std::process::Output;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool, commands};
use paros_core::{HandInput, TickInput};
use paros_shell::require::require_or_skip;
use paros_shell::tick_runner;

use crate::support::TestFolder;

/// Creates a folder with `t.trace`, forty ticks of a session, `bad.trace`, whose last digest is wrong, and
/// `empty.trace`, in which no session starts.
fn folder(name: &str) -> TestFolder {
    let folder = TestFolder::new(&format!("play-{name}"));
    let recorded = |first: TickInput, more: usize| {
        tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
            runner.start_recording();
            runner.run_tick(&first);
            (0..more).for_each(|_| runner.run_tick(&TickInput::default()));
            runner.end_recording_to_bytes().unwrap()
        })
    };
    folder.write("empty.trace", recorded(TickInput::default(), 0));
    let mut bytes =
        recorded(TickInput { start: SessionMode::FreeForm, ..TickInput::default() }, 39);
    folder.write("t.trace", &bytes);
    *bytes.last_mut().unwrap() ^= 1;
    folder.write("bad.trace", bytes);
    folder
}

fn play(folder: &TestFolder, args: &[&str]) -> Output {
    folder.paros(&[&["play"], args].concat())
}

#[track_caller]
fn refuses(folder: &TestFolder, args: &[&str], word: &str) {
    folder.refuses(&[&["play"], args].concat(), word);
}

#[test]
fn a_trace_replays() {
    let folder = folder("replays");
    let args = ["t.trace", "--digests", "d", "--stl", "s.stl", "--frames", "f"];
    let output = play(&folder, &args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(folder.0.join("d")).unwrap().lines().count(), 40);
    assert!(fs::metadata(folder.0.join("s.stl")).unwrap().len() > 84);
    assert_eq!(fs::read_dir(folder.0.join("f")).unwrap().count(), 2);
}

#[test]
fn what_can_not_be_played_leaves_nothing() {
    let folder = folder("refuses");
    refuses(
        &folder,
        &["bad.trace", "--digests", "d", "--stl", "s"],
        "tick 39: another state of islands (",
    );
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "d"], "two outputs");
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "./d"], "two outputs");
    refuses(&folder, &["t.trace", "--digests", "t.trace"], "t.trace");
    let word = "empty.trace: nothing is left to print";
    refuses(&folder, &["empty.trace", "--digests", "d", "--stl", "s"], word);
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "none/s"], "none");
    refuses(&folder, &["t.trace", "--volume", "bad.trace", "--digests", "bad.trace"], "bad.trace");
    folder.write("cut.trace", &folder.read("t.trace")[..1000]);
    refuses(&folder, &["cut.trace", "--frames", "f"], "cut.trace");
}

/// Writes `cut.trace`: a ball and its mirror image cut at an angle into the stone, where a column of one
/// interval keeps no hole, and then straight down. Returns the sums over its edits: removed, added, and
/// refused by closure, mask, depth.
fn record_cuts(folder: &TestFolder) -> [u64; 5] {
    let mut sums = [0; 5];
    let bytes = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let start = SessionMode::FreeForm;
        runner.run_tick(&TickInput { start, ..TickInput::default() });
        let item = BenchItem::Tool(Tool::Rotary).number() as u8;
        let pointer = PointerCommand::Take { hand: 1, item };
        runner.run_tick(&TickInput { pointer, commands: commands::SYMMETRY, ..Default::default() });
        let aslant = |depth| Vec3::new(100.0 - 0.6 * depth, 118.0 - depth, 90.0 - 0.7 * depth);
        let down = |depth| Vec3::new(64.0, 132.0 - depth, 64.0);
        for tick in 0..400 {
            let depth = 0.3 * (tick % 200) as f32;
            let position = if tick < 200 { aslant(depth) } else { down(depth) };
            let bit = Pose { position, rotation: Quat::IDENTITY };
            let mut input = TickInput::default();
            input.hands[1] = HandInput { trigger: 255, ..runner.world().hand_with_bit_at(1, &bit) };
            runner.run_tick(&input);
            let report = runner.world().edit_report(1);
            let counts = [
                report.removed,
                report.added + report.closed,
                report.refused_by_closure,
                report.refused_by_mask,
                report.refused_by_depth,
            ];
            sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += u64::from(count));
        }
        runner.end_recording_to_bytes().unwrap()
    });
    folder.write("cut.trace", bytes);
    sums
}

#[test]
fn the_edits_of_a_session_are_told() {
    let folder = folder("stats");
    let sums = record_cuts(&folder);
    let [removed, added, by_closure, by_mask, by_depth] = sums;
    assert!(removed > 1000 && added == 0, "{sums:?}");
    assert!(by_depth > 0, "{sums:?}");
    let said = |args: &[&str]| {
        let output = play(&folder, args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let plain = said(&["cut.trace"]);
    let stats = said(&["cut.trace", "--stats"]);
    let whole = removed + by_closure + by_mask + by_depth;
    let lines: Vec<_> = stats.strip_prefix(&plain).expect("the same and more").lines().collect();
    let names = ["removed", "added", "refused by closure", "refused by mask", "refused by depth"];
    for ((line, name), sum) in lines.iter().zip(names).zip(sums) {
        let fields = line.strip_prefix(name).unwrap_or_else(|| panic!("{name}: {line}"));
        let mut fields = fields.split_whitespace();
        assert_eq!(fields.next(), Some(&sum.to_string()[..]), "{line}");
        let percent = format!("{:.1}", 100.0 * sum as f64 / whole as f64);
        assert_eq!(fields.next(), (name != "added").then_some(&percent[..]), "{line}");
    }
    assert_eq!(lines.len(), 5);
    let told: serde_json::Value =
        serde_json::from_str(&said(&["cut.trace", "--stats", "--json"])).unwrap();
    assert_eq!(told["added"], added);
    for (name, sum) in names.into_iter().zip(sums).filter(|(name, _)| *name != "added") {
        let share = &told[name.replace(' ', "_")];
        assert_eq!(share["voxels"], sum, "{name}");
        let percent = 100.0 * sum as f64 / whole as f64;
        assert!((share["percent"].as_f64().unwrap() - percent).abs() < 1e-9, "{name}");
    }
    refuses(&folder, &["cut.trace", "--json"], "--stats");
}

/// Standard error can't be written, but the exit code is still right.
#[test]
fn an_unwritable_standard_error_is_no_panic() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full");
    let Some(full) = require_or_skip(full.map_err(|e| format!("/dev/full: {e}"))).unwrap() else {
        return;
    };
    let folder = TestFolder::new("play-unwritable");
    let status = folder.command(&["info", "no.rmap"]).stderr(full).status().unwrap();
    assert_eq!(status.code(), Some(2));
}
