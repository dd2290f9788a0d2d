//! Check for a display and its shared libraries, before `winit` loads them: `winit` panics without
//! libxkbcommon-x11, for example.

use std::env;

/// Libraries of X11 windows, each with the names it is installed under.
const X11: [&[&str]; 6] = [
    &["libX11.so.6", "libX11.so"],
    &["libX11-xcb.so.1", "libX11-xcb.so"],
    &["libxcb.so.1", "libxcb.so"],
    &["libXcursor.so.1", "libXcursor.so"],
    &["libXi.so.6", "libXi.so"],
    &["libxkbcommon-x11.so.0", "libxkbcommon-x11.so"],
];

/// Libraries of Wayland windows.
const WAYLAND: [&[&str]; 1] = [&["libwayland-client.so.0", "libwayland-client.so"]];

/// Libraries that both systems need.
const BOTH: [&[&str]; 1] = [&["libxkbcommon.so.0", "libxkbcommon.so"]];

/// Checks that a display is named in the environment and that its libraries can be loaded.
///
/// # Errors
/// Names the missing display or library.
pub(super) fn check_display_and_libraries() -> Result<(), String> {
    if matches!(env::consts::OS, "macos" | "windows") {
        return Ok(());
    }
    let named = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
    check_named_display_and_libraries(
        named("WAYLAND_DISPLAY") || named("WAYLAND_SOCKET"),
        named("DISPLAY"),
        &can_load,
    )
}

/// Checks the display that `winit` chooses: Wayland if one is named, else X11.
fn check_named_display_and_libraries(
    names_wayland: bool,
    names_x11: bool,
    can_load: &dyn Fn(&str) -> bool,
) -> Result<(), String> {
    let needed: &[&[&str]] = match (names_wayland, names_x11) {
        (true, _) => &WAYLAND,
        (false, true) => &X11,
        (false, false) => return Err("no display: DISPLAY and WAYLAND_DISPLAY are not set".into()),
    };
    let missing = |names: &&&[&str]| !names.iter().any(|name| can_load(name));
    match needed.iter().chain(&BOTH).find(missing) {
        None => Ok(()),
        Some(names) => Err(format!("{} is missing", names[0])),
    }
}

fn can_load(name: &str) -> bool {
    // SAFETY: these are the system's window libraries, whose initialisers do nothing but set
    // themselves up; `winit` would load the same ones.
    unsafe { libloading::Library::new(name) }.is_ok()
}

#[cfg(test)]
mod tests {
    use super::check_named_display_and_libraries;

    #[test]
    fn what_is_missing_is_named() {
        let all = |_: &str| true;
        assert_eq!(check_named_display_and_libraries(true, false, &all), Ok(()));
        assert_eq!(check_named_display_and_libraries(false, true, &all), Ok(()));
        assert!(
            check_named_display_and_libraries(false, false, &all)
                .expect_err("no display")
                .contains("DISPLAY")
        );
        let no_xkb = |name: &str| !name.starts_with("libxkbcommon-x11");
        assert_eq!(check_named_display_and_libraries(true, true, &no_xkb), Ok(()));
        let why =
            check_named_display_and_libraries(false, true, &no_xkb).expect_err("it is needed");
        assert_eq!(why, "libxkbcommon-x11.so.0 is missing");
        let unversioned = |name: &str| name.ends_with(".so");
        assert_eq!(check_named_display_and_libraries(true, false, &unversioned), Ok(()));
        let no_common = |name: &str| !name.starts_with("libxkbcommon.so");
        assert!(check_named_display_and_libraries(true, false, &no_common).is_err());
    }
}
