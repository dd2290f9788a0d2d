//! Options from a file, for a headset, which has no command line: `paros.options`, in the folder of
//! the sessions and sculptures. On a Quest, from a computer:
//!
//! ```text
//! adb push paros.options /sdcard/Android/data/org.paros.studio/files/paros.options
//! ```
//!
//! Its words are those of `paros-quest`'s command line, apart by blanks or ends of lines; `#` begins
//! a comment, which ends with its line:
//!
//! ```text
//! --rate 90 --foveation medium   # for a cool room
//! --handover 120
//! ```
//!
//! It is read at each start. A file with anything wrong in it counts for nothing: the shell says what
//! is wrong where, and runs by the defaults.

use std::fmt::Write;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};
use paros_shell::durable::{self, WriteTarget};

use crate::arguments::HeadsetArgs;
use crate::options::ShellOptions;

/// The file's name.
pub const FILE_NAME: &str = "paros.options";

/// The file's most bytes: a longer one is something else by mistake.
pub const MAX_BYTES: u64 = 4096;

/// Flags that the file may not hold, and why.
const REFUSED_FLAGS: [(&str, &str); 9] = [
    ("--folder", "it is the folder of this file"),
    ("--replay", "a headset plays no traces"),
    ("--digests", "a headset plays no traces"),
    ("--script", "a headset has no standard input"),
    ("--validation", "a headset has no validation layer"),
    ("--help", "paros-quest tells it on Linux"),
    ("-h", "paros-quest tells it on Linux"),
    ("--version", "paros-quest tells it on Linux"),
    ("-V", "paros-quest tells it on Linux"),
];

/// What a file of options holds.
#[derive(Clone, PartialEq, Debug)]
pub struct HeadsetSettings {
    /// Voxels along an edge.
    pub size: usize,
    /// All other options.
    pub options: ShellOptions,
}

/// The settings of a shell, and what is to be said of their file.
#[derive(Clone, PartialEq, Debug)]
pub struct LoadedSettings {
    /// The file's settings, or the defaults.
    pub settings: HeadsetSettings,
    /// The flags that were read or what is wrong with them, for the log; none if there is no file.
    pub log_line: Option<String>,
}

/// Reads the settings of a shell whose files lie in a folder.
/// A trace to be recorded goes into the folder, unless its path is absolute.
#[must_use]
pub fn read_settings(folder: &Path) -> LoadedSettings {
    let path = folder.join(FILE_NAME);
    let defaults = || {
        let options = ShellOptions { folder: Some(folder.into()), ..ShellOptions::default() };
        HeadsetSettings { size: 128, options }
    };
    let text = match read_text(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return LoadedSettings { settings: defaults(), log_line: None };
        }
        text => text.map_err(|error| format!("{}: {error}", path.display())),
    };
    let parsed = text.and_then(|text| {
        let words = split_words(&text);
        let settings = parse_settings(folder, &words).map_err(|why| format_error(&path, &why))?;
        let taken: Vec<&str> = words.iter().map(|word| word.text).collect();
        let taken = if taken.is_empty() { "no flags".into() } else { taken.join(" ") };
        Ok((settings, format!("{}: {taken}", path.display())))
    });
    let (settings, line) =
        parsed.unwrap_or_else(|why: String| (defaults(), format!("{why}; the defaults hold")));
    LoadedSettings { settings, log_line: Some(line) }
}

/// A word, and the number of its line, from 1.
#[derive(Clone, Copy, Debug)]
struct Word<'a> {
    line: usize,
    text: &'a str,
}

/// What is wrong, and in which line.
struct LineError {
    line: usize,
    why: String,
}

fn read_text(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    durable::open_regular_file(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    let expected = |what: String| io::Error::other(format!("{what}, expected flags as text"));
    if bytes.len() as u64 > MAX_BYTES {
        return Err(expected(format!("it is longer than {MAX_BYTES} bytes")));
    }
    // An editor's mark of the encoding is none of the words.
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes).to_vec();
    String::from_utf8(text).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        expected(format!("line {line} is no UTF-8"))
    })
}

fn split_words(text: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let said = line.split_once('#').map_or(line, |(said, _)| said);
        words.extend(said.split_whitespace().map(|text| Word { line: i + 1, text }));
    }
    words
}

fn parse_settings(base_folder: &Path, words: &[Word<'_>]) -> Result<HeadsetSettings, LineError> {
    for word in words {
        if let Some(control) = word.text.chars().find(|c| c.is_control()) {
            let why = format!("control character {}, expected text", control.escape_unicode());
            return Err(LineError { line: word.line, why });
        }
        let flag = word.text.split_once('=').map_or(word.text, |(flag, _)| flag);
        if let Some((_, why)) = REFUSED_FLAGS.iter().find(|(refused, _)| *refused == flag) {
            let why = format!("{flag} can't be set here: {why}");
            return Err(LineError { line: word.line, why });
        }
    }
    let args = parse_arguments(words).map_err(|error| LineError {
        line: find_faulty_line_number(words),
        why: summarize_error(&error),
    })?;
    let mut options = args.to_options();
    options.folder = Some(base_folder.into());
    if let Some(record) = &mut options.record {
        *record = base_folder.join(&*record);
        check_record(base_folder, record).map_err(|why| {
            let flag = words.iter().find(|word| word.text.starts_with("--record"));
            LineError { line: flag.map_or(0, |word| word.line), why }
        })?;
    }
    Ok(HeadsetSettings { size: args.grid_size(), options })
}

/// Whether a trace can be written to a path: now, not after the sculpting. The file of options isn't overwritten.
fn check_record(base_folder: &Path, record: &Path) -> Result<(), String> {
    WriteTarget::resolve_and_check_writable(record).map_err(|error| error.to_string())?;
    let is_options_file = |path: io::Result<PathBuf>| {
        path.is_ok_and(|path| {
            base_folder.join(FILE_NAME).canonicalize().is_ok_and(|own| own == path)
        })
    };
    match is_options_file(record.canonicalize()) {
        true => Err(format!("{}: it is this file, expected another", record.display())),
        false => Ok(()),
    }
}

/// The command line whose words these are. It never tells its help or version, which are no reason why a file
/// is wrong: `-hd` is an unknown flag.
fn file_command() -> clap::Command {
    HeadsetArgs::command().disable_help_flag(true).disable_version_flag(true)
}

/// Parses the words as a command line.
fn parse_arguments(words: &[Word<'_>]) -> Result<HeadsetArgs, clap::Error> {
    let words = ["paros-quest"].into_iter().chain(words.iter().map(|word| word.text));
    HeadsetArgs::from_arg_matches(&file_command().try_get_matches_from(words)?)
}

/// The line at fault: the first after which no further line makes the command line valid again, as one
/// does that holds the value of a flag before it.
fn find_faulty_line_number(words: &[Word<'_>]) -> usize {
    let mut line = 0;
    for end in (1..=words.len()).rev() {
        let is_line = words.get(end).is_none_or(|next| next.line > words[end - 1].line);
        if is_line && parse_arguments(&words[..end]).is_ok() {
            break;
        }
        line = words[end - 1].line;
    }
    line
}

/// A parser's error as one line, without what is meant for a terminal.
fn summarize_error(error: &clap::Error) -> String {
    let text = error.to_string();
    let mut paragraph = String::new();
    for line in text.lines().map(str::trim).take_while(|line| !line.is_empty()) {
        let space = if paragraph.is_empty() { "" } else { " " };
        // A String takes everything.
        let _ = write!(paragraph, "{space}{}", line.trim_start_matches("error: "));
    }
    if error.kind() == ErrorKind::UnknownArgument {
        let _ = write!(paragraph, ", expected one of {}", allowed_flags().join(", "));
    }
    paragraph
}

/// The flags that the file may hold.
fn allowed_flags() -> Vec<String> {
    let command = file_command();
    let all = command.get_arguments().filter_map(|flag| Some(format!("--{}", flag.get_long()?)));
    all.filter(|flag| REFUSED_FLAGS.iter().all(|(refused, _)| refused != flag)).collect()
}

fn format_error(path: &Path, wrong: &LineError) -> String {
    format!("{}:{}: {}", path.display(), wrong.line, wrong.why)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    use paros_core::session::SessionMode;

    use super::{FILE_NAME, HeadsetSettings, LoadedSettings, MAX_BYTES, read_settings};
    use crate::foveation::FoveationLevel;
    use crate::options::ShellOptions;

    /// An empty folder of a test's own.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("paros-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    fn defaults(folder: &Path) -> HeadsetSettings {
        let options = ShellOptions { folder: Some(folder.into()), ..ShellOptions::default() };
        HeadsetSettings { size: 128, options }
    }

    #[test]
    fn no_file_is_the_defaults_and_no_line() {
        let folder = folder("no-options");
        let expected = LoadedSettings { settings: defaults(&folder), log_line: None };
        assert_eq!(read_settings(&folder), expected);
        assert_eq!(read_settings(&folder.join("none")).log_line, None);
        fs::remove_dir_all(folder).expect("it is ours");
    }

    #[test]
    fn its_words_are_the_command_lines() {
        let folder = folder("good-options");
        let path = folder.join(FILE_NAME);
        for empty in ["", "\n", "# nothing\n   # --rate 90", "\u{feff}\r\n"] {
            fs::write(&path, empty).expect("room on the disk");
            let log_line = Some(format!("{}: no flags", path.display()));
            let expected = LoadedSettings { settings: defaults(&folder), log_line };
            assert_eq!(read_settings(&folder), expected, "{empty:?}");
        }
        let text = "\u{feff}# for the fair\r\n--rate 90 --depth#!\r\n\t--foveation\r\n# half\r\n\
            medium\r\n--handover=120 --mode creative --size 256 --record own.trace";
        fs::write(&path, text).expect("room on the disk");
        let LoadedSettings { settings: found, log_line: line } = read_settings(&folder);
        let options = ShellOptions {
            refresh_rate: 90.0,
            submit_depth: true,
            foveation: Some(FoveationLevel::Medium),
            handover_after: Duration::from_secs(120),
            mode: SessionMode::Creative,
            record: Some(folder.join("own.trace")),
            ..defaults(&folder).options
        };
        assert_eq!(found, HeadsetSettings { size: 256, options });
        let words = "--rate 90 --depth --foveation medium --handover=120 --mode creative \
            --size 256 --record own.trace";
        assert_eq!(line, Some(format!("{}: {words}", path.display())));
        fs::remove_dir_all(folder).expect("it is ours");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line_and_the_defaults_hold() {
        let folder = folder("bad-options");
        let path = folder.join(FILE_NAME);
        for (text, line, why) in [
            ("--rate abc", 1, "'abc' for '--rate <HERTZ>': expected a number of hertz"),
            ("--rate 90\n\n# no\n--mode cubes\n--depth", 4, "expected free, creative or one of"),
            ("--rate\n# in two lines\nabc\n--depth\n", 1, "expected a number of hertz"),
            ("--depth\n--rate", 2, "a value is required for '--rate <HERTZ>'"),
            ("--depth\n--rate 60\n--depth\n", 3, "cannot be used multiple times"),
            (
                "--depth\nplease",
                2,
                "'please' found, expected one of --size, --mode, --handover, --record, --steady, \
                --rate, --depth, --foveation; ",
            ),
            (
                "--depth\n--replay a --digests b",
                2,
                "--replay can't be set here: a headset plays no",
            ),
            (
                "--size=512",
                1,
                "invalid value '512' for '--size <SIZE>' [possible values: 128, 256]",
            ),
            ("--script", 1, "--script can't be set here: a headset has no standard input"),
            ("\n--help", 2, "--help can't be set here"),
            ("--depth\n-hd", 2, "unexpected argument '-h' found, expected one of --size"),
            ("-Va", 1, "unexpected argument '-V' found"),
            ("--depth\n--record none/own.trace", 2, "none/own.trace: cannot "),
            ("--depth\n--record paros.options", 2, "it is this file, expected another"),
            ("--record=./paros.options", 1, "it is this file, expected another"),
            ("--depth\n\x1b[2Jplease", 2, "control character \\u{1b}, expected text"),
        ] {
            fs::write(&path, text).expect("room on the disk");
            let LoadedSettings { settings: found, log_line: told } = read_settings(&folder);
            let told = told.expect("there is a file");
            assert_eq!(found, defaults(&folder), "{text}");
            assert!(told.starts_with(&format!("{}:{line}: ", path.display())), "{text:?}: {told}");
            assert!(told.contains(why) && told.ends_with("; the defaults hold"), "{told}");
            assert_eq!(told.lines().count(), 1, "{told}");
        }
        fs::remove_dir_all(folder).expect("it is ours");
    }

    #[test]
    fn what_is_no_text_of_that_length_is_told() {
        let folder = folder("no-text");
        let path = folder.join(FILE_NAME);
        let told = |why: &str| {
            let LoadedSettings { settings: found, log_line: told } = read_settings(&folder);
            let told = told.expect("there is something");
            assert_eq!(found, defaults(&folder));
            let ends = told.starts_with(&format!("{}: ", path.display()))
                && told.ends_with("; the defaults hold");
            assert!(ends && told.contains(why), "{why}: {told}");
        };
        fs::write(&path, b"--depth\n\xff").expect("room on the disk");
        told("line 2 is no UTF-8, expected flags as text");
        // Of a terabyte no more is read than is needed.
        let huge = fs::File::create(&path).expect("room on the disk");
        huge.set_len(1 << 40).expect("a hole");
        told("it is longer than 4096 bytes, expected flags as text");
        let longest = format!("{:1$}", "--depth", MAX_BYTES as usize);
        fs::write(&path, &longest).expect("room on the disk");
        assert!(read_settings(&folder).settings.options.submit_depth);
        fs::write(&path, longest + " ").expect("room on the disk");
        told("it is longer than 4096 bytes");
        fs::remove_file(&path).expect("it is ours");
        fs::create_dir(&path).expect("a folder");
        told("it is not a regular file");
        fs::remove_dir_all(folder).expect("it is ours");
    }
}
