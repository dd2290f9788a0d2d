//! Sculptures' files in a bucket of an S3-compatible store, which several booths may share. Each file is an
//! object.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use futures_util::{StreamExt as _, TryStreamExt as _};
use object_store::aws::{AmazonS3, AmazonS3Builder, AmazonS3ConfigKey};
use object_store::path::Path;
use object_store::{
    ClientConfigKey, ObjectMeta, ObjectStore as _, ObjectStoreExt as _, PutPayload, RetryConfig,
};
use paros_booth_rules::{BoothTime, Deletion, KeptName, ParcelFiles};
use tokio::runtime::{Builder, Runtime};
use tokio_rustls::rustls::crypto::ring::default_provider;

use crate::error::Error;
use crate::store::disk_files::kept_file_name;
use crate::store::files::Files;

/// The time during which a failed request is retried. It is short, as the request holds a place that others
/// wait for.
const RETRY_TIMEOUT: Duration = Duration::from_secs(10);

/// Files in a bucket.
pub struct S3Files {
    store: AmazonS3,
    /// The prefix of all object names, if there is one.
    prefix: Option<String>,
    quota_bytes: u64,
    /// The bytes of kept files: the last count, plus this process' changes since.
    used_bytes: AtomicU64,
    /// `None` only during the drop.
    runtime: Option<Runtime>,
}

impl S3Files {
    /// Opens the files at an address `s3://BUCKET/PREFIX`. `settings` are environment variables with the
    /// endpoint, the region and the keys, such as `AWS_REGION`; others are ignored. Kept files may take up to
    /// `quota_bytes`.
    ///
    /// # Errors
    /// A description of what is wrong with the address or the settings; the store's error.
    pub fn open(
        address: &str,
        settings: impl IntoIterator<Item = (String, String)>,
        quota_bytes: u64,
    ) -> Result<Self, Error> {
        let bad = |what: &str| Error::Input(format!("--files {address}: expected {what}"));
        let rest = address.strip_prefix("s3://").ok_or_else(|| bad("s3://BUCKET/PREFIX"))?;
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let is_plain = |name: &str, more: &[u8]| {
            name.bytes().all(|byte| byte.is_ascii_alphanumeric() || more.contains(&byte))
        };
        let prefix = prefix.trim_matches('/');
        if bucket.is_empty() || !is_plain(bucket, b".-") || !is_plain(prefix, b".-_/") {
            return Err(bad("a bucket, and a prefix of letters, digits and . - _ /"));
        }
        let prefix = Some(prefix.to_owned()).filter(|prefix| !prefix.is_empty());
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(|error| Error::failure("threads", error))?;
        let (store, used_bytes) = (build_store(bucket, settings)?, AtomicU64::new(0));
        let files = S3Files { store, prefix, quota_bytes, used_bytes, runtime: Some(runtime) };
        files.count_kept().map_err(|error| Error::failure(address, error))?;
        Ok(files)
    }

    fn wait<T>(&self, work: impl Future<Output = Result<T, object_store::Error>>) -> io::Result<T> {
        let runtime = self.runtime.as_ref().ok_or(io::ErrorKind::NotConnected)?;
        runtime.block_on(work).map_err(io_error)
    }

    fn path(&self, name: &str) -> Path {
        match &self.prefix {
            Some(prefix) => Path::from(format!("{prefix}/{name}")),
            None => Path::from(name),
        }
    }

    fn kept_path(&self, name: &KeptName) -> Path {
        self.path(&format!("sculptures/{}", kept_file_name(name)))
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<ObjectMeta>> {
        self.wait(self.store.list(Some(folder)).try_collect())
    }

    fn delete_all(&self, paths: Vec<Path>) -> io::Result<()> {
        let paths = futures_util::stream::iter(paths.into_iter().map(Ok)).boxed();
        let deleted = self.store.delete_stream(paths).try_for_each(|_| async { Ok(()) });
        match self.wait(deleted) {
            // Another process has deleted it already.
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            deleted => deleted,
        }
    }

    fn get(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.wait(async { self.store.get(path).await?.bytes().await })?;
        Ok(bytes.into())
    }

    fn put(&self, path: &Path, bytes: Vec<u8>) -> io::Result<()> {
        self.wait(self.store.put(path, PutPayload::from(bytes))).map(drop)
    }

    /// Returns the length of an object; 0 if it doesn't exist.
    fn length_of(&self, path: &Path) -> io::Result<u64> {
        match self.wait(self.store.head(path)) {
            Ok(found) => Ok(found.size),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(0),
            Err(error) => Err(error),
        }
    }

    /// Counts the bytes of all kept files, of all processes.
    fn count_kept(&self) -> io::Result<()> {
        let used = self.list(&self.path("sculptures"))?.iter().map(|found| found.size).sum();
        self.used_bytes.store(used, Ordering::Relaxed);
        Ok(())
    }

    fn check_quota(&self, more: u64) -> io::Result<()> {
        if self.used_bytes().saturating_add(more) <= self.quota_bytes {
            return Ok(());
        }
        let why = "as many bytes of sculptures are kept as may be";
        Err(io::Error::new(io::ErrorKind::StorageFull, why))
    }
}

impl ParcelFiles for S3Files {
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()> {
        self.check_quota(bytes.len() as u64)?;
        let path = self.kept_path(name);
        let before = self.length_of(&path)?;
        self.put(&path, bytes.to_vec())?;
        self.used_bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        subtract(&self.used_bytes, before);
        Ok(())
    }

    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>> {
        self.get(&self.kept_path(name))
    }

    fn remove_kept(&self, name: &KeptName) -> io::Result<()> {
        let path = self.kept_path(name);
        let before = self.length_of(&path)?;
        self.delete_all(vec![path])?;
        subtract(&self.used_bytes, before);
        Ok(())
    }

    /// Writes one object for each call, as objects can't be appended to. Its name contains the time of the
    /// first deletion.
    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()> {
        let Some(first) = deletions.first() else { return Ok(()) };
        let path = self.path(&format!("deletions/{:016x}-{}", first.deleted_at.0, first.id));
        let lines: String = deletions.iter().map(Deletion::to_line).collect();
        self.put(&path, lines.into_bytes())
    }

    /// Also counts the kept files again, as it is called regularly.
    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()> {
        self.count_kept()?;
        let is_old = |path: &Path| {
            let name = path.filename().and_then(|name| name.split_once('-'));
            let at = name.and_then(|(at, _)| u64::from_str_radix(at, 16).ok());
            at.is_some_and(|at| at < time.0)
        };
        let found = self.list(&self.path("deletions"))?.into_iter();
        self.delete_all(found.map(|found| found.location).filter(is_old).collect())
    }
}

impl Files for S3Files {
    fn used_bytes(&self) -> u64 {
        self.used_bytes.load(Ordering::Relaxed)
    }

    fn room_bytes(&self) -> u64 {
        self.quota_bytes.saturating_sub(self.used_bytes())
    }

    fn check_writes(&self) -> io::Result<()> {
        self.put(&self.path("check"), Vec::new())
    }
}

impl Drop for S3Files {
    fn drop(&mut self) {
        // The last owner may be an async task, which must not block on the runtime's threads.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

fn build_store(
    bucket: &str,
    settings: impl IntoIterator<Item = (String, String)>,
) -> Result<AmazonS3, Error> {
    // The cryptographic provider is global to the process; an existing one is kept.
    let _ = default_provider().install_default();
    let mut builder = AmazonS3Builder::new();
    for (name, value) in settings.into_iter().filter(|(name, _)| name.starts_with("AWS_")) {
        if let Ok(key) = name.to_ascii_lowercase().parse() {
            builder = builder.with_config(key, value);
        }
    }
    let mut builder = builder
        .with_bucket_name(bucket)
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::ConnectTimeout), "5 seconds")
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::Timeout), "20 seconds")
        .with_retry(RetryConfig {
            max_retries: 3,
            retry_timeout: RETRY_TIMEOUT,
            ..RetryConfig::default()
        });
    let endpoint = [AmazonS3ConfigKey::S3Endpoint, AmazonS3ConfigKey::Endpoint]
        .iter()
        .find_map(|key| builder.get_config_value(key));
    let allows_http = AmazonS3ConfigKey::Client(ClientConfigKey::AllowHttp);
    let allows_http = builder.get_config_value(&allows_http).is_some_and(|value| value == "true");
    if let Some(endpoint) = endpoint.filter(|endpoint| endpoint.starts_with("http://")) {
        if !allows_http && !is_this_machine(&endpoint) {
            let expected =
                "AWS_ENDPOINT_URL with https://, or on this machine, or AWS_ALLOW_HTTP=true";
            return Err(Error::Input(format!("--files: expected {expected}")));
        }
        builder = builder.with_allow_http(true);
    }
    builder.build().map_err(|error| Error::Input(format!("--files: {error}")))
}

/// Returns `true` if the endpoint's host is a loopback address.
fn is_this_machine(endpoint: &str) -> bool {
    let host = endpoint.strip_prefix("http://").and_then(|rest| rest.split('/').next());
    let host = host.map(|host| host.rsplit_once(':').map_or(host, |(host, _)| host));
    host.is_some_and(|host| ["localhost", "127.0.0.1", "[::1]"].contains(&host))
}

fn io_error(error: object_store::Error) -> io::Error {
    let kind = match error {
        object_store::Error::NotFound { .. } => io::ErrorKind::NotFound,
        _ => io::ErrorKind::Other,
    };
    io::Error::new(kind, error)
}

/// Subtracts down to zero: another process may have removed a file that this one counted.
fn subtract(count: &AtomicU64, less: u64) {
    let _ = count.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |count| {
        Some(count.saturating_sub(less))
    });
}

#[cfg(test)]
mod tests {
    use super::is_this_machine;

    #[test]
    fn http_is_for_this_machine_alone() {
        for near in ["http://127.0.0.1:9000", "http://localhost", "http://[::1]:9000/x"] {
            assert!(is_this_machine(near), "{near}");
        }
        for far in
            ["http://127.0.0.1.example:80", "http://s3.example", "http://localhost@s3.example:80"]
        {
            assert!(!is_this_machine(far), "{far}");
        }
    }
}
