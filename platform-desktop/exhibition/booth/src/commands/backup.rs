//! Backups: a copy of all that a booth keeps, in one file with mode 0600, made while the booth serves.
//!
//! The file is a ZIP archive. In this order, it contains a header with version and time; a consistent
//! snapshot of the database, without mail addresses; the site's keys; the files of the sculptures in the
//! snapshot; and the log of deletions. The log comes last, so that it includes sculptures whose files were
//! deleted during the backup.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use paros_booth_rules::KeptPart;
use paros_protocol::{ContentHash, SculptureId};
use rusqlite::{Connection, OpenFlags};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::clock::booth_time;
use crate::error::Error;
use crate::store::deletion_log::DELETIONS;
use crate::store::disk_files::ending_of;
use crate::store::own_file::OwnPart;

/// The start of the header file: up to its version, and up to the time of the copy in milliseconds.
pub(crate) const ABOUT_START: &str = "backup of a Paros booth, version ";
pub(crate) const ABOUT_HEAD: &str = "backup of a Paros booth, version 1\ncopied_at = ";

/// Names of files in the archive.
pub(crate) const ABOUT: &str = "backup.txt";
pub(crate) const DATABASE: &str = "booth.sqlite";
pub(crate) const KEYS: [&str; 3] = ["keys/ca.key", "keys/ca.pem", "keys/site.key"];

/// Writes a backup of a booth's folder to the file `to`. Returns a report.
///
/// # Errors
/// There is no booth in the folder; an I/O or database error. Then no new file is written, and an existing
/// backup is kept.
pub(crate) fn back_up(folder: &Path, to: &Path) -> Result<String, Error> {
    let database = folder.join(DATABASE);
    if !database.is_file() {
        return Err(Error::Input(format!("{}: there is no booth", folder.display())));
    }
    let fail = |error: io::Error| Error::at(to, error);
    let copied_at = booth_time();
    let (copy, _) = OwnPart::new_file(to).map_err(fail)?;
    let kept = copy_database(&database, &copy.path)?;
    let (part, file) = OwnPart::new_file(to).map_err(fail)?;
    let mut archive = Archive { zip: ZipWriter::new(BufWriter::new(file)) };
    let about = format!("{ABOUT_HEAD}{}\n", copied_at.0);
    archive.add(ABOUT, &mut about.as_bytes()).map_err(fail)?;
    archive.add_file(DATABASE, &copy.path)?;
    for key in KEYS {
        archive.add_file(key, &folder.join(key))?;
    }
    for name in &kept {
        for part in KeptPart::ALL {
            let name = format!("sculptures/{name}.{}", ending_of(part));
            // Traces and pictures are optional. Files deleted meanwhile are in the log of deletions.
            archive.add_file_if_there(&name, &folder.join(&name))?;
        }
    }
    let log = folder.join(DELETIONS);
    if log.is_file() {
        archive.add_file(DELETIONS, &log)?;
    }
    archive.finish().map_err(fail)?;
    part.rename(to).map_err(fail)?;
    let count = kept.len();
    Ok(format!("{}: {count} sculptures\n", to.display()))
}

/// Copies a consistent snapshot of the database, removes mail addresses from the copy, and lists the names of
/// the sculptures' files.
fn copy_database(from: &Path, to: &Path) -> Result<Vec<String>, Error> {
    let fail = |error: rusqlite::Error| Error::at(from, error);
    let existing = OpenFlags::SQLITE_OPEN_READ_WRITE;
    let source = Connection::open_with_flags(from, existing).map_err(fail)?;
    // Copies into an existing empty file, to keep its mode 0600.
    source.execute("VACUUM INTO ?", [to.to_string_lossy()]).map_err(fail)?;
    let copy = Connection::open(to).map_err(fail)?;
    // Overwrites the deleted addresses, so that they don't stay in free pages.
    copy.pragma_update(None, "secure_delete", "ON").map_err(fail)?;
    copy.pragma_update(None, "journal_mode", "OFF").map_err(fail)?;
    copy.execute("UPDATE mail_orders SET address = NULL", []).map_err(fail)?;
    let mut listed = copy.prepare("SELECT id, hash FROM sculptures").map_err(fail)?;
    let names = listed.query_map([], |row| {
        let (id, hash): ([u8; 16], [u8; 32]) = (row.get(0)?, row.get(1)?);
        Ok(format!("{}-{}", SculptureId(id), ContentHash(hash)))
    });
    names.and_then(Iterator::collect).map_err(fail)
}

struct Archive {
    zip: ZipWriter<BufWriter<File>>,
}

impl Archive {
    fn add(&mut self, name: &str, from: &mut impl io::Read) -> io::Result<()> {
        // Sculptures' files are compressed already.
        let is_packed = name.starts_with("sculptures/");
        let method =
            if is_packed { CompressionMethod::Stored } else { CompressionMethod::Deflated };
        let options = SimpleFileOptions::default().compression_method(method);
        self.zip.start_file(name, options.large_file(true).unix_permissions(0o600))?;
        io::copy(from, &mut self.zip).map(drop)
    }

    fn add_file(&mut self, name: &str, path: &Path) -> Result<(), Error> {
        let added = File::open(path).and_then(|mut file| self.add(name, &mut file));
        added.map_err(|error| Error::at(path, error))
    }

    /// Adds a file if it exists.
    fn add_file_if_there(&mut self, name: &str, path: &Path) -> Result<(), Error> {
        match File::open(path) {
            Ok(mut file) => self.add(name, &mut file).map_err(|error| Error::at(path, error)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(error) => Err(Error::at(path, error)),
        }
    }

    fn finish(self) -> io::Result<()> {
        let mut file = self.zip.finish()?;
        file.flush()?;
        file.get_ref().sync_all()
    }
}
