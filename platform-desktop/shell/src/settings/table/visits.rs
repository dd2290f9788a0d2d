//! The settings of visits: whether there are any, their times, and what they offer.

use paros_core::badge::Language;
use paros_core::visit::PlanSetting;

use super::{Setting, SettingScope};
use crate::settings::Settings;
use crate::settings::value::{SettingDefault, SettingKind, SettingValue};
use crate::settings::visits::{MAX_STARTS, VisitSettings, VisitStart};

/// The setting's words for [`Language`], by number.
pub(super) const LANGUAGE_WORDS: [&str; Language::ALL.len()] = ["english", "greek"];

/// The rows. The first one, `visits`, creates the settings in which the others are stored.
pub(super) const VISIT_ROWS: [Setting; 20] = [
    Setting {
        name: "visits",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(false),
        scope: SettingScope::Both,
        summary: "Sessions are visits of an exhibition, from the attract screen to the badge.",
        reason: "at home nobody is to be welcomed, timed or handed over",
        store: |settings, value| {
            settings.visits = (value == SettingValue::Switch(true)).then(VisitSettings::unset);
        },
    },
    Setting {
        name: "welcome_seconds",
        kind: SettingKind::Whole { least: 5, most: 120 },
        default: default_of(PlanSetting::Welcome),
        scope: SettingScope::Both,
        summary: "In visits: seconds of the welcome (language, hand, standing or seated), after which what stands is taken.",
        reason: "enough to read it in a second language; who presses nothing still gets to sculpt",
        store: |settings, value| set_plan(settings, PlanSetting::Welcome, &value),
    },
    Setting {
        name: "choice_seconds",
        kind: SettingKind::Whole { least: 5, most: 300 },
        default: default_of(PlanSetting::Choice),
        scope: SettingScope::Both,
        summary: "In visits: seconds of the choice of a start, after which the one that stands is taken.",
        reason: "a few pictures are looked at in half a minute; beyond five minutes nobody chooses any more",
        store: |settings, value| set_plan(settings, PlanSetting::Choice, &value),
    },
    Setting {
        name: "guided_seconds",
        kind: SettingKind::Whole { least: 0, most: 300 },
        default: default_of(PlanSetting::Guided),
        scope: SettingScope::Both,
        summary: "In visits: seconds of the guided first cut at most; 0 leaves it out.",
        reason: "its steps take most people less, and who is stuck shall sculpt all the same",
        store: |settings, value| set_plan(settings, PlanSetting::Guided, &value),
    },
    Setting {
        name: "session_seconds",
        kind: SettingKind::ZeroOr { least: 60, most: 7200 },
        default: default_of(PlanSetting::Length),
        scope: SettingScope::Both,
        summary: "In visits: seconds of sculpting, from the first cut or the end of the guided one; 0 for no clock.",
        reason: "ten minutes make a sculpture and a queue that moves; under a minute there is none; 0 is for days without a queue",
        store: |settings, value| set_plan(settings, PlanSetting::Length, &value),
    },
    Setting {
        name: "idle_seconds",
        kind: SettingKind::Whole { least: 30, most: 3600 },
        default: default_of(PlanSetting::Idle),
        scope: SettingScope::Both,
        summary: "In visits without a clock: after so many seconds without use the sculpting is over.",
        reason: "who looks closely is still for a minute; a clock, where there is one, ends a session anyway",
        store: |settings, value| set_plan(settings, PlanSetting::Idle, &value),
    },
    Setting {
        name: "off_before_cut_seconds",
        kind: SettingKind::Whole { least: 3, most: 300 },
        default: default_of(PlanSetting::OffBeforeCut),
        scope: SettingScope::Both,
        summary: "In visits: seconds off the head, or unmoved, before the first cut, after which the visitor has gone.",
        reason: "nothing is lost yet, and a strap is adjusted in less",
        store: |settings, value| set_plan(settings, PlanSetting::OffBeforeCut, &value),
    },
    Setting {
        name: "off_sculpting_seconds",
        kind: SettingKind::Whole { least: 5, most: 600 },
        default: default_of(PlanSetting::OffSculpting),
        scope: SettingScope::Both,
        summary: "In visits: seconds off the head, or unmoved, while there is a sculpture, after which the visitor has gone; it is finished and kept.",
        reason: "glasses are cleaned and a child is answered in less; the next one shall not wait for long",
        store: |settings, value| set_plan(settings, PlanSetting::OffSculpting, &value),
    },
    Setting {
        name: "off_after_seconds",
        kind: SettingKind::Whole { least: 1, most: 120 },
        default: default_of(PlanSetting::OffAfter),
        scope: SettingScope::Both,
        summary: "In visits: seconds off the head, or unmoved, once the sculpture is final, after which the visitor has gone.",
        reason: "nothing is left to come back for, but a glance under the headset is no farewell",
        store: |settings, value| set_plan(settings, PlanSetting::OffAfter, &value),
    },
    Setting {
        name: "hands_off_seconds",
        kind: SettingKind::Whole { least: 1, most: 30 },
        default: default_of(PlanSetting::HandsOff),
        scope: SettingScope::Both,
        summary: "In visits: seconds of hands off at least, before the sculpture is final.",
        reason: "a last look, and time for the staff to give a minute more; loose stone falls meanwhile",
        store: |settings, value| set_plan(settings, PlanSetting::HandsOff, &value),
    },
    Setting {
        name: "export_seconds",
        kind: SettingKind::Whole { least: 5, most: 300 },
        default: default_of(PlanSetting::Export),
        scope: SettingScope::Both,
        summary: "In visits: seconds after which a sculpture that is still being exported is left to the background.",
        reason: "nobody shall stand and wait for longer; a slow disk doesn't hold up the queue",
        store: |settings, value| set_plan(settings, PlanSetting::Export, &value),
    },
    Setting {
        name: "badge_least_seconds",
        kind: SettingKind::Whole { least: 0, most: 120 },
        default: default_of(PlanSetting::BadgeLeast),
        scope: SettingScope::Both,
        summary: "In visits: seconds for which the badge is shown at least; not more than `badge_most_seconds`.",
        reason: "who presses on without looking has no badge to ask for the print by",
        store: |settings, value| set_plan(settings, PlanSetting::BadgeLeast, &value),
    },
    Setting {
        name: "badge_most_seconds",
        kind: SettingKind::Whole { least: 10, most: 600 },
        default: default_of(PlanSetting::BadgeMost),
        scope: SettingScope::Both,
        summary: "In visits: seconds for which the badge is shown at most.",
        reason: "it is written down or photographed in a minute; then it is nobody else's to see",
        store: |settings, value| set_plan(settings, PlanSetting::BadgeMost, &value),
    },
    Setting {
        name: "thanks_seconds",
        kind: SettingKind::Whole { least: 5, most: 300 },
        default: default_of(PlanSetting::Thanks),
        scope: SettingScope::Both,
        summary: "In visits: seconds of thanks at most.",
        reason: "the headset comes off meanwhile, or a window's next visitor begins, which ends them; a minute where neither is told",
        store: |settings, value| set_plan(settings, PlanSetting::Thanks, &value),
    },
    Setting {
        name: "ready_seconds",
        kind: SettingKind::Whole { least: 1, most: 300 },
        default: default_of(PlanSetting::Handover),
        scope: SettingScope::Both,
        summary: "In visits: seconds for which the staff is told that the headset is ready for the next visitor.",
        reason: "enough to see it from the other end of a booth; who puts it on is welcome at once",
        store: |settings, value| set_plan(settings, PlanSetting::Handover, &value),
    },
    Setting {
        name: "badges",
        kind: SettingKind::Switch,
        default: SettingDefault::Switch(PlanSetting::Badges.default_value() != 0),
        scope: SettingScope::Both,
        summary: "In visits: a finished sculpture gets a badge, by which its visitor finds it again.",
        reason: "without one nobody can tell whose a print is; off where nothing is printed or shown",
        store: |settings, value| {
            let is_on = SettingValue::Number((value == SettingValue::Switch(true)).into());
            set_plan(settings, PlanSetting::Badges, &is_on);
        },
    },
    Setting {
        name: "languages",
        kind: SettingKind::WordList(&LANGUAGE_WORDS),
        default: SettingDefault::Words(&LANGUAGE_WORDS),
        scope: SettingScope::Both,
        summary: "In visits: the languages to choose from, in this order; the first is that of whoever chooses none.",
        reason: "all that there are; one alone leaves nothing to choose, and the place decides which is the first",
        store: |settings, value| {
            if let (Some(visits), SettingValue::Words(words)) = (&mut settings.visits, value) {
                visits.languages = words.into_iter().filter_map(find_language).collect();
            }
        },
    },
    Setting {
        name: "starts",
        kind: SettingKind::ModeList { most: MAX_STARTS },
        default: SettingDefault::Words(&["free", "owl", "creative"]),
        scope: SettingScope::Both,
        summary: "In visits: the ways to start that are on offer, in this order. Where nothing is chosen it is `mode`, which must be one of them, or the first where `mode` isn't set.",
        reason: "one of each kind: stone alone, something to find in it, a shape to go on from; four fit in a row, eight in two",
        store: |settings, value| {
            if let (Some(visits), SettingValue::Modes(modes)) = (&mut settings.visits, value) {
                let start = |(name, mode)| VisitStart { name, mode };
                visits.starts = modes.into_iter().map(start).collect();
            }
        },
    },
    Setting {
        name: "staff_pin",
        kind: SettingKind::Pin,
        default: SettingDefault::Unset("none"),
        scope: SettingScope::Both,
        summary: "In visits: the four digits that open the staff's panel in the headset; without them it can't be opened. Nothing prints them.",
        reason: "a PIN that stood here would be everybody's; four digits stop who tries keys, not thieves",
        store: |settings, value| {
            if let (Some(visits), SettingValue::Pin(pin)) = (&mut settings.visits, value) {
                visits.staff_pin = Some(pin);
            }
        },
    },
    Setting {
        name: "email_from_age",
        kind: SettingKind::ZeroOr { least: 13, most: 18 },
        default: SettingDefault::Whole(16),
        scope: SettingScope::Booth,
        summary: "At the booth: the age in years from which a visitor may leave an e-mail address for the sculpture; 0 where nobody may. Headset and window ask for none.",
        reason: "below it the law wants a parent's word (GDPR, article 8: 16, or 13 at least where a state says so); from 18 on it asks nothing more",
        store: |settings, value| {
            if let (Some(visits), Some(age)) = (&mut settings.visits, value.number()) {
                visits.email_from_age = age;
            }
        },
    },
];

/// Returns the core's default of a plan setting.
const fn default_of(setting: PlanSetting) -> SettingDefault {
    SettingDefault::Whole(setting.default_value() as u32)
}

fn set_plan(settings: &mut Settings, setting: PlanSetting, value: &SettingValue) {
    let value = value.number().and_then(|number| u16::try_from(number).ok());
    if let (Some(visits), Some(value)) = (&mut settings.visits, value) {
        visits.plan.set_value(setting, value);
    }
}

fn find_language(word: &str) -> Option<Language> {
    let number = LANGUAGE_WORDS.iter().position(|other| *other == word)?;
    Language::ALL.get(number).copied()
}
