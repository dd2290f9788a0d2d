//! A newcomer at the window: no terminal and no script, only a mouse, a keyboard and the screen.

use std::fs;
use std::mem;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_shaders::Image;
use paros_shell::require::{MissingDependency, require_or_skip};

use super::desktop::WindowManager;
use super::rig::{XvfbDisplay, check_program, count_differing, empty_folder, paros_command};
use super::visit::check_print;

/// Timeout until a change is seen: the device is slow.
const PATIENCE: Duration = Duration::from_secs(60);

/// Waits for a condition.
fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "{what}: not within {PATIENCE:?}");
        thread::sleep(Duration::from_millis(200));
    }
}

/// Counts the changed pixels in the middle of the picture, where the stone is.
fn changed_pixels(before: &Image, after: &Image) -> usize {
    count_differing(before, after, [420, 780], [200, 640])
}

/// Waits until the stroke is drawn completely, on any device: two pictures a second apart are equal.
fn wait_until_still(look: impl Fn() -> Image) -> Image {
    let mut last = look();
    wait_until("a picture that stays", || {
        thread::sleep(Duration::from_secs(1));
        let next = look();
        let before = mem::replace(&mut last, next);
        changed_pixels(&before, &last) < 100
    });
    last
}

fn drag_mouse(display: &XvfbDisplay, from: [i32; 2], to: [i32; 2]) {
    display.xdotool(&format!("mousemove {} {}", from[0], from[1]));
    thread::sleep(Duration::from_millis(600));
    display.xdotool("mousedown 1");
    for step in 0..=20 {
        let [x, y] = [0, 1].map(|i| from[i] + (to[i] - from[i]) * step / 20);
        display.xdotool(&format!("mousemove {x} {y}"));
        thread::sleep(Duration::from_millis(80));
    }
    thread::sleep(Duration::from_millis(900));
    display.xdotool("mouseup 1");
    // Moves the cursor off the stone, so that the tool isn't in the picture.
    display.xdotool("mousemove 60 790");
}

#[test]
fn a_newcomer_goes_from_launch_to_a_print_without_a_terminal() -> Result<(), MissingDependency> {
    let folder = empty_folder("newcomer");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, [1200, 890]))? else {
        return Ok(());
    };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let Some(_manager) = require_or_skip(WindowManager::new(&display))? else { return Ok(()) };
    let mut program = launch_paros(&display);
    let look = |name: &str| display.save_screenshot(name);
    let launch = look("1-launch");
    display.xdotool("mousemove 480 270");
    thread::sleep(Duration::from_secs(1));
    display.xdotool("click 1");
    wait_until("the stone", || {
        count_differing(&launch, &look("2-stone"), [300, 900], [150, 700]) > 60_000
    });
    thread::sleep(Duration::from_secs(2));
    display.xdotool("mousemove 60 790");
    thread::sleep(Duration::from_secs(2));
    let stone = look("2-stone");
    drag_mouse(&display, [500, 360], [650, 400]);
    wait_until("the groove", || changed_pixels(&stone, &look("3-carved")) > 800);
    let carved = wait_until_still(|| look("3-carved"));
    display.xdotool("key z");
    wait_until("the stone made whole", || changed_pixels(&stone, &look("4-undone")) < 100);
    display.xdotool("key y");
    wait_until("the groove again", || changed_pixels(&stone, &look("5-redone")) > 800);
    drag_mouse(&display, [490, 470], [650, 520]);
    wait_until("another groove", || changed_pixels(&carved, &look("6-carved-on")) > 800);
    wait_until_still(|| look("6-carved-on"));
    display.xdotool("key Return");
    let sculpted = look("6-carved-on");
    wait_until("the question", || {
        count_differing(&sculpted, &look("7-asked"), [300, 900], [720, 820]) > 10_000
    });
    display.xdotool("key Return");
    let print = folder.join("Paros/sculpture-001.stl");
    wait_until("the print", || print.exists());
    thread::sleep(Duration::from_secs(2));
    look("8-finished");
    display.xdotool("key alt+F4");
    let output = wait_for_exit(&mut program);
    assert_eq!(output, (Some(0), format!("{}\n", print.display()), String::new()));
    check_print(&print)?;
    let picture = fs::read(print.with_extension("png")).expect("a picture");
    assert!(picture.starts_with(b"\x89PNG"));
    rmap_is_read(&folder, &print.with_extension("rmap"));
    Ok(())
}

/// Starts the program in a window of its own.
fn launch_paros(display: &XvfbDisplay) -> Child {
    let program = paros_command(&display.folder)
        .env("DISPLAY", &display.name)
        // Messages of the validation layer go to standard output.
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    display.xdotool("search --sync --onlyvisible --name Paros windowmove 0 0");
    display.xdotool("search --name Paros windowfocus");
    wait_until("the start panel", || {
        // The start panel is dark, over the bright stool; the window has a title bar above it.
        let pixel = display.save_screenshot("1-launch").pixel(590, 630);
        pixel[0] > 20 && pixel[0] < 90
    });
    program
}

fn wait_for_exit(program: &mut Child) -> (Option<i32>, String, String) {
    let mut code = None;
    wait_until("the end", || {
        code = program.try_wait().expect("a child");
        code.is_some()
    });
    let read = |from: &mut dyn std::io::Read| {
        let mut text = String::new();
        from.read_to_string(&mut text).expect("text");
        text
    };
    let out = read(program.stdout.as_mut().expect("it is piped"));
    let err = read(program.stderr.as_mut().expect("it is piped"));
    // A machine without a sound card reports that.
    let is_of_sound = |line: &&str| line.starts_with("paros: no sound: ");
    let err = err.split_inclusive('\n').filter(|line| !is_of_sound(line)).collect();
    (code.and_then(|status| status.code()), out, err)
}

fn rmap_is_read(folder: &Path, volume: &Path) {
    let told = paros_command(folder).arg("info").arg(volume).output().expect("it starts");
    assert!(told.status.success(), "{told:?}");
}
