//! The settings file in `paros settings` and `paros window`.

use serde_json::Value;

use crate::support::TestFolder;

const FAIR: &str = "# for the fair\nmode = \"owl\"\nhandover_seconds = 120\n";
const WRONG: &str = "mode = \"cubes\"\nhandover_seconds = 120\nrate = 90\n";

#[test]
fn a_file_is_checked_and_what_is_wrong_has_its_place() {
    let folder = TestFolder::new("settings-check");
    folder.write("fair.toml", FAIR);
    let said = folder.succeeds(&["settings", "check", "fair.toml"]);
    assert_eq!(said, "fair.toml: 2 settings, nothing wrong\n");
    folder.write("wrong.toml", WRONG);
    folder.refuses(
        &["settings", "check", "wrong.toml"],
        "wrong.toml:1:8: mode = \"cubes\", expected free",
    );
    folder.refuses(
        &["settings", "check", "wrong.toml"],
        "\nwrong.toml:3:1: rate: there is no such setting; is refresh_rate_hz meant?\n",
    );
    folder.refuses(&["settings", "check", "none.toml"], "none.toml: cannot read");
    folder.write("no.toml", "--rate 90");
    folder.refuses(&["settings", "check", "no.toml"], "no.toml:1:8: no TOML: ");

    let output = folder.paros(&["settings", "check", "wrong.toml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let check: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["settings"], 1);
    let fault = &check["faults"][0];
    assert_eq!((&fault["line"], &fault["column"]), (&1.into(), &8.into()));
    assert_eq!((&fault["setting"], &check["faults"][1]["setting"]), (&"mode".into(), &Value::Null));
}

#[test]
fn a_figure_of_ones_own_is_known_where_it_is_named() {
    let folder = TestFolder::new("settings-figure");
    folder.write("zoo.toml", "mode = \"lion\"\n");
    folder.refuses(&["settings", "check", "zoo.toml"], "mode = \"lion\", expected free");
    folder.succeeds(&["settings", "check", "zoo.toml", "--figure", "lion"]);
    folder.refuses(&["settings", "check", "zoo.toml", "--figure", "owl"], "owl: there is one");
}

#[test]
fn what_holds_is_shown_with_where_it_comes_from() {
    let folder = TestFolder::new("settings-show");
    folder.write("fair.toml", FAIR);
    let said = folder.succeeds(&["settings", "show", "fair.toml"]);
    let line = |name: &str| {
        let line = said.lines().find(|line| line.starts_with(name)).unwrap();
        line.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(line("mode "), "mode = \"owl\" # fair.toml:2:8; headset and window");
    assert!(line("kiosk ").ends_with("# default; window"), "{said}");
    let said = folder.succeeds(&["settings", "show", "fair.toml", "--json"]);
    let shown: Value = serde_json::from_str(&said).unwrap();
    let of = |name: &str| shown.as_array().unwrap().iter().find(|s| s["name"] == name).unwrap();
    assert_eq!(
        (&of("mode")["value"], &of("mode")["from"]),
        (&"owl".into(), &"fair.toml:2:8".into())
    );
    assert_eq!((&of("size")["value"], &of("size")["from"]), (&Value::Null, &"default".into()));
    assert_eq!(of("handover_seconds")["value"], 120);
    // For a file with faults, the settings in effect are still shown.
    folder.write("wrong.toml", WRONG);
    let output = folder.paros(&["settings", "show", "wrong.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stdout);
    let mode = said.lines().find(|line| line.starts_with("mode ")).unwrap();
    assert!(mode.contains("= \"free\""), "{said}");

    // Without a file argument, the user's file is shown.
    let show = |data: &str| {
        let mut command = folder.command(&["settings", "show"]);
        let output = command.env("XDG_DATA_HOME", folder.0.join(data)).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    std::fs::create_dir_all(folder.0.join("data/paros")).unwrap();
    folder.write("data/paros/paros.toml", "kiosk = true\n");
    assert!(
        show("data").contains("paros.toml:1:9; window") && !show("none").contains("paros.toml")
    );
}

#[test]
fn a_pin_is_set_or_none_and_shown_to_nobody() {
    let folder = TestFolder::new("settings-pin");
    folder.write("pin.toml", "visits = true\nstaff_pin = \"0420\"\nlanguages = [\"greek\"]\n");
    let said = folder.succeeds(&["settings", "show", "pin.toml"]);
    let pin = said.lines().find(|line| line.starts_with("staff_pin ")).unwrap();
    assert!(pin.contains("= set ") && pin.contains("# pin.toml:2:13; "), "{pin}");
    let json = folder.succeeds(&["settings", "show", "pin.toml", "--json"]);
    let shown: Value = serde_json::from_str(&json).unwrap();
    let of = |name: &str| shown.as_array().unwrap().iter().find(|s| s["name"] == name).unwrap();
    assert_eq!(of("staff_pin")["value"], "set");
    assert_eq!(of("languages")["value"], serde_json::json!(["greek"]));
    assert_eq!(of("starts")["value"], serde_json::json!(["free", "owl", "creative"]));
    assert!(!said.contains("0420") && !json.contains("0420"));

    folder.write("none.toml", "staff_pin = \"04201\"\n");
    let output = folder.paros(&["settings", "show", "none.toml"]);
    let [said, errors] =
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    let pin = said.lines().find(|line| line.starts_with("staff_pin ")).unwrap();
    assert!(pin.contains("  none "), "{pin}");
    assert!(errors.contains("none.toml:1:13: staff_pin = a value that isn't shown"), "{errors}");
    let output = folder.paros(&["settings", "check", "none.toml", "--json"]);
    let json = String::from_utf8(output.stdout).unwrap();
    assert!(json.contains("isn't shown") && ![said, errors, json].concat().contains("0420"));
    folder.write("empty.toml", "");
    let json = folder.succeeds(&["settings", "show", "empty.toml", "--json"]);
    let shown: Value = serde_json::from_str(&json).unwrap();
    let pin = shown.as_array().unwrap().iter().find(|shown| shown["name"] == "staff_pin");
    assert_eq!(pin.unwrap()["value"], Value::Null);
}

#[test]
fn settings_that_contradict_each_other_are_told_with_their_lines() {
    let folder = TestFolder::new("settings-contradictions");
    let text = "visits = true\nbadge_most_seconds = 20\nbadge_least_seconds = 30\nmode = \"cat\"\n";
    folder.write("paros.toml", text);
    let check = ["settings", "check", "paros.toml"];
    let badge = "paros.toml:3:23: badge_least_seconds = 30, expected at most badge_most_seconds = 20 (paros.toml:2:22)\n";
    folder.refuses(&check, badge);
    folder.refuses(&check, "\nparos.toml:4:8: mode = \"cat\", expected one of starts = ");
    let output = folder.paros(&["settings", "show", "paros.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains(badge));
    let said = String::from_utf8_lossy(&output.stdout);
    let mode = said.lines().find(|line| line.starts_with("mode ")).unwrap();
    assert!(mode.contains("= \"free\" ") && mode.contains("# default; "), "{mode}");
    let output = folder.paros(&["settings", "check", "paros.toml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let check: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["settings"], 4);
    let fault = &check["faults"][1];
    assert_eq!((&fault["line"], &fault["setting"]), (&4.into(), &"mode".into()));
    assert_eq!(check["faults"].as_array().map(Vec::len), Some(2));
}

#[test]
fn a_template_is_a_file_without_faults() {
    let folder = TestFolder::new("settings-template");
    let template = folder.succeeds(&["settings", "template"]);
    assert!(template.contains("\n#handover_seconds = 45\n"), "{template}");
    folder.write("paros.toml", &template);
    let said = folder.succeeds(&["settings", "check", "paros.toml"]);
    assert_eq!(said, "paros.toml: 0 settings, nothing wrong\n");
    assert_eq!(folder.read("paros.toml"), template.as_bytes());
}

/// Without a display the command ends after it has read the settings.
#[test]
fn a_window_reads_the_file_that_is_named_or_the_users() {
    let folder = TestFolder::new("settings-window");
    folder.write("wrong.toml", "kiosk_seconds = 5\nkiosk = true\n");
    std::fs::create_dir_all(folder.0.join("data/paros")).unwrap();
    folder.write("data/paros/paros.toml", "size = 128\n");
    let said = |args: &[&str]| {
        let mut command = folder.command(args);
        let output = command.env("XDG_DATA_HOME", folder.0.join("data")).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, errors) = said(&["window", "--settings", "wrong.toml", "--size", "128"]);
    assert!(errors.starts_with("paros: wrong.toml: kiosk = true\n"), "{errors}");
    let fault = "wrong.toml:1:17: kiosk_seconds = 5, expected a whole number from 30 to 3600; 90 holds (default)\n";
    assert!(errors.contains(fault) && code == Some(1), "{errors}");
    let (_, errors) = said(&["window", "--size", "128"]);
    assert!(errors.contains("data/paros/paros.toml: size = 128\n"), "{errors}");
    folder.refuses(&["window", "--settings", "none.toml"], "none.toml: cannot read");
}
