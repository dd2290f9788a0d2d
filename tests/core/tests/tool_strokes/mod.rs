//! A stroke of every bit over flat, convex and concave stone, through the world: how far the bit lags behind
//! its hand, and whether the tool does its work.
//!
//! A hand comes down on the stone with its trigger pulled, presses `pressed_mm` into it, and moves on at a
//! constant speed of up to the bit's bite a tick. `tests/goldens/tool-strokes-*.txt` hold the measurements of
//! some strokes of every bit; `PAROS_GOLDEN=write cargo test -p paros-tests-core tool_strokes` writes them.
//! `every_press_and_speed`, which is ignored, draws a grid of them; `.ci/nightly` runs it.
//!
//! The greatest lag behind the hand in that grid, in millimetres, pressed 0 to 10 mm at 0.03 m/s and more:
//!
//! | bit | at 128 | at 256 | where |
//! |---|---|---|---|
//! | rotary bits, nozzle, file, float | 0 | 0 | |
//! | point chisel | 14 | 14 | at 0.245 m/s: the path of a blow's period |
//! | flat chisel | 18 | 18 | at 0.216 m/s |
//!
//! A chisel stands between two blows, which come every sixth or eighth tick, and cuts its hand's whole path
//! at the next blow. A file passes through the stone that it smooths.

mod figures;
mod scene;
mod stone;

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use paros_core::internals::BitShape;
use paros_core::session::ToolBit;
use paros_core::volume::{Grid, Size};
use paros_models::cases::scaled_step;

use self::figures::StrokeFigures;
use self::scene::{Scene, Stroke};
use self::stone::Stone;

static AT_128: Mutex<Scene<128>> = Mutex::new(Scene::new());
static AT_256: Mutex<Scene<256>> = Mutex::new(Scene::new());

/// Returns the top speed that a bit's bite allows, in millimetres a tick.
fn top_speed(bit: ToolBit) -> f32 {
    bit.spec().bite_um as f32 * 1e-3
}

/// The speed of a hand at 0.03 m/s, in millimetres a tick.
const SLOW: f32 = 30.0 / 72.0;

/// Lists strokes over every kind of stone.
fn list_strokes(presses_and_speeds: impl Fn(Stone, ToolBit) -> Vec<[f32; 2]>) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    for (stone, is_rough) in Stone::ALL.into_iter().flat_map(|s| [(s, false), (s, true)]) {
        let drawn_bits = ToolBit::ALL.into_iter().filter(|bit| bit.spec().flake_um == 0);
        for bit in drawn_bits.filter(|bit| !is_rough || *bit == ToolBit::File) {
            for [pressed_mm, speed_mm] in presses_and_speeds(stone, bit) {
                strokes.push(Stroke { bit, stone, is_rough, pressed_mm, speed_mm });
            }
        }
    }
    strokes
}

/// Draws strokes and asserts that each keeps the rules of its tool.
fn draw_strokes<const N: usize>(
    scene: &Mutex<Scene<N>>,
    strokes: impl Iterator<Item = Stroke>,
) -> Vec<(Stroke, StrokeFigures)>
where
    Grid<N>: Size,
{
    let mut scene = scene.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut drawn, mut broken) = (Vec::new(), Vec::new());
    for stroke in strokes {
        let figures = scene.draw(stroke);
        if !keeps_rules(&stroke, &figures) {
            broken.push(format!("{N} {stroke}: {figures}"));
        }
        drawn.push((stroke, figures));
    }
    scene.check_invariants();
    for (s, f) in &drawn {
        println!("{N} {s}: {f}");
    }
    assert!(broken.is_empty(), "{broken:#?}");
    drawn
}

/// Returns `true` if a stroke keeps the rules that hold at any press and speed.
fn keeps_rules(stroke: &Stroke, figures: &StrokeFigures) -> bool {
    let Stroke { bit, stone, is_rough, pressed_mm, speed_mm } = *stroke;
    let StrokeFigures { behind, aside, stood, asked, left, stray, bare, parts, .. } = *figures;
    let follows = |most_behind: f32| behind <= most_behind && aside < 0.2 && stood == 0;
    let cuts_all =
        |most_left: u32| left <= most_left && (pressed_mm < 4.0 || asked > 0 && bare == 0);
    let is_true_to_its_tool = match bit {
        ToolBit::SmallBall
        | ToolBit::MediumBall
        | ToolBit::LargeBall
        | ToolBit::RoughingBall
        | ToolBit::DiscSaw => follows(0.1) && cuts_all(0),
        ToolBit::Cylinder => follows(1.0) && cuts_all(asked / 100),
        ToolBit::Grinder => follows(4.0) && cuts_all(asked / 100),
        ToolBit::Nozzle => follows(0.1) && left <= asked / 10 && (bare, parts) == (0, 1),
        ToolBit::PointChisel | ToolBit::FlatChisel => {
            behind <= if speed_mm > SLOW { 20.0 } else { 3.0 }
        }
        // Even stone stays even.
        ToolBit::File if stone == Stone::Flat && !is_rough => follows(0.1) && parts == 0,
        // Round stone has steps, which count as odd voxels as roughness does. The float works the plane of
        // its pull, which leaves round stone.
        ToolBit::Float => follows(0.1),
        // The pitching chisel is set and struck, not drawn.
        ToolBit::PitchingChisel => true,
        ToolBit::File => follows(0.1) && (stone != Stone::Flat || left <= asked / 4),
    };
    // A bit that slid returns from there straight to its hand's path.
    let can_slide = matches!(bit.spec().shape, BitShape::Box { .. });
    let most_stray = if can_slide { asked / 100 } else { 0 };
    // A file smooths beyond its own path.
    (stray <= most_stray || bit.spec().action.is_rubbing()) && is_true_to_its_tool
}

/// Returns the presses and speeds of the golden files.
fn presses_and_speeds(stone: Stone, bit: ToolBit) -> Vec<[f32; 2]> {
    let top = top_speed(bit);
    match stone {
        Stone::Flat => vec![[0.0, top], [4.0, top], [10.0, SLOW], [10.0, top]],
        _ => vec![[4.0, top], [10.0, top]],
    }
}

/// Draws the first of `parts` shares of the strokes (the nightly run draws all), and compares the
/// measurements with the golden file, or writes that file. A stroke's measurements depend on the ticks before
/// it, so strokes in between can't be left out.
fn check_or_write_golden<const N: usize>(scene: &Mutex<Scene<N>>, parts: u32)
where
    Grid<N>: Size,
{
    let writes = std::env::var("PAROS_GOLDEN").as_deref() == Ok("write");
    let strokes = list_strokes(presses_and_speeds);
    let parts = if writes { 1 } else { scaled_step(parts) };
    let (count, all) = (strokes.len().div_ceil(parts as usize), strokes.len());
    let drawn = draw_strokes(scene, strokes.into_iter().take(count));
    let now = drawn.iter().map(|(stroke, figures)| format!("{stroke}: {figures}"));
    let head = "# Strokes of every bit; see tests/core/tests/tool_strokes.";
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join("../goldens").join(format!("tool-strokes-{N}.txt"));
    if writes {
        let lines = std::iter::once(head.to_string()).chain(now);
        let text: String = lines.map(|line| line + "\n").collect();
        return std::fs::write(&path, text).expect("the golden file");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    let (first, lines) = kept.split_once('\n').unwrap_or_default();
    let again = "write it: PAROS_GOLDEN=write cargo test -p paros-tests-core tool_strokes";
    assert!(first == head && lines.ends_with('\n'), "no golden file; {again}");
    assert_eq!(lines.lines().count(), all, "{again}");
    for (was, is) in lines.lines().zip(now) {
        assert!(was == is, "{was}, now {is}; if it was meant to, {again}");
    }
}

#[test]
fn bits_draw_the_strokes_that_they_did_at_128() {
    check_or_write_golden(&AT_128, 1);
}

#[test]
fn bits_draw_the_strokes_that_they_did_at_256() {
    check_or_write_golden(&AT_256, 9);
}

#[test]
#[ignore = "some minutes: for `.ci/nightly`"]
fn every_press_and_speed() {
    let grid = |_, bit| {
        let speeds = [SLOW, 0.8, 1.4, 2.2].into_iter().filter(move |speed| *speed < top_speed(bit));
        let presses = [0.0, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0];
        speeds
            .chain([top_speed(bit)])
            .flat_map(|speed| presses.map(|pressed| [pressed, speed]))
            .collect()
    };
    let at_128 = draw_strokes(&AT_128, list_strokes(grid).into_iter()).len();
    let at_256 = draw_strokes(&AT_256, list_strokes(grid).into_iter()).len();
    println!("{at_128} and {at_256} strokes");
}
