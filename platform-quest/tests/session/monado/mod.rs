//! Monado from the tree that `tests/monado-tree.sh` prepares, on a software device, and the shell in
//! its session. Nothing of the tree is installed: all is started through its own loader.

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

pub(crate) use hands::{Hand, Hands};

/// For as long as anything is waited for: a software device shares its processors with others.
const PATIENCE: Duration = Duration::from_secs(60);

/// The tree.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    root: PathBuf,
    libraries: PathBuf,
}

impl Tree {
    /// The tree beside this build.
    pub(crate) fn find() -> Result<Tree, String> {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("monado-tree");
        let root = fs::canonicalize(&root).map_err(|error| {
            let make = "platform-quest/tests/monado-tree.sh makes it";
            format!("no {}: {error}; {make}", root.display())
        })?;
        if !root.join(".ready").exists() {
            return Err(format!("{} is not whole", root.display()));
        }
        Ok(Tree { libraries: root.join("usr/lib/x86_64-linux-gnu"), root })
    }

    /// A program that finds the tree's libraries before the machine's.
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
        command.env("XR_RUNTIME_JSON", self.manifest("openxr/1/openxr_monado.json", folder));
        command.env("VK_DRIVER_FILES", self.manifest("vulkan/icd.d/lvp_icd.json", folder));
        let layer = "vulkan/explicit_layer.d/VkLayer_khronos_validation.json";
        self.manifest(layer, folder);
        command.env("VK_LAYER_PATH", folder);
        command
    }

    /// A copy of a manifest that names its library by its whole path.
    fn manifest(&self, name: &str, folder: &Path) -> PathBuf {
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

/// What OpenXR's validation says, in the service's folder.
const VALIDATION: &str = "validation.txt";

/// Its port is one for the whole machine.
static ONE: Mutex<()> = Mutex::new(());

/// A running service, ended when dropped.
pub(crate) struct Monado {
    service: Child,
    pub(crate) tree: Tree,
    pub(crate) folder: PathBuf,
    _one: MutexGuard<'static, ()>,
}

impl Monado {
    /// Begins the service in a folder of this name, which is emptied.
    pub(crate) fn start(tree: &Tree, name: &str) -> Monado {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = folder(name);
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
        Monado { service, tree: tree.clone(), folder, _one: one }
    }

    /// The driver of head and hands.
    pub(crate) fn hands(&self) -> Hands {
        Hands::connect()
    }

    /// The visitor looks ahead anew.
    pub(crate) fn recentre(&self) {
        let program = self.tree.root.join("usr/bin/monado-ctl");
        let mut ctl = self.tree.command(&program, &self.folder);
        assert!(ctl.arg("-c").stdout(Stdio::null()).status().expect("it runs").success());
    }

    /// The shell in this service's session.
    pub(crate) fn shell(&self, args: &[&str]) -> Shell {
        Shell::start(self.command(args))
    }

    /// The shell in this service's session, with the tests' own API layer between them.
    pub(crate) fn layered_shell(&self, layer: &Path, args: &[&str]) -> Shell {
        Shell::start(self.layered_command(layer, args))
    }

    /// As before, with a device that says it has density maps.
    pub(crate) fn mapped_shell(&self, layer: &Path, args: &[&str]) -> Shell {
        let manifest = format!(
            r#"{{"file_format_version": "1.2.0", "layer": {{"name": "VK_LAYER_PAROS_tests",
            "type": "GLOBAL", "library_path": "{}", "api_version": "1.3.0",
            "implementation_version": "1", "description": "Paros' tests", "device_extensions": [
            {{"name": "VK_EXT_fragment_density_map", "spec_version": "2", "entrypoints": []}}]}}}}"#,
            layer.display()
        );
        // Where Vulkan's validation is found, too, which comes first and sees all.
        fs::write(self.folder.join("vulkan.json"), manifest).expect("the manifest is written");
        let mut command = self.layered_command(layer, args);
        let layers = "VK_LAYER_KHRONOS_validation:VK_LAYER_PAROS_tests";
        command.env("VK_INSTANCE_LAYERS", layers);
        Shell::start(command)
    }

    /// As the first, to be changed before it is started.
    pub(crate) fn layered_command(&self, layer: &Path, args: &[&str]) -> Command {
        let manifest = format!(
            r#"{{"file_format_version": "1.0.0", "api_layer": {{"name": "XR_APILAYER_PAROS_tests",
            "library_path": "{}", "api_version": "1.0", "implementation_version": "1",
            "description": "Paros' tests", "instance_extensions": [
            {{"name": "XR_EXT_performance_settings", "extension_version": "4"}},
            {{"name": "XR_EXT_user_presence", "extension_version": "1"}},
            {{"name": "XR_FB_foveation", "extension_version": "1"}},
            {{"name": "XR_FB_foveation_configuration", "extension_version": "1"}},
            {{"name": "XR_FB_foveation_vulkan", "extension_version": "1"}},
            {{"name": "XR_FB_swapchain_update_state", "extension_version": "3"}},
            {{"name": "XR_KHR_android_thread_settings", "extension_version": "6"}},
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

    /// Khronos' layer looked on at the last shell without the tests' own, and has nothing to say but
    /// that it began and ended.
    pub(crate) fn assert_valid(&self) {
        let said = fs::read_to_string(self.folder.join(VALIDATION)).expect("the layer's words");
        assert!(said.contains("VUID-CoreValidation-Initialize"), "{said}");
        let other = said.lines().find(|line| !line.contains("VUID-CoreValidation-"));
        assert_eq!(other, None, "{said}");
    }

    /// Another program that is a shell, in this service's session.
    pub(crate) fn shell_of(&self, program: &Path, args: &[&str]) -> Shell {
        let mut command = self.tree.command(program, &self.folder);
        command.args(args);
        Shell::start(command)
    }

    fn command(&self, args: &[&str]) -> Command {
        let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
        let mut command = self.tree.command(quest, &self.folder);
        command.args(["--script", "--validation", "--folder", "files"]).args(args);
        let layers = self.folder.join("layers");
        fs::create_dir_all(&layers).expect("a folder");
        let explicit = "openxr/1/api_layers/explicit.d";
        let layer = format!("{explicit}/XrApiLayer_core_validation.x86_64-linux-gnu.json");
        self.tree.manifest(&layer, &layers);
        command.env("XR_API_LAYER_PATH", layers);
        command.env("XR_ENABLE_API_LAYERS", "XR_APILAYER_LUNARG_core_validation");
        command.env("XR_CORE_VALIDATION_EXPORT_TYPE", "text");
        command.env("XR_CORE_VALIDATION_FILE_NAME", self.folder.join(VALIDATION));
        command
    }
}

impl Drop for Monado {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.service.kill();
        let _ = self.service.wait();
    }
}

/// A running shell, ended when dropped.
pub(crate) struct Shell {
    child: Child,
    stdin: ChildStdin,
    said: Receiver<String>,
    errors: Option<JoinHandle<String>>,
}

/// What a shell said of itself.
pub(crate) struct Said(String);

impl Shell {
    pub(crate) fn start(mut command: Command) -> Shell {
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
        Shell { child, stdin, said, errors: Some(errors) }
    }

    /// What it says of itself now.
    pub(crate) fn say(&mut self) -> Said {
        writeln!(self.stdin, "say").expect("the shell listens");
        Said(self.said.recv_timeout(PATIENCE).expect("the shell answers"))
    }

    /// Waits until what it says is as wanted.
    pub(crate) fn until(&mut self, what: &str, wanted: impl Fn(&Said) -> bool) -> Said {
        let begun = Instant::now();
        loop {
            let said = self.say();
            if wanted(&said) {
                return said;
            }
            assert!(begun.elapsed() < PATIENCE, "waiting for {what}: {}", said.0);
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until so many more frames were made.
    pub(crate) fn frames(&mut self, more: u64) -> Said {
        let now = self.say().number("frames");
        self.until("frames", |said| said.number("frames") >= now + more)
    }

    /// Both eyes' pictures of the next frame, left in the folder under a name.
    pub(crate) fn shot(&mut self, folder: &Path, name: &str) -> [PathBuf; 2] {
        let prefix = folder.join(name);
        writeln!(self.stdin, "shot {}", prefix.display()).expect("the shell listens");
        let eyes = ["left", "right"].map(|eye| folder.join(format!("{name}-{eye}.png")));
        wait_for("pictures", || eyes.iter().all(|path| path.exists()));
        eyes
    }

    /// Asks it to leave: its exit code, and what it told on standard error.
    pub(crate) fn quit(mut self) -> (Option<i32>, String) {
        writeln!(self.stdin, "quit").expect("the shell listens");
        self.ended()
    }

    /// Waits for its end: the last that it said, its exit code, and what it told on standard error.
    pub(crate) fn last_words(mut self) -> (Said, Option<i32>, String) {
        let (code, errors) = self.ended();
        let last = self.said.iter().last().unwrap_or_default();
        (Said(last), code, errors)
    }

    /// Waits until it ends by itself.
    pub(crate) fn over(mut self) -> (Option<i32>, String) {
        self.ended()
    }

    /// Kills it, as a system does that needs the memory; what it told on standard error.
    pub(crate) fn kill(mut self) -> String {
        self.child.kill().expect("it still runs");
        self.ended().1
    }

    fn ended(&mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("it is ours") {
                break status;
            }
            assert!(begun.elapsed() < PATIENCE, "the shell does not end");
            thread::sleep(Duration::from_millis(20));
        };
        let errors = self.errors.take().expect("it ends once");
        (status.code(), errors.join().expect("it is text"))
    }
}

impl Drop for Shell {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Said {
    /// The whole line.
    pub(crate) fn all(&self) -> &str {
        &self.0
    }

    /// A field.
    pub(crate) fn field(&self, name: &str) -> &str {
        let start =
            |field: &&str| field.strip_prefix(name).is_some_and(|rest| rest.starts_with(' '));
        let field = self.0.split("; ").find(start);
        &field.unwrap_or_else(|| panic!("no {name} in {}", self.0))[name.len() + 1..]
    }

    /// A field that is a number.
    pub(crate) fn number(&self, name: &str) -> u64 {
        self.field(name).parse().expect("a number")
    }
}

/// An empty folder for a test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("monado-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Waits for something that happens elsewhere.
pub(crate) fn wait_for(what: &str, mut happened: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !happened() {
        assert!(begun.elapsed() < PATIENCE, "waiting for {what}");
        thread::sleep(Duration::from_millis(20));
    }
}
