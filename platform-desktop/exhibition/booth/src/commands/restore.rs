//! Restores a booth from a backup. The folder gets its final name only when it is complete.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, BufReader, Read as _, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

use paros_booth_rules::{BoothPlan, BoothTime, Deletion, RestoreReport};
use zip::ZipArchive;
use zip::read::{ZipFile, read_zipfile_from_stream};
use zip::result::ZipError;

use crate::clock::booth_time;
use crate::commands::backup::{ABOUT, ABOUT_HEAD, ABOUT_START, DATABASE, KEYS};
use crate::commands::shared::SharedOptions;
use crate::error::Error;
use crate::server::app::OpenBooth;
use crate::store::deletion_log::{DELETIONS, read_deletions};
use crate::store::disk_files::parse_kept_name;
use crate::store::own_file::OwnPart;

/// Restores a backup into a new folder. Also deletes what the log `deletions` names. Returns a report.
/// `is_again` allows a second restore of the same backup on the same day.
///
/// # Errors
/// The folder isn't empty, a file isn't a valid backup or log, or the backup was restored today already; an
/// I/O or database error. Then the folder isn't made.
pub(crate) fn restore(
    archive: &Path,
    folder: &Path,
    deletions: Option<&Path>,
    is_again: bool,
) -> Result<String, Error> {
    // Read the log first: a wrong name is reported before the disk is filled.
    let since = deletions.map(read_deletions).transpose()?.unwrap_or_default();
    let new = NewBooth::begin(folder)?;
    let copied_at = unpack(archive, new.path())?;
    let use_of_today = UseOfBackup { copied_at, day: booth_time().day() };
    use_of_today.check_first(archive, is_again)?;
    let mut deletions = read_log(new.path())?;
    deletions.extend(since);
    let open =
        OpenBooth::open(new.path(), &SharedOptions::default(), BoothPlan::default(), u64::MAX)?;
    let report = open.booth.make_restored(&deletions, copied_at, booth_time());
    let report = report.map_err(|refusal| bad(archive, &refusal))?;
    drop(open);
    // Note the use before the new booth can hand out badges.
    use_of_today.note(archive)?;
    new.finish()?;
    Ok(tell(folder, &report))
}

/// A booth's folder under a temporary name. It is removed on drop unless it was finished.
pub(crate) struct NewBooth<'a> {
    part: OwnPart,
    folder: &'a Path,
}

impl<'a> NewBooth<'a> {
    /// Makes the temporary folder.
    ///
    /// # Errors
    /// [`Error::Input`] if `folder` exists and isn't empty; an I/O error.
    pub(crate) fn begin(folder: &'a Path) -> Result<Self, Error> {
        let is_free = fs::read_dir(folder).map_or_else(
            |error| error.kind() == io::ErrorKind::NotFound,
            |mut entries| entries.next().is_none(),
        );
        if !is_free {
            let why = "expected a folder that isn't there yet, or is empty";
            return Err(Error::Input(format!("{}: {why}", folder.display())));
        }
        let part = OwnPart::new_folder(folder).map_err(|error| Error::at(folder, error))?;
        Ok(NewBooth { part, folder })
    }

    /// Returns the temporary path.
    pub(crate) fn path(&self) -> &Path {
        &self.part.path
    }

    /// Syncs the folder, and renames it to its final name.
    ///
    /// # Errors
    /// An I/O error. Then the folder isn't made.
    pub(crate) fn finish(self) -> Result<(), Error> {
        let NewBooth { part, folder } = self;
        let fail = |error: io::Error| Error::at(folder, error);
        for inner in ["keys", "sculptures", ""] {
            File::open(part.path.join(inner)).and_then(|folder| folder.sync_all()).map_err(fail)?;
        }
        part.rename(folder).map_err(fail)
    }
}

/// Reads the log of deletions in a booth's folder; it is empty if there is none.
///
/// # Errors
/// The log can't be read.
pub(crate) fn read_log(folder: &Path) -> Result<Vec<Deletion>, Error> {
    let log = folder.join(DELETIONS);
    if log.is_file() { read_deletions(&log) } else { Ok(Vec::new()) }
}

/// A record that a backup was restored on a day. Two booths restored from one backup on the same day would
/// start with the same badges.
#[derive(Clone, Copy, PartialEq, Eq)]
struct UseOfBackup {
    copied_at: BoothTime,
    day: u32,
}

impl UseOfBackup {
    /// Returns the path of the record's file, beside the archive. A record doesn't apply to a newer archive
    /// of the same name.
    fn path(archive: &Path) -> PathBuf {
        let mut name = archive.as_os_str().to_owned();
        name.push(".restored");
        name.into()
    }

    fn to_line(self) -> String {
        format!("copied_at = {}, restored on day {}\n", self.copied_at.0, self.day)
    }

    fn check_first(self, archive: &Path, is_again: bool) -> Result<(), Error> {
        let noted = fs::read_to_string(Self::path(archive)).unwrap_or_default();
        if noted == self.to_line() && !is_again {
            let why = "it was restored today already, and badges would repeat: restore another backup, or --again where \
                       the booth of before answered no headset";
            return Err(bad(archive, &why));
        }
        Ok(())
    }

    fn note(self, archive: &Path) -> Result<(), Error> {
        let path = Self::path(archive);
        let noted = OwnPart::new_file(&path).and_then(|(part, mut file)| {
            file.write_all(self.to_line().as_bytes())?;
            file.sync_all()?;
            part.rename(&path)
        });
        noted.map_err(|error| Error::at(&path, error))
    }
}

fn tell(folder: &Path, report: &RestoreReport) -> String {
    let RestoreReport { sculptures, deleted, tombstones, mails } = report;
    format!(
        "{}: {sculptures} sculptures, {deleted} of them deleted again; {tombstones} deletions more\n\
         {mails} mails that waited have to be asked for anew\n\
         Accounts, headsets and fleets' files that were shut out since the backup are let in again: look at both pages.\n\
         Restore no other copy of the same backup today, and no newer one later: badges would repeat.\n",
        folder.display()
    )
}

/// Unpacks an archive into an empty folder. Returns the time at which the backup was made.
///
/// # Errors
/// The archive isn't a valid backup, or an I/O error. Files unpacked so far stay in the folder.
pub(crate) fn unpack(archive: &Path, folder: &Path) -> Result<BoothTime, Error> {
    let fail = |error: ZipError| bad(archive, &tell_fault(archive, error));
    let file = File::open(archive).map_err(|error| bad(archive, &error))?;
    let mut zip = ZipArchive::new(BufReader::new(file)).map_err(fail)?;
    for inner in ["keys", "sculptures"] {
        let path = folder.join(inner);
        let made = DirBuilder::new().mode(0o700).create(&path);
        made.map_err(|error| Error::at(&path, error))?;
    }
    let mut copied_at = None;
    for k in 0..zip.len() {
        let mut entry = zip.by_index(k).map_err(fail)?;
        let name = entry.name().map_err(fail)?.into_owned();
        if name == ABOUT {
            copied_at = Some(read_about(&mut entry).map_err(|why| bad(archive, &why))?);
            continue;
        }
        if copied_at.is_none() {
            return Err(bad(archive, &format!("a ZIP archive of something else; {EXPECTED}")));
        }
        if !is_known(&name) {
            return Err(bad(archive, &format!("{name:?}: no file of a backup")));
        }
        unpack_entry(&mut entry, &folder.join(&name))
            .map_err(|error| bad(archive, &format!("{name}: {error}")))?;
    }
    for name in [DATABASE, KEYS[0], KEYS[1], KEYS[2]] {
        if !folder.join(name).is_file() {
            return Err(bad(archive, &format!("{name} is missing")));
        }
    }
    copied_at.ok_or_else(|| bad(archive, &format!("a ZIP archive of nothing; {EXPECTED}")))
}

/// The last part of errors about wrong files.
const EXPECTED: &str = "expected a backup of a booth, as `paros-booth backup` makes it";

/// Reads the time at which a backup was made. Returns a description of the file if this program can't read
/// it.
fn read_about(entry: &mut impl io::Read) -> Result<BoothTime, String> {
    let mut about = String::new();
    let read = entry.take(200).read_to_string(&mut about);
    let time = about.strip_prefix(ABOUT_HEAD).and_then(|time| time.strip_suffix('\n'));
    if let Some(time) = time.filter(|_| read.is_ok()).and_then(|time| time.parse().ok()) {
        return Ok(BoothTime(time));
    }
    let version = about.strip_prefix(ABOUT_START).and_then(|rest| rest.lines().next());
    match version.and_then(|version| version.parse::<u32>().ok()) {
        Some(version) if version > 1 => Err(format!(
            "a backup of version {version}, of a newer program; this one reads version 1"
        )),
        _ => Err(format!("its {ABOUT} is damaged; {EXPECTED}")),
    }
}

/// Describes a file that isn't a complete archive, as far as its first bytes allow.
fn tell_fault(archive: &Path, error: ZipError) -> String {
    let error = match error {
        ZipError::Io(error) => return error.to_string(),
        error => error,
    };
    let mut file = match File::open(archive) {
        Ok(file) => BufReader::new(file),
        Err(error) => return error.to_string(),
    };
    match read_zipfile_from_stream(&mut file) {
        Ok(Some(mut first)) if first.name().is_ok_and(|name| name == ABOUT) => {
            match read_about(&mut first) {
                Ok(_) => "a backup that is cut short or damaged; take another one".to_owned(),
                Err(why) => why,
            }
        }
        Ok(Some(_)) => format!("a ZIP archive of something else, or a damaged one; {EXPECTED}"),
        _ => format!("no ZIP archive ({error}); {EXPECTED}"),
    }
}

/// Returns `true` if a backup may contain a file of this name. Other files are never unpacked.
fn is_known(name: &str) -> bool {
    if let Some(kept) = name.strip_prefix("sculptures/") {
        return parse_kept_name(kept).is_some();
    }
    name == DATABASE || name == DELETIONS || KEYS.contains(&name)
}

fn unpack_entry(entry: &mut ZipFile<'_, BufReader<File>>, path: &Path) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(path)?;
    // The ZIP reader verifies the checksum at the end.
    io::copy(entry, &mut file)?;
    file.sync_all()
}

fn bad(path: &Path, why: &dyn std::fmt::Display) -> Error {
    Error::Input(format!("{}: {why}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::is_known;

    #[test]
    fn only_names_of_a_backup_are_known() {
        let (id, hash) = ("ab".repeat(16), "cd".repeat(32));
        assert!(is_known(&format!("sculptures/{id}-{hash}.png")) && is_known("keys/ca.pem"));
        for name in [
            "../booth.sqlite",
            "/etc/passwd",
            "keys/../x",
            "keys/leaf.key",
            "sculptures/",
            &format!("sculptures/{id}-{hash}.exe"),
            &format!("sculptures/../{id}-{hash}.png"),
            &format!("sculptures/{id}-{hash}.png/x"),
        ] {
            assert!(!is_known(name), "{name}");
        }
    }
}
