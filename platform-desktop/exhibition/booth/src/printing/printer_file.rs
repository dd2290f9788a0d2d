//! The file that lists printers on the network.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::slicer::check_profile;
use crate::error::Error;

/// The most printers of a booth: each has a thread.
const MAX_PRINTERS: usize = 32;

/// The protocol of a printer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PrinterKind {
    /// Moonraker, the web API of Klipper.
    Moonraker,
    /// PrusaLink.
    PrusaLink,
}

/// A printer's API key. It never appears in a log.
#[derive(Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(transparent)]
pub(crate) struct PrinterKey(pub(crate) String);

impl fmt::Debug for PrinterKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PrinterKey(not shown)")
    }
}

/// An entry of the file: one printer.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PrinterEntry {
    /// The printer's name, which staff see. It is unique.
    pub(crate) name: String,
    pub(crate) kind: PrinterKind,
    /// `http://HOST` or `https://HOST`, with an optional port.
    pub(crate) address: String,
    #[serde(default)]
    pub(crate) key: PrinterKey,
    /// The name of PrusaLink's storage for files.
    #[serde(default = "usb")]
    pub(crate) storage: String,
    /// The slicer's settings for this printer; by default those of `--slicer-profile`.
    pub(crate) profile: Option<PathBuf>,
    /// The certificate authority in PEM that verifies an `https://` address.
    pub(crate) ca: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PrinterFile {
    #[serde(default)]
    printer: Vec<PrinterEntry>,
}

fn usb() -> String {
    "usb".to_owned()
}

/// Reads a printers file.
///
/// # Errors
/// The file can't be read, or what is wrong with it and where. The message never contains a key.
pub(crate) fn read_printers(path: &Path) -> Result<Vec<PrinterEntry>, Error> {
    let bad = |why: &dyn fmt::Display| Error::Input(format!("{}: {why}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| bad(&error))?;
    let mut printers = parse_printers(&text).map_err(|why| bad(&why))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for printer in &mut printers {
        if let Some(profile) = &printer.profile {
            printer.profile = Some(check_profile(&folder.join(profile))?);
        }
        printer.ca = printer.ca.as_ref().map(|ca| folder.join(ca));
    }
    Ok(printers)
}

/// Parses the text of a printers file. Relative paths are left as they are.
///
/// # Errors
/// A description of what is wrong with the text and where. The message never contains a key.
pub(crate) fn parse_printers(text: &str) -> Result<Vec<PrinterEntry>, String> {
    let file: PrinterFile = toml::from_str(text).map_err(|error| {
        // Doesn't quote the line, which may contain a key.
        let before = error.span().map_or("", |span| &text[..span.start.min(text.len())]);
        format!("line {}: {}", 1 + before.matches('\n').count(), error.message())
    })?;
    for (k, printer) in file.printer.iter().enumerate() {
        check(printer).map_err(|why| format!("printer {}: {why}", k + 1))?;
        if file.printer[..k].iter().any(|other| other.name == printer.name) {
            return Err(format!("printer {}: another has its name", k + 1));
        }
    }
    if file.printer.len() > MAX_PRINTERS {
        return Err(format!("expected up to {MAX_PRINTERS} printers"));
    }
    Ok(file.printer)
}

fn check(printer: &PrinterEntry) -> Result<(), String> {
    let is_name = |text: &str| {
        (1..=40).contains(&text.chars().count()) && !text.chars().any(char::is_control)
    };
    if !is_name(&printer.name) {
        return Err("expected a name of up to 40 letters".into());
    }
    let rest = printer.address.strip_prefix("http://");
    let (rest, is_secure) = match printer.address.strip_prefix("https://") {
        Some(rest) => (Some(rest), true),
        None => (rest, false),
    };
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b".-:[]".contains(&byte);
    if rest.is_none_or(|rest| rest.is_empty() || !rest.bytes().all(is_plain)) {
        return Err("expected an address as http://10.0.0.7 or https://printer:8443".into());
    }
    if is_secure != printer.ca.is_some() {
        return Err("expected a ca for an https:// address, and for no other".into());
    }
    if !printer.storage.bytes().all(|byte| byte.is_ascii_alphanumeric()) {
        return Err("expected a storage as usb or local".into());
    }
    let is_key = |byte: u8| byte.is_ascii_graphic();
    if !printer.key.0.bytes().all(is_key) {
        return Err("expected a key of letters and digits".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{PrinterKind, parse_printers};

    const TWO: &str = "[[printer]]\nname = \"Left\"\nkind = \"moonraker\"\naddress = \"http://10.0.0.7:7125\"\n\
                       [[printer]]\nname = \"Right\"\nkind = \"prusalink\"\naddress = \"https://right.example\"\n\
                       key = \"secret\"\nca = \"ca.pem\"\nstorage = \"local\"\n";

    #[test]
    fn printers_are_read_and_their_keys_not_shown() {
        let printers = parse_printers(TWO).expect("two printers");
        assert_eq!(printers[0].kind, PrinterKind::Moonraker);
        assert_eq!((printers[0].storage.as_str(), printers[1].storage.as_str()), ("usb", "local"));
        assert_eq!(printers[1].key.0, "secret");
        assert!(!format!("{printers:?}").contains("secret"));
        assert!(parse_printers("").expect("none").is_empty());
    }

    #[test]
    fn what_is_wrong_is_told_without_keys() {
        for (from, to, told) in [
            ("\"Right\"", "\"Left\"", "printer 2: another has its name"),
            ("\"Left\"", "\"\"", "printer 1: expected a name"),
            ("http://10", "10", "printer 1: expected an address"),
            ("ca = \"ca.pem\"\n", "", "printer 2: expected a ca"),
            ("https://right", "http://right", "printer 2: expected a ca"),
            ("\"local\"", "\"../x\"", "printer 2: expected a storage"),
            ("\"secret\"", "\"secret\\n\"", "printer 2: expected a key"),
            ("key = \"secret\"", "key = \"secret", "line 9: "),
            ("key =", "kex =", "line 9: "),
            ("moonraker", "octoprint", "line 3: "),
        ] {
            let why = parse_printers(&TWO.replace(from, to)).expect_err(told);
            assert!(why.starts_with(told) && !why.contains("secret"), "{why}");
        }
    }
}
