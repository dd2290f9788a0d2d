//! Runtime manifest files, which name a runtime's library if no broker does.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Candidate, RuntimeLibrary};
use paros_shell::durable;

/// Android's partitions, in the order in which a loader looks for manifest files on them.
pub const PARTITIONS: [&str; 5] = ["/product", "/odm", "/oem", "/vendor", "/system"];

/// A partition's manifest files: the one of the architecture comes first.
const MANIFESTS: [&str; 2] =
    ["etc/openxr/1/active_runtime.aarch64.json", "etc/openxr/1/active_runtime.json"];

/// The maximum number of bytes that are read from a file: a bound against a faulty one.
const MAX_BYTES: u64 = 1 << 20;

/// Reads the manifest files of partitions, each a candidate. If there is no file at all, one failed candidate
/// reports it. (OpenXR loader specification, "Runtime Manifest File Format".)
pub fn read_manifests(partitions: &[impl AsRef<Path>]) -> Vec<Candidate> {
    let files = partitions.iter().flat_map(|partition| {
        MANIFESTS.iter().map(move |manifest| partition.as_ref().join(manifest))
    });
    let mut candidates: Vec<Candidate> = files.filter_map(|file| read_manifest(&file)).collect();
    if candidates.is_empty() {
        let names = partitions.iter().map(|name| name.as_ref().display().to_string());
        let source =
            format!("{} of {}", MANIFESTS.join(" and "), names.collect::<Vec<_>>().join(", "));
        candidates.push(Candidate { source, library: Err("there is no such file".into()) });
    }
    candidates
}

/// Parses a manifest file's bytes. The existence of the library isn't checked.
///
/// # Errors
/// One line that describes the fault.
pub fn parse_manifest(file: &Path, bytes: &[u8]) -> Result<RuntimeLibrary, String> {
    let manifest: Value = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if manifest["file_format_version"] != "1.0.0" {
        return Err("file_format_version is not 1.0.0".into());
    }
    let runtime = &manifest["runtime"];
    let path = runtime["library_path"].as_str().ok_or("no library_path of a runtime")?;
    let mut library = RuntimeLibrary::runtime(locate_library(file, path));
    for (function, symbol) in runtime["functions"].as_object().into_iter().flatten() {
        if let Some(symbol) = symbol.as_str() {
            library.rename_function(function, symbol);
        }
    }
    Ok(library)
}

/// Reads the candidate that a file names; `None` if there is no such file.
fn read_manifest(file: &Path) -> Option<Candidate> {
    let library = match durable::read_regular_file_up_to(file, MAX_BYTES) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
        Err(error) => Err(error.to_string()),
        Ok(bytes) => parse_manifest(file, &bytes),
    };
    Some(Candidate { source: file.display().to_string(), library })
}

/// Locates a library. The linker resolves a bare name; another relative path starts from the manifest's
/// folder, after symbolic links are resolved.
fn locate_library(file: &Path, path: &str) -> PathBuf {
    if !path.contains('/') {
        return path.into();
    }
    let file = file.canonicalize().unwrap_or_else(|_| file.into());
    file.with_file_name(path)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::symlink;
    use std::path::PathBuf;

    use super::{Candidate, MANIFESTS, RuntimeLibrary, parse_manifest, read_manifests};

    /// A folder with partitions, which is removed when the value is dropped.
    struct Device(PathBuf);

    impl Device {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("paros-{name}-{}", std::process::id()));
            fs::create_dir_all(folder.join("system/etc/openxr/1")).expect("room on the disk");
            fs::create_dir_all(folder.join("odm/etc/openxr/1")).expect("room on the disk");
            Device(folder.canonicalize().expect("it was just made"))
        }

        fn read(&self) -> Vec<Candidate> {
            read_manifests(&[self.0.join("odm"), self.0.join("system")])
        }
    }

    impl Drop for Device {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn manifest(library: &str) -> String {
        format!(r#"{{"file_format_version": "1.0.0", "runtime": {{"library_path": "{library}"}}}}"#)
    }

    #[test]
    fn every_partition_s_manifests_are_candidates() {
        let device = Device::new("partitions");
        let [odm, system] = ["odm", "system"].map(|name| device.0.join(name));
        let why = device.read().remove(0);
        assert!(why.source.ends_with(&format!("{}, {}", odm.display(), system.display())));
        assert_eq!(why.library, Err("there is no such file".into()));
        let files = [odm.join(MANIFESTS[0]), odm.join(MANIFESTS[1]), system.join(MANIFESTS[1])];
        fs::write(&files[0], manifest("libodm.so")).expect("room on the disk");
        fs::write(&files[1], "{").expect("room on the disk");
        let real = device.0.join("system/runtime.json");
        fs::write(&real, manifest("lib64/libsystem.so")).expect("room on the disk");
        symlink(&real, &files[2]).expect("room on the disk");
        let [first, second, third] = &device.read()[..] else { panic!("three") };
        assert_eq!(first.library, Ok(RuntimeLibrary::runtime("libodm.so".into())));
        assert_eq!(second.source, files[1].display().to_string());
        assert!(second.library.as_ref().expect_err("no JSON").contains("line 1"));
        let beside = device.0.join("system/lib64/libsystem.so");
        assert_eq!(third.library, Ok(RuntimeLibrary::runtime(beside)));
    }

    #[test]
    fn what_a_manifest_lacks_is_told() {
        let parse = |text: &str| parse_manifest("/etc/a.json".as_ref(), text.as_bytes());
        let version = "file_format_version is not 1.0.0";
        assert_eq!(parse("[]").expect_err("no manifest"), version);
        let other = manifest("a").replace("1.0.0", "2.0.0");
        assert_eq!(parse(&other).expect_err("another"), version);
        let empty = r#"{"file_format_version": "1.0.0"}"#;
        assert_eq!(parse(empty).expect_err("empty"), "no library_path of a runtime");
        let renames = r#"{"file_format_version": "1.0.0", "runtime": {"library_path": "/lib/a.so",
            "functions": {"xrNegotiateLoaderRuntimeInterface": "own", "xrOther": 1}}}"#;
        let library = parse(renames).expect("a manifest");
        assert_eq!(library.path, PathBuf::from("/lib/a.so"));
        assert_eq!(library.negotiate_symbol.as_deref(), Some("own"));
    }
}
