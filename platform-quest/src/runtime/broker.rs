//! The broker: an app that knows which runtime is the active one.

use std::path::{Path, PathBuf};

use super::Error;
use crate::device;

/// The brokers, in the order they are asked: one that the visitor installed, then the headset's own.
pub const BROKERS: [&str; 2] =
    ["org.khronos.openxr.runtime_broker", "org.khronos.openxr.system_runtime_broker"];

/// What is asked: the folder of the runtime's library, and its name there.
pub const COLUMNS: [&str; 2] = ["native_lib_dir", "so_filename"];

/// Asks the brokers for the library of the active runtime for OpenXR 1 on arm64. `query` reads the
/// first row of a content provider's table.
///
/// # Errors
/// [`Error::NoBroker`] if none names one.
pub fn ask(
    mut query: impl FnMut(&str, [&str; 2]) -> Result<Option<[Option<String>; 2]>, device::Error>,
) -> Result<PathBuf, Error> {
    let mut said = Vec::new();
    for broker in BROKERS {
        let table = format!("content://{broker}/openxr/1/abi/arm64-v8a/runtimes/active/0");
        match query(&table, COLUMNS) {
            Ok(Some([Some(folder), Some(name)])) => return Ok(Path::new(&folder).join(name)),
            Ok(_) => said.push((broker, None)),
            Err(error) => said.push((broker, Some(error))),
        }
    }
    Err(Error::NoBroker(said))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{COLUMNS, ask};
    use crate::device;

    const FIRST: &str =
        "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";
    const SECOND: &str = "content://org.khronos.openxr.system_runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";

    #[test]
    fn the_headset_s_own_broker_is_asked_last() {
        let row = |name: &str| Some([Some("/system/lib64".to_owned()), Some(name.to_owned())]);
        let mut asked = Vec::new();
        let library = ask(|table, columns| {
            assert_eq!(columns, COLUMNS);
            asked.push(table.to_owned());
            Ok(if table == FIRST { row("first.so") } else { row("second.so") })
        });
        assert_eq!(library.expect("the first knows"), Path::new("/system/lib64/first.so"));
        assert_eq!(asked, [FIRST]);
        let library = ask(|table, _| Ok(if table == SECOND { row("second.so") } else { None }));
        assert_eq!(library.expect("the second knows"), Path::new("/system/lib64/second.so"));
    }

    #[test]
    fn what_each_broker_said_is_told() {
        let why = ask(|table, _| match table {
            FIRST => Err(device::Error { member: None, why: "refused".into() }),
            _ => Ok(Some([Some("/system/lib64".into()), None])),
        });
        assert_eq!(
            why.expect_err("no library is named").to_string(),
            "no OpenXR runtime: no broker names one; org.khronos.openxr.runtime_broker: refused; \
             org.khronos.openxr.system_runtime_broker: no answer"
        );
    }
}
