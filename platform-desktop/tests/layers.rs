//! Volumes of several intervals a column on the command line: written, reported, refused and closed.
//!
//! Planted faults (tried by hand): a volume is closed without a request; `info` reads a volume of one
//! interval as one of two; `play` opens a volume with the requested number of intervals, regardless of the
//! trace.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::session::SessionMode;
use paros_core::volume::{BitGrid, BitSet, Grid};
use paros_core::{RangeMaps, TickInput};
use paros_shell::rmap;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::tick_runner::TickRunner;
use serde_json::Value;

use crate::support::{TETRAHEDRON, TestFolder};

/// Voxels of the cavity.
const CAVITY: u64 = 20 * 20 * 20;

/// Locks a block with a cavity of 20 voxels a side, which needs columns of two intervals.
fn lock_hollow_block() -> MutexGuard<'static, BitGrid<128>> {
    static BITS: Mutex<BitGrid<128>> = Mutex::new(BitGrid::new());
    let mut bits = BITS.lock().unwrap_or_else(PoisonError::into_inner);
    bits.clear();
    for y in 0..90 {
        for z in 30..90 {
            for x in 30..90 {
                let hollow = [x, y, z].iter().all(|i| (40..60).contains(i));
                bits.row_mut(y, z).insert_if(!hollow, x);
            }
        }
    }
    bits
}

/// Encodes the hollow block as a file.
fn encode_hollow_block<const K: usize>() -> Vec<u8> {
    let mut maps = Box::new(RangeMaps::<128, K>::new());
    lock_hollow_block().write_closure(&mut maps);
    rmap::encode(&maps)
}

fn json_info(folder: &TestFolder, name: &str) -> Value {
    serde_json::from_str(&folder.succeeds(&["info", name, "--json"])).unwrap()
}

#[test]
fn info_tells_the_intervals_of_a_column() {
    let folder = TestFolder::new("layers-info");
    let bytes = [encode_hollow_block::<1>(), encode_hollow_block::<2>()];
    for (layers, (name, bytes)) in ["one.rmap", "two.rmap"].into_iter().zip(&bytes).enumerate() {
        folder.write(name, bytes);
        let info = json_info(&folder, name);
        assert_eq!(
            (&info["version"], &info["layers"]),
            (&(layers + 1).into(), &(layers + 1).into())
        );
        assert_eq!(info["bytes"], bytes.len());
        let sum = u32::from_le_bytes(*bytes.last_chunk().unwrap());
        assert_eq!(info["checksum"], format!("{sum:08x}"), "that of the file");
    }
    let count = |name| json_info(&folder, name)["voxels"].as_u64().unwrap();
    assert_eq!(count("one.rmap") - count("two.rmap"), CAVITY);
    let lines = folder.succeeds(&["info", "one.rmap"]);
    assert!(lines.contains("file      version 1, 1 interval a column, "), "{lines}");
    let lines = folder.succeeds(&["info", "two.rmap"]);
    assert!(lines.contains("file      version 2, 2 intervals a column, "), "{lines}");
}

#[test]
fn meshes_are_baked_with_either_number_of_intervals() {
    let folder = TestFolder::new("layers-bake");
    folder.write("m.obj", TETRAHEDRON);
    let mut voxels = Vec::new();
    for (args, layers) in [(&[][..], 2), (&["--layers", "2"], 2), (&["--layers", "1"], 1)] {
        folder.succeeds(&[&["bake", "m.obj", "-o", "v.rmap"], args].concat());
        let info = json_info(&folder, "v.rmap");
        assert_eq!(
            (&info["version"], &info["layers"]),
            (&layers.into(), &layers.into()),
            "{args:?}"
        );
        voxels.push(info["voxels"].as_u64());
    }
    assert!(voxels.iter().all(|count| *count == voxels[0]), "{voxels:?}");
    for other in ["0", "3", "two"] {
        folder.refuses(&["bake", "m.obj", "-o", "w.rmap", "--layers", other], other);
    }
    assert_eq!(folder.names(), ["m.obj", "v.rmap"]);
}

#[test]
fn a_volume_is_closed_to_fewer_intervals_if_that_is_asked_for() {
    let folder = TestFolder::new("layers-open");
    folder.write("one.rmap", encode_hollow_block::<1>());
    folder.write("two.rmap", encode_hollow_block::<2>());
    let told = format!("two.rmap: {CAVITY} voxels filled to leave 1 interval a column\n");
    let export = |volume, args: &[&str]| {
        folder.succeeds(&[&["export", volume, "-o", "m.stl"], args].concat())
    };
    let said = export("two.rmap", &["--layers", "1"]);
    assert!(said.starts_with(&format!("{told}m.stl: ")), "{said}");
    let closed = folder.read("m.stl");
    for (volume, args) in [("one.rmap", &[][..]), ("one.rmap", &["--layers", "1"])] {
        let said = export(volume, args);
        assert!(said.starts_with("m.stl: "), "{said}");
        assert!(folder.read("m.stl") == closed, "{volume} {args:?}");
    }
    for args in [&[][..], &["--layers", "2"]] {
        let said = export("two.rmap", args);
        assert!(said.starts_with("m.stl: "), "{said}");
        assert!(folder.read("m.stl").len() > closed.len(), "the cavity is printed");
    }
    let render = ["render", "two.rmap", "-o", "p.png", "--size", "8x8"];
    let said = folder.succeeds(&[&render[..], &["--layers", "1"]].concat());
    assert!(said.starts_with(&format!("{told}p.png: ")), "{said}");
    assert!(folder.succeeds(&render).starts_with("p.png: "));
}

#[test]
fn more_intervals_than_are_opened_are_refused() {
    let folder = TestFolder::new("layers-refused");
    folder.write("three.rmap", encode_hollow_block::<3>());
    let word = "three.rmap: at byte 8: expected columns of at most 2 intervals, found 3";
    for args in [
        &["info", "three.rmap"][..],
        &["export", "three.rmap", "-o", "m.stl"],
        &["render", "three.rmap", "-o", "p.png"],
    ] {
        folder.refuses(args, word);
    }
    let said = folder.succeeds(&["export", "three.rmap", "-o", "m.stl", "--layers", "2"]);
    assert!(
        said.starts_with("three.rmap: 0 voxels filled to leave 2 intervals a column\n"),
        "{said}"
    );
}

/// Records a trace with one interval a column, in which a session starts from this volume, closed.
fn record_start_from_closed(volume: &[u8]) -> Vec<u8> {
    let mut resident = <Grid<128> as Resident<128, 1>>::lock_world();
    resident.generate_starts();
    let WorldWithStarts { start_volumes, world } = &mut *resident;
    rmap::decode_closed(volume, start_volumes.offer_visitor_volume()).unwrap();
    let hidden = start_volumes.hidden_figures();
    let mut runner = TickRunner::new(world, start_volumes.start_volumes(&hidden));
    runner.start_recording();
    runner.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
    runner.end_recording_to_bytes().unwrap()
}

#[test]
fn a_trace_of_one_interval_starts_from_volumes_of_one() {
    let folder = TestFolder::new("layers-play");
    let two = encode_hollow_block::<2>();
    folder.write("t.trace", record_start_from_closed(&two));
    folder.write("two.rmap", two);
    folder.write("one.rmap", encode_hollow_block::<1>());
    let word = "two.rmap: at byte 8: expected columns of 1 interval, found columns of 2";
    folder.refuses(&["play", "t.trace", "--volume", "two.rmap"], word);
    let word = "t.trace: is of 1 interval a column, not of 2";
    folder.refuses(&["play", "t.trace", "--volume", "two.rmap", "--layers", "2"], word);
    folder.refuses(&["play", "t.trace", "--layers", "1"], "--volume");

    let told = format!("two.rmap: {CAVITY} voxels filled to leave 1 interval a column\n");
    let played = |volume, args: &[&str]| {
        folder.succeeds(&[&["play", "t.trace", "--volume", volume], args].concat())
    };
    let of_one = played("one.rmap", &[]);
    assert!(of_one.starts_with("t.trace: 1 ticks, all as recorded; "), "{of_one}");
    assert_eq!(played("one.rmap", &["--layers", "1"]), of_one);
    assert_eq!(played("two.rmap", &["--layers", "1"]), format!("{told}{of_one}"));
    let json = ["play", "t.trace", "--volume", "two.rmap", "--layers", "1", "--stats", "--json"];
    let output = folder.paros(&json);
    assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok(), "{output:?}");
    assert_eq!(String::from_utf8_lossy(&output.stderr), told);
}
