//! The README's picture of the three modes, drawn by the window.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use paros_core::World;
use paros_core::limits::INTERVALS;
use paros_core::limits::max_save_bytes;
use paros_shaders::Image;
use paros_shell::demo::{DemoScript, play_demo};
use paros_shell::require::{MissingDependency, require_or_skip};
use paros_shell::tick_runner::with_fresh_world;

use super::rig::{ScriptedWindow, XvfbDisplay, empty_folder};

/// Size of the window in pixels; the picture has half of it each way.
const SIZE: [usize; 2] = [800, 700];

type WindowPercent = [f32; 2];

/// Makes a stroke through points of the window, in percent, with `ticks` ticks at each.
fn stroke(visit: &mut ScriptedWindow, points: impl IntoIterator<Item = WindowPercent>, ticks: u32) {
    for (number, [x, y]) in points.into_iter().enumerate() {
        visit.do_step(&format!("move {x:.2} {y:.2}"));
        if number == 0 {
            visit.do_all(&["wait 12", "press left"]);
        }
        visit.do_step(&format!("wait {ticks}"));
    }
    visit.do_all(&["wait 40", "release left", "wait 6"]);
}

/// Returns points on a line.
fn line(from: WindowPercent, to: WindowPercent, count: u16) -> impl Iterator<Item = WindowPercent> {
    (0..=count).map(move |i| {
        let part = f32::from(i) / f32::from(count);
        [0, 1].map(|k| from[k] + (to[k] - from[k]) * part)
    })
}

/// Cuts a spiral into the lump.
fn free(visit: &mut ScriptedWindow) {
    visit.do_all(&["start free", "wait 4", "wheel 9"]);
    let spiral = (0..110u8).map(|i| {
        let part = f32::from(i) / 110.0;
        let (sin, cos) = (part * 2.3 * std::f32::consts::TAU).sin_cos();
        let radius = 3.0 + 15.0 * part;
        [46.0 + 0.8 * radius * cos, 46.0 + radius * sin]
    });
    stroke(visit, spiral, 7);
    visit.do_step("wait 100");
}

/// Saves a session with the demo's owl, partly out of the stone. A window of this folder resumes it.
fn save_hidden(folder: &Path) {
    let sessions = folder.join("data/paros");
    fs::create_dir_all(&sessions).expect("a folder");
    with_fresh_world::<128, INTERVALS, _>(|mut stage| {
        let mut until = |world: &World<128, INTERVALS>| {
            if world.tick() < HALF_WAY {
                return ControlFlow::Continue(());
            }
            let mut bytes = vec![0; max_save_bytes(128, INTERVALS)];
            let len = world.save(&mut bytes);
            fs::write(sessions.join("session-128.save"), &bytes[..len]).expect("it is written");
            ControlFlow::Break(())
        };
        play_demo(DemoScript::Owl, &mut stage, &mut until, |_, _| {});
    });
}

/// The tick at which the demo has bared the owl's front, but not its back.
const HALF_WAY: u64 = 5000;

/// Makes a bow tie of paste; the mirror makes the second half.
fn creative(visit: &mut ScriptedWindow) {
    visit.do_all(&["start creative", "wait 4", "key m", "wait 4", "key 3", "wait 4"]);
    for rise in [-2.4, 0.0, 2.4] {
        stroke(visit, line([48.4, 42.5], [53.0, 42.5 + rise], 8), 5);
    }
    visit.do_all(&["key 1", "wait 40"]);
}

#[test]
#[ignore = "takes minutes, and writes tests/pictures/modes.png"]
fn the_readme_shows_the_three_modes() -> Result<(), MissingDependency> {
    let folder = empty_folder("pictures");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, SIZE))? else {
        return Ok(());
    };
    save_hidden(&folder);
    let mut visit = ScriptedWindow::new(&display);
    let mut shot = |name, mode: fn(&mut ScriptedWindow)| {
        // Small while it carves: a frame runs at most four ticks.
        visit.do_all(&["size 160 140", "frames 3"]);
        mode(&mut visit);
        visit.do_all(&["size 800 700", "frames 3", "move 64 72"]);
        halved(&visit.screenshot(&display, name))
    };
    let hidden = shot("hidden", |visit| visit.do_all(&["key escape", "wait 60"]));
    let pictures = [shot("free", free), hidden, shot("creative", creative)];
    assert_eq!(visit.close(), (Some(0), String::new()));
    let mut png = Vec::new();
    beside(&pictures).write_png(&mut png).expect("a picture");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/pictures/modes.png");
    fs::write(path, png).expect("it is written");
    Ok(())
}

/// Halves a picture's size: each pixel is the mean of four.
fn halved(picture: &Image) -> Image {
    let (width, height) = (picture.width / 2, picture.height / 2);
    let mut pixels = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let four = four.map(|(dx, dy)| picture.pixel(2 * x + dx, 2 * y + dy));
        let mean = |k: usize| (four.iter().map(|p| u16::from(p[k])).sum::<u16>() / 4) as u8;
        pixels.extend([0, 1, 2].map(mean));
    }
    Image { width, height, pixels }
}

/// Joins pictures of one size in a row, with a gap between them.
fn beside(pictures: &[Image; 3]) -> Image {
    let [Image { width, height, .. }, ..] = pictures;
    let mut pixels = Vec::new();
    for y in 0..*height {
        for (number, picture) in pictures.iter().enumerate() {
            if number > 0 {
                pixels.extend([255; 3 * GAP]);
            }
            pixels.extend_from_slice(&picture.pixels[3 * width * y..][..3 * width]);
        }
    }
    Image { width: 3 * width + 2 * GAP, height: *height, pixels }
}

/// Pixels between two pictures.
const GAP: usize = 6;
