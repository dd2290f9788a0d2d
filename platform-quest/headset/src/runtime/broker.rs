//! Runtime brokers: content providers that name the library of the active OpenXR runtime.

use std::path::Path;

use super::{Candidate, RuntimeLibrary};

/// The brokers' authorities in the order of queries: the installable broker, then the system's.
pub const BROKERS: [&str; 2] =
    ["org.khronos.openxr.runtime_broker", "org.khronos.openxr.system_runtime_broker"];

/// The columns of a runtime: the folder of its library, the library's file name, the runtime's package, and
/// whether the library renames functions.
pub const RUNTIME_COLUMNS: [&str; 4] =
    ["native_lib_dir", "so_filename", "package_name", "has_functions"];

/// The columns of a function: its name in OpenXR, and its symbol in the library.
pub const FUNCTION_COLUMNS: [&str; 2] = ["function_name", "symbol_name"];

/// The values of a content provider's row, one for each column; `None` if a column is missing or null.
pub type ContentRow = Vec<Option<String>>;

/// The result of a query of a content provider's table, or the reason of its failure.
pub type QueryResult = Result<Vec<ContentRow>, String>;

/// A broker's tables of the active runtime, in the order of queries: all rows, and the single row of older
/// brokers.
const ACTIVE_TABLES: [&str; 2] = ["active", "active/0"];

/// Queries a broker for the active runtime for OpenXR 1 on arm64. There may be several rows, which a loader
/// tries in order. `query` reads columns of a content provider's table. (OpenXR loader specification,
/// "Android Active Runtime Location".)
pub fn query_broker(
    broker: &str,
    query: &mut impl FnMut(&str, &[&str]) -> QueryResult,
) -> Vec<Candidate> {
    let runtimes = format!("content://{broker}/openxr/1/abi/arm64-v8a/runtimes");
    let mut why = None;
    for table in ACTIVE_TABLES {
        match query(&format!("{runtimes}/{table}"), &RUNTIME_COLUMNS) {
            Err(error) => why = why.or(Some(error)),
            Ok(rows) if rows.is_empty() => {}
            Ok(rows) => {
                let candidate = |(number, row): (usize, &ContentRow)| Candidate {
                    source: format!("{broker}, row {}", number + 1),
                    library: read_runtime_row(row, &runtimes, query),
                };
                return rows.iter().enumerate().map(candidate).collect();
            }
        }
    }
    let library = Err(why.unwrap_or_else(|| "no answer".into()));
    vec![Candidate { source: broker.into(), library }]
}

/// Returns the library of a runtime's row, or an error that names the missing part.
fn read_runtime_row(
    row: &ContentRow,
    runtimes: &str,
    query: &mut impl FnMut(&str, &[&str]) -> QueryResult,
) -> Result<RuntimeLibrary, String> {
    let [Some(folder), Some(name), package, renames] = &row[..] else {
        let [folder, name, ..] = RUNTIME_COLUMNS;
        return Err(format!("no {folder} or {name}"));
    };
    let mut library = RuntimeLibrary::runtime(Path::new(folder).join(name));
    if renames.as_deref() != Some("1") {
        return Ok(library);
    }
    let unnamed = |why: String| format!("{}: {why}", library.path.display());
    let Some(package) = package else {
        return Err(unnamed("has_functions without package_name".into()));
    };
    let functions = query(&format!("{runtimes}/{package}/functions"), &FUNCTION_COLUMNS);
    let functions = functions.map_err(unnamed)?;
    if functions.is_empty() {
        return Err(unnamed("has_functions, but no functions are told".into()));
    }
    for function in functions {
        if let [Some(function), Some(symbol)] = &function[..] {
            library.rename_function(function, symbol);
        }
    }
    Ok(library)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{INITIALIZE_FUNCTION, NEGOTIATE_FUNCTION, RuntimeLibrary};
    use super::{BROKERS, Candidate, ContentRow, FUNCTION_COLUMNS, RUNTIME_COLUMNS, query_broker};

    const ACTIVE: &str =
        "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes/active";

    fn row<const C: usize>(texts: [&str; C]) -> ContentRow {
        texts.map(|text| Some(text.to_owned())).to_vec()
    }

    #[test]
    fn every_row_is_a_candidate() {
        let named = query_broker(BROKERS[0], &mut |table, columns| {
            assert_eq!((table, columns), (ACTIVE, &RUNTIME_COLUMNS[..]));
            Ok(vec![
                row(["/data/app/base.apk!/lib/arm64-v8a", "first.so", "com.first", "0"]),
                vec![Some("/system/lib64".into()), None, None, None],
                row(["/system/lib64", "third.so", "com.third", "0"]),
            ])
        });
        let source = |number| format!("org.khronos.openxr.runtime_broker, row {number}");
        let library = |path: &str| Ok(RuntimeLibrary::runtime(path.into()));
        let first = library("/data/app/base.apk!/lib/arm64-v8a/first.so");
        let expected = [
            Candidate { source: source(1), library: first },
            Candidate {
                source: source(2),
                library: Err("no native_lib_dir or so_filename".into()),
            },
            Candidate { source: source(3), library: library("/system/lib64/third.so") },
        ];
        assert_eq!(named, expected);
    }

    #[test]
    fn a_broker_with_one_row_alone_is_asked_for_that() {
        let named = query_broker(BROKERS[0], &mut |table, _| {
            let rows = vec![row(["/data", "only.so", "com.only", "0"])];
            Ok(if table.strip_prefix(ACTIVE) == Some("/0") { rows } else { vec![] })
        });
        let library = named.into_iter().next().expect("a row").library.expect("a library");
        assert_eq!(library.path, Path::new("/data/only.so"));
    }

    #[test]
    fn why_a_broker_names_nothing_is_told() {
        let refused = || Err("refused".to_owned());
        for (is_refused, why) in [(true, "refused"), (false, "no answer")] {
            let mut query = |_: &str, _: &[&str]| if is_refused { refused() } else { Ok(vec![]) };
            let named = query_broker(BROKERS[1], &mut query);
            let source = "org.khronos.openxr.system_runtime_broker".into();
            assert_eq!(named, [Candidate { source, library: Err(why.into()) }]);
        }
    }

    #[test]
    fn a_library_s_own_names_are_asked_for() {
        let own = |functions: Vec<ContentRow>| {
            let named = query_broker(BROKERS[0], &mut |table, columns| {
                if table == ACTIVE {
                    return Ok(vec![row(["/data", "own.so", "com.maker.runtime", "1"])]);
                }
                let expected = ACTIVE.replace("active", "com.maker.runtime/functions");
                assert_eq!((table, columns), (&*expected, &FUNCTION_COLUMNS[..]));
                Ok(functions.clone())
            });
            named.into_iter().next().expect("a row").library
        };
        let initialize = row([INITIALIZE_FUNCTION, "maker_initialize"]);
        let negotiate = row([NEGOTIATE_FUNCTION, "maker_negotiate"]);
        let library = own(vec![initialize.clone(), negotiate]).expect("it is named");
        assert_eq!(library.path, Path::new("/data/own.so"));
        assert_eq!(library.initialize_symbol, "maker_initialize");
        assert_eq!(library.negotiate_symbol.as_deref(), Some("maker_negotiate"));
        let library = own(vec![initialize]).expect("it is named");
        assert_eq!(library.negotiate_symbol.as_deref(), Some(NEGOTIATE_FUNCTION));
        let why = own(vec![]).expect_err("its names are not told");
        assert_eq!(why, "/data/own.so: has_functions, but no functions are told");
    }
}
