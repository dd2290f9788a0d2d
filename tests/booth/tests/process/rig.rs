//! The folders and processes of a booth and a shell.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_booth_process::BoothProcess;
use paros_protocol::{DeviceName, UploadFacts};
use paros_upload::enrolment::{FleetFile, NewDevice, enrol_by_fleet, enrolment_file};
use paros_upload_https::HttpsCaller;

/// Timeout of every wait.
const PATIENCE: Duration = Duration::from_secs(120);

/// The folders of a booth and a shell.
pub(crate) struct Place {
    folder: PathBuf,
    booth: PathBuf,
}

/// The reports of a shell.
#[derive(Default, Debug)]
pub(crate) struct Told {
    /// Ids of sculptures reported as *kept here*.
    pub(crate) kept: Vec<String>,
    /// Ids of sculptures reported as *kept at the booth*.
    pub(crate) signed: Vec<String>,
    /// `true` if the booth has every sculpture.
    pub(crate) is_done: bool,
}

impl Told {
    pub(crate) fn add(&mut self, line: &str) {
        match line.split_once(' ') {
            Some(("kept", id)) => self.kept.push(id.into()),
            Some(("signed", id)) => self.signed.push(id.into()),
            _ => self.is_done |= line == "done",
        }
        // A sculpture at the booth was stored here first, even if the shell didn't report that step.
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

    pub(crate) fn shell_folder(&self) -> PathBuf {
        self.folder.join("shell")
    }

    pub(crate) fn enrolment_file(&self) -> PathBuf {
        enrolment_file(&self.shell_folder().join("sessions"))
    }

    pub(crate) fn start_booth(&self) -> BoothProcess {
        BoothProcess::start(&self.booth, &self.folder, None)
    }

    /// Starts the booth at an address.
    pub(crate) fn start_booth_at(&self, listen: &str) -> BoothProcess {
        BoothProcess::start(&self.booth, &self.folder, Some(listen))
    }

    pub(crate) fn enrol_by_fleet_file(&self, booth: &BoothProcess) {
        let path = self.folder.join("fleet.toml");
        fs::write(&path, booth.make_fleet_file()).expect("room on the disk");
        let fleet = FleetFile::read(&path).expect("what the booth printed");
        let device = NewDevice::draw(None, DeviceName::new("test").expect("a name"));
        let mut link = HttpsCaller::new(&fleet.address, &fleet.ca);
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
                let log = fs::read_to_string(self.folder.join("log")).unwrap_or_default();
                panic!("the shell doesn't end; the booth's log: {log}");
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

    /// Returns every sculpture at the booth: its facts and its packed volume.
    pub(crate) fn parcels_at_booth(&self) -> Vec<(UploadFacts, Vec<u8>)> {
        let names = fs::read_dir(self.folder.join("booth/sculptures")).expect("a folder");
        let paths = names.map(|entry| entry.expect("a file").path());
        let kept = paths.filter(|path| path.extension() == Some("sculpture".as_ref()));
        let read = |path: PathBuf| {
            let bytes = fs::read(path).expect("a file");
            let (facts, volume) = UploadFacts::split_head(&bytes).expect("a head");
            (facts, volume.to_vec())
        };
        kept.map(read).collect()
    }

    /// Returns the volumes in the shell's folder.
    pub(crate) fn volumes(&self) -> Vec<Vec<u8>> {
        let names = fs::read_dir(self.shell_folder().join("sculptures")).expect("a folder");
        let paths = names.map(|entry| entry.expect("a file").path());
        let volumes = paths.filter(|path| path.extension() == Some("rmap".as_ref()));
        volumes.map(|path| fs::read(path).expect("a file")).collect()
    }
}

/// Waits until a booth's log contains a text `count` times.
pub(crate) fn wait_for_log(booth: &BoothProcess, text: &str, count: usize) {
    let begun = Instant::now();
    while booth.read_log().matches(text).count() < count {
        assert!(begun.elapsed() < PATIENCE, "{text}: {}", booth.read_log());
        thread::sleep(Duration::from_millis(50));
    }
}
