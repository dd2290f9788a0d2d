//! The broker: an app that knows which runtime is the active one.

use std::path::{Path, PathBuf};

use super::Error;
use crate::device;

/// The brokers, in the order they are asked: one that the visitor installed, then the headset's own.
pub const BROKERS: [&str; 2] =
    ["org.khronos.openxr.runtime_broker", "org.khronos.openxr.system_runtime_broker"];

/// What is asked: the folder of the runtime's library, its name there, the runtime's package, and
/// whether the library has functions under other names.
pub const COLUMNS: [&str; 4] = ["native_lib_dir", "so_filename", "package_name", "has_functions"];

/// What is asked of functions: how OpenXR calls one, and how the library does.
pub const FUNCTIONS: [&str; 2] = ["function_name", "symbol_name"];

/// The function that every runtime's library has, under this name or another.
pub const NEGOTIATE: &str = "xrNegotiateLoaderRuntimeInterface";

/// The library that a broker names.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Named {
    /// Where it is.
    pub library: PathBuf,
    /// What [`NEGOTIATE`] is called there.
    pub negotiate: String,
}

impl Named {
    /// A library that calls its functions what OpenXR does.
    #[must_use]
    pub fn plain(library: PathBuf) -> Self {
        Named { library, negotiate: NEGOTIATE.into() }
    }
}

/// Asks the brokers for the library of the active runtime for OpenXR 1 on arm64. `query` reads
/// columns of a content provider's table. (OpenXR loader specification, "Android Active Runtime
/// Location".)
///
/// # Errors
/// [`Error::NoBroker`] if none names one.
pub fn ask(
    mut query: impl FnMut(&str, &[&str]) -> Result<Vec<device::Row>, device::Error>,
) -> Result<Named, Error> {
    let mut said = Vec::new();
    for broker in BROKERS {
        match named(broker, &mut query) {
            Ok(Some(named)) => return Ok(named),
            Ok(None) => said.push((broker, None)),
            Err(error) => said.push((broker, Some(error))),
        }
    }
    Err(Error::NoBroker(said))
}

/// The library that one broker names, if it does.
fn named(
    broker: &str,
    query: &mut impl FnMut(&str, &[&str]) -> Result<Vec<device::Row>, device::Error>,
) -> Result<Option<Named>, device::Error> {
    let runtimes = format!("content://{broker}/openxr/1/abi/arm64-v8a/runtimes");
    let rows = query(&format!("{runtimes}/active/0"), &COLUMNS)?;
    let Some([Some(folder), Some(name), package, renames]) = rows.first().map(Vec::as_slice) else {
        return Ok(None);
    };
    let mut named = Named::plain(Path::new(folder).join(name));
    if renames.as_deref() != Some("1") {
        return Ok(Some(named));
    }
    let Some(package) = package else { return Err(wrong("has_functions without package_name")) };
    let rows = query(&format!("{runtimes}/{package}/functions"), &FUNCTIONS)?;
    if rows.is_empty() {
        return Err(wrong("has_functions, but no functions are told"));
    }
    for row in rows {
        if let [Some(function), Some(symbol)] = &row[..]
            && function == NEGOTIATE
        {
            named.negotiate.clone_from(symbol);
        }
    }
    Ok(Some(named))
}

fn wrong(why: &str) -> device::Error {
    device::Error { member: None, why: why.into() }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{COLUMNS, FUNCTIONS, NEGOTIATE, ask};
    use crate::device::{self, Row};

    const FIRST: &str =
        "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";
    const SECOND: &str = "content://org.khronos.openxr.system_runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active/0";

    fn row<const C: usize>(texts: [&str; C]) -> Row {
        texts.map(|text| Some(text.to_owned())).to_vec()
    }

    fn library(name: &str) -> Vec<Row> {
        vec![row(["/system/lib64", name, "com.maker.runtime", "0"])]
    }

    #[test]
    fn the_headset_s_own_broker_is_asked_last() {
        let mut asked = Vec::new();
        let named = ask(|table, columns| {
            assert_eq!(columns, COLUMNS);
            asked.push(table.to_owned());
            Ok(library(if table == FIRST { "first.so" } else { "second.so" }))
        });
        let named = named.expect("the first knows");
        assert_eq!(named.library, Path::new("/system/lib64/first.so"));
        assert_eq!(named.negotiate, NEGOTIATE);
        assert_eq!(asked, [FIRST]);
        let named = ask(|table, _| Ok(if table == SECOND { library("second.so") } else { vec![] }));
        let named = named.expect("the second knows");
        assert_eq!(named.library, Path::new("/system/lib64/second.so"));
    }

    #[test]
    fn what_each_broker_said_is_told() {
        let why = ask(|table, _| match table {
            FIRST => Err(device::Error { member: None, why: "refused".into() }),
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
        let own = |functions: Vec<Row>| {
            ask(move |table, columns| {
                if table == FIRST {
                    return Ok(vec![row(["/data", "own.so", "com.maker.runtime", "1"])]);
                }
                let expected = FIRST.replace("active/0", "com.maker.runtime/functions");
                if table != expected {
                    return Ok(vec![]);
                }
                assert_eq!(columns, FUNCTIONS);
                Ok(functions.clone())
            })
        };
        let other = row(["xrInitializeLoaderKHR", "maker_initialize"]);
        let named = own(vec![other.clone(), row([NEGOTIATE, "maker_negotiate"])]);
        assert_eq!(named.expect("it is named").negotiate, "maker_negotiate");
        assert_eq!(own(vec![other]).expect("it is named").negotiate, NEGOTIATE);
        let why = own(vec![]).expect_err("its names are not told").to_string();
        assert!(why.contains("has_functions, but no functions are told"), "{why}");
    }
}
