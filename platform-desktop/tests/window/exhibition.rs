//! Visits in a window: from a stone that is carved for nobody to a badge, by the mouse alone.

use std::fs;

use glam::{Quat, Vec2, Vec3};
use paros_shaders::panel::PanelRect;
use paros_shaders::panel::layout::{self, Clock};
use paros_shaders::panel::{Icon, Message};
use paros_shell::require::{MissingDependency, require_or_skip};
use paros_visit::{PanelSpot, WindowView};

use crate::rig::{
    HEIGHT, ScriptedWindow, WIDTH, XvfbDisplay, count_differing, empty_folder, paros_command,
};

/// Tangent of half the height of a picture that no bar covers, as the window's camera has it.
const HALF: f32 = 0.376_4;

const WELCOME: [f32; 2] = [1080.0, 476.0];

/// Clicks on the middle of a button of a panel that nothing covers.
fn click(visit: &mut ScriptedWindow, spot: PanelSpot, size: [f32; 2], button: PanelRect) {
    let right = HALF * WIDTH as f32 / HEIGHT as f32;
    let view =
        WindowView { position: Vec3::ZERO, rotation: Quat::IDENTITY, right, up: HALF, down: -HALF };
    let pose = view.panel_pose(spot, size);
    let at = (button.middle() - 0.5 * Vec2::from_array(size)) * 1e-3 * pose.scale;
    let seen = pose.middle + Vec3::new(at.x, -at.y, 0.0);
    let [x, y] = [seen.x / -seen.z / right, -seen.y / -seen.z / HALF];
    let to = format!("move {} {}", 50.0 + 50.0 * x, 50.0 + 50.0 * y);
    visit.do_all(&[&to, "wait 4", "press left", "wait 2", "release left", "wait 4"]);
}

#[test]
fn a_visitor_comes_and_leaves_with_a_badge() -> Result<(), MissingDependency> {
    let folder = empty_folder("exhibition");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::spawn_with(
        paros_command(&folder).env("DISPLAY", &display.name),
        &["--visits"],
    );
    visit.do_all(&["size 1000 700", "wait 10"]);
    let stone = visit.voxel_count();
    visit.screenshot(&display, "1-attract");
    visit.do_step("wait 500");
    assert!(visit.voxel_count() < stone, "nobody carves");
    visit.screenshot(&display, "2-attract-later");
    visit.do_all(&["move 50 50", "wait 4"]);
    assert_eq!(visit.ask_state("visit"), "Welcome TakeTool");
    visit.screenshot(&display, "3-welcome");
    let welcome = layout::welcome_buttons(0, 1);
    click(&mut visit, PanelSpot::Main, WELCOME, welcome[1].rect);
    visit.screenshot(&display, "4-welcome-greek");
    click(&mut visit, PanelSpot::Main, WELCOME, welcome[0].rect);
    click(&mut visit, PanelSpot::Main, WELCOME, welcome[6].rect);
    assert_eq!(visit.ask_state("visit"), "Choice TakeTool");
    visit.screenshot(&display, "5-choice");
    let cards = layout::choice_buttons(0, &[(Message::ChoiceFree, Icon::Stone); 3]);
    click(&mut visit, PanelSpot::Main, [1020.0, 580.0], cards[1].rect);
    assert_eq!(visit.ask_state("visit"), "Guided TakeTool");
    assert!(visit.ask_state("mode").starts_with("Constrained"), "the owl's card");
    visit.screenshot(&display, "6-guided");
    visit.do_all(&["key 1", "wait 4", "move 45 70", "wait 20"]);
    visit.screenshot(&display, "7-touch");
    println!("{}", visit.ask_state("visit"));
    visit.do_all(&["press left", "move 55 72", "wait 60", "release left", "wait 20"]);
    println!("{}", visit.ask_state("visit"));
    visit.screenshot(&display, "8-cut");
    let _ = (Clock::default(), fs::metadata(&folder), count_differing);
    let (code, complaints) = visit.close();
    assert_eq!((code, &*complaints), (Some(0), ""));
    Ok(())
}
