//! Runs the booth's real program as a process, for tests of its clients.
#![forbid(unsafe_code)]

use std::env;
use std::fs::{self, OpenOptions};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread;

use paros_shell::require::require_or_skip;

/// Returns the path of the booth's program: the one named by the environment variable `PAROS_BOOTH`, or a
/// fresh build. If the program has never been built, returns `None` so that the test is skipped, unless all
/// tests are required.
///
/// # Panics
/// The program can't be built, and all tests are required.
#[must_use]
pub fn find_booth() -> Option<PathBuf> {
    // Builds once a process, so that a program in use by another test isn't replaced.
    static FOUND: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| {
        if let Some(program) = env::var_os("PAROS_BOOTH") {
            let program = PathBuf::from(program);
            return fs::canonicalize(&program)
                .map_err(|error| format!("no booth: {}: {error}", program.display()));
        }
        let test = env::current_exe().map_err(|error| error.to_string())?;
        let folder = test.ancestors().nth(2).ok_or("the test has no folder")?;
        let program = folder.join(format!("paros-booth{}", env::consts::EXE_SUFFIX));
        let is_wanted = env::var_os("PAROS_REQUIRE").is_some_and(|parts| parts == "all");
        if !program.exists() && !is_wanted {
            return Err("no booth: `cargo build -p paros-booth` builds it".into());
        }
        build_booth(folder.ends_with("release")).map(|()| program)
    });
    require_or_skip(FOUND.clone()).expect("the booth's program")
}

fn build_booth(is_release: bool) -> Result<(), String> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "-p", "paros-booth"]).args(is_release.then_some("--release"));
    // Cargo's variables for this test's package would make crates that read them rebuild.
    for (name, _) in env::vars_os() {
        let told = name.to_string_lossy();
        if ["CARGO_PKG_", "CARGO_MANIFEST_"].iter().any(|group| told.starts_with(group)) {
            build.env_remove(&name);
        }
    }
    let built = build.current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let built = built.map_err(|error| format!("no booth: cargo: {error}"))?;
    match built.status.success() {
        true => Ok(()),
        false => Err(format!("no booth: {}", String::from_utf8_lossy(&built.stderr).trim())),
    }
}

/// A running booth with its data in `FOLDER/booth` and its log in `FOLDER/log`. Dropping it kills the
/// process.
#[derive(Debug)]
pub struct BoothProcess {
    process: Child,
    program: PathBuf,
    folder: PathBuf,
    address: String,
}

impl BoothProcess {
    /// Starts a program on a free port, or at the address `listen`, and waits until it accepts connections.
    ///
    /// # Panics
    /// The program doesn't start.
    #[must_use]
    pub fn start(program: &Path, folder: &Path, listen: Option<&str>) -> Self {
        let log = folder.join("log");
        let words = OpenOptions::new().append(true).create(true).open(&log).expect("a log");
        let mut process = Command::new(program)
            .args(["--listen", listen.unwrap_or("127.0.0.1:0"), "--folder"])
            .arg(folder.join("booth"))
            .stdout(Stdio::piped())
            .stderr(words)
            .spawn()
            .expect("the program");
        let mut lines = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let Some(Ok(address)) = lines.next() else {
            let words = fs::read_to_string(&log).unwrap_or_default();
            panic!("the booth doesn't start: {:?}; its log: {words}", process.wait());
        };
        assert!(address.starts_with("https://"), "{address}");
        // Drains the rest of the output, so that the program never blocks on a full pipe.
        thread::spawn(move || lines.for_each(drop));
        BoothProcess { process, program: program.into(), folder: folder.into(), address }
    }

    /// Returns the booth's URL: `https://` and a socket address.
    #[must_use]
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Returns the data folder.
    #[must_use]
    pub fn data(&self) -> PathBuf {
        self.folder.join("booth")
    }

    /// Returns the whole log, earlier starts included.
    #[must_use]
    pub fn read_log(&self) -> String {
        fs::read_to_string(self.folder.join("log")).unwrap_or_default()
    }

    /// Runs one of the program's commands on the booth's data and returns its standard output.
    ///
    /// # Panics
    /// The command fails.
    #[must_use]
    pub fn run(&self, arguments: &[&str]) -> String {
        let mut command = Command::new(&self.program);
        let done = command.args(arguments).arg("--folder").arg(self.data()).output();
        let done = done.expect("the program");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).expect("text")
    }

    /// Returns the text of a new fleet file.
    ///
    /// # Panics
    /// The command fails.
    #[must_use]
    pub fn make_fleet_file(&self) -> String {
        self.run(&["fleet-file", "--address", &self.address])
    }

    /// Kills the process abruptly, as a loss of power does.
    pub fn kill(&mut self) {
        // The process may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Drop for BoothProcess {
    fn drop(&mut self) {
        self.kill();
    }
}
