//! Test fixture: a headless X display (Xvfb), a scripted window on it, and screenshots.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_shaders::Image;

pub(crate) const DRIVER: &str = "/usr/share/vulkan/icd.d/lvp_icd.json";
pub(crate) const LAYER: &str = "/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json";

pub(crate) const WIDTH: usize = 1000;
pub(crate) const HEIGHT: usize = 700;

/// An Xvfb server, stopped when dropped.
pub(crate) struct XvfbDisplay {
    server: Child,
    size: [usize; 2],
    pub(crate) name: String,
    pub(crate) folder: PathBuf,
}

impl XvfbDisplay {
    pub(crate) fn new(folder: &Path) -> Result<Self, String> {
        Self::with_size(folder, [WIDTH, HEIGHT])
    }

    pub(crate) fn with_size(folder: &Path, size: [usize; 2]) -> Result<Self, String> {
        check_files(&[DRIVER, LAYER])?;
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-fbdir"])
            .arg(folder)
            .args(["-screen", "0", &format!("{}x{}x24", size[0], size[1])])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("no Xvfb: {error}"))?;
        let mut number = String::new();
        let out = server.stdout.take().expect("it is piped");
        BufReader::new(out).read_line(&mut number).map_err(|error| error.to_string())?;
        let name = format!(":{}", number.trim());
        Ok(XvfbDisplay { server, size, name, folder: folder.to_owned() })
    }

    /// Runs `xdotool`: moves the mouse, presses keys, or manages windows.
    pub(crate) fn xdotool(&self, arguments: &str) {
        let mut tool = Command::new("xdotool");
        tool.env("DISPLAY", &self.name).args(arguments.split(' '));
        assert!(tool.status().expect("it is there").success(), "xdotool {arguments}");
    }

    /// Runs `xdotool` and returns its output.
    pub(crate) fn ask_xdotool(&self, arguments: &str) -> String {
        let mut tool = Command::new("xdotool");
        let told = tool.env("DISPLAY", &self.name).args(arguments.split(' ')).output();
        String::from_utf8_lossy(&told.expect("it is there").stdout).into_owned()
    }

    /// Reads the screen from the server's framebuffer file (XWD format), and writes it as `name.png`.
    pub(crate) fn save_screenshot(&self, name: &str) -> Image {
        let bytes = fs::read(self.folder.join("Xvfb_screen0")).expect("the server's file");
        let word = |i: usize| {
            let word: [u8; 4] = bytes[4 * i..4 * i + 4].try_into().expect("four bytes");
            u32::from_be_bytes(word) as usize
        };
        let (header, width, height, row, colors) = (word(0), word(4), word(5), word(12), word(19));
        assert_eq!(([width, height], word(11)), (self.size, 32), "pixels of 32 bits");
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

impl Drop for XvfbDisplay {
    fn drop(&mut self) {
        // The server may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A `paros window` process whose script is written step by step.
pub(crate) struct ScriptedWindow {
    pub(crate) window: Child,
    steps: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl ScriptedWindow {
    /// Opens a window on a display, with its files in the display's folder.
    pub(crate) fn new(display: &XvfbDisplay) -> Self {
        Self::spawn(paros_command(&display.folder).env("DISPLAY", &display.name))
    }

    /// Opens a window by a command without its arguments.
    pub(crate) fn spawn(paros: &mut Command) -> Self {
        Self::spawn_with(paros, &[])
    }

    /// Opens a window by a command, with these arguments.
    pub(crate) fn spawn_with(paros: &mut Command, arguments: &[&str]) -> Self {
        let mut window = paros
            .args(["window", "--script", "-", "--validation"])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program can be started");
        let steps = window.stdin.take();
        let answers = BufReader::new(window.stdout.take().expect("it is piped"));
        ScriptedWindow { window, steps, answers }
    }

    /// Writes a step and waits until it is done. Returns the output in between.
    pub(crate) fn do_step(&mut self, step: &str) -> String {
        let steps = self.steps.as_mut().expect("the visit goes on");
        writeln!(steps, "{step}").expect("the window listens");
        let (done, mut said) = (format!("done {step}\n"), String::new());
        loop {
            let mut line = String::new();
            let read = self.answers.read_line(&mut line).expect("text");
            assert_ne!(read, 0, "the window closed instead of: {step}; {}", self.read_stderr());
            if line == done {
                return said;
            }
            said += &line;
        }
    }

    pub(crate) fn do_all(&mut self, steps: &[&str]) {
        for step in steps {
            self.do_step(step);
        }
    }

    /// Returns one field of the window's state line.
    pub(crate) fn ask_state(&mut self, what: &str) -> String {
        let said = self.do_step("say");
        let (said, note) = said.split_once("; note ").expect("a note, the last thing said");
        if what == "note" {
            return note.trim().to_owned();
        }
        let after = said.split("; ").find_map(|part| part.trim().strip_prefix(what));
        after.unwrap_or_else(|| panic!("nothing of {what} in: {said}")).trim().to_owned()
    }

    pub(crate) fn voxel_count(&mut self) -> u64 {
        self.ask_state("voxels").parse().expect("a number")
    }

    /// Waits 6 frames, in which all changes are drawn. Returns the screen, saved as `name.png`.
    pub(crate) fn screenshot(&mut self, display: &XvfbDisplay, name: &str) -> Image {
        self.do_step("frames 6");
        display.save_screenshot(name)
    }

    /// Ends the script. Returns the exit code and standard error.
    pub(crate) fn close(mut self) -> (Option<i32>, String) {
        drop(self.steps.take());
        self.wait_for_exit()
    }

    /// Waits up to 20 seconds for the window to end by itself. Returns the exit code and standard error.
    pub(crate) fn wait_for_exit(mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        let code = loop {
            if let Some(status) = self.window.try_wait().expect("a child") {
                break status.code();
            }
            if begun.elapsed() > Duration::from_secs(20) {
                self.window.kill().expect("it can be ended");
                panic!("the window goes on: {}", self.read_stderr());
            }
            thread::sleep(Duration::from_millis(20));
        };
        (code, self.read_stderr())
    }

    pub(crate) fn read_stderr(&mut self) -> String {
        let mut text = String::new();
        if let Some(mut from) = self.window.stderr.take() {
            std::io::Read::read_to_string(&mut from, &mut text).expect("text");
        }
        text
    }
}

/// Returns the command of the program, with `folder` as its home.
pub(crate) fn paros_command(folder: &Path) -> Command {
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros
        .env("VK_DRIVER_FILES", DRIVER)
        .env("XDG_DATA_HOME", folder.join("data"))
        .env("XDG_CACHE_HOME", folder.join("cache"))
        // Share compiled shaders: otherwise each window would compile them, in three seconds of processor
        // time.
        .env("MESA_SHADER_CACHE_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("mesa"))
        .env("HOME", folder)
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    paros
}

/// Checks that files exist.
pub(crate) fn check_files(files: &[&str]) -> Result<(), String> {
    match files.iter().find(|file| !Path::new(file).exists()) {
        Some(file) => Err(format!("no {file}")),
        None => Ok(()),
    }
}

/// Checks that a program can be run, by an argument that makes it exit.
pub(crate) fn check_program(program: &str, argument: &str) -> Result<(), String> {
    let tried = Command::new(program).arg(argument).stdout(Stdio::null()).status();
    tried.map(drop).map_err(|error| format!("no {program}: {error}"))
}

/// Creates an empty folder for a test.
pub(crate) fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Counts the pixels of a rectangle that differ by more than 12 of 255.
pub(crate) fn count_differing(a: &Image, b: &Image, x: [usize; 2], y: [usize; 2]) -> usize {
    let far = |x: usize, y: usize| {
        let (a, b) = (a.pixel(x, y), b.pixel(x, y));
        (0..3).any(|k| a[k].abs_diff(b[k]) > 12)
    };
    (y[0]..y[1]).map(|y| (x[0]..x[1]).filter(|x| far(*x, y)).count()).sum()
}

/// Steps of a stroke across the stone.
pub(crate) const STROKE: [&str; 8] = [
    "move 42 42",
    "wait 12",
    "press left",
    "wait 8",
    "move 56 46",
    "wait 60",
    "release left",
    "wait 4",
];

/// The smallest solid mesh.
pub(crate) const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n";
