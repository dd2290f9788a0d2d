//! `paros exhibit` as a whole: a booth and a window on one machine.

use std::fs;
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_booth_process::find_booth;
use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{XvfbDisplay, empty_folder, paros_command};

/// Timeout of every wait.
const PATIENCE: Duration = Duration::from_secs(120);

/// On a termination signal, for example by `systemctl stop`, neither window nor booth stays: a remaining
/// booth would keep its folder and its port.
#[test]
fn told_to_end_it_ends_its_window_and_its_booth() -> Result<(), MissingDependency> {
    let folder = empty_folder("exhibit");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    if find_booth().is_none() {
        return Ok(());
    }
    let said = folder.join("said");
    let all = folder.join("all");
    let mut exhibit = paros_command(&folder)
        .env("DISPLAY", &display.name)
        .args(["exhibit", "--listen", "127.0.0.1:0", "--folder"])
        .arg(&all)
        .stdout(fs::File::create(&said).expect("room on the disk"))
        .stderr(Stdio::null())
        .spawn()
        .expect("it runs");
    wait_until("booth and window are there", || list_processes(&all).len() == 3);
    let told = fs::read_to_string(&said).expect("text");
    let place = told.lines().next().and_then(|line| line.strip_prefix("booth: https://"));
    let place = place.expect("an address").to_owned();
    assert!(TcpStream::connect(&place).is_ok(), "{told}");
    end(&exhibit);
    wait_until("it ends", || exhibit.try_wait().expect("a process").is_some());
    assert_eq!(exhibit.wait().expect("it has ended").code(), Some(0));
    assert_eq!(list_processes(&all), [""; 0]);
    Ok(())
}

fn end(process: &Child) {
    let ended = Command::new("kill").arg(process.id().to_string()).status();
    assert!(ended.expect("kill").success());
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "{what}: it isn't so");
        thread::sleep(Duration::from_millis(50));
    }
}

/// Returns the command lines of all processes that name a folder.
fn list_processes(folder: &Path) -> Vec<String> {
    let folder = folder.display().to_string();
    let of_all = fs::read_dir("/proc").expect("a kernel's").flatten();
    let lines = of_all.filter_map(|entry| fs::read_to_string(entry.path().join("cmdline")).ok());
    lines.filter(|line| line.contains(&folder)).collect()
}
