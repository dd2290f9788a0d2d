//! Tests of a booth on a full disk.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::require_or_skip;

use crate::prints::{send_form, slicer_by, with_sculpture};
use crate::rig::{BoothFolder, Headset, Parcel};
use crate::smtp_sink::wait_until;
use crate::staff::Browser;

/// A mounted file system in memory.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// Mounts a file system of this size. Returns `None` if the user may not mount.
    fn mount(folder: &Path, kib: u32) -> Option<Self> {
        fs::create_dir_all(folder).expect("room");
        let disk = SmallDisk(folder.to_owned());
        let mounted = disk.run("mount", &["-t", "tmpfs", "-o", &format!("size={kib}k"), "tmpfs"]);
        require_or_skip(mounted.then_some(disk).ok_or("no mount")).expect("a user who may mount")
    }

    fn resize(&self, kib: u32) {
        assert!(self.run("mount", &["-o", &format!("remount,size={kib}k")]));
    }

    fn run(&self, program: &str, arguments: &[&str]) -> bool {
        let done = Command::new(program).args(arguments).arg(&self.0).output();
        done.is_ok_and(|done| done.status.success())
    }

    /// Fills the file system with a file. Returns its path.
    fn fill(&self) -> PathBuf {
        let path = self.0.join("filler");
        let mut file = fs::File::create(&path).expect("room");
        while std::io::copy(&mut &[0; 1 << 12][..], &mut file).is_ok() {}
        path
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        self.run("umount", &["-l"]);
    }
}

#[test]
fn a_full_disk_is_told_and_what_comes_again_is_kept() {
    let folder = BoothFolder::new("full-disk");
    let Some(disk) = SmallDisk::mount(&folder.path(), 32 << 10) else { return };
    let booth = folder.start();
    let client = &booth.client;
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(1);
    assert!(headset.upload(client, &parcel).expect("an answer").is_ok());
    let at = format!("/staff/sculptures/{}", parcel.facts.id);
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    assert_eq!(client.get("/healthz").status, 200);
    assert!(client.metric("paros_booth_room_bytes") > 1 << 20);

    let filler = disk.fill();
    wait_until(|| (client.get("/healthz").status == 503).then_some(()));
    assert!(client.metric("paros_booth_room_bytes") < 1 << 16);
    let late = Parcel::volume(2);
    let refused = headset.upload(client, &late).expect("an answer").expect_err("no room");
    assert!(refused.status == 503 && refused.head.contains("retry-after"), "{refused:?}");
    let wish = "height=100&minutes=&filament=bone+white&note=for+Eleni";
    let ordered = send_form(&ana, &at, &format!("{at}/print"), wish);
    assert!(ordered.status == 503 && ordered.text().contains("bone white"), "{ordered:?}");
    assert_eq!(client.metric("paros_booth_prints_queued"), 0);

    fs::remove_file(filler).unwrap();
    wait_until(|| (client.get("/healthz").status == 200).then_some(()));
    assert!(headset.upload(client, &late).expect("an answer").is_ok());
    assert_eq!(send_form(&ana, &at, &format!("{at}/print"), wish).status, 303);
    assert_eq!(client.metric("paros_booth_prints_queued"), 1);
}

#[test]
fn a_print_waits_until_there_is_room_for_its_slice() {
    let folder = BoothFolder::new("full-slices");
    let slices = folder.path().join("slices");
    let Some(disk) = SmallDisk::mount(&slices, 64) else { return };
    let slicer = slicer_by(&folder).display().to_string();
    let booth = folder.start_with(&["--slicer", &slicer]);
    let ana = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let at = with_sculpture(&booth.client, &folder, 1);
    let order = |wish: &str| send_form(&ana, &at, &format!("{at}/print"), wish).status;
    assert_eq!(order("height=&minutes=60&filament=&note="), 303);
    wait_until(|| (folder.log().contains("the slicer's folder")).then_some(()));
    disk.resize(64 << 10);
    // The order wakes the slicing thread, which takes the oldest print first.
    assert_eq!(order("height=60&minutes=&filament=&note="), 303);
    wait_until(|| (ana.get(&at).text().matches("ready to print").count() == 2).then_some(()));
}

/// A booth under a umask of 0 makes no files that others can read.
#[test]
fn files_are_their_owners_whatever_the_umask() {
    let folder = BoothFolder::new("umask");
    let program = env!("CARGO_BIN_EXE_paros-booth");
    let script = format!("umask 0; exec {program} --listen 127.0.0.1:0 --folder \"$0\"");
    let mut booth = Command::new("sh").args(["-c", &script]).arg(folder.path()).spawn().unwrap();
    wait_until(|| (folder.path().join("booth.sqlite-wal").exists()).then_some(()));
    let mut folders = vec![folder.path()];
    let mut count = 0;
    while let Some(next) = folders.pop() {
        let entries = fs::read_dir(&next).unwrap().map(|entry| entry.unwrap().path());
        for path in entries.chain([next.clone()]) {
            let mode = fs::metadata(&path).unwrap().permissions().mode() & 0o777;
            let expected = if path.is_dir() { 0o700 } else { 0o600 };
            assert_eq!(mode, expected, "{}", path.display());
            count += 1;
            if path.is_dir() && path != next {
                folders.push(path);
            }
        }
    }
    let _ = booth.kill();
    let _ = booth.wait();
    assert!(count > 5, "{count}");
}
