//! The commands with a Vulkan device, and their messages without one.

use std::fs;
use std::path::Path;

use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_shaders::{Camera, TwinScene, TwinSettings, shade_ray};
use paros_shell::require::require_or_skip;
use paros_shell::rmap;
use paros_shell::tick_runner::with_fresh_world;

use crate::support::{TOY, TestFolder, rasterize_toy};

/// Returns the name of the best device, if there is one.
fn device() -> Option<String> {
    require_or_skip(paros_headless::open_gpu(None)).unwrap().map(|gpu| gpu.name.clone())
}

fn succeeds(folder: &TestFolder, args: &[&str]) {
    let output = folder.paros(args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {errors}");
}

/// Returns width, height, and the colours row by row.
fn picture(path: &Path) -> (usize, usize, Vec<[u8; 3]>) {
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width as usize, info.height as usize, pixels)
}

/// Away from the outline, a pixel shows the sculpture exactly where the ray of the CPU twin hits it.
#[test]
fn a_vulkan_picture_has_the_twins_silhouette() {
    let Some(_) = device() else { return };
    let folder = TestFolder::new("vulkan-silhouette");
    let maps = rasterize_toy();
    folder.write("toy.rmap", rmap::encode(&maps));
    let (width, height, azimuth, elevation) = (240, 180, 0.5_f32, 0.3_f32);
    let view = format!("{},{}", azimuth.to_degrees(), elevation.to_degrees());
    let camera = Camera::orbiting(azimuth, elevation);
    let scene = TwinScene::new(&maps, -azimuth, TwinSettings::default());
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
        let (w, h, pixels) = picture(&folder.0.join("p.png"));
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
    let folder = TestFolder::new("vulkan-play");
    folder.write("t.trace", trace());
    succeeds(&folder, &["play", "t.trace", "--frames", "f", "--renderer", "vulkan"]);
    let (width, height, pixels) = picture(&folder.0.join("f/000000.png"));
    assert_eq!((width, height), (640, 480));
    let covered = pixels.iter().filter(|&&pixel| pixel != pixels[0]).count();
    assert!(covered > pixels.len() / 10, "{covered}");
}

/// Returns a trace of two ticks of a session.
fn trace() -> Vec<u8> {
    with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        runner.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
        runner.run_tick(&TickInput::default());
        runner.end_recording_to_bytes().unwrap()
    })
}

/// The room is drawn around the sculpture, and its light falls on the sculpture.
#[test]
fn a_vulkan_picture_shows_the_room() {
    let Some(_) = device() else { return };
    let folder = TestFolder::new("vulkan-room");
    let draw_by = |renderer: &str, more: &[&str]| {
        let args = ["render", "owl", "-o", "p.png", "--size", "160x120", "--renderer", renderer];
        succeeds(&folder, &[&args[..], more].concat());
        picture(&folder.0.join("p.png")).2
    };
    let draw = |more: &[&str]| draw_by("vulkan", more);
    let (plain, room) = (draw(&["--plain"]), draw(&[]));
    let alike = |a: [u8; 3], b: [u8; 3]| (0..3).all(|c| a[c].abs_diff(b[c]) <= 2);
    let backdrop = |pixels: &[[u8; 3]]| pixels.iter().filter(|&&p| alike(p, plain[0])).count();
    assert!(backdrop(&plain) > plain.len() / 2, "{}", backdrop(&plain));
    assert!(backdrop(&room) < room.len() / 10, "{}", backdrop(&room));
    // The owl's chest is stone in both pictures, in different light, at the same place.
    let chest = 58 * 160 + 80;
    assert!(plain[chest].iter().chain(&room[chest]).all(|&c| c > 90), "{:?}", room[chest]);
    assert_ne!(plain[chest], room[chest]);
    // The CPU draws the same room.
    let cpu = draw_by("cpu", &[]);
    let far = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 12);
    let differ = cpu.iter().zip(&room).map(far).filter(|far| *far).count();
    assert!(differ < room.len() / 20, "{differ} of {} pixels differ", room.len());
    // A turntable is also drawn in the room.
    draw(&["--turn", "3"]);
}

#[test]
fn without_vulkan_a_line_says_so() {
    let folder = TestFolder::new("vulkan-without");
    folder.write("toy.rmap", &*TOY);
    let args = ["render", "toy.rmap", "-o", "p.png", "--renderer", "vulkan"];
    // Older loaders use the older name.
    let mut paros = folder.command(&args);
    paros.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
    let output = paros.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("Vulkan") && errors.lines().count() == 1, "{errors}");
    assert!(output.stdout.is_empty());
    assert_eq!(folder.names(), ["toy.rmap"]);
}

#[test]
fn unknown_renderers_and_paths_are_refused() {
    let folder = TestFolder::new("vulkan-arguments");
    for (option, value) in [("--renderer", "opengl"), ("--path", "slow")] {
        let args = ["render", "v.rmap", "-o", "p.png", option, value];
        let output = folder.paros(&args);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(value));
    }
}
