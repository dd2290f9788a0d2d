//! The log: lines on standard error, which Android adds to the system log, and in a file in the app's folder.

use std::fmt;
use std::io::{self, Write};
use std::panic;
use std::path::Path;
use std::sync::{Mutex, Once, PoisonError};
use std::time::SystemTime;

use paros_shell::log_file::LogFile;

/// The process's log file, once its folder is known.
static FILE: Mutex<Option<LogFile>> = Mutex::new(None);

/// Also writes log lines and panics to a file from now on. A write error is reported once on standard error.
pub fn open_log_file(path: &Path) {
    static PANICS: Once = Once::new();

    PANICS.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            print(panic);
            // The panicking thread may hold the lock; the panic is then only printed.
            if let Ok(mut file) = FILE.try_lock()
                && let Some(log) = file.as_mut()
            {
                let _ = log.append_line(SystemTime::now(), format_args!("{panic}"));
            }
        }));
    });
    let opened = LogFile::open(path);
    let why = opened.as_ref().err().map(ToString::to_string);
    *FILE.lock().unwrap_or_else(PoisonError::into_inner) = opened.ok();
    if let Some(why) = why {
        write_log_line(format_args!("no log is kept: {}: {why}", path.display()));
    }
}

/// Writes a line to standard error and to the log file.
pub fn write_log_line(text: fmt::Arguments<'_>) {
    // Standard error may be closed.
    let _ = writeln!(io::stderr(), "paros-quest: {text}");
    let mut file = FILE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(log) = file.as_mut() else { return };
    if let Err(why) = log.append_line(SystemTime::now(), text) {
        let _ = writeln!(io::stderr(), "paros-quest: the log can't be written any more: {why}");
        *file = None;
    }
}
