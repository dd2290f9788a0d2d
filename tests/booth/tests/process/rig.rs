//! Folders of a booth and a shell, and their processes.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_core::outbox::messages::{ContentHash, DeviceName};
use paros_outbox_link::HttpsCaller;
use paros_shell::outbox::Parcel;
use paros_shell::outbox::enrolment::{
    ENROL_TIMEOUT, FleetFile, NewDevice, enrol_by_fleet, enrolment_file,
};
use paros_shell::require::require_or_skip;
use sha2::{Digest as _, Sha256};

/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// The booth's program, brought up to date. Newcomers don't build it: where nobody has, nothing is tried but by the whole
/// check.
pub(crate) fn find_booth() -> Option<PathBuf> {
    let program = Path::new(env!("CARGO_BIN_EXE_headless-shell")).with_file_name("paros-booth");
    let is_wanted = std::env::var_os("PAROS_REQUIRE").is_some_and(|parts| parts == "all");
    let found = match program.exists() || is_wanted {
        true => build_booth().map(|()| program),
        false => Err("no booth: `cargo build -p paros-booth` builds it".into()),
    };
    require_or_skip(found).expect("the booth's program")
}

fn build_booth() -> Result<(), String> {
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "-p", "paros-booth"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output();
    match built {
        Ok(done) if done.status.success() => Ok(()),
        Ok(done) => Err(format!("no booth: {}", String::from_utf8_lossy(&done.stderr).trim())),
        Err(error) => Err(format!("no booth: {error}")),
    }
}

/// A booth's folder and a shell's.
pub(crate) struct Place {
    folder: PathBuf,
    booth: PathBuf,
}

/// A running booth. It is killed when it is dropped.
pub(crate) struct Booth {
    process: Child,
    pub(crate) address: String,
}

/// What a shell told.
#[derive(Default, Debug)]
pub(crate) struct Told {
    /// Ids of sculptures that a visitor read *kept here* of.
    pub(crate) kept: Vec<String>,
    /// Those of which it was *kept at the booth*.
    pub(crate) signed: Vec<String>,
    /// Whether all were signed for.
    pub(crate) is_done: bool,
}

impl Told {
    pub(crate) fn add(&mut self, line: &str) {
        match line.split_once(' ') {
            Some(("kept", id)) => self.kept.push(id.into()),
            Some(("signed", id)) => self.signed.push(id.into()),
            _ => self.is_done |= line == "done",
        }
        // What is signed for was kept before, though nobody looked in between.
        if let Some(id) = self.signed.last().filter(|id| !self.kept.contains(id)) {
            self.kept.push(id.clone());
        }
    }
}

impl Place {
    pub(crate) fn new(name: &str, booth: PathBuf) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("process-{name}"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("shell/sessions")).expect("room on the disk");
        Place { folder, booth }
    }

    fn data(&self) -> PathBuf {
        self.folder.join("booth")
    }

    pub(crate) fn shell_folder(&self) -> PathBuf {
        self.folder.join("shell")
    }

    pub(crate) fn enrolment_file(&self) -> PathBuf {
        enrolment_file(&self.shell_folder().join("sessions"))
    }

    pub(crate) fn start_booth(&self) -> Booth {
        self.start_booth_at("127.0.0.1:0")
    }

    /// Starts the booth, and waits until it can be reached.
    pub(crate) fn start_booth_at(&self, listen: &str) -> Booth {
        let log = File::options().append(true).create(true).open(self.folder.join("log"));
        let mut process = Command::new(&self.booth)
            .args(["--listen", listen, "--folder"])
            .arg(self.data())
            .stdout(Stdio::piped())
            .stderr(log.expect("a log"))
            .spawn()
            .expect("the program");
        let mut lines = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let Some(Ok(address)) = lines.next() else {
            panic!("the booth doesn't start: {:?}; its log: {}", process.wait(), self.booth_log());
        };
        assert!(address.starts_with("https://"), "{address}");
        // What else it says is read, so that it never waits for that.
        thread::spawn(move || lines.for_each(drop));
        Booth { process, address }
    }

    pub(crate) fn run_booth(&self, arguments: &[&str]) -> String {
        let done = Command::new(&self.booth)
            .args(arguments)
            .arg("--folder")
            .arg(self.data())
            .output()
            .expect("the program");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).expect("text")
    }

    pub(crate) fn enrol_by_fleet_file(&self, address: &str) {
        let path = self.folder.join("fleet.toml");
        let text = self.run_booth(&["fleet-file", "--address", address]);
        fs::write(&path, text).expect("room on the disk");
        let fleet = FleetFile::read(&path).expect("what the booth printed");
        let device = NewDevice::draw(None, DeviceName::new("test").expect("a name"));
        let mut link = HttpsCaller::new(&fleet.address, &fleet.ca, ENROL_TIMEOUT);
        let enrolled = enrol_by_fleet(&mut link, &fleet, &device.expect("bits"));
        enrolled.expect("a token").write(&self.enrolment_file()).expect("room on the disk");
    }

    pub(crate) fn start_shell(&self, visits: u32, seed: u64) -> Child {
        Command::new(env!("CARGO_BIN_EXE_headless-shell"))
            .arg(self.shell_folder())
            .args([visits.to_string(), seed.to_string()])
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program")
    }

    pub(crate) fn run_shell_to_the_end(&self, visits: u32, seed: u64) -> Told {
        let mut shell = self.start_shell(visits, seed);
        let begun = Instant::now();
        while shell.try_wait().expect("a process").is_none() {
            if begun.elapsed() > PATIENCE {
                let _ = shell.kill();
                panic!("the shell doesn't end; the booth's log: {}", self.booth_log());
            }
            thread::sleep(Duration::from_millis(20));
        }
        let mut text = String::new();
        shell.stdout.take().expect("a pipe").read_to_string(&mut text).expect("text");
        let mut told = Told::default();
        text.lines().for_each(|line| told.add(line));
        assert!(told.is_done, "{text}");
        told
    }

    /// All that the booth keeps.
    pub(crate) fn parcels_at_booth(&self) -> Vec<Parcel> {
        let names = fs::read_dir(self.data().join("sculptures")).expect("a folder");
        let paths = names.map(|entry| entry.expect("a file").path());
        let kept = paths.filter(|path| path.extension() == Some("sculpture".as_ref()));
        kept.map(|path| Parcel::read(fs::read(path).expect("a file")).expect("whole")).collect()
    }

    /// SHA-256 of the prints in the shell's folder.
    pub(crate) fn print_hashes(&self) -> BTreeSet<ContentHash> {
        let names = fs::read_dir(self.shell_folder().join("sculptures")).expect("a folder");
        let paths = names.map(|entry| entry.expect("a file").path());
        let prints = paths.filter(|path| path.extension() == Some("stl".as_ref()));
        prints.map(|path| ContentHash(Sha256::digest(fs::read(path).unwrap()).into())).collect()
    }

    pub(crate) fn booth_log(&self) -> String {
        fs::read_to_string(self.folder.join("log")).unwrap_or_default()
    }

    /// Waits until the booth's log has a text so often.
    pub(crate) fn wait_for_log(&self, text: &str, count: usize) {
        let begun = Instant::now();
        while self.booth_log().matches(text).count() < count {
            assert!(begun.elapsed() < PATIENCE, "{text}: {}", self.booth_log());
            thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Booth {
    /// Kills it as a loss of power does.
    pub(crate) fn kill(&mut self) {
        self.process.kill().expect("it runs");
        self.process.wait().expect("it ends");
    }
}

impl Drop for Booth {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
