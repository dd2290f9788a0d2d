use std::fs;
use std::path::Path;
use std::time::Duration;

use paros_core::session::SessionMode;

use super::table::{SETTINGS, Setting};
use super::{BoothSettings, LoadedSettings, Settings, SettingsLayer};
use crate::headset::foveation::FoveationLevel;

fn file(text: &str) -> SettingsLayer {
    SettingsLayer::parse_toml("f", text, &[])
}

#[test]
fn the_defaults_are_those_that_hold_without_a_file() {
    let expected = Settings {
        size: None,
        mode: SessionMode::FreeForm,
        handover_after: Duration::from_secs(45),
        steady_mm: 0,
        snap_heights: true,
        refresh_rate_hz: 72,
        foveation: None,
        least_resolution_percent: 85,
        samples: 4,
        submit_depth: false,
        sound_percent: 70,
        record: None,
        kiosk: false,
        kiosk_handover_after: Duration::from_secs(90),
        visits: None,
        booth: BoothSettings {
            enrolment: None,
            sends_traces: false,
            grace_days: 3,
            space_mb: 1024,
        },
    };
    assert_eq!(Settings::default(), expected);
    let loaded = LoadedSettings::merge(&[]);
    assert_eq!(loaded.log_lines().count(), 0);
    assert!(loaded.origins.iter().all(|origin| origin.to_string() == "default"));
}

#[test]
fn every_setting_has_a_place_of_its_own() {
    let text = "size = 256\nmode = \"cat\"\nhandover_seconds = 120\nsteady_mm = 20\nsnap_heights = false\n\
        refresh_rate_hz = 90\nfoveation = \"medium\"\nleast_resolution_percent = 90\nsamples = 2\nsubmit_depth = true\nsound_percent = 0\nrecord = \"a\"\n\
        kiosk = true\nkiosk_seconds = 60\nbooth_enrolment = \"e\"\nbooth_traces = true\n\
        booth_grace_days = 0\nbooth_space_mb = 64\n";
    // The settings of visits have their own test.
    let visits = |setting: &&Setting| setting.name == "visits" || setting.name == "email_from_age";
    let [first, last] =
        [SETTINGS.iter().position(|s| visits(&s)), SETTINGS.iter().rposition(|s| visits(&s))];
    let of_visits = last.zip(first).map_or(0, |(last, first)| last + 1 - first);
    assert_eq!(text.lines().count(), SETTINGS.len() - of_visits);
    let expected = Settings {
        size: Some(256),
        mode: SessionMode::Constrained { figure: 9 },
        handover_after: Duration::from_secs(120),
        steady_mm: 20,
        snap_heights: false,
        refresh_rate_hz: 90,
        foveation: Some(FoveationLevel::Medium),
        least_resolution_percent: 90,
        samples: 2,
        submit_depth: true,
        sound_percent: 0,
        record: Some("a".into()),
        kiosk: true,
        kiosk_handover_after: Duration::from_secs(60),
        visits: None,
        booth: BoothSettings {
            enrolment: Some("e".into()),
            sends_traces: true,
            grace_days: 0,
            space_mb: 64,
        },
    };
    assert_eq!(LoadedSettings::merge(&[file(text)]).settings, expected);
    // Each line changes a setting from its default.
    for line in text.lines() {
        assert_ne!(LoadedSettings::merge(&[file(line)]).settings, Settings::default(), "{line}");
    }
}

#[test]
fn a_later_layer_wins_setting_by_setting() {
    let baked =
        SettingsLayer::parse_toml("baked", "size = 256\nsteady_mm = 10\nmode = \"owl\"", &[]);
    let file = file("steady_mm = 20\nmode = \"cubes\"");
    let managed =
        SettingsLayer::from_texts("managed", [("handover_seconds", "60"), ("size", "128")], &[]);
    let loaded = LoadedSettings::merge(&[baked, file, managed]);
    let Settings { size, steady_mm, mode, handover_after, .. } = loaded.settings;
    assert_eq!((size, steady_mm), (Some(128), 20));
    assert_eq!((mode, handover_after.as_secs()), (SessionMode::Constrained { figure: 8 }, 60));
    let from: Vec<_> = loaded.origins.iter().take(4).map(ToString::to_string).collect();
    assert_eq!(from, ["managed", "baked:3:8", "managed", "f:1:13"]);
    assert_eq!(
        loaded.told,
        [
            "baked: size = 256, steady_mm = 10, mode = \"owl\"",
            "f: steady_mm = 20",
            "managed: handover_seconds = 60, size = 128"
        ]
    );
    let fault = &loaded.faults[0];
    assert!(fault.starts_with("f:2:8: mode = \"cubes\", expected free"), "{fault}");
    assert!(fault.ends_with("; \"owl\" holds (baked:3:8)"), "{fault}");
}

#[test]
fn faults_say_what_holds_all_the_same() {
    let faults = |text: &str| LoadedSettings::merge(&[file(text)]).faults.concat();
    let told = faults("handover_seconds = 0");
    assert!(told.ends_with("expected a whole number from 1 to 3600; 45 holds (default)"), "{told}");
    assert!(faults("size = 1").ends_with(
        "; 128 in a headset; in a window 256 if it is drawn fast enough holds (default)"
    ));
    assert!(faults("kiosk").ends_with("; it counts for nothing"));
    assert!(faults("kiosc = true").ends_with("is kiosk meant?"));
    // A file with only faults is not logged as setting nothing.
    assert_eq!(LoadedSettings::merge(&[file("size = 1")]).told, [""; 0]);
    assert_eq!(LoadedSettings::merge(&[file("# nothing")]).told, ["f: no settings"]);
}

#[test]
fn a_trace_that_cannot_be_written_is_told_before_the_sculpting() {
    let folder = std::env::temp_dir().join(format!("paros-record-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("paros.toml"), "").unwrap();
    let resolve = |record: &str| {
        let mut loaded = LoadedSettings::merge(&[file(&format!("record = \"{record}\""))]);
        loaded.resolve_record(&folder, &[]);
        (loaded.settings.record, loaded.faults.concat())
    };
    assert_eq!(resolve("own.trace"), (Some(folder.join("own.trace")), String::new()));
    for (record, why) in [
        ("none/own.trace", "none/own.trace: cannot "),
        ("paros.toml", "it is the file of settings, expected another"),
        ("./paros.toml", "it is the file of settings, expected another"),
    ] {
        let (path, told) = resolve(record);
        assert!(path.is_none() && told.contains(why), "{told}");
        assert!(told.starts_with("record: ") && told.ends_with("; nothing is recorded"), "{told}");
    }
    let left: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, [Path::new("paros.toml")]);
    fs::remove_dir_all(&folder).unwrap();
}
