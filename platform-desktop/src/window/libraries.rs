//! Whether a window can be opened at all, found out before `winit` tries: without libxkbcommon-x11,
//! say, that would panic.

use std::env;

/// What X11 windows need at run time, each with the names it goes by.
const X11: [&[&str]; 6] = [
    &["libX11.so.6", "libX11.so"],
    &["libX11-xcb.so.1", "libX11-xcb.so"],
    &["libxcb.so.1", "libxcb.so"],
    &["libXcursor.so.1", "libXcursor.so"],
    &["libXi.so.6", "libXi.so"],
    &["libxkbcommon-x11.so.0", "libxkbcommon-x11.so"],
];

/// What Wayland windows need.
const WAYLAND: [&[&str]; 1] = [&["libwayland-client.so.0", "libwayland-client.so"]];

/// What both need.
const BOTH: [&[&str]; 1] = [&["libxkbcommon.so.0", "libxkbcommon.so"]];

/// Whether a display is named and the libraries to reach it are there.
///
/// # Errors
/// What is missing, in a few words.
pub(super) fn probe() -> Result<(), String> {
    if matches!(env::consts::OS, "macos" | "windows") {
        return Ok(());
    }
    let named = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
    probe_with(named("WAYLAND_DISPLAY") || named("WAYLAND_SOCKET"), named("DISPLAY"), &is_there)
}

/// The kind of display is `winit`'s choice: Wayland if it is named, else X11.
fn probe_with(wayland: bool, x11: bool, is_there: &dyn Fn(&str) -> bool) -> Result<(), String> {
    let needed: &[&[&str]] = match (wayland, x11) {
        (true, _) => &WAYLAND,
        (false, true) => &X11,
        (false, false) => return Err("no display: DISPLAY and WAYLAND_DISPLAY are not set".into()),
    };
    let missing = |names: &&&[&str]| !names.iter().any(|name| is_there(name));
    match needed.iter().chain(&BOTH).find(missing) {
        None => Ok(()),
        Some(names) => Err(format!("{} is missing", names[0])),
    }
}

fn is_there(name: &str) -> bool {
    // SAFETY: these are the system's window libraries, whose initialisers do nothing but set
    // themselves up; `winit` would load the same ones.
    unsafe { libloading::Library::new(name) }.is_ok()
}

#[cfg(test)]
mod tests {
    use super::probe_with;

    #[test]
    fn what_is_missing_is_named() {
        let all = |_: &str| true;
        assert_eq!(probe_with(true, false, &all), Ok(()));
        assert_eq!(probe_with(false, true, &all), Ok(()));
        assert!(probe_with(false, false, &all).expect_err("no display").contains("DISPLAY"));
        let no_xkb = |name: &str| !name.starts_with("libxkbcommon-x11");
        assert_eq!(probe_with(true, true, &no_xkb), Ok(()));
        let why = probe_with(false, true, &no_xkb).expect_err("it is needed");
        assert_eq!(why, "libxkbcommon-x11.so.0 is missing");
        let unversioned = |name: &str| name.ends_with(".so");
        assert_eq!(probe_with(true, false, &unversioned), Ok(()));
        let no_common = |name: &str| !name.starts_with("libxkbcommon.so");
        assert!(probe_with(true, false, &no_common).is_err());
    }
}
