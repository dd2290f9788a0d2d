//! The settings file, and a console's texts by setting name: errors have one line and a place within the
//! file, and the accepted settings are unchanged by a round trip.

use std::collections::HashSet;
use std::fmt::Write;

use paros_shell::settings::table::SETTINGS;
use paros_shell::settings::value::SettingKind;
use paros_shell::settings::{LoadedSettings, MAX_BYTES, Settings, SettingsLayer};

use crate::engine::FuzzTarget;

pub(super) const SETTINGS_FILE: FuzzTarget = FuzzTarget {
    name: "settings",
    seeds,
    words: &[
        b"size = 256\n",
        b"mode = 'owl'\n",
        b"mode = \"lion\"\n",
        b"handover_seconds = 120\n",
        b"record = 'a.trace'\n",
        b"refresh_rate_hz = 90\n",
        b"submit_depth = true\n",
        b"sound_percent = 40\n",
        b"foveation = \"medium\"\n",
        b"steady_mm = 0x14\n",
        b"visits = true\n",
        b"languages = ['greek']\n",
        b"starts = ['lion', 'owl']\n",
        b"badge_least_seconds = 61\n",
        b"staff_pin = '0420'\n",
        b"kiosk",
        b"[a]",
        b"[[a]]",
        b"{ a = 1 }",
        b"\"\"\"",
        b"'''",
        b"\\u001b",
        b"\\n",
        b"1979-05-27",
        b"1e-50",
        b"inf",
        b"99999999999999999999",
        b"=",
        b"#",
        b".",
        b"\r\n",
        b"\xef\xbb\xbf",
        b"\xc2\x85",
    ],
    longest: 4096,
    runs: 3000,
    run: |bytes| {
        let layer = SettingsLayer::parse_bytes("file", bytes, &own_figures());
        check_layer(bytes, &layer) + &check_texts(bytes)
    },
};

fn seeds() -> Vec<Vec<u8>> {
    let texts: [&[u8]; 9] = [
        b"\xef\xbb\xbf# for the fair\r\nrefresh_rate_hz = 90\r\n\tsubmit_depth = true # half\r\nfoveation = 'medium'\r\n",
        b"handover_seconds = 120\nmode = \"creative\"\nsize = 256\nrecord = \"own.trace\"\n",
        b"mode = \"lion\"\nsteady_mm = 0x14\nkiosk = true\nkiosk_seconds = 6_0\n",
        b"mode = \"cubes\"\nrate = 90\n[steady]\nmm = 1.5\n",
        b"a.b.c = [1, {x = 2}]\nrecord = \"\"\"a\nb\"\"\"\n",
        b"visits = true\nmode = 'cat'\nstarts = ['owl', 'lion']\nbadge_least_seconds = 61\nkiosk_seconds = 60\n",
        b"visits = true\nlanguages = ['greek', 'english']\nsession_seconds = 0\nstaff_pin = '0420'\nbadges = false\n",
        b"size = 128\nsize = 256\n",
        b"kiosk = true\n\xff",
    ];
    texts.map(<[u8]>::to_vec).into()
}

fn own_figures() -> Vec<String> {
    vec!["lion".into()]
}

/// Checks a layer read from a file's bytes. Returns its findings without text of the file.
fn check_layer(bytes: &[u8], layer: &SettingsLayer) -> String {
    assert!(bytes.len() as u64 <= MAX_BYTES);
    let names: HashSet<_> = layer.entries.iter().map(|entry| entry.setting.name).collect();
    assert_eq!(names.len(), layer.entries.len(), "each is set once");
    let mut found = String::new();
    for fault in &layer.faults {
        assert!(!fault.why.chars().any(char::is_control), "{:?}", fault.why);
        assert!(!fault.costs_layer || (layer.entries.is_empty() && layer.faults.len() == 1));
        if let Some(place) = fault.place {
            let lines = bytes.split(|byte| *byte == b'\n').count();
            assert!(
                (1..=lines).contains(&place.line) && place.column >= 1,
                "{place} of {lines} lines"
            );
        }
        let setting = fault.setting.map_or("", |setting| setting.name);
        let _ = write!(found, "{setting} {}", fault.why.rsplit(", expected").next().unwrap_or(""));
    }
    let loaded = LoadedSettings::merge(std::slice::from_ref(layer));
    assert_eq!(loaded.faults.len(), layer.faults.len() + loaded.contradictions.len());
    assert!(loaded.log_lines().all(|line| !line.chars().any(char::is_control)));
    check_written_again(&loaded);
    names.iter().for_each(|name| found += name);
    found
}

/// Asserts that the settings, written as TOML, are read back unchanged, except for a PIN, which is never
/// written.
fn check_written_again(loaded: &LoadedSettings) {
    let mut text = String::new();
    for (setting, origin) in
        SETTINGS.iter().zip(&loaded.origins).filter(|(_, origin)| origin.is_set)
    {
        if setting.kind == SettingKind::Pin {
            assert_eq!(origin.value, "set");
        } else {
            let _ = writeln!(text, "{} = {}", setting.name, origin.value);
        }
    }
    let again = SettingsLayer::parse_toml("again", &text, &own_figures());
    assert!(again.faults.is_empty(), "{text}: {:?}", again.faults);
    let mut expected = loaded.settings.clone();
    expected.visits.iter_mut().for_each(|visits| visits.staff_pin = None);
    assert_eq!(LoadedSettings::merge(&[again]).settings, expected, "{text}");
}

/// Uses the bytes as a console's text for each setting: the text is accepted or reported, and changes no
/// other setting.
fn check_texts(bytes: &[u8]) -> String {
    let Ok(text) = std::str::from_utf8(bytes) else { return String::new() };
    let texts = SETTINGS.iter().map(|setting| (setting.name, text)).chain([(text, text)]);
    let layer = SettingsLayer::from_texts("console", texts, &own_figures());
    // If a name occurs twice, the last value counts.
    let set_or_told = layer.entries.len() + layer.faults.len();
    assert!(set_or_told >= SETTINGS.len(), "{layer:?}");
    let loaded = LoadedSettings::merge(std::slice::from_ref(&layer));
    assert!(loaded.faults.iter().all(|fault| !fault.chars().any(char::is_control)));
    if layer.entries.is_empty() {
        assert_eq!(loaded.settings, Settings::default());
    }
    check_written_again(&loaded);
    layer.entries.iter().map(|entry| entry.setting.name).collect()
}
