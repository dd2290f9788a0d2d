//! End-to-end tests in a session of a real runtime, Monado, with Vulkan's validation enabled: a scripted
//! hand sculpts, a killed shell resumes, and a missing runtime is reported.
//!
//! Captured frames stay in the tests' folder, for inspection.

mod asked;
mod bare_hands;
mod foveation;
mod frugal;
mod handover;
mod layered;
mod monado;
mod placement;
mod refusals;
mod resolution;
mod sleep;
mod start;
mod visits;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use glam::{Quat, Vec3, Vec4Swizzles};
use monado::{MonadoService, MonadoTree, RemoteHand, RemoteHands, ShellEnd, ShellProcess};
use paros_core::internals::{STOOL_TOP, UNITS_PER_METRE};
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, Tool};
use paros_core::volume::Grid;
use paros_shaders::gpu::{Eye, Fov};
use paros_shell::require::require_or_skip;
use paros_shell::statics::Resident;
use paros_shell::trace::Trace;

const RIGHT: usize = 1;

/// Rest positions of the hands, outside the captured frames.
const REST: RemoteHand = RemoteHand::at(0.35, 0.75, 0.0);
const LEFT_REST: RemoteHand = RemoteHand::at(-0.35, 0.75, 0.0);

/// Connects to the driver, places the head in front of the stone, looking over it, and both hands at rest.
fn hands_at_rest(monado: &MonadoService) -> RemoteHands {
    let mut hands = monado.connect_hands();
    hands.place_eyes(&looking_over_stone(visitor_eyes()));
    hands.place_hand(0, LEFT_REST);
    hands.place_hand(RIGHT, REST);
    hands
}

/// Returns the eyes of a visitor in front of the stone, looking down at it.
fn visitor_eyes() -> [Eye; 2] {
    eyes_at(Vec3::new(0.0, 1.45, 0.35), Quat::from_rotation_x(-0.35))
}

/// The field of view of an eye: angles in radians.
const FOV: Fov = Fov { left: -0.6, right: 0.6, up: 0.5, down: -0.5 };

/// Turns the field of view above the stone: a software device draws the wall several times as fast.
fn looking_over_stone(eyes: [Eye; 2]) -> [Eye; 2] {
    eyes.map(|eye| Eye { fov: Fov { up: 1.1, down: 0.55, ..FOV }, ..eye })
}

/// Returns the eyes of a head.
fn eyes_at(head: Vec3, rotation: Quat) -> [Eye; 2] {
    let eye = |x| Eye { position: head + rotation * Vec3::new(x, 0.0, 0.0), rotation, fov: FOV };
    [-0.032, 0.032].map(eye)
}

/// Moves the right hand to a tool of the bench, squeezes, and waits until the tool is held.
fn take_tool(hands: &mut monado::RemoteHands, shell: &mut ShellProcess, tool: Tool) {
    let home = BenchItem::Tool(tool).home_position();
    let there = RemoteHand { position: home, ..REST };
    hands.place_hand(RIGHT, there);
    shell.wait_frames(3);
    hands.place_hand(RIGHT, RemoteHand { squeeze: 1.0, ..there });
    let name = tool.default_bit().spec().name;
    shell.wait_until("the tool", |said| said.field("holds").contains(&format!("{name:?}]")));
    hands.place_hand(RIGHT, there);
    shell.wait_frames(2);
}

/// Pushes the running tool into the stone until `voxels` voxels are gone, and waits until the chips have
/// settled. Returns the carved place in the room.
fn carve_voxels(hands: &mut monado::RemoteHands, shell: &mut ShellProcess, voxels: u64) -> Vec3 {
    let before = shell.query_status().number("voxels");
    let reach = Tool::Rotary.length_um() as f32 * 1e-6;
    let ahead =
        |z: f32| RemoteHand { trigger: 1.0, ..RemoteHand::at(0.05, STOOL_TOP.y + 0.27, z + reach) };
    let mut z = -0.2;
    loop {
        hands.place_hand(RIGHT, ahead(z));
        let gone = before - shell.wait_frames(2).number("voxels");
        if gone >= voxels {
            break;
        }
        z -= 0.01;
        assert!(z > -0.6, "{gone} voxels are gone");
    }
    hands.place_hand(RIGHT, RemoteHand::at(0.05, STOOL_TOP.y + 0.27, 0.1));
    shell.wait_frames(2);
    hands.place_hand(RIGHT, REST);
    // Wait until the chips have settled and disappeared.
    let now = shell.query_status().number("ticks");
    shell.wait_until("the chips", |said| said.number("ticks") > now + 250);
    Vec3::new(0.05, STOOL_TOP.y + 0.27, -0.33)
}

/// A captured frame.
struct CapturedFrame {
    width: usize,
    height: usize,
    /// Red, green and blue of each pixel.
    rgb: Vec<u8>,
}

fn read_frame(path: &Path) -> CapturedFrame {
    let file = std::io::BufReader::new(fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let mut rgb = vec![0; reader.output_buffer_size().expect("it has a size")];
    let info = reader.next_frame(&mut rgb).expect("a picture");
    CapturedFrame { width: info.width as usize, height: info.height as usize, rgb }
}

/// The pixels that differ by more than 24 in a colour channel.
struct ChangedPixels {
    count: usize,
    /// Column and row.
    centroid: [f32; 2],
}

/// Compares two captured frames.
fn compare_frames(before: &Path, after: &Path) -> ChangedPixels {
    let (before, after) = (read_frame(before), read_frame(after));
    let (mut count, mut sum) = (0, [0.0; 2]);
    for (i, (a, b)) in before.rgb.chunks_exact(3).zip(after.rgb.chunks_exact(3)).enumerate() {
        if a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 24) {
            count += 1;
            sum = [sum[0] + (i % before.width) as f32, sum[1] + (i / before.width) as f32];
        }
    }
    ChangedPixels { count, centroid: sum.map(|sum| sum / count.max(1) as f32) }
}

/// Projects a point of the room to a pixel of an eye's frame.
fn project_to_pixel(eye: &Eye, room_point: Vec3, frame: &Path) -> [f32; 2] {
    let CapturedFrame { width, height, .. } = read_frame(frame);
    let clip = eye.clip_from_room() * room_point.extend(1.0);
    let at = clip.xy() / clip.w * 0.5 + 0.5;
    [at.x * width as f32, at.y * height as f32]
}

#[test]
fn a_scripted_hand_takes_a_tool_and_carves() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let monado = MonadoService::start(&tree, "carves");
    let mut hands = hands_at_rest(&monado);
    hands.place_eyes(&visitor_eyes());
    let mut shell = monado.start_shell(&["--record", "live.trace"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(4);

    let before = shell.capture_eyes(&monado.folder, "before");
    let place = carve_voxels(&mut hands, &mut shell, 3000);
    let after = shell.capture_eyes(&monado.folder, "after");
    for eye in 0..2 {
        let ChangedPixels { count, centroid: mean } = compare_frames(&before[eye], &after[eye]);
        let there = project_to_pixel(&visitor_eyes()[eye], place, &after[eye]);
        let off = (mean[0] - there[0]).hypot(mean[1] - there[1]);
        assert!(count > 50 && off < 25.0, "eye {eye}: {count} pixels at {mean:?}, not {there:?}");
    }
    assert!(compare_frames(&after[0], &after[1]).count > 500, "both eyes see the same");

    lose_and_regain_tracking(&mut hands, &mut shell);
    monado.recentre();
    shell.wait_frames(6);
    let ShellEnd { code, errors } = shell.quit();
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
    assert_trace_holds_hands(&monado.folder.join("live.trace"));
    assert_replays_alike(&monado.folder);
}

/// Loses tracking while the trigger is pulled, and moves the hand through the stone: nothing may be cut.
fn lose_and_regain_tracking(hands: &mut monado::RemoteHands, shell: &mut ShellProcess) {
    let voxels = shell.query_status().number("voxels");
    let beside = RemoteHand { trigger: 1.0, ..RemoteHand::at(0.6, 1.1, -0.3) };
    hands.place_hand(RIGHT, beside);
    shell.wait_frames(2);
    hands.place_hand(RIGHT, RemoteHand { active: false, ..beside });
    let lost = shell.wait_until("the loss", |said| said.field("tracked") == "[true, false]");
    assert!(lost.field("holds").contains("burr"), "what it holds is kept");
    let within = RemoteHand { position: Vec3::new(0.0, 1.1, -0.3), ..beside };
    hands.place_hand(RIGHT, RemoteHand { active: false, ..within });
    shell.wait_frames(3);
    hands.place_hand(RIGHT, RemoteHand { trigger: 0.0, ..beside });
    shell.wait_until("the hand", |said| said.field("tracked") == "[true, true]");
    assert_eq!(shell.wait_frames(3).number("voxels"), voxels);
    // The controller is put down: the bare hand takes over.
    hands.place_hand(RIGHT, RemoteHand { active: false, bare: true, ..REST });
    shell.wait_frames(3);
    assert_eq!(shell.query_status().field("tracked"), "[true, true]");
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(2);
}

/// Asserts that the recorded trace contains the poses that were sent to the driver.
fn assert_trace_holds_hands(path: &Path) {
    let trace = Trace::read(path).expect("a trace");
    let home = BenchItem::Tool(Tool::Rotary).home_position();
    let near = |position: [i32; 3]| {
        let metres = Vec3::from_array(position.map(|v| v as f32 / UNITS_PER_METRE as f32));
        metres.distance(home) < 0.002
    };
    let ticks = trace.records().filter(|record| near(record.input.hands[RIGHT].grip.position));
    assert!(ticks.count() > 3, "the hand was never at the bench");
}

/// Asserts that the recorded trace replays to the same digests here and in the desktop's shell.
fn assert_replays_alike(folder: &Path) {
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let played = run_to_end(Command::new(quest).current_dir(folder).args([
        "--replay",
        "live.trace",
        "--digests",
        "here",
    ]));
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let paros = quest.with_file_name("paros");
    let found = paros.exists().then_some(()).ok_or("no paros beside paros-quest: build it");
    if require_or_skip(found).unwrap().is_none() {
        return;
    }
    let play = ["play", "live.trace", "--digests", "there"];
    let played = run_to_end(Command::new(paros).current_dir(folder).args(play));
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let digests = ["here", "there"].map(|name| fs::read(folder.join(name)).expect("digests"));
    assert!(!digests[0].is_empty() && digests[0] == digests[1], "two shells, two lists");
}

#[test]
fn a_killed_shell_goes_on_where_it_was() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let monado = MonadoService::start(&tree, "killed");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.start_shell(&[]);
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    carve_voxels(&mut hands, &mut shell, 1000);
    let said = shell.query_status();
    let (voxels, undo) = (said.number("voxels"), said.number("undo"));
    let errors = shell.kill();
    assert!(!errors.contains("goes on"), "{errors}");

    let programs = monado.folder.join("files/cache/pipelines.bin");
    assert!(fs::metadata(programs).expect("the driver's programs").len() > 0);
    let saved = fs::read(monado.folder.join("files/sessions/session-128.save")).expect("a save");
    let world = &mut <Grid<128> as Resident<128, INTERVALS>>::lock_world().world;
    world.load(&saved).expect("a whole save");
    let digest = format!("digest {:016x}", world.digest());
    let mut shell = monado.start_shell(&[]);
    let again = shell.wait_until("focus", |said| said.field("life") == "focused");
    assert_eq!((again.number("voxels"), again.number("undo")), (voxels, undo));
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains(&digest), "{digest} in: {errors}");
}

#[test]
fn what_is_missing_is_said() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let folder = monado::create_empty_folder("missing");
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let refuses = |command: &mut Command, word: &str| {
        let ended = run_to_end(command.arg("--folder").arg(&folder));
        let errors = String::from_utf8_lossy(&ended.stderr);
        let last = errors.lines().last().unwrap_or_default();
        assert_eq!(ended.status.code(), Some(1), "{errors}");
        assert!(last.starts_with("paros-quest: ") && last.contains(word), "{word}: {errors}");
        assert!(errors.contains("no picture can tell of it in the headset: "), "{errors}");
    };
    // First no service behind the runtime, then no runtime at all.
    refuses(&mut tree.command(quest, &folder), "no OpenXR runtime answers");
    let none = PathBuf::from("/nonexistent");
    let mut command = tree.command(quest, &folder);
    refuses(command.env("XR_RUNTIME_JSON", &none), "no OpenXR runtime answers");
}

/// Runs a command to its end and collects its output.
fn run_to_end(command: &mut Command) -> Output {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    monado::wait_for("its end", || child.try_wait().expect("it is ours").is_some());
    child.wait_with_output().expect("it has ended")
}
