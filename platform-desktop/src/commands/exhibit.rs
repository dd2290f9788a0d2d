//! `paros exhibit`: runs a booth and a studio with visits on one machine, enrolled at each other.

mod mail_sink;

use std::env;
use std::ffi::OsString;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::net::SocketAddr;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use paros_headless::Error;
use paros_protocol::DeviceName;
use paros_shell::durable;
use paros_upload::enrolment::{Enrolment, FleetFile, NewDevice, enrol_by_fleet, enrolment_file};
use paros_upload_https::HttpsCaller;
use rustix::process::{Pid, Signal, kill_process};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::booth::BUILD_COMMAND;
use mail_sink::MailSink;

/// The arguments of `paros exhibit`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Folder for the booth's data, the studio's sessions, the sculptures, and with --mails-to-files the
    /// mails.
    ///
    /// The studio reads its settings from FOLDER/studio/paros/paros.toml, if the file exists.
    #[arg(long, value_name = "FOLDER", default_value = "paros-exhibit")]
    folder: PathBuf,
    /// Address on which the booth listens.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "0.0.0.0:8443")]
    listen: SocketAddr,
    /// Write each of the booth's mails to a file instead of sending it.
    #[arg(long)]
    mails_to_files: bool,
    /// Further arguments of the window, after `--`; see `paros window --help`.
    #[arg(last = true, value_name = "ARGUMENT")]
    window: Vec<OsString>,
}

/// Poll interval for the window and the booth.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Least time between two restarts of the booth.
const RESTART_EVERY: Duration = Duration::from_secs(5);

/// Folders of an exhibition.
struct ExhibitPlaces {
    booth: PathBuf,
    /// Value of `XDG_DATA_HOME` for the studio.
    data: PathBuf,
    sculptures: PathBuf,
    mails: PathBuf,
}

/// A running booth process. Dropping it sends a termination signal and waits for the end.
struct RunningBooth {
    process: Child,
    /// Address at which this machine reaches the booth.
    address: String,
    /// Address on which the booth listens, with its actual port.
    listen: SocketAddr,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let program = find_booth()?;
    let end = listen_for_end()?;
    let folder = &args.folder;
    durable::make_folder(folder)?;
    let folder = folder.canonicalize().map_err(Error::failure)?;
    let places = ExhibitPlaces {
        booth: folder.join("booth"),
        data: folder.join("studio"),
        sculptures: folder.join("sculptures"),
        mails: folder.join("mails"),
    };
    let sink = args.mails_to_files.then(|| MailSink::start(&places.mails)).transpose()?;
    let start = |listen| RunningBooth::start(&program, listen, &places, sink.as_ref());
    let booth = start(args.listen)?;
    let settings = places.data.join("paros/paros.toml");
    let is_there = if settings.exists() { "" } else { " (not there: all defaults)" };
    print_line(&format!("settings of the studio: {}{is_there}", settings.display()));
    if sink.is_some() {
        print_line(&format!("mails become files in {}", places.mails.display()));
    }
    enrol(&program, &places, &booth.address)?;
    let window = Command::new(env::current_exe().map_err(Error::failure)?)
        .args(["window", "--visits", "--folder"])
        .arg(&places.sculptures)
        .args(&args.window)
        .env("XDG_DATA_HOME", &places.data)
        .spawn()
        .map_err(Error::failure)?;
    end_of_window(wait_for_window(window, booth, start, &end)?, &folder)
}

/// Registers a flag that termination signals set. The command then ends all its processes.
fn listen_for_end() -> Result<Arc<AtomicBool>, Error> {
    let end = Arc::new(AtomicBool::new(false));
    for signal in [SIGTERM, SIGINT, SIGHUP] {
        signal_hook::flag::register(signal, end.clone()).map_err(Error::failure)?;
    }
    Ok(end)
}

/// Waits until the window ends, or ends it once `end` is set. If the booth ends earlier, this is reported and
/// the booth restarted at the same address.
fn wait_for_window(
    mut window: Child,
    booth: RunningBooth,
    start: impl Fn(SocketAddr) -> Result<RunningBooth, Error>,
    end: &AtomicBool,
) -> Result<ExitStatus, Error> {
    let listen = booth.listen;
    let mut booth = Some(booth);
    let mut next_start = Instant::now();
    let mut is_told = false;
    loop {
        if end.load(Ordering::Relaxed) {
            // The session is saved continuously, and resumes at the next start.
            tell_to_end(&mut window);
        }
        if let Some(status) = window.try_wait().map_err(Error::failure)? {
            return Ok(status);
        }
        if let Some(status) = booth.as_mut().and_then(|booth| booth.process.try_wait().ok()?) {
            print_line(&format!("booth: it has ended ({status}); it is started again"));
            (booth, is_told) = (None, false);
        }
        if booth.is_none() && next_start <= Instant::now() {
            next_start = Instant::now() + RESTART_EVERY;
            // The window continues without a booth.
            match start(listen) {
                Ok(started) => booth = Some(started),
                Err(why) if !is_told => {
                    print_line(&format!("booth: it doesn't start, and is tried again: {why}"));
                    is_told = true;
                }
                Err(_) => {}
            }
        }
        thread::sleep(LOOK_EVERY);
    }
}

fn end_of_window(window: ExitStatus, folder: &Path) -> Result<String, Error> {
    let why = "the window has told above why it ended";
    match (window.code(), window.signal()) {
        (Some(0), _) | (_, Some(SIGTERM)) => Ok(format!("{}: all of it\n", folder.display())),
        (Some(2), _) => Err(Error::Input(why.into())),
        _ => Err(Error::Failure(why.into())),
    }
}

/// Finds the booth's program, which is beside this one.
fn find_booth() -> Result<PathBuf, Error> {
    let booth = env::current_exe().map_err(Error::failure)?.with_file_name("paros-booth");
    match booth.exists() {
        true => Ok(booth),
        false => Err(Error::Failure(format!(
            "{}: there is no such program; `{BUILD_COMMAND}` builds it",
            booth.display()
        ))),
    }
}

impl RunningBooth {
    /// Starts the booth, and prints its messages: its address, its fingerprint, the first account's code.
    fn start(
        program: &Path,
        listen: SocketAddr,
        places: &ExhibitPlaces,
        sink: Option<&MailSink>,
    ) -> Result<Self, Error> {
        let mut command = Command::new(program);
        command.arg("--listen").arg(listen.to_string()).arg("--folder").arg(&places.booth);
        // The booth's page may be requested under any name, but this machine's studio uses this name.
        command.args(["--name", "127.0.0.1"]);
        if let Some(sink) = sink {
            let server = sink.address().to_string();
            command.args(["--smtp", &server, "--smtp-tls", "none"]);
            command.args(["--mail-from", "booth@exhibition.example"]);
        }
        let started = command.stdout(Stdio::piped()).spawn();
        let mut process =
            started.map_err(|error| Error::Failure(format!("{}: {error}", program.display())))?;
        let mut lines =
            process.stdout.take().map(BufReader::new).into_iter().flat_map(|out| out.lines());
        let mut booth = RunningBooth { process, address: String::new(), listen };
        let first = lines.next().and_then(Result::ok).unwrap_or_default();
        let port = first.rsplit_once(':').and_then(|(_, port)| port.trim().parse::<u16>().ok());
        let port = port.filter(|_| first.starts_with("https://"));
        let Some(port) = port else {
            return Err(Error::Failure("the booth has told above why it doesn't serve".into()));
        };
        let host = match listen.ip() {
            ip if ip.is_unspecified() => "127.0.0.1".to_owned(),
            ip if ip.is_ipv6() => format!("[{ip}]"),
            ip => ip.to_string(),
        };
        booth.address = format!("https://{host}:{port}");
        booth.listen.set_port(port);
        print_line(&format!("booth: {first}"));
        thread::spawn(move || {
            lines.map_while(Result::ok).for_each(|line| print_line(&format!("booth: {line}")));
        });
        Ok(booth)
    }
}

fn print_line(line: &str) {
    // Standard output may be closed.
    let _ = writeln!(io::stdout(), "{line}");
}

impl Drop for RunningBooth {
    fn drop(&mut self) {
        tell_to_end(&mut self.process);
        let _ = self.process.wait();
    }
}

fn tell_to_end(process: &mut Child) {
    let pid = i32::try_from(process.id()).ok().and_then(Pid::from_raw);
    let told = pid.map(|pid| kill_process(pid, Signal::TERM));
    if !matches!(told, Some(Ok(()))) {
        // A killed booth loses no data either.
        let _ = process.kill();
    }
}

/// Enrols the studio, unless an earlier run has done so. In that case only the address is updated, as the
/// booth's port may have changed.
fn enrol(program: &Path, places: &ExhibitPlaces, address: &str) -> Result<(), Error> {
    let file = enrolment_file(&places.data.join("paros"));
    if let Some(found) = Enrolment::read(&file).map_err(Error::input)? {
        if found.address != address {
            Enrolment { address: address.into(), ..found }.write(&file)?;
        }
        return Ok(());
    }
    let made = Command::new(program)
        .args(["fleet-file", "--uses", "1", "--days", "1", "--address", address, "--folder"])
        .arg(&places.booth)
        .output()
        .map_err(Error::failure)?;
    if !made.status.success() {
        let why = String::from_utf8_lossy(&made.stderr);
        return Err(Error::Failure(format!("the studio isn't enrolled: {}", why.trim())));
    }
    let fleet = FleetFile::parse(&places.booth.display().to_string(), &made.stdout)
        .map_err(Error::failure)?;
    let name = DeviceName::new("this machine").ok_or_else(|| Error::failure("a name"))?;
    let device = NewDevice::draw(None, name).map_err(Error::failure)?;
    let mut link = HttpsCaller::new(&fleet.address, &fleet.ca);
    enrol_by_fleet(&mut link, &fleet, &device).map_err(Error::failure)?.write(&file)?;
    Ok(())
}
