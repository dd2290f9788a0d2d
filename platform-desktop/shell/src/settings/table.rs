//! The table of all settings: name, kind, default, scope, and reason.
//!
//! Everything else about settings is generated from it: the validation, the template, `SETTINGS.md`, and
//! Android's list of restrictions.

mod booth;
mod visits;

use std::path::PathBuf;
use std::time::Duration;

use paros_core::limits::MAX_STRING_MM;
use paros_core::session::TICK_RATE;

use super::Settings;
use super::value::{SettingDefault, SettingKind, SettingValue};
use crate::headset::foveation::FoveationLevel;
use crate::headset::resolution::LEAST_PERCENT;
use crate::headset::visit::DEFAULT_HANDOVER;
use crate::sizes::GRID_SIDES;
use booth::BOOTH_ROWS;
use visits::VISIT_ROWS;

/// The program that uses a setting. The other programs check the setting and ignore it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingScope {
    /// The headset.
    Headset,
    /// The window.
    Window,
    /// Both the headset and the window.
    Both,
    /// The booth, at which visitors ask for their sculptures.
    Booth,
}

/// A setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The key in the file and in managed configuration.
    pub name: &'static str,
    /// The kind of its value.
    pub kind: SettingKind,
    /// The default.
    pub default: SettingDefault,
    /// The program that uses it.
    pub scope: SettingScope,
    /// The description, a sentence for people who run an exhibition.
    pub summary: &'static str,
    /// The reason for its default and its bounds.
    pub reason: &'static str,
    /// Stores a value of its kind in the settings.
    pub(super) store: fn(&mut Settings, SettingValue),
}

/// The words of [`FoveationLevel`], after `auto` for no level.
const FOVEATION_WORDS: [&str; 5] = ["auto", "off", "low", "medium", "high"];

/// All settings: those of the studio, of visits, and of the connection to a booth.
pub static SETTINGS: [Setting; VISITS_FROM + VISIT_ROWS.len() + BOOTH_ROWS.len()] = {
    let mut all = [STUDIO_ROWS[0]; VISITS_FROM + VISIT_ROWS.len() + BOOTH_ROWS.len()];
    let mut i = 1;
    while i < all.len() {
        all[i] = match (i.checked_sub(VISITS_FROM), i.checked_sub(BOOTH_FROM)) {
            (_, Some(row)) => BOOTH_ROWS[row],
            (Some(row), None) => VISIT_ROWS[row],
            (None, None) => STUDIO_ROWS[i],
        };
        i += 1;
    }
    all
};

/// The indices of the first row of visits, and of the booth.
const VISITS_FROM: usize = STUDIO_ROWS.len();
const BOOTH_FROM: usize = VISITS_FROM + VISIT_ROWS.len();

const STUDIO_ROWS: [Setting; 14] = [
    Setting {
        name: "size",
        kind: SettingKind::Numbers(&GRID_SIDES_U32),
        default: SettingDefault::Unset(
            "128 in a headset; in a window 256 if it is drawn fast enough",
        ),
        scope: SettingScope::Both,
        summary: "Voxels along an edge of the block.",
        reason: "no headset has shown yet that it draws 256 at its rate; a window measures it",
        store: |settings, value| settings.size = value.number().map(|side| side as usize),
    },
    Setting {
        name: "mode",
        kind: SettingKind::Mode,
        default: SettingDefault::Word("free"),
        scope: SettingScope::Both,
        summary: "How sessions start: free, creative, or the name of a hidden figure. A window looks at it in visits \
            alone.",
        reason: "free form needs no explanation; in a window without visits the visitor chooses",
        store: |settings, value| {
            if let SettingValue::Mode(_, mode) = value {
                settings.mode = mode;
            }
        },
    },
    Setting {
        name: "handover_seconds",
        kind: SettingKind::Whole { least: 1, most: 3600 },
        default: SettingDefault::Whole(DEFAULT_HANDOVER.as_secs() as u32),
        scope: SettingScope::Headset,
        summary: "For how long the headset must be off, asleep or without motion for who uses it next to be \
            another visitor: the sculpture is finished and kept, and a new session starts.",
        reason: "who adjusts a strap is back sooner; beyond an hour nobody hands over",
        store: |settings, value| settings.handover_after = seconds(&value),
    },
    Setting {
        name: "steady_mm",
        kind: SettingKind::Whole { least: 0, most: MAX_STRING_MM as u32 },
        default: SettingDefault::Whole(0),
        scope: SettingScope::Headset,
        summary: "Steadies the hands: a running bit is drawn behind its hand on a string of so many millimetres.",
        reason: "0 steadies nothing, as a bit that lags surprises; a string beyond 40 mm rounds off corners as large as a head",
        store: |settings, value| settings.steady_mm = value.number().unwrap_or(0) as u8,
    },
    Setting {
        name: "snap_heights",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(true),
        scope: SettingScope::Headset,
        summary: "Where the room is placed for a visitor, bench and stool are 20 cm lower for eyes below 1.34 m and \
            10 cm higher for eyes from 1.68 m on; false leaves them 86 and 80 cm above the floor.",
        reason: "who sits or is tall has the stone at the height of the elbows; steps, chosen once, as a world that \
            moves by itself makes sick",
        store: |settings, value| settings.snap_heights = value == SettingValue::Switch(true),
    },
    Setting {
        name: "refresh_rate_hz",
        kind: SettingKind::Whole { least: 60, most: 144 },
        default: SettingDefault::Whole(TICK_RATE),
        scope: SettingScope::Headset,
        summary: "The display's rate that is asked for, in hertz; the nearest that it has is taken.",
        reason: "72 is a Quest's own and that of the ticks; headsets' displays have 60 to 144",
        store: |settings, value| settings.refresh_rate_hz = value.number().unwrap_or(TICK_RATE),
    },
    Setting {
        name: "foveation",
        kind: SettingKind::Words(&FOVEATION_WORDS),
        default: SettingDefault::Word("auto"),
        scope: SettingScope::Headset,
        summary: "How coarsely pictures are shaded away from their middle at least. Heat and a low battery raise \
            it, unless it is off.",
        reason: "auto is medium on a headset's GPU, and lets the runtime lower that while frames are in time; elsewhere none",
        store: |settings, value| {
            settings.foveation = value.word().and_then(FoveationLevel::from_name);
        },
    },
    Setting {
        name: "least_resolution_percent",
        kind: SettingKind::Whole { least: LEAST_PERCENT, most: 100 },
        default: SettingDefault::Whole(LEAST_PERCENT),
        scope: SettingScope::Headset,
        summary: "How much of the sides of the recommended pictures is drawn at least while frames would be late \
            otherwise.",
        reason: "below 85 edges are seen to swim, says Meta; 100 draws all of them always",
        store: |settings, value| {
            settings.least_resolution_percent = value.number().unwrap_or(LEAST_PERCENT);
        },
    },
    Setting {
        name: "samples",
        kind: SettingKind::Numbers(&[2, 4]),
        default: SettingDefault::Whole(4),
        scope: SettingScope::Headset,
        summary: "Samples of a pixel along edges; four where a GPU hasn't two.",
        reason: "four are the smoother ones, and cost a headset little as it draws in tiles",
        store: |settings, value| settings.samples = value.number().unwrap_or(4),
    },
    Setting {
        name: "submit_depth",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(false),
        scope: SettingScope::Headset,
        summary: "Gives the compositor depth too, for steadier pictures; pixels have one sample then.",
        reason: "four samples a pixel are worth more where no frame is late",
        store: |settings, value| settings.submit_depth = value == SettingValue::Switch(true),
    },
    Setting {
        name: "sound_percent",
        kind: SettingKind::Whole { least: 0, most: 100 },
        default: SettingDefault::Whole(70),
        scope: SettingScope::Both,
        summary: "How loud tools, stone and the clock are, in hundredths; 0 is off.",
        reason: "70 is half of full scale, so that others of the room can be made louder than it",
        store: |settings, value| settings.sound_percent = value.number().unwrap_or(0),
    },
    Setting {
        name: "record",
        kind: SettingKind::Path,
        default: SettingDefault::Unset("no trace is written"),
        scope: SettingScope::Both,
        summary: "A file for the trace of the last session, every input of it; in a headset the session starts anew then. A relative \
            path is one in the folder of this file, in a headset of its sessions.",
        reason: "a trace grows by half a megabyte a minute, and a visitor has a right not to be recorded",
        store: |settings, value| {
            settings.record = if let SettingValue::Path(path) = value { Some(path) } else { None };
        },
    },
    Setting {
        name: "kiosk",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(false),
        scope: SettingScope::Window,
        summary: "For visitors, one after the other: on the full screen, without files and developers' keys.",
        reason: "at home a window is a window",
        store: |settings, value| settings.kiosk = value == SettingValue::Switch(true),
    },
    Setting {
        name: "kiosk_seconds",
        kind: SettingKind::Whole { least: 30, most: 3600 },
        default: SettingDefault::Whole(90),
        scope: SettingScope::Window,
        summary: "In a kiosk: once nobody has touched it for so long, the sculpture is finished and kept, and the \
            start shown again.",
        reason: "who looks closely is still for a minute; the last 20 seconds are counted down, so 30 at least",
        store: |settings, value| settings.kiosk_handover_after = seconds(&value),
    },
];

/// The grid's sides as numbers of settings.
const GRID_SIDES_U32: [u32; GRID_SIDES.len()] = [GRID_SIDES[0] as u32, GRID_SIDES[1] as u32];

/// Returns the setting with a name.
#[must_use]
pub fn find_setting(name: &str) -> Option<&'static Setting> {
    SETTINGS.iter().find(|setting| setting.name == name)
}

/// Returns the name of the setting most similar to a word, if it is similar enough, for suggestions.
#[must_use]
pub fn nearest_name(word: &str) -> Option<&'static str> {
    let distances = SETTINGS.iter().map(|setting| {
        // A part of a name matches too: `rate`, `handover`.
        let is_part = word.len() > 2 && setting.name.split('_').any(|part| part == word);
        let distance = if is_part { 1 } else { strsim::osa_distance(word, setting.name) };
        (distance, setting.name)
    });
    let (distance, name) = distances.min()?;
    (distance <= 1 + name.len() / 4).then_some(name)
}

fn seconds(value: &SettingValue) -> Duration {
    Duration::from_secs(value.number().unwrap_or(0).into())
}

/// Returns the settings before any value is stored.
pub(super) const fn unset_settings() -> Settings {
    Settings {
        size: None,
        mode: paros_core::session::SessionMode::FreeForm,
        handover_after: Duration::ZERO,
        steady_mm: 0,
        snap_heights: false,
        refresh_rate_hz: 0,
        foveation: None,
        least_resolution_percent: 0,
        samples: 0,
        submit_depth: false,
        sound_percent: 0,
        record: None::<PathBuf>,
        kiosk: false,
        kiosk_handover_after: Duration::ZERO,
        visits: None,
        booth: super::BoothSettings::unset(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::{FOVEATION_WORDS, SETTINGS, find_setting, nearest_name};
    use crate::headset::foveation::FoveationLevel;
    use crate::settings::value::{SettingDefault, SettingKind};

    #[test]
    fn every_setting_is_whole() {
        let names: HashSet<_> = SETTINGS.iter().map(|setting| setting.name).collect();
        assert_eq!(names.len(), SETTINGS.len());
        for setting in &SETTINGS {
            let name = setting.name;
            // The name is valid as an unquoted TOML key and as an Android key.
            assert!(name.bytes().all(|c| c.is_ascii_lowercase() || c == b'_'), "{name}");
            assert!(setting.summary.ends_with('.') && !setting.reason.is_empty(), "{name}");
            if let SettingKind::Whole { least, most } = setting.kind {
                let SettingDefault::Whole(default) = setting.default else {
                    panic!("{name}: the default is no number")
                };
                assert!((least..=most).contains(&default), "{name}");
            }
        }
    }

    #[test]
    fn the_words_of_foveation_are_its_levels() {
        for word in &FOVEATION_WORDS[1..] {
            assert!(
                FoveationLevel::from_name(word).is_some_and(|level| level.to_string() == *word)
            );
        }
        assert_eq!(FOVEATION_WORDS.len(), FoveationLevel::NAMES.len() + 1);
        assert_eq!(FoveationLevel::from_name(FOVEATION_WORDS[0]), None);
    }

    #[test]
    fn a_word_near_a_name_is_taken_for_it_and_another_is_not() {
        assert!(find_setting("mode").is_some() && find_setting("Mode").is_none());
        for (word, name) in [
            ("siez", "size"),
            ("handover", "handover_seconds"),
            ("handover_second", "handover_seconds"),
            ("steady", "steady_mm"),
            ("Mode", "mode"),
            ("refresh-rate-hz", "refresh_rate_hz"),
        ] {
            assert_eq!(nearest_name(word), Some(name), "{word}");
        }
        for word in ["", "volume", "brightness", "mm", "x"] {
            assert_eq!(nearest_name(word), None, "{word}");
        }
    }
}
