//! Runtime brokers: content providers that know the active OpenXR runtime's library.

use std::path::{Path, PathBuf};

use super::RuntimeError;
use crate::device;

/// The brokers' authorities in the order of queries: the installable broker, then the system's.
pub const BROKERS: [&str; 2] =
    ["org.khronos.openxr.runtime_broker", "org.khronos.openxr.system_runtime_broker"];

/// The columns of a runtime: the folder of its library, the library's file name, the runtime's package,
/// and whether the library exports functions by other names.
pub const RUNTIME_COLUMNS: [&str; 4] =
    ["native_lib_dir", "so_filename", "package_name", "has_functions"];

/// The columns of a function: its name in OpenXR, and its symbol in the library.
pub const FUNCTION_COLUMNS: [&str; 2] = ["function_name", "symbol_name"];

/// The function that every runtime's library has, by this symbol or another.
pub const NEGOTIATE_FUNCTION: &str = "xrNegotiateLoaderRuntimeInterface";

/// A runtime's library.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RuntimeLibrary {
    /// Its file.
    pub path: PathBuf,
    /// The symbol of [`NEGOTIATE_FUNCTION`].
    pub negotiate_symbol: String,
}

impl RuntimeLibrary {
    /// A library whose symbols are OpenXR's names.
    #[must_use]
    pub fn with_standard_names(path: PathBuf) -> Self {
        RuntimeLibrary { path, negotiate_symbol: NEGOTIATE_FUNCTION.into() }
    }
}

/// Queries the brokers for the library of the active runtime for OpenXR 1 on arm64. `query` reads columns
/// of a content provider's table. (OpenXR loader specification, "Android Active Runtime Location".)
///
/// # Errors
/// [`RuntimeError::NoBroker`] if none names one.
pub fn query_brokers(
    mut query: impl FnMut(&str, &[&str]) -> Result<Vec<device::ContentRow>, device::JavaError>,
) -> Result<RuntimeLibrary, RuntimeError> {
    let mut said = Vec::new();
    for broker in BROKERS {
        match query_broker(broker, &mut query) {
            Ok(Some(library)) => return Ok(library),
            Ok(None) => said.push((broker, None)),
            Err(error) => said.push((broker, Some(error))),
        }
    }
    Err(RuntimeError::NoBroker(said))
}

/// Queries one broker for the library, if it names one.
fn query_broker(
    broker: &str,
    query: &mut impl FnMut(&str, &[&str]) -> Result<Vec<device::ContentRow>, device::JavaError>,
) -> Result<Option<RuntimeLibrary>, device::JavaError> {
    let runtimes = format!("content://{broker}/openxr/1/abi/arm64-v8a/runtimes");
    let rows = query(&format!("{runtimes}/active/0"), &RUNTIME_COLUMNS)?;
    let Some([Some(folder), Some(name), package, renames]) = rows.first().map(Vec::as_slice) else {
        return Ok(None);
    };
    let mut library = RuntimeLibrary::with_standard_names(Path::new(folder).join(name));
    if renames.as_deref() != Some("1") {
        return Ok(Some(library));
    }
    let Some(package) = package else {
        return Err(answer_error("has_functions without package_name"));
    };
    let rows = query(&format!("{runtimes}/{package}/functions"), &FUNCTION_COLUMNS)?;
    if rows.is_empty() {
        return Err(answer_error("has_functions, but no functions are told"));
    }
    for row in rows {
        if let [Some(function), Some(symbol)] = &row[..]
            && function == NEGOTIATE_FUNCTION
        {
            library.negotiate_symbol.clone_from(symbol);
        }
    }
    Ok(Some(library))
}

fn answer_error(why: &str) -> device::JavaError {
    device::JavaError { member: None, why: why.into() }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{FUNCTION_COLUMNS, NEGOTIATE_FUNCTION, RUNTIME_COLUMNS, query_brokers};
    use crate::device::{self, ContentRow};

    const FIRST: &str =
        "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";
    const SECOND: &str = "content://org.khronos.openxr.system_runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";

    fn row<const C: usize>(texts: [&str; C]) -> ContentRow {
        texts.map(|text| Some(text.to_owned())).to_vec()
    }

    fn library(name: &str) -> Vec<ContentRow> {
        vec![row(["/system/lib64", name, "com.maker.runtime", "0"])]
    }

    #[test]
    fn the_headset_s_own_broker_is_asked_last() {
        let mut asked = Vec::new();
        let named = query_brokers(|table, columns| {
            assert_eq!(columns, RUNTIME_COLUMNS);
            asked.push(table.to_owned());
            Ok(library(if table == FIRST { "first.so" } else { "second.so" }))
        });
        let named = named.expect("the first knows");
        assert_eq!(named.path, Path::new("/system/lib64/first.so"));
        assert_eq!(named.negotiate_symbol, NEGOTIATE_FUNCTION);
        assert_eq!(asked, [FIRST]);
        let named = query_brokers(|table, _| {
            Ok(if table == SECOND { library("second.so") } else { vec![] })
        });
        let named = named.expect("the second knows");
        assert_eq!(named.path, Path::new("/system/lib64/second.so"));
    }

    #[test]
    fn what_each_broker_said_is_told() {
        let why = query_brokers(|table, _| match table {
            FIRST => Err(device::JavaError { member: None, why: "refused".into() }),
            _ => Ok(vec![vec![Some("/system/lib64".into()), None, None, None]]),
        });
        assert_eq!(
            why.expect_err("no library is named").to_string(),
            "no OpenXR runtime: no broker names one; org.khronos.openxr.runtime_broker: refused; \
             org.khronos.openxr.system_runtime_broker: no answer"
        );
    }

    #[test]
    fn a_library_s_own_names_are_asked_for() {
        let own = |functions: Vec<ContentRow>| {
            query_brokers(move |table, columns| {
                if table == FIRST {
                    return Ok(vec![row(["/data", "own.so", "com.maker.runtime", "1"])]);
                }
                let expected = FIRST.replace("active/0", "com.maker.runtime/functions");
                if table != expected {
                    return Ok(vec![]);
                }
                assert_eq!(columns, FUNCTION_COLUMNS);
                Ok(functions.clone())
            })
        };
        let other = row(["xrInitializeLoaderKHR", "maker_initialize"]);
        let named = own(vec![other.clone(), row([NEGOTIATE_FUNCTION, "maker_negotiate"])]);
        assert_eq!(named.expect("it is named").negotiate_symbol, "maker_negotiate");
        assert_eq!(own(vec![other]).expect("it is named").negotiate_symbol, NEGOTIATE_FUNCTION);
        let why = own(vec![]).expect_err("its names are not told").to_string();
        assert!(why.contains("has_functions, but no functions are told"), "{why}");
    }
}
