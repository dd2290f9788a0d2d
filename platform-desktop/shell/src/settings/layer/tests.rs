use std::fs;
use std::path::PathBuf;

use super::{FilePlace, MAX_BYTES, SettingsLayer};

fn parse(text: &str) -> SettingsLayer {
    SettingsLayer::parse_toml("s", text, &[])
}

/// Returns the faults as they are reported.
fn told(layer: &SettingsLayer) -> Vec<String> {
    layer.faults.iter().map(|fault| fault.describe(&layer.source)).collect()
}

#[test]
fn values_are_taken_with_their_places() {
    let layer =
        parse("\u{feff}# for the fair\r\nsize = 256\r\n\tmode = 'owl' # thin\nrecord=\"ä.trace\"");
    assert_eq!(told(&layer), [""; 0]);
    let set: Vec<_> = layer
        .entries
        .iter()
        .map(|entry| format!("{} {} {}", entry.setting.name, entry.value, entry.place.unwrap()))
        .collect();
    assert_eq!(set, ["size 256 2:8", "mode \"owl\" 3:9", "record \"ä.trace\" 4:8"]);
    assert!(parse("").entries.is_empty() && parse("").faults.is_empty());
}

#[test]
fn what_is_wrong_costs_its_setting_alone() {
    for (text, line) in [
        ("mode = \"cubes\"", "s:1:8: mode = \"cubes\", expected free, creative or one of"),
        ("mode = 3", "s:1:8: mode = 3, expected free"),
        ("\n steady_mm = 41", "s:2:14: steady_mm = 41, expected a whole number from 0 to 40"),
        ("steady_mm = 4.5", "s:1:13: steady_mm = a number with a point, expected a whole number"),
        ("steady_mm = 99999999999999999999", "s:1:13: steady_mm = a number that long, expected"),
        ("steady_mm = -1", "s:1:13: steady_mm = -1, expected"),
        ("steady_mm = \"4\"", "s:1:13: steady_mm = \"4\", expected"),
        ("size = 512", "s:1:8: size = 512, expected 128 or 256"),
        ("submit_depth = 1", "s:1:16: submit_depth = 1, expected true or false"),
        ("foveation = [\"off\"]", "s:1:13: foveation = a list, expected one of \"auto\", \"off\""),
        ("record = \"\"", "s:1:10: record = \"\", expected a file's path"),
        ("record = \"a\\u001b[2J\"", "s:1:10: record = \"a\\u001B[2J\", expected a file's path"),
        ("size.x = 1", "s:1:1: size = a table, expected 128 or 256"),
        ("rate = 90", "s:1:1: rate: there is no such setting; is refresh_rate_hz meant?"),
        ("a.b = 90", "s:1:1: a: there is no such setting; expected one of size, mode, "),
        ("'a\x09' = 90", "s:1:1: a\\t: there is no such setting; expected one of"),
        ("[steady]\nx = 1", "s:1:2: steady: there is no such setting; is steady_mm meant?"),
    ] {
        let layer = parse(&format!("{text}\n"));
        let told = told(&layer);
        assert!(told.len() == 1 && told[0].starts_with(line), "{text}: {told:?}, not {line}");
        assert!(layer.entries.is_empty() && !layer.faults[0].costs_layer, "{text}");
        assert_eq!(told[0].lines().count(), 1);
        // Valid settings before the fault are used.
        let layer = parse(&format!("kiosk = true\n{text}\n"));
        assert_eq!((layer.entries.len(), layer.faults.len()), (1, 1), "{text}");
    }
}

#[test]
fn a_file_that_is_no_toml_counts_for_nothing() {
    for (text, line) in [
        ("kiosk = true\nsize 256", "s:2:6: "),
        ("kiosk = true\nkiosk = true", "s:2:1: no TOML: duplicate key"),
        ("kiosk = true\nmode = \"owl", "s:2:12: "),
        ("kiosk = true\n--rate 90", "s:2:8: "),
        ("kiosk = true\n\x1b[2J = 1", "s:2:2: "),
    ] {
        let layer = parse(text);
        let told = told(&layer);
        assert!(told[0].starts_with(line), "{told:?}, not {line}");
        assert!(told[0].contains(": no TOML: "), "{told:?}");
        assert!(layer.entries.is_empty() && layer.faults[0].costs_layer && told.len() == 1);
        assert!(!told[0].chars().any(char::is_control), "{told:?}");
    }
}

#[test]
fn texts_of_a_console_are_checked_like_a_file() {
    let texts = [("size", "256"), ("submit_depth", "true"), ("steady_mm", "41"), ("sise", "1")];
    let layer = SettingsLayer::from_texts("managed", texts, &[]);
    assert_eq!(layer.entries.len(), 2);
    assert_eq!(
        told(&layer),
        [
            "managed: steady_mm = 41, expected a whole number from 0 to 40",
            "managed: sise: there is no such setting; is size meant?"
        ]
    );
}

#[test]
fn what_is_no_text_of_that_length_is_told() {
    let folder = std::env::temp_dir().join(format!("paros-settings-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let path: PathBuf = folder.join("paros.toml");
    let read = || SettingsLayer::read_file(&path, &[]);
    assert!(read().is_none(), "it isn't there");
    let why = |expected: &str| {
        let layer = read().expect("there is something");
        let told = told(&layer).concat();
        let line = format!("{}: {expected}", path.display());
        assert!(layer.entries.is_empty() && told == line, "{told}, not {line}");
    };
    fs::write(&path, b"kiosk = true\n\xff").unwrap();
    why("line 2 is no UTF-8, expected settings as TOML");
    // Of a file of a terabyte only the needed part is read.
    fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
    why("it is longer than 65536 bytes, expected settings as TOML");
    let longest = "kiosk = true".to_owned() + &" ".repeat(MAX_BYTES as usize - 12);
    fs::write(&path, &longest).unwrap();
    assert_eq!(read().unwrap().entries.len(), 1);
    fs::write(&path, longest + " ").unwrap();
    why("it is longer than 65536 bytes, expected settings as TOML");
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    why("it is not a regular file");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn places_count_characters() {
    let place = |offset| super::find_place("äb\nc", offset);
    assert_eq!(place(2), FilePlace { line: 1, column: 2 });
    assert_eq!(place(4), FilePlace { line: 2, column: 1 });
    // Within a character, or beyond the end: no panic.
    assert_eq!(place(1).line, 2);
    assert_eq!(place(99), FilePlace { line: 2, column: 2 });
}
