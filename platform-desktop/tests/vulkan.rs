//! What the commands do with a Vulkan device, and what they say without one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::Grid;
use paros_core::{RangeMaps, TickInput};

use paros_shaders::{Camera, TwinScene, TwinSettings, shade_ray};
use paros_shell::figures::Figure;
use paros_shell::require::require_or_skip;
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::tick_runner::TickRunner;
use serde_json::Value;

/// The name of the best device, if there is one.
fn device() -> Option<String> {
    require_or_skip(paros_headless::open_gpu(None)).unwrap().map(|gpu| gpu.name.clone())
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("vulkan-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn paros(folder: &Path, args: &[&str]) -> Command {
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros.args(args).current_dir(folder).stdin(Stdio::null()).env_remove("PAROS_REQUIRE");
    paros
}

fn succeeds(folder: &Path, args: &[&str]) -> Output {
    let output = paros(folder, args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {errors}");
    output
}

/// The command fails for what the machine lacks, with one line that says `word`, and writes nothing.
fn fails(folder: &Path, mut command: Command, word: &str) {
    let count = || fs::read_dir(folder).unwrap().count();
    let before = count();
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{command:?}: {errors}");
    assert!(errors.contains(word), "{command:?} should say {word:?}: {errors}");
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert!(output.stdout.is_empty());
    assert_eq!(count(), before, "{command:?} left something behind");
}

/// Width, height, and the colours row by row.
fn picture(path: &Path) -> (usize, usize, Vec<[u8; 3]>) {
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width as usize, info.height as usize, pixels)
}

fn rows(output: &Output) -> Vec<Value> {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Away from the outline, a pixel shows the sculpture exactly where the twin's ray meets it.
#[test]
fn a_vulkan_picture_has_the_twins_silhouette() {
    let Some(_) = device() else { return };
    let folder = folder("silhouette");
    let maps: &mut RangeMaps<128, INTERVALS> = &mut Grid::<128>::lock_range_maps();
    let plane = &mut *Grid::<128>::lock_bit_grid();
    Figure::Toy.rasterize_into(maps, plane);
    rmap::write(&folder.join("toy.rmap"), maps).unwrap();
    let (width, height, azimuth, elevation) = (240, 180, 0.5_f32, 0.3_f32);
    let view = format!("{},{}", azimuth.to_degrees(), elevation.to_degrees());
    let camera = Camera::orbiting(azimuth, elevation);
    let scene = TwinScene::new(maps, -azimuth, TwinSettings::default());
    let hit = |i: usize| {
        let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let (w, h) = (width as f32, height as f32);
        shade_ray(&scene, &camera.ray_through((2.0 * x - w) / h, 1.0 - 2.0 * y / h), 0.5).is_some()
    };
    let hits: Vec<bool> = (0..width * height).map(hit).collect();
    for path in ["paper", "fast"] {
        let size = format!("{width}x{height}");
        let args = ["render", "toy.rmap", "-o", "p.png", "--size", &size, "--view", &view];
        let more = ["--renderer", "vulkan", "--path", path, "--plain"];
        succeeds(&folder, &[&args[..], &more].concat());
        let (w, h, pixels) = picture(&folder.join("p.png"));
        assert_eq!((w, h), (width, height));
        let (mut inside, mut outside, mut wrong) = (0, 0, 0);
        for y in 2..height - 2 {
            for x in 2..width - 2 {
                let i = y * width + x;
                let around = (0..25).map(|k| hits[i + (k / 5) * width + k % 5 - 2 * width - 2]);
                if around.clone().any(|hit| hit != hits[i]) {
                    continue;
                }
                *(if hits[i] { &mut inside } else { &mut outside }) += 1;
                wrong += u32::from((pixels[i] != pixels[0]) != hits[i]);
            }
        }
        assert!(inside > 4000 && outside > 4000, "{inside} {outside}");
        assert!(wrong <= 20, "{path}: {wrong} of {} pixels differ", inside + outside);
    }
}

#[test]
fn a_trace_is_drawn() {
    let Some(_) = device() else { return };
    let folder = folder("play");
    trace(&folder.join("t.trace"));
    succeeds(&folder, &["play", "t.trace", "--frames", "f", "--renderer", "vulkan"]);
    let (width, height, pixels) = picture(&folder.join("f/000000.png"));
    assert_eq!((width, height), (640, 480));
    let covered = pixels.iter().filter(|&&pixel| pixel != pixels[0]).count();
    assert!(covered > pixels.len() / 10, "{covered}");
}

/// Two ticks of a session.
fn trace(path: &Path) {
    let mut starts = <Grid<128> as Resident<128, INTERVALS>>::lock_start_volumes();
    starts.generate_once(&mut Grid::<128>::lock_bit_grid(), |_| {});
    let (hidden, mut world) = (starts.hidden_figures(), Grid::<128>::lock_world());
    let mut stage = TickRunner::new(&mut world, starts.start_volumes(&hidden));
    stage.start_recording();
    stage.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    stage.run_tick(&TickInput::default());
    fs::write(path, stage.end_recording_to_bytes().unwrap()).unwrap();
}

/// The room around the sculpture, and the sculpture in its light.
#[test]
fn a_vulkan_picture_shows_the_room() {
    let Some(_) = device() else { return };
    let folder = folder("room");
    let draw_by = |renderer: &str, more: &[&str]| {
        let args = ["render", "owl", "-o", "p.png", "--size", "160x120", "--renderer", renderer];
        succeeds(&folder, &[&args[..], more].concat());
        picture(&folder.join("p.png")).2
    };
    let draw = |more: &[&str]| draw_by("vulkan", more);
    let (plain, room) = (draw(&["--plain"]), draw(&[]));
    let alike = |a: [u8; 3], b: [u8; 3]| (0..3).all(|c| a[c].abs_diff(b[c]) <= 2);
    let backdrop = |pixels: &[[u8; 3]]| pixels.iter().filter(|&&p| alike(p, plain[0])).count();
    assert!(backdrop(&plain) > plain.len() / 2, "{}", backdrop(&plain));
    assert!(backdrop(&room) < room.len() / 10, "{}", backdrop(&room));
    // The owl's chest is stone in both, in other light; its top is where it was.
    let chest = 58 * 160 + 80;
    assert!(plain[chest].iter().chain(&room[chest]).all(|&c| c > 90), "{:?}", room[chest]);
    assert_ne!(plain[chest], room[chest]);
    // The CPU draws the same room.
    let cpu = draw_by("cpu", &[]);
    let far = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 12);
    let differ = cpu.iter().zip(&room).map(far).filter(|far| *far).count();
    assert!(differ < room.len() / 20, "{differ} of {} pixels differ", room.len());
    // A turntable goes round in the room.
    draw(&["--turn", "3"]);
}

#[test]
fn bench_render_has_a_row_for_each_comparison() {
    let Some(device) = device() else { return };
    let folder = folder("bench");
    let size = ["--size", "96x96", "--runs", "1", "--json"];
    let rows = rows(&succeeds(&folder, &[&["bench", "render", "toy", "lump"], &size[..]].concat()));
    for kind in ["mono, 1 sample", "mono, 4 samples", "stereo, 1 sample", "stereo, 4 samples"] {
        for (what, sizes) in [
            ("the paper's path", &[128, 256][..]),
            ("the paper's path with a full march, ours without", &[128, 256]),
            ("the paper's path at 128", &[256]),
            ("the paper's path at 256, ours the same at 128", &[128]),
            ("whole frame, ours with the upload of a stroke of radius 6", &[128, 256]),
        ] {
            let against = format!("{what}; {kind}");
            let found: Vec<_> = rows.iter().filter(|row| row["against"] == against).collect();
            for volume in ["toy", "lump", "geometric mean of 2"] {
                let found = found.iter().filter(|row| row["volume"] == volume);
                let found: Vec<_> = found.map(|row| row["size"].as_u64().unwrap()).collect();
                assert_eq!(found, sizes, "{volume}: {against}");
            }
            for row in found {
                assert!(row["ratio"].as_f64().unwrap() > 0.0, "{row}");
                assert_eq!(row["device"], device.as_str());
                if let Some(filled) = row.get("filled") {
                    assert!((filled.as_f64().unwrap() - 0.25).abs() < 0.01, "{row}");
                }
            }
        }
    }
    for kind in ["mono, 1 sample", "stereo, 4 samples"] {
        for other in ["first", "last"] {
            let against = format!("the sculpture {other}, ours tools, sculpture, room; {kind}");
            let found = rows.iter().filter(|row| row["against"] == against && row["size"] == 128);
            assert_eq!(found.count(), 3, "{against}");
        }
    }
    let bytes = |row: &Value| row.get("bytes").and_then(Value::as_u64);
    let bytes: Vec<_> = rows.iter().filter_map(bytes).collect();
    assert_eq!(bytes.len(), 8);
    assert!(bytes.iter().all(|bytes| (500..=32 * 1024).contains(bytes)), "{bytes:?}");
}

#[test]
fn bench_layers_has_rows_of_the_papers_path() {
    let Some(device) = device() else { return };
    let folder = folder("layers");
    let size = ["--size", "64x64", "--runs", "1", "--json", "--device", &device];
    let rows = rows(&succeeds(&folder, &[&["bench", "layers", "toy"], &size[..]].concat()));
    for kind in ["mono, 1 sample", "stereo, 4 samples"] {
        let against = format!("the paper's path with one interval a column; {kind}");
        let found: Vec<_> = rows.iter().filter(|row| row["against"] == against).collect();
        assert_eq!(found.iter().map(|row| &row["size"]).collect::<Vec<_>>(), [128, 256]);
        for row in found {
            assert!(row["ratio"].as_f64().unwrap() > 0.0, "{row}");
            assert_eq!(row["device"], device.as_str());
        }
    }
}

#[test]
fn bench_paper_sets_ratios_beside_the_published_ones() {
    let Some(device) = device() else { return };
    let folder = folder("paper");
    let size = ["--size", "64x64", "--runs", "1", "--json", "--device", &device];
    let rows = rows(&succeeds(&folder, &[&["bench", "paper", "toy"], &size[..]].concat()));
    let row = |against: &str| {
        let row = rows.iter().find(|row| row["against"] == against);
        row.unwrap_or_else(|| panic!("no {against}"))
    };
    let figure = |against: &str, key: &str| row(against)[key].as_f64().unwrap();
    let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let whole = figure("whole frame", "ours_ms");
    for what in [
        "whole frame",
        "SDF off (published: at most)",
        "shading off (published: at most)",
        "full march",
        "whole frame at 256",
        "our fast path",
        "our fast path at 256",
    ] {
        assert_eq!(row(what)["device"], device.as_str());
        assert!(is_near(figure(what, "share"), figure(what, "ours_ms") / whole), "{what}");
    }
    for way in ["the paper's queue", "our rows"] {
        for what in [
            "clean-up every frame",
            "clean-up at once, worst tick",
            "clean-up at once each second, mean tick",
            "amortised clean-up, worst tick",
            "amortised clean-up, mean tick",
        ] {
            let what = format!("{what}: {way}");
            assert!(is_near(figure(&what, "share"), figure(&what, "ours_ms") * 0.072), "{what}");
        }
    }
    assert!(is_near(figure("clean-up every frame: the paper's queue", "published"), 5.472));
    assert!(is_near(figure("full march", "published"), 50.0 / 3.0 / 14.7));
    let published = rows.iter().filter(|row| row.get("published").is_some()).count();
    assert_eq!(published, 6);
}

#[test]
fn without_vulkan_a_line_says_so() {
    let folder = folder("without");
    let maps: &mut RangeMaps<128, INTERVALS> = &mut Grid::<128>::lock_range_maps();
    let plane = &mut *Grid::<128>::lock_bit_grid();
    Figure::Toy.rasterize_into(maps, plane);
    rmap::write(&folder.join("toy.rmap"), maps).unwrap();
    let without = |args: &[&str]| {
        let mut paros = paros(&folder, args);
        // The older name too, for older loaders.
        paros.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
        paros
    };
    let render = ["render", "toy.rmap", "-o", "p.png", "--renderer", "vulkan"];
    fails(&folder, without(&render), "Vulkan");
    fails(&folder, without(&["bench", "render", "toy"]), "Vulkan");

    let args = ["bench", "paper", "toy", "--runs", "1", "--json"];
    let output = without(&args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.starts_with("skipped: frames: "), "{errors}");
    let (skipped, timed): (Vec<_>, Vec<_>) =
        rows(&output).into_iter().partition(|row| row.get("skipped").is_some());
    assert_eq!((skipped.len(), timed.len()), (7, 10));
    assert!(skipped.iter().all(|row| row["ours_ms"].is_null()));
    assert!(timed.iter().all(|row| row["share"].as_f64().unwrap() > 0.0));
    let table = without(&["bench", "paper", "toy", "--runs", "1"]).output().unwrap();
    assert!(String::from_utf8_lossy(&table.stdout).contains("full march; skipped: "));
    let required = without(&args).env("PAROS_REQUIRE", "all").output().unwrap();
    assert_eq!(required.status.code(), Some(1));
}

#[test]
fn a_device_that_is_not_there_is_named() {
    let Some(device) = device() else { return };
    let folder = folder("device");
    let args = ["bench", "render", "toy", "--device", "no such device"];
    fails(&folder, paros(&folder, &args), &format!("{device} is not the one asked for"));
}

#[test]
fn unknown_renderers_and_paths_are_refused() {
    let folder = folder("arguments");
    for (option, value) in [("--renderer", "opengl"), ("--path", "slow")] {
        let args = ["render", "v.rmap", "-o", "p.png", option, value];
        let output = paros(&folder, &args).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(value));
    }
}
