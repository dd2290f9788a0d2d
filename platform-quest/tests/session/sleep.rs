//! Time away: after a kill or a sleep, the session resumes if the break was short, and is handed over if it
//! was long. The device's clock is the tests' own. Head and hands are Monado's, which reports no user
//! presence.

use std::fs;
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::session::Tool;
use paros_shell::require::require_or_skip;

use super::handover::finished_sculptures;
use super::layered::find_rig;
use super::monado::{MonadoService, MonadoTree, RemoteHands, ShellEnd, ShellProcess, wait_for};
use super::{carve_voxels, eyes_at, hands_at_rest, looking_over_stone, take_tool};

/// Sets the time for which the device has slept since it booted, and the identifier of another boot, if any.
fn set_clock(monado: &MonadoService, slept_seconds: u32, boot: &str) {
    fs::write(monado.folder.join("draft"), format!("{slept_seconds} {boot}")).expect("a clock");
    fs::rename(monado.folder.join("draft"), monado.folder.join("clock")).expect("a clock");
}

fn start(monado: &MonadoService, program: &Path) -> ShellProcess {
    let mut shell = monado.start_program(program, &["files", "clock"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell
}

/// Carves, and waits until the session and the time of its last use are on the disk. Returns the remaining
/// voxels.
fn carve_and_save(
    monado: &MonadoService,
    hands: &mut RemoteHands,
    shell: &mut ShellProcess,
) -> u64 {
    take_tool(hands, shell, Tool::Rotary);
    carve_voxels(hands, shell, 500);
    let stamp = monado.folder.join("files/sessions/session-128.last-use");
    wait_for("the time of the last use", || stamp.exists());
    shell.query_status().number("voxels")
}

/// Places a visitor in front of the stool, so that the room need not move.
fn stand_before_stool(hands: &mut RemoteHands, height: f32) {
    let eyes = eyes_at(Vec3::Y * height, Quat::from_rotation_x(-0.3));
    hands.place_eyes(&looking_over_stone(eyes));
}

#[test]
fn a_short_break_goes_on_and_a_long_one_hands_over() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(sleeper) = require_or_skip(find_rig("sleeper")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "sleep");
    let mut hands = hands_at_rest(&monado);
    stand_before_stool(&mut hands, 1.45);
    let mut shell = start(&monado, &sleeper);
    let whole = shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let whole = whole.number("voxels");
    let mut voxels = carve_and_save(&monado, &mut hands, &mut shell);

    // Killed, and restarted after ten seconds.
    shell.kill();
    set_clock(&monado, 10, "");
    let mut shell = start(&monado, &sleeper);
    stand_before_stool(&mut hands, 1.5);
    let again = shell.wait_frames(10);
    assert_eq!((again.number("voxels"), again.field("session")), (voxels, "Sculpting"));
    assert!(again.number("undo") > 0);

    // Asleep for a minute: at first nobody is there, then a visitor is.
    set_clock(&monado, 70, "");
    assert_eq!(shell.wait_frames(10).number("voxels"), voxels);
    assert!(finished_sculptures(&monado, "stl").is_empty());
    stand_before_stool(&mut hands, 1.55);
    let anew = shell.wait_until("a new stone", |said| said.number("voxels") == whole);
    assert_eq!((anew.field("session"), anew.number("undo")), ("Sculpting", 0));
    wait_for("the print", || finished_sculptures(&monado, "stl").len() == 1);

    // Killed, and restarted after a minute; killed, and restarted at once in another boot.
    let other_boot = "00000000-0000-4000-8000-000000000001";
    for (prints, slept, boot) in [(2, 140, ""), (3, 140, other_boot)] {
        voxels = carve_and_save(&monado, &mut hands, &mut shell);
        assert!(voxels < whole);
        shell.kill();
        set_clock(&monado, slept, boot);
        shell = start(&monado, &sleeper);
        let anew = shell.wait_until("a new stone", |said| said.number("voxels") == whole);
        assert_eq!(anew.number("undo"), 0);
        wait_for("the print", || finished_sculptures(&monado, "rmap").len() == prints);
    }
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("a session is found at tick"), "{errors}");
    assert_eq!(errors.matches("another visitor\n").count(), 1, "{errors}");
}
