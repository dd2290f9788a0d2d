//! The log of deletions: a text file beside the database, synced at each entry. A copy that is newer than a
//! backup lets a restore delete again what was deleted since the backup.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use paros_booth_rules::{BoothTime, Deletion};
use paros_shell::durable;

use crate::error::Error;
use crate::store::own_file::OwnPart;

/// The file's name in a booth's folder.
pub(crate) const DELETIONS: &str = "deletions";

/// A booth's log of deletions.
#[derive(Debug)]
pub(crate) struct DeletionLog {
    path: PathBuf,
    /// Serialises changes of the file.
    turn: Mutex<()>,
}

impl DeletionLog {
    /// Opens the log of a folder, and makes it if there is none. Removes an incomplete last line, which a
    /// power cut left: its deletion is logged again.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        let path = folder.join(DELETIONS);
        let mut options = OpenOptions::new();
        let opened = options.read(true).write(true).create(true).truncate(false).mode(0o600);
        let mut file = opened.open(&path)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        if whole < bytes.len() {
            file.set_len(whole as u64)?;
        }
        file.sync_all()?;
        File::open(folder)?.sync_all()?;
        Ok(DeletionLog { path, turn: Mutex::new(()) })
    }

    /// Appends lines.
    ///
    /// # Errors
    /// An I/O error. Then the lines are removed again, if the disk allows.
    pub(crate) fn append(&self, deletions: &[Deletion]) -> io::Result<()> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let lines: String = deletions.iter().map(Deletion::to_line).collect();
        let mut file = OpenOptions::new().append(true).open(&self.path)?;
        let before = file.metadata()?.len();
        let added = file.write_all(lines.as_bytes()).and_then(|()| file.sync_data());
        if added.is_err() {
            let _ = file.set_len(before);
        }
        added
    }

    /// Drops the lines from before a time. Does nothing unless the first line is such. The other lines
    /// survive a power cut.
    ///
    /// # Errors
    /// An I/O error. Then the log isn't changed.
    pub(crate) fn forget_before(&self, time: BoothTime) -> io::Result<()> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let is_old = |line: &str| {
            Deletion::parse_line(line).is_some_and(|deletion| deletion.deleted_at < time)
        };
        let mut first = String::new();
        BufReader::new(File::open(&self.path)?).read_line(&mut first)?;
        if !is_old(first.trim_end_matches('\n')) {
            return Ok(());
        }
        let text = fs::read_to_string(&self.path)?;
        let (part, mut file) = OwnPart::new_file(&self.path)?;
        for line in text.lines().filter(|line| !is_old(line)) {
            file.write_all(format!("{line}\n").as_bytes())?;
        }
        file.sync_all()?;
        part.rename(&self.path)
    }
}

/// Reads a log. Ignores an incomplete last line, which a power cut left.
///
/// # Errors
/// An I/O error, or the first line that isn't valid.
pub(crate) fn read_deletions(path: &Path) -> Result<Vec<Deletion>, Error> {
    let bad = |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", path.display()));
    let bytes = durable::read_regular_file(path).map_err(|error| bad(&error))?;
    parse_deletions(bytes).map_err(|why| bad(&why))
}

/// Parses the bytes of a log.
///
/// # Errors
/// The first line that isn't valid.
pub(crate) fn parse_deletions(bytes: Vec<u8>) -> Result<Vec<Deletion>, String> {
    let text = String::from_utf8(bytes).map_err(|_| "expected lines of a log of deletions")?;
    let whole = text.rfind('\n').map_or("", |last| &text[..last]);
    let lines = whole.split_terminator('\n').enumerate();
    let read = |(k, line)| {
        let expected = "expected a deletion: id, headset, hash, badge, time";
        Deletion::parse_line(line).ok_or_else(|| format!("line {}: {expected}", k + 1))
    };
    lines.map(read).collect()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use paros_protocol::{ContentHash, SculptureId};

    use super::*;

    fn deletion(number: u8) -> Deletion {
        let (id, hash) = (SculptureId([number; 16]), ContentHash([7; 32]));
        Deletion { id, headset: 1, hash, badge: Some(5), deleted_at: BoothTime(9) }
    }

    /// Cuts the second line at every byte: the first line stays, and the next entry is complete.
    #[test]
    fn a_line_that_was_cut_is_passed_over_and_nothing_is_joined_to_it() {
        let folder = std::env::temp_dir().join(format!("paros-deletions-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("room on the disk");
        let path = folder.join(DELETIONS);
        let lines = [deletion(1), deletion(2)].map(|deletion| deletion.to_line()).concat();
        let first = deletion(1).to_line().len();
        for cut in first..lines.len() {
            fs::write(&path, &lines[..cut]).unwrap();
            assert_eq!(read_deletions(&path).unwrap(), [deletion(1)], "cut at {cut}");
            let log = DeletionLog::open(&folder).unwrap();
            log.append(&[deletion(3), deletion(4)]).unwrap();
            let expected = [deletion(1), deletion(3), deletion(4)];
            assert_eq!(read_deletions(&path).unwrap(), expected, "cut at {cut}");
        }
        let log = DeletionLog::open(&folder).unwrap();
        let old = Deletion { deleted_at: BoothTime(8), ..deletion(5) };
        fs::write(&path, [old.to_line(), deletion(6).to_line()].concat()).unwrap();
        for (time, expected) in [(8, vec![old, deletion(6)]), (9, vec![deletion(6)]), (10, vec![])]
        {
            log.forget_before(BoothTime(time)).unwrap();
            assert_eq!(read_deletions(&path).unwrap(), expected, "{time}");
        }
        log.append(&[deletion(7)]).unwrap();
        assert_eq!(read_deletions(&path).unwrap(), [deletion(7)]);
        fs::remove_file(&path).unwrap();
        DeletionLog::open(&folder).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        assert_eq!(read_deletions(&path).unwrap(), []);
        fs::write(&path, "one line\n").unwrap();
        let told = read_deletions(&path).expect_err("none of a log").to_string();
        assert!(told.contains("line 1: expected a deletion"), "{told}");
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
