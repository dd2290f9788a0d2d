//! The shell in a session of a real runtime, Monado: a scripted hand sculpts, a killed shell goes
//! on, and what is missing is said. Vulkan's validation looks on.
//!
//! The pictures are left in the tests' folder, to be looked at.
#![cfg(unix)]

mod asked;
mod foveation;
mod frugal;
mod handover;
mod layered;
mod monado;
mod refusals;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use glam::{Quat, Vec3, Vec4Swizzles};
use monado::{Hand, Hands, Monado, Shell, Tree};
use paros_core::frame::STOOL;
use paros_core::input::METRE;
use paros_core::size::Grid;
use paros_core::tools::Tool;
use paros_core::workbench::Item;
use paros_shaders::gpu::{Eye, Fov};
use paros_shell::require::require;
use paros_shell::statics::Resident;
use paros_shell::trace::Trace;

const RIGHT: usize = 1;

/// Hands out of the way of the pictures.
const REST: Hand = Hand::at(0.35, 0.75, 0.0);
const LEFT_REST: Hand = Hand::at(-0.35, 0.75, 0.0);

/// A visitor's, before anything is done.
fn hands_at_rest(monado: &Monado) -> Hands {
    let mut hands = monado.hands();
    hands.look(&eyes());
    hands.hold(0, LEFT_REST);
    hands.hold(RIGHT, REST);
    hands
}

/// A visitor before the stone, who looks down at it.
fn eyes() -> [Eye; 2] {
    let rotation = Quat::from_rotation_x(-0.35);
    let fov = Fov { left: -0.6, right: 0.6, up: 0.5, down: -0.5 };
    [-0.032, 0.032].map(|x| Eye { position: Vec3::new(x, 1.45, 0.35), rotation, fov })
}

/// Brings the hand to a tool of the bench and takes it.
fn take(hands: &mut monado::Hands, shell: &mut Shell, tool: Tool) {
    let home = Item::Tool(tool).home();
    let there = Hand { position: home, ..REST };
    hands.hold(RIGHT, there);
    shell.frames(3);
    hands.hold(RIGHT, Hand { squeeze: 1.0, ..there });
    let name = tool.first_bit().data().name;
    shell.until("the tool", |said| said.field("holds").contains(&format!("{name:?}]")));
    hands.hold(RIGHT, there);
    shell.frames(2);
}

/// Drives a running tool from before the stone into it, until so many voxels are gone.
fn carve(hands: &mut monado::Hands, shell: &mut Shell, voxels: u64) -> Vec3 {
    let before = shell.say().number("voxels");
    let reach = Tool::Rotary.length() as f32 * 1e-6;
    let ahead = |z: f32| Hand { trigger: 1.0, ..Hand::at(0.05, STOOL.y + 0.27, z + reach) };
    let mut z = -0.2;
    loop {
        hands.hold(RIGHT, ahead(z));
        let gone = before - shell.frames(2).number("voxels");
        if gone >= voxels {
            break;
        }
        z -= 0.01;
        assert!(z > -0.6, "{gone} voxels are gone");
    }
    hands.hold(RIGHT, Hand::at(0.05, STOOL.y + 0.27, 0.1));
    shell.frames(2);
    hands.hold(RIGHT, REST);
    // The chips have settled and gone.
    let now = shell.say().number("ticks");
    shell.until("the chips", |said| said.number("ticks") > now + 250);
    Vec3::new(0.05, STOOL.y + 0.27, -0.33)
}

/// Red, green and blue of a picture that the shell wrote.
fn pixels(path: &Path) -> (usize, usize, Vec<u8>) {
    let file = std::io::BufReader::new(fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("it has a size")];
    let info = reader.next_frame(&mut pixels).expect("a picture");
    (info.width as usize, info.height as usize, pixels)
}

/// Where two pictures differ: how many pixels, and their mean place.
fn changed(a: &Path, b: &Path) -> (usize, [f32; 2]) {
    let ((width, _, a), (.., b)) = (pixels(a), pixels(b));
    let (mut count, mut sum) = (0, [0.0; 2]);
    for (i, (a, b)) in a.chunks_exact(3).zip(b.chunks_exact(3)).enumerate() {
        if a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 24) {
            count += 1;
            sum = [sum[0] + (i % width) as f32, sum[1] + (i / width) as f32];
        }
    }
    (count, sum.map(|sum| sum / count.max(1) as f32))
}

/// The pixel of a point in the room.
fn pixel_of(eye: &Eye, point: Vec3, path: &Path) -> [f32; 2] {
    let (width, height, _) = pixels(path);
    let clip = eye.clip_from_room() * point.extend(1.0);
    let at = clip.xy() / clip.w * 0.5 + 0.5;
    [at.x * width as f32, at.y * height as f32]
}

#[test]
fn a_scripted_hand_takes_a_tool_and_carves() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let monado = Monado::start(&tree, "carves");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.shell(&["--record", "live.trace"]);
    shell.until("focus", |said| said.field("life") == "focused");
    shell.until("a session", |said| said.field("session") == "Sculpting");
    take(&mut hands, &mut shell, Tool::Rotary);
    hands.hold(RIGHT, REST);
    shell.frames(4);

    let before = shell.shot(&monado.folder, "before");
    let place = carve(&mut hands, &mut shell, 3000);
    let after = shell.shot(&monado.folder, "after");
    for eye in 0..2 {
        let (count, mean) = changed(&before[eye], &after[eye]);
        let there = pixel_of(&eyes()[eye], place, &after[eye]);
        let off = (mean[0] - there[0]).hypot(mean[1] - there[1]);
        assert!(count > 50 && off < 25.0, "eye {eye}: {count} pixels at {mean:?}, not {there:?}");
    }
    assert!(changed(&after[0], &after[1]).0 > 500, "both eyes see the same");

    loses_tracking_and_recovers(&mut hands, &mut shell);
    monado.recentre();
    shell.frames(6);
    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("recentred"), "{errors}");
    monado.assert_valid();
    let states = ["Idle", "Ready", "Synchronized", "Visible", "Focused", "Visible", "Synchronized"];
    let mut rest = &errors[..];
    for state in states.into_iter().chain(["Stopping", "Idle", "Exiting"]) {
        let line = format!("paros-quest: {state}\n");
        let at = rest.find(&line).unwrap_or_else(|| panic!("no {state} in its turn: {errors}"));
        rest = &rest[at + line.len()..];
    }
    the_trace_is_of_these_hands(&monado.folder.join("live.trace"));
    replays_alike(&monado.folder);
}

/// The hand is gone with its trigger pulled, and goes through the stone: nothing is cut.
fn loses_tracking_and_recovers(hands: &mut monado::Hands, shell: &mut Shell) {
    let voxels = shell.say().number("voxels");
    let beside = Hand { trigger: 1.0, ..Hand::at(0.6, 1.1, -0.3) };
    hands.hold(RIGHT, beside);
    shell.frames(2);
    hands.hold(RIGHT, Hand { active: false, ..beside });
    let lost = shell.until("the loss", |said| said.field("tracked") == "[true, false]");
    assert!(lost.field("holds").contains("burr"), "what it holds is kept");
    let within = Hand { position: Vec3::new(0.0, 1.1, -0.3), ..beside };
    hands.hold(RIGHT, Hand { active: false, ..within });
    shell.frames(3);
    hands.hold(RIGHT, Hand { trigger: 0.0, ..beside });
    shell.until("the hand", |said| said.field("tracked") == "[true, true]");
    assert_eq!(shell.frames(3).number("voxels"), voxels);
    // The controller is put down: the bare hand takes over.
    hands.hold(RIGHT, Hand { active: false, bare: true, ..REST });
    shell.frames(3);
    assert_eq!(shell.say().field("tracked"), "[true, true]");
    hands.hold(RIGHT, REST);
    shell.frames(2);
}

/// What the driver was told is what the core was told.
fn the_trace_is_of_these_hands(path: &Path) {
    let trace = Trace::read(path).expect("a trace");
    let home = Item::Tool(Tool::Rotary).home();
    let near = |position: [i32; 3]| {
        let metres = Vec3::from_array(position.map(|v| v as f32 / METRE as f32));
        metres.distance(home) < 0.002
    };
    let ticks = trace.records().filter(|record| near(record.input.hands[RIGHT].grip.position));
    assert!(ticks.count() > 3, "the hand was never at the bench");
}

/// A trace recorded here replays here, and in the desktop's shell, to the same digests.
fn replays_alike(folder: &Path) {
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let played = output(Command::new(quest).current_dir(folder).args([
        "--replay",
        "live.trace",
        "--digests",
        "here",
    ]));
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let paros = quest.with_file_name("paros");
    let found = paros.exists().then_some(()).ok_or("no paros beside paros-quest: build it");
    if require(found).unwrap().is_none() {
        return;
    }
    let play = ["play", "live.trace", "--digests", "there"];
    let played = output(Command::new(paros).current_dir(folder).args(play));
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let digests = ["here", "there"].map(|name| fs::read(folder.join(name)).expect("digests"));
    assert!(!digests[0].is_empty() && digests[0] == digests[1], "two shells, two lists");
}

#[test]
fn a_killed_shell_goes_on_where_it_was() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let monado = Monado::start(&tree, "killed");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.shell(&[]);
    shell.until("a session", |said| said.field("session") == "Sculpting");
    take(&mut hands, &mut shell, Tool::Rotary);
    carve(&mut hands, &mut shell, 1000);
    let said = shell.say();
    let (voxels, undo) = (said.number("voxels"), said.number("undo"));
    let errors = shell.kill();
    assert!(!errors.contains("goes on"), "{errors}");

    let programs = monado.folder.join("files/cache/pipelines.bin");
    assert!(fs::metadata(programs).expect("the driver's programs").len() > 0);
    let saved = fs::read(monado.folder.join("files/sessions/session-128.save")).expect("a save");
    let mut world = Grid::<128>::world();
    world.load(&saved).expect("a whole save");
    let digest = format!("digest {:016x}", world.digest());
    let mut shell = monado.shell(&[]);
    let again = shell.until("focus", |said| said.field("life") == "focused");
    assert_eq!((again.number("voxels"), again.number("undo")), (voxels, undo));
    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains(&digest), "{digest} in: {errors}");
}

#[test]
fn what_is_missing_is_said() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let folder = monado::folder("missing");
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let refuses = |command: &mut Command, word: &str| {
        let ended = output(command.arg("--folder").arg(&folder));
        let errors = String::from_utf8_lossy(&ended.stderr);
        let last = errors.lines().last().unwrap_or_default();
        assert_eq!(ended.status.code(), Some(1), "{errors}");
        assert!(last.starts_with("paros-quest: ") && last.contains(word), "{word}: {errors}");
    };
    // No service behind the runtime, no runtime at all.
    refuses(&mut tree.command(quest, &folder), "no OpenXR runtime answers");
    let none = PathBuf::from("/nonexistent");
    let mut command = tree.command(quest, &folder);
    refuses(command.env("XR_RUNTIME_JSON", &none), "no OpenXR runtime answers");
}

fn output(command: &mut Command) -> Output {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    monado::wait_for("its end", || child.try_wait().expect("it is ours").is_some());
    child.wait_with_output().expect("it has ended")
}
