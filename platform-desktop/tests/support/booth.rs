//! A booth's program, beside that of the tests.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use paros_shell::require::require_or_skip;

/// A booth that serves in a folder. It is killed when it is dropped.
pub(crate) struct BoothProcess {
    process: Child,
    program: PathBuf,
    folder: PathBuf,
    pub(crate) address: String,
}

impl BoothProcess {
    /// `None` where it isn't built.
    pub(crate) fn start(folder: &Path) -> Option<Self> {
        let program = Path::new(env!("CARGO_BIN_EXE_paros")).with_file_name("paros-booth");
        let found = program.exists().then_some(program.clone());
        require_or_skip(found.ok_or("no booth: `cargo build -p paros-booth` builds it"))
            .expect("a booth")?;
        let mut process = Command::new(&program)
            .args(["--listen", "127.0.0.1:0", "--folder"])
            .arg(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program");
        let mut address = String::new();
        let out = process.stdout.take().expect("a pipe");
        BufReader::new(out).read_line(&mut address).expect("a line");
        let (address, folder) = (address.trim().into(), folder.into());
        Some(BoothProcess { process, program, folder, address })
    }

    pub(crate) fn run(&self, args: &[&str]) -> String {
        let mut command = Command::new(&self.program);
        let done = command.args(args).arg("--folder").arg(&self.folder).output().expect("it runs");
        String::from_utf8(done.stdout).expect("text")
    }
}

impl Drop for BoothProcess {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
