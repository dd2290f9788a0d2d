//! A Monado service from the tree that `tests/monado-tree.sh` prepares, on a software device, and shells in
//! its session. Nothing is installed: programs start through the tree's own dynamic loader.

mod hands;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

pub(crate) use hands::{RemoteHand, RemoteHands};

/// The timeout of every wait; generous, as a software device shares the processors with other tests.
const PATIENCE: Duration = Duration::from_secs(60);

/// The tree of Monado's programs and libraries.
#[derive(Clone, Debug)]
pub(crate) struct MonadoTree {
    root: PathBuf,
    libraries: PathBuf,
}

impl MonadoTree {
    /// Finds the tree beside this build. An error tells how to make it.
    pub(crate) fn find() -> Result<MonadoTree, String> {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("monado-tree");
        let root = fs::canonicalize(&root).map_err(|error| {
            let make = "platform-quest/tests/monado-tree.sh makes it";
            format!("no {}: {error}; {make}", root.display())
        })?;
        if !root.join(".ready").exists() {
            return Err(format!("{} is not whole", root.display()));
        }
        Ok(MonadoTree { libraries: root.join("usr/lib/x86_64-linux-gnu"), root })
    }

    /// Returns a command for a program that finds the tree's libraries before the system's.
    pub(crate) fn command(&self, program: &Path, folder: &Path) -> Command {
        let run = folder.join("run");
        fs::create_dir_all(&run).expect("a folder");
        fs::set_permissions(&run, fs::Permissions::from_mode(0o700)).expect("it is ours");
        let beside =
            ["", "..", "pulseaudio", "blas", "lapack"].map(|name| self.libraries.join(name));
        let paths = beside.map(|path| path.display().to_string()).join(":");
        let mut command = Command::new(self.root.join("usr/lib64/ld-linux-x86-64.so.2"));
        command.arg("--library-path").arg(paths).arg(program);
        command.env("XDG_RUNTIME_DIR", run).current_dir(folder);
        command.env("XR_RUNTIME_JSON", self.write_manifest("openxr/1/openxr_monado.json", folder));
        command.env("VK_DRIVER_FILES", self.write_manifest("vulkan/icd.d/lvp_icd.json", folder));
        let layer = "vulkan/explicit_layer.d/VkLayer_khronos_validation.json";
        self.write_manifest(layer, folder);
        command.env("VK_LAYER_PATH", folder);
        command
    }

    /// Writes a copy of a manifest into a folder, with the absolute path of its library.
    fn write_manifest(&self, name: &str, folder: &Path) -> PathBuf {
        let text = fs::read_to_string(self.root.join("usr/share").join(name)).expect("a manifest");
        let key = text.find("\"library_path\"").expect("it names a library");
        let library = key + 14 + text[key + 14..].find('"').expect("a name") + 1;
        let (before, library) = text.split_at(library);
        let library = library.strip_prefix("/usr/lib/x86_64-linux-gnu/").unwrap_or(library);
        let text = format!("{before}{}/{library}", self.libraries.display());
        let copy = folder.join(Path::new(name).file_name().expect("a name"));
        fs::write(&copy, text).expect("the copy is written");
        copy
    }
}

/// The file of the OpenXR validation layer's messages, in the service's folder.
const VALIDATION: &str = "validation.txt";

/// Serialises services: the driver's TCP port is one for the whole machine.
static ONE: Mutex<()> = Mutex::new(());

/// A running service, ended when dropped.
pub(crate) struct MonadoService {
    service: Child,
    pub(crate) tree: MonadoTree,
    pub(crate) folder: PathBuf,
    _one: MutexGuard<'static, ()>,
}

impl MonadoService {
    /// Starts the service in an empty folder of this name, and waits for its socket.
    pub(crate) fn start(tree: &MonadoTree, name: &str) -> MonadoService {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = create_empty_folder(name);
        let log = fs::File::create(folder.join("service.log")).expect("a log");
        let program = tree.root.join("usr/bin/monado-service");
        let mut service = tree
            .command(&program, &folder)
            .envs([("XRT_COMPOSITOR_NULL", "1"), ("P_OVERRIDE_ACTIVE_CONFIG", "remote")])
            .envs([("XRT_NO_STDIN", "1")])
            .stdin(Stdio::null())
            .stdout(log.try_clone().expect("a log"))
            .stderr(log)
            .spawn()
            .expect("the service starts");
        let socket = folder.join("run/monado_comp_ipc");
        wait_for("the service", || {
            let ended = service.try_wait().expect("it is ours");
            assert!(ended.is_none(), "the service ended: see {}/service.log", folder.display());
            socket.exists()
        });
        MonadoService { service, tree: tree.clone(), folder, _one: one }
    }

    /// Connects to the driver of head and hands.
    pub(crate) fn connect_hands(&self) -> RemoteHands {
        RemoteHands::connect()
    }

    /// Recentres the reference spaces, by `monado-ctl`.
    pub(crate) fn recentre(&self) {
        let program = self.tree.root.join("usr/bin/monado-ctl");
        let mut ctl = self.tree.command(&program, &self.folder);
        assert!(ctl.arg("-c").stdout(Stdio::null()).status().expect("it runs").success());
    }

    /// Starts the shell in this service's session.
    pub(crate) fn start_shell(&self, args: &[&str]) -> ShellProcess {
        ShellProcess::start(self.command(args))
    }

    /// Starts the shell with the tests' own API layer between it and the service.
    pub(crate) fn start_layered_shell(&self, layer: &Path, args: &[&str]) -> ShellProcess {
        ShellProcess::start(self.layered_command(layer, args))
    }

    /// Starts a shell like [`Self::start_layered_shell`], on a device that reports fragment density maps.
    pub(crate) fn start_mapped_shell(&self, layer: &Path, args: &[&str]) -> ShellProcess {
        let manifest = format!(
            r#"{{"file_format_version": "1.2.0", "layer": {{"name": "VK_LAYER_PAROS_tests",
            "type": "GLOBAL", "library_path": "{}", "api_version": "1.3.0",
            "implementation_version": "1", "description": "Paros' tests", "device_extensions": [
            {{"name": "VK_EXT_fragment_density_map", "spec_version": "2", "entrypoints": []}}]}}}}"#,
            layer.display()
        );
        // The same folder contains Vulkan's validation layer, which comes first and sees all calls.
        fs::write(self.folder.join("vulkan.json"), manifest).expect("the manifest is written");
        let mut command = self.layered_command(layer, args);
        let layers = "VK_LAYER_KHRONOS_validation:VK_LAYER_PAROS_tests";
        command.env("VK_INSTANCE_LAYERS", layers);
        ShellProcess::start(command)
    }

    /// Returns the command of [`Self::start_layered_shell`] without starting it.
    pub(crate) fn layered_command(&self, layer: &Path, args: &[&str]) -> Command {
        let manifest = format!(
            r#"{{"file_format_version": "1.0.0", "api_layer": {{"name": "XR_APILAYER_PAROS_tests",
            "library_path": "{}", "api_version": "1.0", "implementation_version": "1",
            "description": "Paros' tests", "instance_extensions": [
            {{"name": "XR_EXT_hand_interaction", "extension_version": "2"}},
            {{"name": "XR_EXT_performance_settings", "extension_version": "4"}},
            {{"name": "XR_EXT_user_presence", "extension_version": "1"}},
            {{"name": "XR_FB_foveation", "extension_version": "1"}},
            {{"name": "XR_FB_foveation_configuration", "extension_version": "1"}},
            {{"name": "XR_FB_foveation_vulkan", "extension_version": "1"}},
            {{"name": "XR_FB_swapchain_update_state", "extension_version": "3"}},
            {{"name": "XR_KHR_android_thread_settings", "extension_version": "6"}},
            {{"name": "XR_META_recommended_layer_resolution", "extension_version": "1"}},
            {{"name": "XR_META_vulkan_swapchain_create_info", "extension_version": "1"}},
            {{"name": "XR_META_touch_controller_plus", "extension_version": "1"}}]}}}}"#,
            layer.display()
        );
        let folder = self.folder.join("layer");
        fs::create_dir_all(&folder).expect("a folder");
        fs::write(folder.join("layer.json"), manifest).expect("the manifest is written");
        let mut command = self.command(args);
        command.env("XR_API_LAYER_PATH", &folder).env("PAROS_LAYER", &folder);
        command.env("XR_ENABLE_API_LAYERS", "XR_APILAYER_PAROS_tests");
        command
    }

    /// Asserts that the OpenXR validation layer found nothing in the last shell that ran without the
    /// tests' own layer.
    pub(crate) fn assert_valid(&self) {
        let said = fs::read_to_string(self.folder.join(VALIDATION)).expect("the layer's words");
        assert!(said.contains("VUID-CoreValidation-Initialize"), "{said}");
        let other = said.lines().find(|line| !line.contains("VUID-CoreValidation-"));
        assert_eq!(other, None, "{said}");
    }

    /// Starts another program that runs the shell, in this service's session.
    pub(crate) fn start_program(&self, program: &Path, args: &[&str]) -> ShellProcess {
        let mut command = self.tree.command(program, &self.folder);
        command.args(args);
        ShellProcess::start(command)
    }

    fn command(&self, args: &[&str]) -> Command {
        let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
        let mut command = self.tree.command(quest, &self.folder);
        command.args(["--script", "--validation", "--folder", "files"]).args(args);
        if !args.contains(&"--handover") {
            // The driver's head and hands don't move between a test's steps, which may take long on a slow
            // machine.
            command.args(["--handover", "600"]);
        }
        if !args.contains(&"--least-resolution") {
            // A software device isn't fast enough for pictures of the full size.
            command.args(["--least-resolution", "100"]);
        }
        let layers = self.folder.join("layers");
        fs::create_dir_all(&layers).expect("a folder");
        let explicit = "openxr/1/api_layers/explicit.d";
        let layer = format!("{explicit}/XrApiLayer_core_validation.x86_64-linux-gnu.json");
        self.tree.write_manifest(&layer, &layers);
        command.env("XR_API_LAYER_PATH", layers);
        command.env("XR_ENABLE_API_LAYERS", "XR_APILAYER_LUNARG_core_validation");
        command.env("XR_CORE_VALIDATION_EXPORT_TYPE", "text");
        command.env("XR_CORE_VALIDATION_FILE_NAME", self.folder.join(VALIDATION));
        command
    }
}

impl Drop for MonadoService {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.service.kill();
        let _ = self.service.wait();
    }
}

/// A running shell, ended when dropped.
pub(crate) struct ShellProcess {
    child: Child,
    stdin: ChildStdin,
    said: Receiver<String>,
    errors: Option<JoinHandle<String>>,
}

/// The status line that a shell prints on the command `say`: fields separated by semicolons.
pub(crate) struct StatusLine(String);

/// A shell's end.
pub(crate) struct ShellEnd {
    /// The exit code; `None` if a signal ended it.
    pub(crate) code: Option<i32>,
    /// The text on standard error.
    pub(crate) errors: String,
}

impl ShellProcess {
    pub(crate) fn start(mut command: Command) -> ShellProcess {
        let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = pipes.spawn().expect("the shell starts");
        let stdin = child.stdin.take().expect("it is piped");
        let (tell, said) = channel();
        let out = BufReader::new(child.stdout.take().expect("it is piped"));
        thread::spawn(move || {
            out.lines().map_while(Result::ok).try_for_each(|line| tell.send(line))
        });
        let mut err = child.stderr.take().expect("it is piped");
        let errors = thread::spawn(move || {
            let mut text = String::new();
            let _ = err.read_to_string(&mut text);
            text
        });
        ShellProcess { child, stdin, said, errors: Some(errors) }
    }

    /// Queries the shell's status.
    pub(crate) fn query_status(&mut self) -> StatusLine {
        writeln!(self.stdin, "say").expect("the shell listens");
        StatusLine(self.said.recv_timeout(PATIENCE).expect("the shell answers"))
    }

    /// Queries the status until it satisfies `wanted`. `what` names the condition in the panic's message.
    pub(crate) fn wait_until(
        &mut self,
        what: &str,
        wanted: impl Fn(&StatusLine) -> bool,
    ) -> StatusLine {
        let begun = Instant::now();
        loop {
            let said = self.query_status();
            if wanted(&said) {
                return said;
            }
            assert!(begun.elapsed() < PATIENCE, "waiting for {what}: {}", said.0);
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until `more` frames have been made.
    pub(crate) fn wait_frames(&mut self, more: u64) -> StatusLine {
        let now = self.query_status().number("frames");
        self.wait_until("frames", |said| said.number("frames") >= now + more)
    }

    /// Captures the next frame. Returns the paths of the left and the right eye's picture.
    pub(crate) fn capture_eyes(&mut self, folder: &Path, name: &str) -> [PathBuf; 2] {
        let prefix = folder.join(name);
        writeln!(self.stdin, "shot {}", prefix.display()).expect("the shell listens");
        let eyes = ["left", "right"].map(|eye| folder.join(format!("{name}-{eye}.png")));
        wait_for("pictures", || eyes.iter().all(|path| path.exists()));
        eyes
    }

    /// Sends a command.
    pub(crate) fn send(&mut self, command: &str) {
        writeln!(self.stdin, "{command}").expect("the shell listens");
    }

    /// Quits the shell.
    pub(crate) fn quit(mut self) -> ShellEnd {
        writeln!(self.stdin, "quit").expect("the shell listens");
        self.wait_and_collect()
    }

    /// Waits for the end. Returns the last line of standard output and the end.
    pub(crate) fn wait_for_last_status(mut self) -> (StatusLine, ShellEnd) {
        let end = self.wait_and_collect();
        let last = self.said.iter().last().unwrap_or_default();
        (StatusLine(last), end)
    }

    /// Waits for the end.
    pub(crate) fn wait_for_end(mut self) -> ShellEnd {
        self.wait_and_collect()
    }

    /// Kills the process, as a system that runs out of memory does. Returns its standard error.
    pub(crate) fn kill(mut self) -> String {
        self.child.kill().expect("it still runs");
        self.wait_and_collect().errors
    }

    fn wait_and_collect(&mut self) -> ShellEnd {
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("it is ours") {
                break status;
            }
            assert!(begun.elapsed() < PATIENCE, "the shell does not end");
            thread::sleep(Duration::from_millis(20));
        };
        let errors = self.errors.take().expect("it ends once");
        ShellEnd { code: status.code(), errors: errors.join().expect("it is text") }
    }
}

impl Drop for ShellProcess {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl StatusLine {
    /// Returns the whole line.
    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Returns the value of a field.
    ///
    /// # Panics
    /// There is no field of that name.
    pub(crate) fn field(&self, name: &str) -> &str {
        let start =
            |field: &&str| field.strip_prefix(name).is_some_and(|rest| rest.starts_with(' '));
        let field = self.0.split("; ").find(start);
        &field.unwrap_or_else(|| panic!("no {name} in {}", self.0))[name.len() + 1..]
    }

    /// Returns the value of a numeric field.
    pub(crate) fn number(&self, name: &str) -> u64 {
        self.field(name).parse().expect("a number")
    }
}

/// Creates an empty folder for a test.
pub(crate) fn create_empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("monado-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Waits until `happened` returns true. `what` names the event in the panic's message.
pub(crate) fn wait_for(what: &str, mut happened: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !happened() {
        assert!(begun.elapsed() < PATIENCE, "waiting for {what}");
        thread::sleep(Duration::from_millis(20));
    }
}
