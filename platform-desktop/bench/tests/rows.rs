//! Rows of the benchmarks that need no device.

use std::cell::RefCell;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use paros_bench::{Benchmark, Plan};
use paros_core::limits::INTERVALS;
use paros_core::volume::{BitGrid, BitSet, Grid};
use paros_core::{RangeMaps, TickInput};
use paros_shell::figures::Figure;
use paros_shell::require::require_or_skip;
use paros_shell::rmap;
use paros_shell::start_volume_store::StartVolume;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::tick_runner;
use serde_json::Value;

use crate::bench_command;

fn bench(args: &[&str]) -> Output {
    bench_command(args).output().unwrap()
}

fn rows(args: &[&str]) -> Vec<Value> {
    let output = bench(args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert!(!rows.is_empty());
    for row in &rows {
        for key in ["bench", "volume", "size", "ours_ms", "against", "against_ms", "ratio"] {
            assert!(row.get(key).is_some(), "no {key} in {row}");
        }
    }
    rows
}

#[test]
fn rows_have_all_keys_and_the_ratio_is_theirs_over_ours() {
    let rows = rows(&["islands", "--volume", "toy", "--runs", "1", "--json"]);
    for size in [128, 256] {
        assert_eq!(rows.iter().filter(|row| row["size"] == size).count(), 4);
    }
    for row in &rows {
        assert_eq!((&row["bench"], &row["volume"]), (&"islands".into(), &"toy".into()));
        let [ours, theirs, ratio] =
            ["ours_ms", "against_ms", "ratio"].map(|key| row[key].as_f64().unwrap());
        assert!(ours > 0.0 && theirs > 0.0);
        assert!((ratio * ours / theirs - 1.0).abs() < 1e-9, "{row}");
    }
}

#[test]
fn a_missing_rival_leaves_its_half_empty_and_says_so() {
    let args = ["mesh", "--volume", "toy", "--runs", "1", "--json", "--python", "no-such-python"];
    for row in rows(&args) {
        assert!(row["ours_ms"].as_f64().unwrap() > 0.0);
        assert!(row["against_ms"].is_null() && row["ratio"].is_null(), "{row}");
    }
    let errors = String::from_utf8(bench(&args).stderr).unwrap();
    assert!(errors.contains("skipped: ") && errors.contains("no-such-python"), "{errors}");
    let required = bench_command(&args).env("PAROS_REQUIRE", "all").output().unwrap();
    assert_eq!(required.status.code(), Some(1));
    let errors = String::from_utf8(required.stderr).unwrap();
    assert!(
        errors.contains("no-such-python") && errors.contains("PAROS_REQUIRE is all"),
        "{errors}"
    );
    assert!(required.stdout.is_empty());
}

/// Returns the rows of a run of `paros-bench layers`, shared by all tests.
fn layer_rows() -> &'static [Value] {
    static ROWS: OnceLock<Vec<Value>> = OnceLock::new();
    ROWS.get_or_init(|| rows(&["layers", "toy", "--runs", "1", "--json"]))
}

/// Each cost is compared with one interval's, at both sizes.
#[test]
fn what_two_intervals_cost_is_told() {
    for side in [128, 256] {
        let row = |what: &str| {
            let row = layer_rows().iter().find(|row| row["size"] == side && row["against"] == what);
            row.unwrap_or_else(|| panic!("no {what} at {side}"))
        };
        for what in [
            "a carve of radius 6 with one interval a column",
            "a fill of radius 6 with one interval a column",
            "an island pass with one interval a column, nothing to remove",
            "an island pass with one interval a column, an island to remove",
            "the paper's voxel queue at once, nothing to remove",
            "the paper's voxel queue at once, an island to remove",
            "an export with one interval a column",
            "a bake with one interval a column",
        ] {
            assert_eq!(row(what)["volume"], "toy");
            assert!(row(what)["ratio"].as_f64().unwrap() > 0.0, "{}", row(what));
        }
        let bytes = |what: &str| row(what)["bytes"].as_u64().unwrap();
        for (one, two) in [
            (format!("size of World<{side}, 1>"), format!("size of World<{side}, 2>")),
            of_both("size of a volume's file"),
            of_both("size of a save at most"),
        ] {
            assert!((bytes(&one) + 1..=2 * bytes(&one)).contains(&bytes(&two)), "{two}");
        }
        let expected = 12 + 6 * 2 * side * side + 4;
        assert_eq!(bytes("size of a volume's file, two intervals a column"), expected);
    }
}

/// Returns the names of two rows: with one interval, then with two.
fn of_both(what: &str) -> (String, String) {
    (format!("{what}, one interval a column"), format!("{what}, two intervals a column"))
}

#[test]
fn a_bake_of_two_intervals_has_a_row() {
    let rows = rows(&["bake", "toy", "--runs", "1", "--json", "--python", "no-such-python"]);
    for side in [128, 256] {
        let found: Vec<_> = rows.iter().filter(|row| row["size"] == side).collect();
        let names =
            ["", ", ours of two intervals"].map(|two| format!("trimesh voxelized().fill(){two}"));
        assert_eq!(
            found.iter().map(|row| &row["against"]).collect::<Vec<_>>(),
            [&names[0], &names[1]]
        );
        assert!(found.iter().all(|row| row["ours_ms"].as_f64().unwrap() > 0.0), "{found:?}");
    }
}

/// The rows give the session's edits, and the size of its world in a save.
#[test]
fn a_session_is_played_with_one_interval_and_with_two() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-layers");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("short.trace");
    let trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        (0..30).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().unwrap()
    });
    fs::write(&path, trace).unwrap();
    let plan = Plan { traces: vec![path], ..plan_without_subjects(Benchmark::Layers) };
    let rows = plan.run(|_| {}).unwrap().rows;
    let of_session: Vec<_> = rows.iter().filter(|row| row.volume == "short").collect();
    assert!(of_session[0].refusal.is_some() && of_session[0].ratio.is_some());
    let (one, two) = of_both("size of a save at its end");
    let [one, two] = [one, two].map(|what| {
        of_session.iter().find(|row| row.against == what).and_then(|row| row.bytes).unwrap()
    });
    assert!(0 < one && one < two && two < 2 * one, "{one} {two}");
}

/// A volume of two intervals is measured in the closest form of one interval. The report states this, with
/// the number of voxels filled.
#[test]
fn what_is_filled_of_a_volume_is_told() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-hollow.rmap");
    let mut bits = Box::new(BitGrid::<128>::new());
    for (y, z) in (0..60).flat_map(|y| (30..90).map(move |z| (y, z))) {
        for x in 30..90 {
            let hollow = [x, y, z].iter().all(|i| (40..50).contains(i));
            bits.row_mut(y, z).insert_if(!hollow, x);
        }
    }
    let mut maps = Box::new(RangeMaps::<128, INTERVALS>::new());
    bits.write_closure(&mut maps);
    rmap::write(&file, &maps).unwrap();
    let output = bench(&["islands", file.to_str().unwrap(), "--runs", "1"]);
    let said = String::from_utf8(output.stderr).unwrap();
    let expected = format!("{}: 1000 voxels filled to leave 1 interval a column", file.display());
    assert!(output.status.success() && said.lines().any(|line| line == expected), "{said}");
    let mut closed = Box::new(RangeMaps::<128, 1>::new());
    bits.write_closure(&mut closed);
    rmap::write(&file, &closed).unwrap();
    let said = String::from_utf8(bench(&["islands", file.to_str().unwrap(), "--runs", "1"]).stderr)
        .unwrap();
    assert!(!said.contains("filled"), "{said}");
}

/// The limits for two intervals: holes 0.5 %, undercuts 5 % and 10 % at worst, slots 1 %.
#[test]
fn two_intervals_keep_cuts_that_one_refuses() {
    let cuts: Vec<_> = layer_rows().iter().filter(|row| row.get("refusal").is_some()).collect();
    assert_eq!(cuts.len(), 5);
    for (row, aim, worst_aim) in [
        (cuts[0], 0.5, 0.5),
        (cuts[1], 5.0, 10.0),
        (cuts[2], 1.0, 1.0),
        (cuts[3], 1.0, 1.0),
        (cuts[4], 1.0, 1.0),
    ] {
        let [one, two, worst] = ["one_percent", "two_percent", "worst_two_percent"]
            .map(|key| row["refusal"][key].as_f64().unwrap());
        assert!(two < aim && worst < worst_aim, "{row}");
        assert!(one > 9.0, "{row}");
    }
}

/// The goals at the speed of hands, as fractions of the slow cut: a groove at 0.6 m/s 95 %, at 1 m/s 85 %,
/// chisels at 0.3 m/s 60 %; a circle 95 %, with at most 3 % outside; and 20,000 voxels a second in roughing
/// out.
#[test]
#[ignore = "100 s in a debug build: `.ci/run bench` measures in a release build"]
fn bits_keep_up_with_hands() {
    let rows = rows(&["feel", "--json"]);
    let mut checked = 0;
    for row in &rows {
        let [bit, against] = ["volume", "against"].map(|key| row[key].as_str().unwrap());
        let is_chisel = bit.contains("chisel");
        let least = match against {
            "the slow groove; 0.3 m/s" if is_chisel => 0.6,
            "the slow groove; 0.3 m/s" | "the slow groove; 0.6 m/s" if !is_chisel => 0.95,
            "the slow groove; 1.0 m/s" if !is_chisel => 0.85,
            "the slow circle; in 0.8 s" => 0.95,
            _ => continue,
        };
        assert!(row["ratio"].as_f64().unwrap() >= least, "{row}");
        checked += 1;
    }
    // Rotary bits: three in three sizes, three in two, a saw, each at three speeds. Two chisels, three sizes.
    // Four circles.
    assert_eq!(checked, 2 * (16 * 3 + 6 + 4));
    let beside = rows.iter().filter(|row| row["against"].as_str().unwrap().contains("outside"));
    assert!(beside.clone().count() == 8);
    beside.for_each(|row| assert!(row["ratio"].as_f64().unwrap() <= 0.03, "{row}"));
    let raster = rows.iter().filter(|row| row.get("voxels_per_second").is_some());
    // Voxels at 256 have an eighth of the volume of those at 128.
    raster.for_each(|row| {
        let least = if row["size"] == 256 { 160_000.0 } else { 20_000.0 };
        assert!(row["voxels_per_second"].as_f64().unwrap() > least, "{row}");
    });
}

/// Instruction counts of a debug build are meaningless: the test only checks that they exist.
#[test]
fn the_worst_frame_of_each_change_is_told() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-field-toy.rmap");
    let maps: &mut RangeMaps<128, INTERVALS> = &mut Grid::<128>::lock_range_maps();
    let plane = &mut *Grid::<128>::lock_bit_grid();
    Figure::Toy.rasterize_into(maps, plane);
    rmap::write(&file, maps).unwrap();
    let valgrind = Command::new("valgrind").arg("--version").output();
    let counts =
        require_or_skip(valgrind.map_err(|error| format!("no valgrind: {error}"))).unwrap();
    let rows = rows(&["field", file.to_str().unwrap(), "--json"]);
    for what in ["a stroke of radius 6", "taken back", "a load", "the upper half falls"] {
        let row = rows.iter().find(|row| row["against"].as_str().unwrap().contains(what));
        let row = row.unwrap_or_else(|| panic!("no {what}"));
        assert!((1000..256 * 1024).contains(&row["bytes"].as_u64().unwrap()), "{row}");
        assert_eq!(row.get("instructions").is_some(), counts.is_some(), "{row}");
    }
    let two = rows.iter().filter(|row| row["against"].as_str().unwrap().contains("two intervals"));
    assert_eq!((rows.len(), two.count()), (8, 4));
}

#[test]
fn bad_input_is_refused() {
    for (args, word) in [
        (["islands", "--volume", "no-such.rmap"], "no-such.rmap"),
        (["edit", "--volume", "no-such.obj"], "no-such.obj"),
        (["islands", "--runs=1", "none.ply"], "none.ply: cannot read: No such file"),
        (["islands", "--runs=1", "none.rmap"], "none.rmap: cannot read: No such file"),
        (["bake", "--volume", "no-such-figure"], "no-such-figure: nothing to measure on"),
        (["islands", "--volume", "x.txt"], "(lump, owl, cat, amphora, dolphin, toy)"),
        (["islands", "--volume", "x.txt"], "or a name in .rmap, .obj, .stl"),
        (["all", "--runs", "0"], "--runs"),
    ] {
        let output = bench(&args);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(word), "{args:?} should say {word:?}: {errors}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn the_help_names_every_figure() {
    let help = String::from_utf8(bench(&["--help"]).stdout).unwrap();
    for figure in Figure::ALL {
        assert!(help.contains(figure.name()), "no {} in {help}", figure.name());
    }
    assert!(help.contains("takes minutes"), "{help}");
}

/// The part that takes minutes reports its progress.
#[test]
fn a_counted_replay_tells_its_progress() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-progress");
    fs::create_dir_all(&folder).unwrap();
    let trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        (0..1200).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().unwrap()
    });
    fs::write(folder.join("session.trace"), &trace).unwrap();
    fs::write(folder.join("ticks"), "7\n").unwrap();
    let starts = Grid::<128>::lock_world();
    for volume in StartVolume::all() {
        let maps: &RangeMaps<128, INTERVALS> = starts.start_volumes.volume(volume);
        rmap::write(&folder.join(volume.name()).with_extension("rmap"), maps).unwrap();
    }
    drop(starts);
    let output = bench(&["--replay", folder.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let parts: Vec<f64> = said.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(parts.len(), 400);
    assert!(parts.is_sorted() && parts[0] == 0.0 && parts[399] > 0.99, "{parts:?}");
}

/// Progress is also reported within a piece; without counting, as here, after each run.
#[test]
fn progress_is_told_within_a_piece() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-pieces");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("short.trace");
    let trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        runner.run_tick(&TickInput::default());
        runner.end_recording_to_bytes().unwrap()
    });
    fs::write(&path, trace).unwrap();
    let plan = Plan { traces: vec![path], ..plan_without_subjects(Benchmark::Step) };
    assert_eq!(plan.piece_count(), 2);
    let heard = RefCell::new(vec![]);
    plan.run(|done| heard.borrow_mut().push(done)).unwrap();
    let heard = heard.into_inner();
    assert!(heard.is_sorted() && heard[..2] == [0.0, 1.0], "{heard:?}");
    assert!(heard[2..].len() > 3 && heard[2..].iter().all(|&done| 1.0 < done && done < 2.0));
}

fn plan_without_subjects(bench: Benchmark) -> Plan {
    Plan {
        benches: vec![bench],
        subjects: vec![],
        traces: vec![],
        runs: 1,
        frame_runs: 1,
        canvas: [1, 1],
        device: None,
        python: "python3".into(),
    }
}

/// A trace is checked before anything is counted.
#[test]
fn a_trace_that_differs_is_refused_at_its_tick() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-step");
    fs::create_dir_all(&folder).unwrap();
    let mut trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        (0..30).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().unwrap()
    });
    let (good, bad) = (folder.join("good.trace"), folder.join("bad.trace"));
    fs::write(&good, &trace).unwrap();
    *trace.last_mut().unwrap() ^= 1;
    fs::write(&bad, &trace).unwrap();
    let refused = bench(&["step", bad.to_str().unwrap()]);
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(errors.contains("bad.trace: ") && errors.contains("tick 29"), "{errors}");

    let valgrind = Command::new("valgrind").arg("--version").output();
    if require_or_skip(valgrind.map_err(|error| format!("no valgrind: {error}"))).unwrap().is_some()
    {
        let rows = rows(&["step", good.to_str().unwrap(), "--json"]);
        let worst = rows.iter().find(|row| row["against"].as_str().unwrap().contains("worst"));
        let worst = worst.unwrap_or_else(|| panic!("no worst tick in {rows:?}"));
        assert!(worst["instructions"].as_u64().unwrap() > 100, "{worst}");
        assert_eq!((&worst["volume"], &worst["size"]), (&"good".into(), &128.into()));
    }
}
