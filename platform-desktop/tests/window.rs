//! The window on a display of its own (Xvfb) and a software device (lavapipe): a scripted visitor
//! carves, takes it back and finishes, and the screen shows it. Validation looks on.
//!
//! The screens are left in the test's folder, to be looked at.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use paros_shaders::Image;
use paros_shell::require::{Required, require};

const DRIVER: &str = "/usr/share/vulkan/icd.d/lvp_icd.json";
const LAYER: &str = "/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json";

const WIDTH: usize = 1000;
const HEIGHT: usize = 700;

/// A display without a screen, ended when dropped.
struct Display {
    server: Child,
    name: String,
    folder: PathBuf,
}

impl Display {
    fn new(folder: &Path) -> Result<Self, String> {
        for part in [DRIVER, LAYER] {
            if !Path::new(part).exists() {
                return Err(format!("no {part}"));
            }
        }
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-fbdir"])
            .arg(folder)
            .args(["-screen", "0", &format!("{WIDTH}x{HEIGHT}x24")])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("no Xvfb: {error}"))?;
        let mut number = String::new();
        let out = server.stdout.take().expect("it is piped");
        BufReader::new(out).read_line(&mut number).map_err(|error| error.to_string())?;
        let name = format!(":{}", number.trim());
        Ok(Display { server, name, folder: folder.to_owned() })
    }

    /// What is on the screen, from the file that the server keeps it in (the XWD format).
    fn screen(&self, name: &str) -> Image {
        let bytes = fs::read(self.folder.join("Xvfb_screen0")).expect("the server's file");
        let word = |i: usize| {
            let word: [u8; 4] = bytes[4 * i..4 * i + 4].try_into().expect("four bytes");
            u32::from_be_bytes(word) as usize
        };
        let (header, width, height, row, colors) = (word(0), word(4), word(5), word(12), word(19));
        assert_eq!((width, height, word(11)), (WIDTH, HEIGHT, 32), "pixels of 32 bits");
        let start = header + 12 * colors;
        let mut pixels = Vec::new();
        for y in 0..height {
            let row = &bytes[start + y * row..][..4 * width];
            row.chunks_exact(4).for_each(|p| pixels.extend([p[2], p[1], p[0]]));
        }
        let image = Image { width, height, pixels };
        let mut png = Vec::new();
        image.write_png(&mut png).expect("a picture");
        fs::write(self.folder.join(name).with_extension("png"), png).expect("it is written");
        image
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A window on a display, and the script that it is told.
struct Visit<'a> {
    display: &'a Display,
    window: Child,
    steps: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl<'a> Visit<'a> {
    fn new(display: &'a Display, more: &[&str]) -> Self {
        let mut window = paros(&display.folder)
            .args(["window", "--script", "-", "--validation"])
            .args(more)
            .env("DISPLAY", &display.name)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program can be started");
        let steps = window.stdin.take();
        let answers = BufReader::new(window.stdout.take().expect("it is piped"));
        Visit { display, window, steps, answers }
    }

    /// Does a step, and waits until it is done; what was said meanwhile comes back.
    fn does(&mut self, step: &str) -> String {
        let steps = self.steps.as_mut().expect("the visit goes on");
        writeln!(steps, "{step}").expect("the window listens");
        let (done, mut said) = (format!("done {step}\n"), String::new());
        loop {
            let mut line = String::new();
            let read = self.answers.read_line(&mut line).expect("text");
            assert_ne!(read, 0, "the window closed instead of: {step}; {}", self.complaints());
            if line == done {
                return said;
            }
            said += &line;
        }
    }

    fn do_all(&mut self, steps: &[&str]) {
        for step in steps {
            self.does(step);
        }
    }

    /// What the window says of one thing.
    fn asks(&mut self, what: &str) -> String {
        let said = self.does("say");
        let after = said.split("; ").find_map(|part| part.trim().strip_prefix(what));
        after.unwrap_or_else(|| panic!("nothing of {what} in: {said}")).trim().to_owned()
    }

    fn voxels(&mut self) -> u64 {
        self.asks("voxels").parse().expect("a number")
    }

    /// What the screen shows once all is drawn.
    fn sees(&mut self, name: &str) -> Image {
        self.does("frames 40");
        self.display.screen(name)
    }

    /// Ends the visit: the exit code and what was complained of.
    fn ends(mut self) -> (Option<i32>, String) {
        drop(self.steps.take());
        let complaints = self.complaints();
        (self.window.wait().expect("it ends").code(), complaints)
    }

    fn complaints(&mut self) -> String {
        let mut text = String::new();
        if let Some(mut from) = self.window.stderr.take() {
            std::io::Read::read_to_string(&mut from, &mut text).expect("text");
        }
        text
    }
}

fn paros(folder: &Path) -> Command {
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros
        .env("VK_DRIVER_FILES", DRIVER)
        .env("XDG_DATA_HOME", folder.join("data"))
        .env("XDG_CACHE_HOME", folder.join("cache"))
        .env("HOME", folder)
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    paros
}

/// An empty folder for a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Pixels of a rectangle that differ clearly.
fn differing(a: &Image, b: &Image, x: [usize; 2], y: [usize; 2]) -> usize {
    let far = |x: usize, y: usize| {
        let (a, b) = (a.pixel(x, y), b.pixel(x, y));
        (0..3).any(|k| a[k].abs_diff(b[k]) > 12)
    };
    (y[0]..y[1]).map(|y| (x[0]..x[1]).filter(|x| far(*x, y)).count()).sum()
}

const STROKE: [&str; 8] = [
    "move 42 42",
    "wait 12",
    "press left",
    "wait 8",
    "move 56 46",
    "wait 60",
    "release left",
    "wait 4",
];

#[test]
fn a_visitor_carves_undoes_and_finishes() -> Result<(), Required> {
    let folder = folder("visit");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let mut visit = Visit::new(&display, &[]);
    let start = visit.sees("1-start");
    visit.do_all(&["start free", "wait 4", "wheel -6", "move 3 97"]);
    let whole = visit.voxels();
    let stone = visit.sees("2-stone");
    assert!(differing(&start, &stone, [0, WIDTH], [0, HEIGHT]) > 20_000, "the stone is seen");
    visit.do_all(&STROKE);
    visit.does("move 3 97");
    let left = visit.voxels();
    assert!(left + 300 < whole, "{left} voxels are left of {whole}");
    let carved = visit.sees("3-carved");
    let middle = ([340, 660], [180, 440]);
    let groove = differing(&stone, &carved, middle.0, middle.1);
    assert!(groove > 500, "the groove is seen in {groove} pixels");
    visit.does("key z");
    visit.does("wait 2");
    assert_eq!(visit.voxels(), whole);
    let undone = visit.sees("4-undone");
    let still = differing(&stone, &undone, middle.0, middle.1);
    assert!(still * 20 < groove, "{still} pixels are still another");
    visit.do_all(&["key y", "wait 2", "key f1", "key f2"]);
    assert_eq!(visit.voxels(), left);
    visit.sees("5-help");
    // The first asks, the second does it.
    visit.do_all(&["key f1", "key f2", "key enter", "wait 4"]);
    assert_eq!(visit.asks("session"), "Sculpting");
    visit.do_all(&["key enter", "wait 4", "settle"]);
    assert_eq!(visit.asks("session"), "Finished");
    visit.sees("6-finished");
    let print = PathBuf::from(visit.asks("printed"));
    visit.does("key r");
    visit.does("settle");
    let (code, complaints) = visit.ends();
    assert_eq!((code, &*complaints), (Some(0), ""));
    assert!(print.starts_with(folder.join("Paros")), "{}", print.display());
    for ending in ["png", "rmap"] {
        assert!(print.with_extension(ending).exists(), "no {ending}");
    }
    let played = paros(&folder).arg("play").arg(folder.join("Paros/session-001.trace")).output();
    let played = String::from_utf8_lossy(&played.expect("it can be started").stdout).into_owned();
    assert!(played.contains(&format!("{left} voxels")), "{played}");
    check_print(&print)
}

/// The print has triangles, and `admesh` finds nothing to mend.
fn check_print(print: &Path) -> Result<(), Required> {
    assert!(fs::metadata(print).expect("the print").len() > 84);
    let checked = Command::new("admesh").arg(print).output();
    let Some(report) = require(checked.map_err(|error| format!("no admesh: {error}")))? else {
        return Ok(());
    };
    let report = String::from_utf8_lossy(&report.stdout);
    for what in ["Total disconnected facets", "Facets added", "Edges fixed"] {
        let line = report.lines().find(|line| line.starts_with(what));
        let zero = line
            .and_then(|line| line.split(':').nth(1))
            .map(|rest| rest.split_whitespace().next() == Some("0"));
        assert_eq!(zero, Some(true), "{what} in {report}");
    }
    Ok(())
}

#[test]
fn a_mouse_and_keys_do_what_the_help_says() -> Result<(), Required> {
    let folder = folder("devices");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let tool = Command::new("xdotool").arg("version").output();
    let Some(_) = require(tool.map_err(|error| format!("no xdotool: {error}")))? else {
        return Ok(());
    };
    let x = |arguments: &str| {
        let mut tool = Command::new("xdotool");
        tool.env("DISPLAY", &display.name).args(arguments.split(' '));
        assert!(tool.status().expect("it is there").success(), "xdotool {arguments}");
    };
    let mut visit = Visit::new(&display, &[]);
    visit.does("frames 2");
    // The first button of the start panel.
    let window = "search --name Paros windowfocus --sync";
    x(window);
    x("mousemove 440 298");
    visit.does("frames 3");
    x("click 1");
    visit.does("frames 4");
    assert_eq!(
        (visit.asks("session"), visit.asks("mode")),
        ("Sculpting".into(), "FreeForm".into())
    );
    let whole = visit.voxels();
    x("mousemove 430 300");
    visit.does("wait 20");
    x("mousedown 1");
    visit.does("wait 30");
    x("mousemove 520 320");
    visit.does("wait 60");
    x("mouseup 1");
    visit.does("wait 8");
    let left = visit.voxels();
    assert!(left + 100 < whole, "{left} voxels are left of {whole}");
    x("key z");
    visit.does("frames 4");
    assert_eq!(visit.voxels(), whole);
    x("key ctrl+shift+z");
    visit.does("frames 4");
    assert_eq!(visit.voxels(), left);
    for (key, held) in
        [("3", "paste nozzle"), ("1", "medium ball burr"), ("shift+3", "large ball burr")]
    {
        x(&format!("key {key}"));
        visit.does("frames 4");
        assert_eq!(visit.asks("holds"), held);
    }
    let before = visit.sees("1-before");
    x("mousedown 3");
    x("mousemove 700 260");
    x("mouseup 3");
    let turned = visit.sees("2-orbited");
    assert!(differing(&before, &turned, [200, 800], [100, 560]) > 20_000, "the eye went round");
    let (code, complaints) = visit.ends();
    assert_eq!((code, &*complaints), (Some(0), ""));
    Ok(())
}

#[test]
fn sizes_files_and_losses_are_survived() -> Result<(), Required> {
    let folder = folder("survived");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let mut visit = Visit::new(&display, &[]);
    visit.do_all(&["start owl", "wait 4"]);
    visit.do_all(&STROKE);
    let voxels = visit.voxels();
    for (size, name) in [("700 500", "1-small"), ("1000 620", "2-wide"), ("120 90", "3-tiny")] {
        visit.does(&format!("size {size}"));
        visit.does("frames 2");
        visit.sees(name);
        assert_eq!(visit.asks("size"), size.replace(' ', "x"));
    }
    visit.do_all(&["size 1000 700", "frames 3", "minimise", "wait 60", "restore", "frames 3"]);
    fs::write(folder.join("notes.obj"), "a letter, no mesh\n").expect("a file");
    fs::write(folder.join("notes.txt"), "a letter\n").expect("a file");
    for name in ["notes.obj", "notes.txt", "gone.stl"] {
        visit.does(&format!("open {}", folder.join(name).display()));
        visit.does("settle");
        visit.does("wait 4");
        let note = visit.asks("note");
        assert!(note.contains(name), "{note}");
        assert_eq!(visit.voxels(), voxels);
    }
    visit.sees("4-no-mesh");
    visit.do_all(&["lose", "frames 3"]);
    assert!(visit.asks("note").contains("lost and is back"));
    assert_eq!(visit.voxels(), voxels);
    let back = visit.sees("5-back");
    assert!(back.pixel(500, 300)[0] > 90, "the stone is in the middle");
    // A mesh becomes the start of a session.
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n";
    fs::write(folder.join("mesh.obj"), tetrahedron).expect("a file");
    visit.does(&format!("open {}", folder.join("mesh.obj").display()));
    visit.do_all(&["settle", "wait 8"]);
    assert_eq!(visit.asks("mode"), "Own");
    visit.sees("6-mesh");
    let (code, complaints) = visit.ends();
    assert_eq!((code, &*complaints), (Some(0), ""));
    // What was left for the mesh's session is kept beside it.
    assert!(folder.join("data/paros/session-128.before.save").exists());
    Ok(())
}

#[test]
fn a_vanished_display_loses_no_sculpture() -> Result<(), Required> {
    let folder = folder("vanished");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let mut visit = Visit::new(&display, &[]);
    visit.do_all(&["start cat", "wait 4"]);
    visit.do_all(&STROKE);
    visit.does("wait 100");
    visit.does("settle");
    let voxels = visit.voxels();
    let mut window = visit.window;
    drop(display);
    let begun = Instant::now();
    while window.try_wait().expect("a child").is_none() {
        if begun.elapsed() > Duration::from_secs(20) {
            window.kill().expect("it can be ended");
            panic!("the window goes on without a display");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let display = Display::new(&folder).expect("it was there before");
    let mut visit = Visit::new(&display, &[]);
    assert_eq!(visit.voxels(), voxels);
    assert_eq!(visit.asks("mode"), "Constrained { figure: 1 }");
    visit.sees("1-resumed");
    assert_eq!(visit.ends(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn without_a_display_or_a_device_a_line_says_so() -> Result<(), Required> {
    let folder = folder("without");
    let output = paros(&folder).arg("window").env_remove("DISPLAY").output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("no display") && text.lines().count() == 1, "{text}");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let window = |driver: &str, script: &str| {
        fs::write(folder.join("script"), script).expect("a file");
        let mut window = paros(&folder);
        window.env("DISPLAY", &display.name).env("VK_DRIVER_FILES", driver).arg("window");
        let output = window.arg("--script").arg(folder.join("script")).output();
        let output = output.expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = window("/nowhere.json", "quit\n");
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("no window can be opened"), "{text}");
    let (code, text) = window(DRIVER, "wait 1\njump 3\n");
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("line 2: no step: jump 3"), "{text}");
    Ok(())
}

/// Memory of the device that is missing once is asked for anew with another device; where there is
/// none for good, the session is saved and the window says so.
#[test]
fn memory_that_runs_out_loses_no_sculpture() -> Result<(), Required> {
    let folder = folder("starved");
    let Some(display) = require(Display::new(&folder))? else { return Ok(()) };
    let mut visit = Visit::new(&display, &[]);
    visit.do_all(&["start owl", "wait 4"]);
    visit.do_all(&STROKE);
    let voxels = visit.voxels();
    visit.do_all(&["starve 1", "size 700 500", "frames 3", "size 1000 700", "frames 3"]);
    assert!(visit.asks("note").contains("lost and is back"));
    let back = visit.sees("1-back");
    assert!(back.pixel(500, 300)[0] > 90, "the stone is in the middle");
    assert_eq!(visit.ends(), (Some(0), String::new()));
    let mut visit = Visit::new(&display, &[]);
    visit.do_all(&STROKE);
    let left = visit.voxels();
    assert_ne!(left, voxels);
    visit.do_all(&["starve 100000", "size 700 500"]);
    let complaints = visit.complaints();
    assert_eq!(visit.window.wait().expect("it ends").code(), Some(1), "{complaints}");
    assert!(complaints.contains("memory") && complaints.contains("is saved in"), "{complaints}");
    assert_eq!(complaints.lines().count(), 1, "{complaints}");
    let mut visit = Visit::new(&display, &[]);
    assert_eq!(visit.voxels(), left);
    assert_eq!(visit.ends(), (Some(0), String::new()));
    Ok(())
}
