use std::collections::HashSet;

use paros_core::badge::Language;
use paros_core::session::SessionMode;
use paros_core::visit::{PlanSetting, VisitCommand, VisitPlan};

use super::{MAX_STARTS, VisitSettings, plan_changes};
use crate::settings::table::{SETTINGS, SettingScope};
use crate::settings::value::{SettingDefault, SettingKind};
use crate::settings::{LoadedSettings, SettingsLayer, write_documentation, write_restrictions};

/// The time settings of visits, with the settings of the core's plan.
const TIMES: [(&str, PlanSetting); 14] = [
    ("welcome_seconds", PlanSetting::Welcome),
    ("choice_seconds", PlanSetting::Choice),
    ("guided_seconds", PlanSetting::Guided),
    ("session_seconds", PlanSetting::Length),
    ("idle_seconds", PlanSetting::Idle),
    ("off_before_cut_seconds", PlanSetting::OffBeforeCut),
    ("off_sculpting_seconds", PlanSetting::OffSculpting),
    ("off_after_seconds", PlanSetting::OffAfter),
    ("hands_off_seconds", PlanSetting::HandsOff),
    ("export_seconds", PlanSetting::Export),
    ("badge_least_seconds", PlanSetting::BadgeLeast),
    ("badge_most_seconds", PlanSetting::BadgeMost),
    ("thanks_seconds", PlanSetting::Thanks),
    ("ready_seconds", PlanSetting::Handover),
];

fn load(text: &str) -> LoadedSettings {
    LoadedSettings::merge(&[SettingsLayer::parse_toml("f", text, &[])])
}

fn load_visits(text: &str) -> VisitSettings {
    let loaded = load(&format!("visits = true\n{text}"));
    assert_eq!(loaded.faults, [""; 0]);
    loaded.settings.visits.expect("they are on")
}

/// Returns the commands that change a world's default plan to these settings.
fn commands_of(visits: &VisitSettings) -> Vec<VisitCommand> {
    plan_changes(&VisitPlan::new(), &visits.plan).collect()
}

/// Returns the value of a setting and its origin.
fn origin(loaded: &LoadedSettings, name: &str) -> String {
    let number = SETTINGS.iter().position(|setting| setting.name == name).expect("a setting");
    let origin = &loaded.origins[number];
    format!("{} {origin}", origin.value)
}

#[test]
fn the_defaults_are_the_cores_and_need_no_command() {
    let visits = load_visits("");
    assert_eq!(visits.plan, VisitPlan::new());
    assert_eq!(commands_of(&visits), []);
    assert_eq!(visits.languages, Language::ALL);
    let starts: Vec<_> = visits.starts.iter().map(|start| (&*start.name, start.mode)).collect();
    let owl = SessionMode::Constrained { figure: 8 };
    let expected =
        [("free", SessionMode::FreeForm), ("owl", owl), ("creative", SessionMode::Creative)];
    assert_eq!(starts, expected);
    assert_eq!(visits.staff_pin, None);
    assert_eq!(load("session_seconds = 60\nstaff_pin = \"0000\"").settings.visits, None);
    // The values are documented for exhibitions.
    let defaults = TIMES.map(|(name, setting)| {
        let row = SETTINGS.iter().find(|row| row.name == name).expect("a setting");
        assert_eq!(row.scope, SettingScope::Both);
        assert_eq!(row.default, SettingDefault::Whole(setting.default_value().into()), "{name}");
        setting.default_value()
    });
    assert_eq!(defaults, [20, 45, 60, 600, 90, 10, 45, 5, 3, 60, 10, 60, 60, 10]);
}

#[test]
fn each_time_sets_its_own_value_of_the_plan() {
    for (name, setting) in TIMES {
        let row = SETTINGS.iter().find(|row| row.name == name).expect("a setting");
        let (SettingKind::Whole { least, most } | SettingKind::ZeroOr { least, most }) = row.kind
        else {
            panic!("{name} is no number")
        };
        for value in [least, most] {
            let value = u16::try_from(value).expect("a plan has 16 bits");
            let mut expected = VisitPlan::new();
            expected.set_value(setting, value);
            let text = format!("{name} = {value}");
            // At its bound the least time of a badge exceeds the default of the greatest time.
            let text = if name == "badge_least_seconds" {
                format!("{text}\nbadge_most_seconds = 600")
            } else {
                text
            };
            let visits = load_visits(&text);
            assert_eq!(visits.plan.value(setting), value, "{name}");
            let commands = commands_of(&visits);
            assert!(commands.contains(&VisitCommand::Set { setting, value }), "{name}");
        }
    }
    let distinct: HashSet<_> = TIMES.iter().map(|(_, setting)| *setting as u8).collect();
    // All settings of the plan but `Badges` are times.
    assert_eq!(distinct.len() + 1, PlanSetting::ALL.len());
    assert_eq!(load_visits("session_seconds = 0").plan.value(PlanSetting::Length), 0);
    let badges = VisitCommand::Set { setting: PlanSetting::Badges, value: 0 };
    assert_eq!(commands_of(&load_visits("badges = false")), [badges]);
    assert_eq!(commands_of(&load_visits("badges = true")), []);
}

/// Only the booth uses this setting: it is in no form for headsets.
#[test]
fn an_age_for_e_mail_is_nobodys_or_one_that_a_law_may_set() {
    assert_eq!(load_visits("").email_from_age, 16);
    for age in [0, 13, 15, 18] {
        assert_eq!(load_visits(&format!("email_from_age = {age}")).email_from_age, age);
    }
    for age in ["1", "12", "19", "-1", "\"16\""] {
        let loaded = load(&format!("visits = true\nemail_from_age = {age}"));
        let expected = "f:2:18: email_from_age = ";
        assert!(loaded.faults.len() == 1 && loaded.faults[0].starts_with(expected), "{age}");
        assert_eq!(loaded.settings.visits.expect("they are on").email_from_age, 16);
    }
    assert!(!write_restrictions(&[]).restrictions.contains("email_from_age"));
    assert!(
        write_documentation()
            .contains("| `email_from_age` | 0, or a whole number from 13 to 18 | `16` | booth |")
    );
}

#[test]
fn what_an_earlier_run_set_becomes_the_default_again() {
    let set = |setting, value| VisitCommand::Set { setting, value };
    let mut plan = VisitPlan::new();
    plan.set_value(PlanSetting::Export, 30);
    plan.set_value(PlanSetting::Thanks, 9);
    let mut found = VisitPlan::new();
    found.set_value(PlanSetting::Length, 90);
    found.set_value(PlanSetting::Thanks, 9);
    let length = PlanSetting::Length.default_value();
    assert_eq!(
        plan_changes(&found, &plan).collect::<Vec<_>>(),
        [set(PlanSetting::Length, length), set(PlanSetting::Export, 30)]
    );
}

#[test]
fn commands_have_an_order_of_their_own_and_make_the_plan() {
    let text = "ready_seconds = 20\nbadges = false\nmode = \"owl\"\nwelcome_seconds = 30\nidle_seconds = 90";
    let visits = load_visits(text);
    let owl = SessionMode::Constrained { figure: 8 };
    let commands = [
        VisitCommand::SetStart(owl),
        VisitCommand::Set { setting: PlanSetting::Welcome, value: 30 },
        VisitCommand::Set { setting: PlanSetting::Handover, value: 20 },
        VisitCommand::Set { setting: PlanSetting::Badges, value: 0 },
    ];
    assert_eq!(commands_of(&visits), commands);
    let mut plan = VisitPlan::new();
    for command in commands {
        match command {
            VisitCommand::Set { setting, value } => plan.set_value(setting, value),
            VisitCommand::SetStart(start) => plan.set_start(start),
            _ => unreachable!("no command of a plan"),
        }
    }
    assert_eq!(plan, visits.plan);
}

#[test]
fn lists_come_from_every_layer() {
    let own = ["lion".to_owned()];
    let baked = "visits = true\nlanguages = [\"greek\"]\nstarts = [\"lion\", \"free\"]\nstaff_pin = \"1111\"";
    let baked = SettingsLayer::parse_toml("baked", baked, &own);
    let file = SettingsLayer::parse_toml("f", "starts = [\"cat\", \"lion\"]", &own);
    let managed = [("languages", "greek, english"), ("staff_pin", "0042"), ("badges", "false")];
    let managed = SettingsLayer::from_texts("managed", managed, &own);
    let loaded = LoadedSettings::merge(&[baked, file, managed]);
    assert_eq!(loaded.faults, [""; 0]);
    let visits = loaded.settings.visits.as_ref().expect("they are on");
    assert_eq!(visits.languages, [Language::Greek, Language::English]);
    let starts: Vec<_> = visits.starts.iter().map(|start| &*start.name).collect();
    assert_eq!(starts, ["cat", "lion"]);
    assert!(visits.staff_pin.is_some_and(|pin| pin.matches(&[0, 0, 4, 2])));
    assert_eq!(visits.plan.value(PlanSetting::Badges), 0);
    // No mode is set: the first of the starts is used, and reported as the mode.
    assert_eq!(visits.plan.start(), SessionMode::Constrained { figure: 9 });
    assert_eq!(origin(&loaded, "mode"), "\"cat\" f:1:10");
    assert_eq!(origin(&loaded, "languages"), "[\"greek\", \"english\"] managed");
    let told = loaded.told.concat();
    assert!(told.contains("staff_pin = set") && !told.contains("0042") && !told.contains("1111"));
    assert!(!format!("{loaded:?}").contains("0042"));
}

#[test]
fn a_pin_is_in_no_line_whatever_is_wrong_with_it() {
    for text in [
        "staff_pin = \"67676\"",
        "staff_pin = 6767",
        "staff_pin = 06767",
        "staff_pin = 6767 6767",
        "staff_pin = \"6767",
        "staff_pin = 6767a",
        "staff_pin = '6767'6767",
        "staff_pin = \"6767\"\nstaff_pin = \"6767\"",
        "staff_pin = [\"6767\"]",
        "staff_pin = { a = 6767 }",
        "staff_pin = 6767-67-67",
        "staff_pin \"6767\"",
        "staff_pn = \"6767\"",
        "visits = true\nstaff_pin = \"6767\"\nmode = \"cat\"",
    ] {
        let loaded = load(text);
        assert_eq!(loaded.faults.len(), 1, "{text}");
        assert!(loaded.log_lines().all(|line| !line.contains("67")), "{:?}", loaded.faults);
        assert!(!format!("{loaded:?}").contains("67"), "{loaded:?}");
    }
    let texts = [("staff_pin", "67676")];
    let loaded = LoadedSettings::merge(&[SettingsLayer::from_texts("managed", texts, &[])]);
    let told = "managed: staff_pin = a value that isn't shown, expected four digits in quotes; none holds (default)";
    assert_eq!(loaded.faults, [told]);
}

#[test]
fn a_badge_shown_for_longer_at_least_than_at_most_is_told_with_both_places() {
    let loaded = load("visits = true\nbadge_most_seconds = 20\n\nbadge_least_seconds = 21");
    let told = "f:4:23: badge_least_seconds = 21, expected at most badge_most_seconds = 20 (f:2:22); 10 and 60 hold (default)";
    assert_eq!(loaded.faults, [told]);
    let plan = loaded.settings.visits.as_ref().expect("they are on").plan;
    assert_eq!(plan, VisitPlan::new());
    assert_eq!(origin(&loaded, "badge_least_seconds"), "10 default");
    assert_eq!(origin(&loaded, "badge_most_seconds"), "60 default");
    // A contradiction between different layers, and with a default.
    let managed = SettingsLayer::from_texts("managed", [("badge_least_seconds", "61")], &[]);
    let file = SettingsLayer::parse_toml("f", "visits = true", &[]);
    let told = LoadedSettings::merge(&[file, managed]).faults.concat();
    assert!(told.starts_with("managed: badge_least_seconds = 61, expected at most"), "{told}");
    assert!(told.contains("badge_most_seconds = 60 (default); "), "{told}");
    assert_eq!(load_visits("badge_most_seconds = 10").plan.value(PlanSetting::BadgeMost), 10);
    assert_eq!(load("badge_least_seconds = 61").faults, [""; 0]);
}

#[test]
fn a_mode_that_is_not_on_offer_is_told_and_the_first_start_stands() {
    let text = "mode = \"cat\"\nvisits = true\nstarts = [\"owl\", \"free\"]";
    let loaded = load(text);
    let told = "f:1:8: mode = \"cat\", expected one of starts = [\"owl\", \"free\"] (f:3:10); \"owl\" holds, the first of them";
    assert_eq!(loaded.faults, [told]);
    let owl = SessionMode::Constrained { figure: 8 };
    assert_eq!(loaded.settings.mode, owl);
    assert_eq!(loaded.settings.visits.as_ref().expect("they are on").plan.start(), owl);
    assert_eq!(origin(&loaded, "mode"), "\"owl\" f:3:10");
    let loaded = load("mode = \"cat\"\nvisits = true");
    assert!(loaded.faults.concat().contains("\"creative\"] (default); \"free\" holds"));
    // A mode that is on offer needn't be the first start; without visits any mode is valid.
    let visits = load_visits("mode = \"free\"\nstarts = [\"owl\", \"free\"]");
    assert_eq!(visits.plan.start(), SessionMode::FreeForm);
    assert_eq!(commands_of(&visits), []);
    let loaded = load("mode = \"cat\"\nstarts = [\"owl\"]");
    assert_eq!(loaded.settings.mode, SessionMode::Constrained { figure: 9 });
    assert_eq!(loaded.faults, [""; 0]);
}

#[test]
fn times_that_visits_have_none_of_are_told() {
    let loaded = load("handover_seconds = 60\nvisits = true\nkiosk_seconds = 60\nkiosk = true");
    assert_eq!(
        loaded.faults,
        [
            "f:1:20: handover_seconds = 60, expected none beside visits = true (f:2:10), but \
            off_before_cut_seconds, off_sculpting_seconds and off_after_seconds; it has no effect",
            "f:3:17: kiosk_seconds = 60, expected none beside visits = true (f:2:10), but \
            session_seconds, idle_seconds and off_sculpting_seconds; it has no effect",
        ]
    );
    let faults = load("handover_seconds = 60\nkiosk_seconds = 60\nvisits = false").faults;
    assert_eq!(faults, [""; 0]);
}

#[test]
fn lists_of_visits_have_their_bounds() {
    let names = ["free", "creative", "owl", "cat", "amphora", "dolphin", "owl-half", "cat-half"];
    let starts = |names: &[&str]| format!("starts = {names:?}");
    assert_eq!(load_visits(&starts(&names)).starts.len(), MAX_STARTS);
    for (text, found) in [
        (starts(&[&names[..], &["owl-whole"]].concat()), "a list of 9, expected a list of 1 to 8"),
        (starts(&["owl", "owl"]), "a list with \"owl\" twice, expected"),
        (starts(&[]), "an empty list, expected"),
        ("languages = [\"greek\", \"latin\"]".into(), "a list with \"latin\", expected a list of"),
        ("languages = []".into(), "an empty list, expected"),
        ("languages = \"greek\"".into(), "\"greek\", expected a list of one or more"),
    ] {
        let told = load(&text).faults.concat();
        assert!(told.contains(found) && told.starts_with("f:1:"), "{told}, not {found}");
    }
}
