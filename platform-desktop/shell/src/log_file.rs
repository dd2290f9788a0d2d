//! Log rotation with two files of bounded size. A full log replaces the former log, and a new one begins; so
//! the newest lines are always kept.

use std::fmt::{self, Write as _};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// The most bytes of a log: some thousand lines. A day of visitors leaves a few hundred.
const MAX_BYTES: u64 = 256 * 1024;

/// The most bytes of a line. A longer line is cut, so that one line never fills a log.
const MAX_LINE_BYTES: usize = 8 * 1024;

/// The log that is being written.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    file: File,
    bytes: u64,
    /// The buffer of the line that is being written, reused so that logging allocates nothing.
    line: String,
}

impl LogFile {
    /// Opens a log for appending. Creates its folder.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn open(path: &Path) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        let bytes = file.metadata()?.len();
        let line = String::with_capacity(MAX_LINE_BYTES);
        Ok(LogFile { path: path.to_owned(), file, bytes, line })
    }

    /// Appends a line that begins with the time. When this returns, the system has the line, and it outlives
    /// the process.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn append_line(&mut self, now: SystemTime, text: fmt::Arguments<'_>) -> io::Result<()> {
        self.line.clear();
        let mut line = LineWriter(&mut self.line);
        // A line that is too long is cut.
        let _ = write_utc(&mut line, now).and_then(|()| line.write_fmt(format_args!(" {text}")));
        self.line.push('\n');
        let length = self.line.len() as u64;
        if self.bytes > 0 && self.bytes + length > MAX_BYTES {
            self.begin_anew()?;
        }
        self.bytes += length;
        self.file.write_all(self.line.as_bytes())
    }

    /// Returns the path of the former log.
    #[must_use]
    pub fn former_path(path: &Path) -> PathBuf {
        path.with_extension("1.log")
    }

    fn begin_anew(&mut self) -> io::Result<()> {
        // A log that can't be renamed is lost: if it kept growing, it would fill the storage.
        let _ = fs::rename(&self.path, Self::former_path(&self.path));
        self.file = File::create(&self.path)?;
        self.bytes = 0;
        Ok(())
    }
}

/// Writes a text as one entry of a log: further lines are indented, and text beyond [`MAX_LINE_BYTES`] is
/// cut.
struct LineWriter<'a>(&'a mut String);

impl fmt::Write for LineWriter<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        const INDENT: &str = "    ";

        for letter in text.chars() {
            // Leaves room for the line's end too.
            if self.0.len() + letter.len_utf8() + INDENT.len() >= MAX_LINE_BYTES {
                return Err(fmt::Error);
            }
            self.0.push(letter);
            if letter == '\n' {
                self.0.push_str(INDENT);
            }
        }
        Ok(())
    }
}

/// Writes a UTC time of the Gregorian calendar, to seconds: `2026-11-25T21:41:59Z`.
fn write_utc(to: &mut impl fmt::Write, time: SystemTime) -> fmt::Result {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Howard Hinnant's civil_from_days: years begin in March, and 400 of them have 146,097 days.
    let from_march = days + 719_468;
    let (era, day) = (from_march / 146_097, from_march % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    write!(to, "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::{Duration, SystemTime, UNIX_EPOCH};

    use super::{LogFile, MAX_BYTES, MAX_LINE_BYTES, write_utc};

    fn at(seconds: u64) -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(seconds)
    }

    #[test]
    fn times_are_the_calendars() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_799, "2000-02-29T23:59:59Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (1_735_689_600, "2025-01-01T00:00:00Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            let mut text = String::new();
            write_utc(&mut text, at(seconds)).expect("room");
            assert_eq!(text, expected);
        }
    }

    #[test]
    fn a_log_goes_on_and_keeps_the_newest_lines_in_bounded_files() {
        let folder = std::env::temp_dir().join(format!("paros-log-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let path = folder.join("inner/paros.log");
        let former = LogFile::former_path(&path);
        assert_eq!(former.file_name().and_then(|name| name.to_str()), Some("paros.1.log"));
        LogFile::open(&path).expect("a log").append_line(at(0), format_args!("one")).expect("room");
        let mut log = LogFile::open(&path).expect("a log");
        log.append_line(at(1), format_args!("two\nlines")).expect("room");
        // The log isn't closed before it is read.
        let text = fs::read_to_string(&path).expect("a log");
        assert_eq!(text, "1970-01-01T00:00:00Z one\n1970-01-01T00:00:01Z two\n    lines\n");

        let lines = 3 * MAX_BYTES / 100;
        for i in 0..lines {
            let text = "x".repeat(80);
            log.append_line(at(2), format_args!("line {i} {text}")).expect("room");
            let sizes = [&path, &former].map(|path| fs::metadata(path).map_or(0, |at| at.len()));
            assert!(sizes.iter().all(|size| *size <= MAX_BYTES), "{sizes:?}");
        }
        let [text, before] = [&path, &former].map(|path| fs::read_to_string(path).expect("a log"));
        assert!(text.lines().last().expect("a line").contains(&format!("line {} ", lines - 1)));
        let first = text.lines().next().and_then(|line| line.split(' ').nth(2)?.parse().ok());
        let next: u64 = first.expect("a numbered line");
        let last = before.lines().last().expect("a line");
        assert!(last.contains(&format!("line {} ", next - 1)), "{last}");
        assert_eq!(fs::read_dir(path.parent().expect("a folder")).expect("it").count(), 2);

        // A line longer than a log, of letters of several bytes.
        let text = "\u{00e4}".repeat(MAX_BYTES as usize);
        let room = log.line.capacity();
        log.append_line(at(3), format_args!("{text}")).expect("room");
        assert_eq!(log.line.capacity(), room, "a line takes no memory");
        let text = fs::read_to_string(&path).expect("text");
        let last = text.lines().last().expect("a line").len();
        assert!(last < MAX_LINE_BYTES && last > MAX_LINE_BYTES - 10, "{last}");
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
