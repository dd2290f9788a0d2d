//! The headset's file of options: what is wrong is told in one line, with its place, and the defaults hold; or its
//! settings, written again, are read as the same.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use paros_core::session::SessionMode;
use paros_quest::foveation::FoveationLevel;
use paros_quest::options::ShellOptions;
use paros_quest::settings::{FILE_NAME, HeadsetSettings, LoadedSettings, MAX_BYTES, read_settings};
use paros_shell::modes::named_modes;

use crate::engine::FuzzTarget;

pub(super) const OPTIONS: FuzzTarget = FuzzTarget {
    name: "options",
    seeds,
    words: &[
        b" --size 256",
        b" --mode owl",
        b" --mode=creative",
        b" --handover 120",
        b" --record a.trace",
        b" --rate 90",
        b" --depth",
        b" --foveation medium",
        b"--folder",
        b"--replay",
        b"--digests",
        b"--script",
        b"--validation",
        b"--help",
        b" -h",
        b" -V",
        b" -- ",
        b"=",
        b"#",
        b"\r\n",
        b"\xef\xbb\xbf",
        b"\xc2\x85",
        b"inf",
        b"1e-50",
    ],
    longest: MAX_BYTES as usize + 8,
    runs: 1000,
    run: |bytes| {
        let folder = OwnFolder::new();
        fs::write(folder.0.join(FILE_NAME), bytes).expect("room on the disk");
        let loaded = read_settings(&folder.0);
        assert_eq!(folder.names(), [FILE_NAME], "nothing is left beside it");
        check(&folder, bytes, &loaded)
    },
};

fn seeds() -> Vec<Vec<u8>> {
    let texts: [&[u8]; 6] = [
        b"\xef\xbb\xbf# for the fair\r\n--rate 90 --depth\r\n\t--foveation\r\n# half\r\nmedium\r\n",
        b"--handover=120 --mode creative --size 256 --record own.trace",
        b"--mode cat\n--foveation off#!\n--rate\n72.5",
        b"--mode cubes\n--depth\n",
        b"--replay a.trace --digests b\n",
        b"--depth\n--record none/own.trace\n\xff",
    ];
    texts.map(<[u8]>::to_vec).into()
}

/// A folder for one run, gone with it.
struct OwnFolder(PathBuf);

impl OwnFolder {
    fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("paros-fuzz-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        OwnFolder(folder)
    }

    fn names(&self) -> Vec<std::ffi::OsString> {
        let entries = fs::read_dir(&self.0).expect("its folder");
        entries.map(|entry| entry.expect("an entry").file_name()).collect()
    }
}

impl Drop for OwnFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn check(folder: &OwnFolder, bytes: &[u8], loaded: &LoadedSettings) -> String {
    let told = loaded.log_line.as_ref().expect("there is a file");
    assert_eq!(told.lines().count(), 1, "{told:?}");
    let path = folder.0.join(FILE_NAME).display().to_string();
    let told = told.strip_prefix(&path).expect("it names the file").strip_prefix(':');
    let told = told.expect("it tells what of the file");
    match told.strip_suffix("; the defaults hold") {
        Some(why) => {
            assert_eq!(loaded.settings, defaults(&folder.0));
            check_place(bytes, why)
        }
        None => {
            let again = write_options(&folder.0, &loaded.settings);
            fs::write(folder.0.join(FILE_NAME), &again).expect("room on the disk");
            assert_eq!(read_settings(&folder.0).settings, loaded.settings, "{again}");
            assert_ne!(told, " ", "it tells the flags");
            again.split(" --record=").next().unwrap_or_default().into()
        }
    }
}

/// Why the file counts for nothing, without its own words. It names a line of it, or the file is no text of flags.
fn check_place(bytes: &[u8], why: &str) -> String {
    if let Some(why) = why.strip_prefix(' ') {
        assert!(why.ends_with(", expected flags as text"), "{why}");
        return why.into();
    }
    let (line, why) = why.split_once(": ").expect("a line's number");
    let lines = bytes.split(|byte| *byte == b'\n').count();
    assert!((1..=lines).contains(&line.parse().expect("a number")), "line {line} of {lines}");
    assert!(!why.contains("Sculpt in a headset") && !why.starts_with("paros-quest"), "{why}");
    // Paths of what can't be recorded and words between apostrophes are the file's own.
    let why = why.rsplit_once(": cannot ").map_or(why, |(_, why)| why);
    why.split('\'').next().into_iter().chain(why.rsplit('\'').next()).collect()
}

fn defaults(folder: &Path) -> HeadsetSettings {
    let options = ShellOptions { folder: Some(folder.into()), ..ShellOptions::default() };
    HeadsetSettings { size: 128, options }
}

/// The text of a file with these settings. Those that a file can't change aren't in it.
fn write_options(folder: &Path, settings: &HeadsetSettings) -> String {
    let HeadsetSettings { size, options } = settings;
    let named = |mode: &SessionMode| named_modes().find(|(_, of)| of == mode).map(|(name, _)| name);
    let mode = named(&options.mode).expect("a mode with a name");
    let (seconds, rate) = (options.handover_after.as_secs(), options.refresh_rate);
    let mut text = format!("--size {size} --mode {mode} --handover {seconds} --rate {rate}");
    if options.submit_depth {
        text += " --depth";
    }
    if let Some(level) = options.foveation {
        let found = FoveationLevel::NAMES.iter().find(|(_, of)| *of == level);
        let _ = write!(text, " --foveation {}", found.expect("a level with a name").0);
    }
    if let Some(record) = &options.record {
        let record = record.strip_prefix(folder).unwrap_or(record);
        let _ = write!(text, " --record={}", record.display());
    }
    text
}
