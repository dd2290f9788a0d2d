//! Removes the source location from `winit`'s operating-system errors: it is a path on the build machine.

use core::fmt::Display;

/// `winit`'s text before a source location; `FILE:LINE: ` and the error follow.
const PLACE: &str = "os error at ";

/// Returns the text of `winit`'s error, without the source location.
#[must_use]
pub(super) fn strip_source_location(error: &dyn Display) -> String {
    let text = error.to_string();
    let stripped = text.split_once(PLACE).and_then(|(before, after)| {
        let (_, what) = after.match_indices(": ").find_map(|(at, _)| {
            let (place, what) = after.split_at(at);
            let (file, line) = place.rsplit_once(':')?;
            line.parse::<u32>().is_ok().then_some((file, &what[2..]))
        })?;
        Some(format!("{before}{what}"))
    });
    stripped.unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::strip_source_location;

    #[test]
    fn the_place_in_the_source_is_left_out() {
        for (said, told) in [
            ("os error at /home/a b/winit: x/src/x11/mod.rs:775: no server: 7", "no server: 7"),
            ("os error at C:\\src\\mod.rs:12: lost", "lost"),
            ("the loop: os error at mod.rs:1: it ended", "the loop: it ended"),
            ("os error at nowhere", "os error at nowhere"),
            ("EventLoop can't be recreated", "EventLoop can't be recreated"),
        ] {
            assert_eq!(strip_source_location(&said), told);
        }
    }
}
