//! The settings of the connection to a booth: what is sent, and how long it is kept here.

use super::{Setting, SettingScope};
use crate::settings::value::{SettingDefault, SettingKind, SettingValue};

pub(super) const BOOTH_ROWS: [Setting; 4] = [
    Setting {
        name: "booth_enrolment",
        kind: SettingKind::Path,
        default: SettingDefault::Unset(
            "enrolment.toml beside the saved sessions, as `paros enrol` writes it",
        ),
        scope: SettingScope::Both,
        summary: "At a booth: the file that an enrolment left. Where there is none nothing is sent. A relative path is one in the \
            folder of saved sessions.",
        reason: "by it the booth knows the device, so it lies where nobody else reads",
        store: |settings, value| {
            if let SettingValue::Path(path) = value {
                settings.booth.enrolment = Some(path);
            }
        },
    },
    Setting {
        name: "booth_traces",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(false),
        scope: SettingScope::Both,
        summary: "At a booth: the trace of a visit is sent with its sculpture, where the recording is of that visit alone.",
        reason: "a trace is how a visitor's hands moved, which is personal: only where visitors are asked",
        store: |settings, value| settings.booth.sends_traces = value == SettingValue::Switch(true),
    },
    Setting {
        name: "booth_grace_days",
        kind: SettingKind::Whole { least: 0, most: 365 },
        default: SettingDefault::Whole(3),
        scope: SettingScope::Both,
        summary: "At a booth: days for which a sculpture stays in the device once the booth has it.",
        reason: "a weekend, should the booth's disk fail on a Friday; a device that others get shall not keep them for long",
        store: |settings, value| settings.booth.grace_days = value.number().unwrap_or(0),
    },
    Setting {
        name: "booth_space_mb",
        kind: SettingKind::Whole { least: 64, most: 65_536 },
        default: SettingDefault::Whole(1024),
        scope: SettingScope::Both,
        summary: "At a booth: megabytes that sculptures on their way may take in the device. Who hands it over is told when it is \
            nearly full.",
        reason: "many times what five days of visits without the booth take, with traces; what the booth has makes room first",
        store: |settings, value| settings.booth.space_mb = value.number().unwrap_or(0),
    },
];
