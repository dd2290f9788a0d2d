//! Runs PrusaSlicer as a subprocess: one at a time, in its own folder, without the booth's environment, and
//! with limits on time, memory and file size. Its output is untrusted.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process_group, prlimit};

use super::gcode::{Estimate, read_estimate};
use super::options::SlicerOptions;
use super::slice_folder::{SliceFolder, SliceFolders};
use crate::error::Error;
use crate::server::worker::LOW_PRIORITY;
use crate::store::own_file::check_folder;

/// The timeout of a slice: a sculpture with 256 voxels a side takes some twenty seconds on a small processor.
const MAX_SLICE_TIME: Duration = Duration::from_secs(240);

/// The most bytes of memory: a sculpture with 256 voxels a side takes half a gigabyte.
const MAX_MEMORY: u64 = 4 << 30;

/// The most bytes of a file that the slicer writes. The G-code of a week's print has some 200 MB.
const MAX_FILE: u64 = 1 << 30;

/// The most bytes of the slicer's output that are read.
const MAX_WORDS: u64 = 64 << 10;

/// The density of PLA, the most common material, in grams per cubic centimetre. Used if there is no profile.
const PLA_DENSITY: &str = "1.24";

/// The poll interval for the slicer's exit.
const LOOK_AGAIN: Duration = Duration::from_millis(30);

/// A runner of PrusaSlicer.
pub(crate) struct Slicer {
    program: PathBuf,
    profile: Option<PathBuf>,
    folders: SliceFolders,
    one_at_a_time: Mutex<()>,
    is_over: Arc<AtomicBool>,
    bounds: Bounds,
}

/// Limits of a slice.
#[derive(Clone, Copy)]
struct Bounds {
    time: Duration,
    memory: u64,
    file: u64,
}

/// The reason why a slice failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum SliceFault {
    /// The print is larger than the printer.
    TooLarge,
    /// The slicer's folder can't be written, for example on a full disk: retry later.
    Disk(String),
    /// Any other reason, as text for staff.
    Failed(String),
    /// The program is ending.
    Over,
}

/// G-code in a folder that is removed when this value is dropped.
#[derive(Debug)]
pub(crate) struct SlicedPrint {
    pub(crate) estimate: Estimate,
    pub(crate) gcode: PathBuf,
    _folder: SliceFolder,
}

impl Slicer {
    /// Finds the slicer by the options. Returns `None` if there is none. Slices are made in a folder of this
    /// process in `folder`.
    ///
    /// # Errors
    /// A program or file that the options name doesn't exist; the error of the disk.
    pub(crate) fn find(options: &SlicerOptions, folder: &Path) -> Result<Option<Self>, Error> {
        let program = match &options.slicer {
            Some(none) if none.as_os_str() == "none" => return Ok(None),
            Some(named) => find_program(named).ok_or_else(|| {
                Error::Input(format!("--slicer {}: expected a program", named.display()))
            })?,
            None => match find_program(Path::new("prusa-slicer")) {
                Some(found) => found,
                None => return Ok(None),
            },
        };
        let profile = options.slicer_profile.as_deref().map(check_profile).transpose()?;
        let folders = SliceFolders::take(folder)?;
        Ok(Some(Slicer {
            program,
            profile,
            folders,
            one_at_a_time: Mutex::new(()),
            is_over: Arc::default(),
            bounds: Bounds { time: MAX_SLICE_TIME, memory: MAX_MEMORY, file: MAX_FILE },
        }))
    }

    /// Returns a flag that ends a running slice at once when it is set.
    pub(crate) fn end(&self) -> Arc<AtomicBool> {
        self.is_over.clone()
    }

    /// Slices a scaled model with a profile; by default the profile of the options.
    ///
    /// # Errors
    /// The reason why the slice failed.
    pub(crate) fn slice(
        &self,
        stl: &[u8],
        scale: f64,
        profile: Option<&Path>,
    ) -> Result<SlicedPrint, SliceFault> {
        let _turn = self.one_at_a_time.lock().unwrap_or_else(PoisonError::into_inner);
        if self.is_over.load(Ordering::Relaxed) {
            return Err(SliceFault::Over);
        }
        let failed = |error: io::Error| SliceFault::Disk(format!("the slicer's folder: {error}"));
        let folder = self.folders.make_next().map_err(failed)?;
        File::create(folder.path().join("model.stl"))
            .and_then(|mut file| file.write_all(stl))
            .map_err(failed)?;
        let profile = profile.or(self.profile.as_deref());
        let status = self.run(folder.path(), scale, profile)?;
        if !status.success() {
            check_folder(folder.path()).map_err(failed)?;
            return Err(fault_of(folder.path(), status));
        }
        let gcode = folder.path().join("print.gcode");
        match read_estimate(&gcode) {
            Ok(Some(estimate)) => Ok(SlicedPrint { estimate, gcode, _folder: folder }),
            Ok(None) => Err(SliceFault::Failed("the slicer told no time".into())),
            Err(_) => Err(SliceFault::Failed("the slicer wrote nothing".into())),
        }
    }

    fn run(
        &self,
        folder: &Path,
        scale: f64,
        profile: Option<&Path>,
    ) -> Result<ExitStatus, SliceFault> {
        let failed = |error: io::Error| SliceFault::Failed(format!("the slicer: {error}"));
        let words = File::create(folder.join("words")).map_err(failed)?;
        let mut command = Command::new(&self.program);
        command.args(["--export-gcode", "--output", "print.gcode", "--datadir", "settings"]);
        match profile {
            Some(profile) => command.arg("--load").arg(profile),
            None => command.args(["--filament-density", PLA_DENSITY]),
        };
        command
            .arg("--scale")
            .arg(format!("{scale:.6}"))
            .arg("model.stl")
            .current_dir(folder)
            .env_clear()
            .env("PATH", "/usr/local/bin:/usr/bin:/bin")
            .env("HOME", folder)
            .env("TMPDIR", folder)
            .env("LC_ALL", "C")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(words)
            // A process group, so that the slicer's own child processes are killed with it.
            .process_group(0);
        let mut child = command.spawn().map_err(failed)?;
        let bounded = self.bound(&child);
        let ended = bounded.and_then(|()| self.wait(&mut child));
        if ended.is_err() {
            kill(&mut child);
        }
        ended
    }

    /// Sets the limits of the process before it has read its model.
    fn bound(&self, child: &Child) -> Result<(), SliceFault> {
        let pid = Pid::from_child(child);
        let Bounds { time, memory, file } = self.bounds;
        // If the booth is killed, the limit of processor time still ends the slicer.
        for (resource, most) in [
            (Resource::As, memory),
            (Resource::Fsize, file),
            (Resource::Core, 0),
            (Resource::Cpu, 4 * time.as_secs().max(1)),
        ] {
            let limit = Rlimit { current: Some(most), maximum: Some(most) };
            match prlimit(Some(pid), resource, limit) {
                Ok(_) | Err(rustix::io::Errno::SRCH) => {}
                Err(error) => {
                    return Err(SliceFault::Failed(format!("the slicer's bounds: {error}")));
                }
            }
        }
        // Requests of the pages take precedence.
        let _ = rustix::process::setpriority_process(Some(pid), LOW_PRIORITY);
        Ok(())
    }

    fn wait(&self, child: &mut Child) -> Result<ExitStatus, SliceFault> {
        let start = Instant::now();
        loop {
            match child.try_wait() {
                Ok(Some(status)) => return Ok(status),
                Ok(None) if self.is_over.load(Ordering::Relaxed) => return Err(SliceFault::Over),
                Ok(None) if start.elapsed() > self.bounds.time => {
                    return Err(SliceFault::Failed("the slicer took too long".into()));
                }
                Ok(None) => std::thread::sleep(LOOK_AGAIN),
                Err(error) => return Err(SliceFault::Failed(format!("the slicer: {error}"))),
            }
        }
    }
}

/// Checks that a profile exists. Returns its absolute path, as the slicer runs in another folder.
pub(crate) fn check_profile(path: &Path) -> Result<PathBuf, Error> {
    let found = fs::canonicalize(path).ok().filter(|found| found.is_file());
    let expected = "expected a file of the slicer's settings";
    found.ok_or_else(|| Error::Input(format!("{}: {expected}", path.display())))
}

/// Finds a program by its path, or by its name in `PATH`.
fn find_program(name: &Path) -> Option<PathBuf> {
    if name.components().count() > 1 {
        return fs::canonicalize(name).ok().filter(|found| found.is_file());
    }
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file())
}

fn kill(child: &mut Child) {
    let _ = kill_process_group(Pid::from_child(child), Signal::KILL);
    let _ = child.kill();
    let _ = child.wait();
}

/// Returns why the slicer failed. Recognises known messages in its output, but never quotes the output.
fn fault_of(folder: &Path, status: ExitStatus) -> SliceFault {
    let mut words = Vec::new();
    let read = File::open(folder.join("words"))
        .and_then(|file| file.take(MAX_WORDS).read_to_end(&mut words));
    let words = String::from_utf8_lossy(&words);
    if read.is_ok() && words.contains("could not fit on the bed") {
        return SliceFault::TooLarge;
    }
    SliceFault::Failed(match status.code() {
        Some(code) => format!("the slicer ended with code {code}"),
        None => "the slicer broke off".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::sync::atomic::Ordering;
    use std::time::{Duration, Instant};

    use super::{Bounds, SliceFault, Slicer, SlicerOptions};

    /// Makes a slicer from a shell script.
    fn slicer(name: &str, script: &str) -> Slicer {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../target/tmp/slicer");
        let folder = folder.join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let [draft, program] = ["draft", "slicer"].map(|name| folder.join(name));
        std::fs::write(&draft, format!("#!/bin/sh\n{script}\n")).unwrap();
        // A separate process writes the program: a child of another test would inherit this process' file
        // descriptor, and then starting the program would fail ("text file busy").
        let installed = std::process::Command::new("install").arg(draft).arg(&program).status();
        assert!(installed.unwrap().success());
        let options = SlicerOptions { slicer: Some(program), slicer_profile: None, printers: None };
        let mut slicer =
            Slicer::find(&options, &folder.join("slices")).unwrap().expect("it is there");
        slicer.bounds = Bounds { time: Duration::from_secs(3), memory: 1 << 30, file: 1 << 20 };
        slicer
    }

    fn fault(slicer: &Slicer) -> String {
        match slicer.slice(b"stl", 1.0, None).expect_err("a fault") {
            SliceFault::Failed(why) => why,
            other => format!("{other:?}"),
        }
    }

    const WELL: &str =
        "printf '; total filament used [g] = 2\n; estimated printing time (normal mode) = 2m\n'";

    #[test]
    fn it_is_told_what_to_do_in_a_folder_of_its_own_without_the_booths_environment() {
        let script = format!("env | sort >env; echo \"$@\" >arguments; {WELL} >print.gcode");
        let slicer = slicer("well", &script);
        let sliced = slicer.slice(b"stl", 0.5, None).expect("a slice");
        assert_eq!((sliced.estimate.minutes, sliced.estimate.tenths_gram), (2, 20));
        let folder = sliced.gcode.parent().unwrap().to_owned();
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(!read("env").contains("CARGO"), "{}", read("env"));
        assert!(read("arguments").contains("--scale 0.500000 model.stl"));
        assert_eq!(read("model.stl"), "stl");
        drop(sliced);
        assert!(!folder.exists(), "it is removed");
    }

    #[test]
    fn it_is_bounded_in_time_with_all_that_it_started() {
        let slicer = slicer("slow", "sleep 300 & echo $! >../child; wait");
        let start = Instant::now();
        assert_eq!(fault(&slicer), "the slicer took too long");
        assert!(start.elapsed() < Duration::from_secs(20));
        let child = std::fs::read_to_string(slicer.folders.path().join("child")).unwrap();
        let of_child = PathBuf::from(format!("/proc/{}/stat", child.trim()));
        // A killed process may remain as a zombie until it is reaped.
        let is_gone =
            || std::fs::read_to_string(&of_child).map_or(true, |stat| stat.contains(") Z"));
        let start = Instant::now();
        while !is_gone() {
            assert!(start.elapsed() < Duration::from_secs(10), "its child goes on");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    #[test]
    fn it_is_bounded_in_what_it_writes_and_in_memory() {
        // The script sleeps, as the limits are set shortly after it starts.
        let slicer_of_file =
            slicer("file", "sleep 0.3; head -c 9000000 /dev/zero >print.gcode || exit 3");
        assert_eq!(fault(&slicer_of_file), "the slicer ended with code 3");
        let of_memory = "sleep 0.3; dd if=/dev/zero of=/dev/null bs=1500M count=1 || exit 4";
        assert_eq!(fault(&slicer("memory", of_memory)), "the slicer ended with code 4");
    }

    #[test]
    fn its_words_are_not_passed_on() {
        assert_eq!(
            fault(&slicer("words", "echo '<b>secret' >&2; exit 9")),
            "the slicer ended with code 9"
        );
        assert_eq!(
            fault(&slicer("bed", "echo 'Objects could not fit on the bed' >&2; exit 1")),
            "TooLarge"
        );
        assert_eq!(fault(&slicer("silent", "exit 0")), "the slicer wrote nothing");
        assert_eq!(fault(&slicer("empty", ": >print.gcode")), "the slicer told no time");
        assert_eq!(fault(&slicer("killed", "kill -9 $$")), "the slicer broke off");
    }

    #[test]
    fn the_end_of_the_program_waits_for_none() {
        let slicer = slicer("over", "sleep 300");
        let end = slicer.end();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(200));
                end.store(true, Ordering::Relaxed);
            });
            assert_eq!(fault(&slicer), "Over");
        });
        assert_eq!(fault(&slicer), "Over");
    }

    #[test]
    fn one_that_was_named_and_is_not_there_is_told() {
        for name in ["/nowhere/slicer", "no-such-slicer-anywhere"] {
            let options =
                SlicerOptions { slicer: Some(name.into()), slicer_profile: None, printers: None };
            let told = Slicer::find(&options, Path::new("slices")).err().expect("it is missing");
            assert!(told.to_string().contains(name), "{told}");
        }
        let none =
            SlicerOptions { slicer: Some("none".into()), slicer_profile: None, printers: None };
        assert!(Slicer::find(&none, Path::new("slices")).unwrap().is_none());
    }
}
