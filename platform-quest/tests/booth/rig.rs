//! The booth's own program, and a sculpture to send.

use std::env;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::outbox::messages::{
    AgeGroup, ContentHash, FinishCause, ParcelKind, SculptureId, UploadFacts,
};
use paros_core::session::SessionMode;
use paros_core::volume::Grid;
use paros_shell::outbox::courier::ParcelDraft;
use paros_shell::require::require_or_skip;
use paros_shell::statics::Resident;
use paros_shell::stl_export::StlExporter;
use paros_shell::tick_runner::with_fresh_world;
use sha2::{Digest as _, Sha256};

/// A running booth with a folder of its own. It is killed when it is dropped.
pub(crate) struct Booth {
    program: PathBuf,
    process: Child,
    folder: PathBuf,
    pub(crate) address: String,
}

impl Booth {
    /// Builds the program and starts it; none where it can't be built.
    pub(crate) fn start(name: &str) -> Option<Self> {
        let program = require_or_skip(build_booth()).expect("a booth")?;
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("room on the disk");
        let log = fs::File::create(folder.join("log")).expect("room on the disk");
        let mut process = Command::new(&program)
            .args(["--listen", "127.0.0.1:0", "--folder"])
            .arg(folder.join("data"))
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .expect("it starts");
        let mut lines = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let address = lines.next().expect("a line").expect("text");
        Some(Booth { program, process, folder, address })
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// A new fleet's file.
    pub(crate) fn fleet_text(&self) -> String {
        let made = Command::new(&self.program)
            .args(["fleet-file", "--address", &self.address, "--uses", "1", "--folder"])
            .arg(self.folder.join("data"))
            .output()
            .expect("it starts");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        String::from_utf8(made.stdout).expect("text")
    }

    /// Whether it keeps a sculpture, whose mesh it has made anew to the same bytes.
    pub(crate) fn keeps(&self, id: SculptureId) -> bool {
        let entries = fs::read_dir(self.folder.join("data/sculptures")).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name().into_string());
        let is_kept =
            |name: String| name.starts_with(&id.to_string()) && name.ends_with(".sculpture");
        let log = fs::read_to_string(self.folder.join("log")).expect("a log");
        log.contains(&format!("mesh compared id={id} state=Equal")) && names.flatten().any(is_kept)
    }
}

impl Drop for Booth {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Builds the program as these tests were built, beside them.
fn build_booth() -> Result<PathBuf, String> {
    let test = env::current_exe().map_err(|error| error.to_string())?;
    let folder = test.ancestors().nth(2).ok_or("the test has no folder")?;
    let is_release = folder.file_name().is_some_and(|name| name == "release");
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "-p", "paros-booth"]).args(is_release.then_some("--release"));
    let built = build.current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let built = built.map_err(|error| format!("cargo: {error}"))?;
    let program = folder.join("paros-booth");
    if built.status.success() && program.exists() {
        Ok(program)
    } else {
        let told = String::from_utf8_lossy(&built.stderr).into_owned();
        let lines: Vec<_> = told.lines().filter(|line| line.starts_with("error")).collect();
        Err(format!("no {}: cargo build -p paros-booth: {}", program.display(), lines.join("; ")))
    }
}

/// The toy that a creative session starts from, as the mesh that a headset exported.
pub(crate) fn make_draft(headset: u32) -> ParcelDraft {
    let stl = with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
        let mut buffers = <Grid<128> as Resident<128, INTERVALS>>::lock_stl_buffers();
        let mut exporter = StlExporter::new(&mut buffers, 120.0).expect("a height");
        exporter.begin_export(runner.world().volume().rows(), runner.world().mask());
        exporter.run_export_to_end().expect("a mesh").bytes.to_vec()
    });
    let facts = UploadFacts {
        kind: ParcelKind::Mesh,
        id: SculptureId([0x5c; 16]),
        headset,
        badge: None,
        core_version: paros_core::codec::trace::CORE_VERSION,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"el",
        mode: SessionMode::Creative,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 300,
        finished_at: 1_790_000_000,
        height_mm_tenths: 1200,
        stl_hash: ContentHash(Sha256::digest(&stl).into()),
        stl_bytes: stl.len() as u64,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    ParcelDraft { facts, first_file: stl, trace: None }
}
