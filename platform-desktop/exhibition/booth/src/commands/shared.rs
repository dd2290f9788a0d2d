//! The services that several booths of one exhibition share: a PostgreSQL database, an S3-compatible store, and the site's
//! keys, which are copied into each booth's folder.

use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use clap::Args;
use paros_booth_rules::SiteKeys;

use crate::error::Error;
use crate::server::keys::BoothKeys;
use crate::store::disk_files::DiskFiles;
use crate::store::files::Files;
use crate::store::folder_lock::FolderLock;
use crate::store::postgres_link::PostgresAddress;
use crate::store::postgres_schema::SiteRow;
use crate::store::postgres_store::PostgresStore;
use crate::store::s3_files::S3Files;

/// Data that several booths share. Without these options, one booth keeps everything in its folder.
#[derive(Clone, Default, Debug, Args)]
pub struct SharedOptions {
    /// PostgreSQL database that several booths share, instead of a database in the folder.
    ///
    /// The booths must also share --files, and each needs a copy of the first booth's FOLDER/keys.
    #[arg(long, value_name = "postgres://USER@HOST/NAME", requires = "files")]
    pub database: Option<DatabaseUrl>,
    /// File with the database's password in its first line.
    #[arg(long, value_name = "FILE", requires = "database")]
    pub database_password_file: Option<PathBuf>,
    /// PEM file with the certificate authorities that verify the database, instead of the system's.
    #[arg(long, value_name = "FILE", requires = "database")]
    pub database_ca: Option<PathBuf>,
    /// S3-compatible store for sculptures, instead of the folder.
    ///
    /// The store's address and keys are read from the environment: AWS_ENDPOINT_URL, AWS_REGION,
    /// AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY.
    #[arg(long, value_name = "s3://BUCKET/PREFIX")]
    pub files: Option<String>,
}

/// A database address. It may contain a password, and is never shown.
#[derive(Clone)]
pub struct DatabaseUrl(String);

impl SharedOptions {
    /// Returns `true` if no other booth shares the database.
    #[must_use]
    pub(crate) const fn is_alone(&self) -> bool {
        self.database.is_none()
    }

    /// Opens a booth's files, in `folder` or in the shared store.
    ///
    /// # Errors
    /// The error of the disk or the store.
    pub(crate) fn open_files(&self, folder: &Path, quota: u64) -> Result<Arc<dyn Files>, Error> {
        Ok(match &self.files {
            None => {
                Arc::new(DiskFiles::open(folder, quota).map_err(|error| Error::at(folder, error))?)
            }
            Some(address) => {
                let settings = std::env::vars_os();
                let settings = settings.filter_map(|(name, value)| {
                    Some((name.into_string().ok()?, value.into_string().ok()?))
                });
                Arc::new(S3Files::open(address, settings, quota)?)
            }
        })
    }

    /// Opens the shared database, if the options name one, and loads the site's keys. The first booth of a
    /// new site generates them.
    ///
    /// # Errors
    /// The error of the database or the disk; the database belongs to another site.
    pub(crate) fn open_database(
        &self,
        folder: &Path,
    ) -> Result<Option<(PostgresStore, BoothKeys)>, Error> {
        let Some(DatabaseUrl(url)) = &self.database else { return Ok(None) };
        let (password, ca) = (self.database_password_file.as_deref(), self.database_ca.as_deref());
        let failure = |error| Error::failure("--database", error);
        let store =
            PostgresStore::open(PostgresAddress::new(url, password, ca)?).map_err(failure)?;
        // If several processes start in one folder, the first generates the keys and the others load them.
        let _one_at_a_time = FolderLock::take_in_turn(folder)?;
        let keys = BoothKeys::load_or_draw(folder, store.site().map_err(failure)?.is_none())?;
        let files = self.files.as_deref().unwrap_or_default();
        let own = site_row(&keys.site, files);
        let found = store.claim_site(&own).map_err(failure)?;
        if found != own {
            let what = match found.files == own.files || found.site != own.site {
                true => {
                    let keys = folder.join("keys");
                    format!(
                        "of another site than {}: copy the keys of its first booth",
                        keys.display()
                    )
                }
                false => format!("of a site whose files are in {}, not in {files}", found.files),
            };
            return Err(Error::Input(format!("--database: it is {what}")));
        }
        Ok(Some((store, keys)))
    }
}

fn site_row(keys: &SiteKeys, files: &str) -> SiteRow {
    SiteRow {
        site: keys.site.0.to_vec(),
        ca_hash: keys.ca_hash.0.to_vec(),
        files: files.trim_end_matches('/').to_owned(),
    }
}

impl FromStr for DatabaseUrl {
    type Err = Infallible;

    /// Accepts any text. It is checked later, as clap's error would show the text, which may contain a
    /// password.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(DatabaseUrl(text.to_owned()))
    }
}

impl fmt::Debug for DatabaseUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an address")
    }
}

#[cfg(test)]
mod tests {
    use super::DatabaseUrl;

    #[test]
    fn an_address_is_never_shown() {
        let Ok(url) = "postgres://ana:hunter2@host/booth".parse::<DatabaseUrl>();
        assert_eq!(format!("{url:?}"), "an address");
    }
}
