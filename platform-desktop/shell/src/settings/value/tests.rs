use super::{RawValue, SettingKind, SettingValue};

#[test]
fn a_value_fits_its_kind_or_is_told() {
    let whole = SettingKind::Whole { least: 1, most: 40 };
    let untyped = |text: &str| RawValue::Untyped(text.into());
    let text = |text: &str| RawValue::Text(text.into());
    for raw in [RawValue::Whole(1), untyped("1"), untyped("001")] {
        assert_eq!(whole.check(&raw, &[]), Ok(SettingValue::Number(1)), "{raw}");
    }
    for raw in [
        RawValue::Whole(0),
        RawValue::Whole(41),
        RawValue::Whole(1 + (1 << 32)),
        RawValue::Whole(-1),
        RawValue::Switch(true),
        RawValue::Other("a float"),
        text("1"),
        untyped("+1"),
        untyped(""),
        untyped("99999999999999999999"),
    ] {
        let why = whole.check(&raw, &[]).expect_err("it doesn't fit");
        assert_eq!(why, format!("{raw}, expected a whole number from 1 to 40"));
    }
    let switch = SettingKind::Switch;
    assert_eq!(switch.check(&untyped("true"), &[]), Ok(SettingValue::Switch(true)));
    assert!(switch.check(&text("true"), &[]).is_err() && switch.check(&untyped("1"), &[]).is_err());
    let numbers = SettingKind::Numbers(&[128, 256]);
    assert_eq!(numbers.check(&untyped("256"), &[]), Ok(SettingValue::Number(256)));
    assert_eq!(numbers.describe(&[]), "128 or 256");
    assert!(numbers.check(&RawValue::Whole(200), &[]).is_err());
    let words = SettingKind::Words(&["off", "low"]);
    assert_eq!(words.check(&text("low"), &[]), Ok(SettingValue::Word("low")));
    let why = words.check(&text("Low"), &[]).expect_err("another word");
    assert_eq!(why, "\"Low\", expected one of \"off\", \"low\"");
}

#[test]
fn a_figure_of_ones_own_is_a_mode_by_its_name() {
    let own = ["lion".to_owned()];
    let lion = RawValue::Text("lion".into());
    assert!(matches!(SettingKind::Mode.check(&lion, &own), Ok(SettingValue::Mode(..))));
    assert!(SettingKind::Mode.check(&lion, &[]).is_err());
    let why = SettingKind::Mode.check(&RawValue::Text("lynx".into()), &own);
    assert!(why.is_err_and(|why| why.ends_with("or a figure of one's own: lion")));
}

#[test]
fn a_path_is_a_line_of_text_and_what_cannot_be_seen_is_escaped() {
    let check = |text: &str| SettingKind::Path.check(&RawValue::Text(text.into()), &[]);
    assert!(check("a/b c.trace").is_ok_and(|path| path.to_string() == "\"a/b c.trace\""));
    assert!(check("a\"\\b").is_ok_and(|path| path.to_string() == r#""a\"\\b""#));
    let why = check("a\nb\u{1b}").expect_err("no line");
    assert!(why.starts_with(r#""a\u000Ab\u001B", expected a file's path"#), "{why}");
    assert!(check("").is_err() && check(&"a".repeat(4097)).is_err());
}

#[test]
fn zero_or_more_leaves_out_what_is_between() {
    let seconds = SettingKind::ZeroOr { least: 60, most: 7200 };
    for whole in [0, 60, 7200] {
        let value = SettingValue::Number(whole as u32);
        assert_eq!(seconds.check(&RawValue::Whole(whole), &[]), Ok(value));
    }
    for whole in [-1, 1, 59, 7201] {
        let why = seconds.check(&RawValue::Whole(whole), &[]).expect_err("it doesn't fit");
        assert_eq!(why, format!("{whole}, expected 0, or a whole number from 60 to 7200"));
    }
}

fn list(texts: &[&str]) -> RawValue {
    RawValue::List(texts.iter().map(|text| RawValue::Text((*text).into())).collect())
}

#[test]
fn a_list_is_an_array_or_one_untyped_text_and_keeps_its_order() {
    let words = SettingKind::WordList(&["a", "b", "c"]);
    let untyped = |text: &str| RawValue::Untyped(text.into());
    for raw in [list(&["c", "a"]), untyped("c,a"), untyped(" c , a ")] {
        let value = words.check(&raw, &[]).expect("it fits");
        assert_eq!(value, SettingValue::Words(vec!["c", "a"]));
        assert_eq!(value.to_string(), r#"["c", "a"]"#);
    }
    let nested = RawValue::List(vec![RawValue::Other("a list")]);
    for (raw, found) in [
        (list(&[]), "an empty list"),
        (untyped(""), "an empty list"),
        (untyped(" "), "an empty list"),
        (list(&["a", "d"]), r#"a list with "d""#),
        (untyped("a,,b"), r#"a list with """#),
        (untyped("a,"), r#"a list with """#),
        (list(&["a", "b", "a"]), r#"a list with "a" twice"#),
        (list(&["a\u{1b}"]), r#"a list with "a\u001B""#),
        (RawValue::List(vec![RawValue::Whole(3)]), "a list with 3"),
        (nested, "a list with a list"),
        (RawValue::Text("a,b".into()), r#""a,b""#),
        (RawValue::Whole(1), "1"),
    ] {
        let why = words.check(&raw, &[]).expect_err("it doesn't fit");
        let expected = r#"expected a list of one or more of "a", "b", "c", none twice"#;
        assert_eq!(why, format!("{found}, {expected}"));
    }
}

#[test]
fn a_list_of_modes_has_a_most_and_knows_ones_own_figures() {
    let modes = SettingKind::ModeList { most: 3 };
    let names = |value: Result<SettingValue, String>| match value {
        Ok(SettingValue::Modes(modes)) => modes.into_iter().map(|(name, _)| name).collect(),
        other => vec![format!("{other:?}")],
    };
    let own = ["lion".to_owned()];
    let raw = list(&["lion", "free", "owl-half"]);
    assert_eq!(names(modes.check(&raw, &own)), ["lion", "free", "owl-half"]);
    let why = modes.check(&raw, &[]).expect_err("there is no lion");
    assert!(
        why.starts_with("a list with \"lion\", expected a list of 1 to 3, none twice"),
        "{why}"
    );
    let why = modes.check(&list(&["free", "owl", "cat", "creative"]), &[]).expect_err("too many");
    assert!(why.starts_with("a list of 4, expected a list of 1 to 3"), "{why}");
}

#[test]
fn a_pin_is_never_told() {
    let check = |raw: RawValue| SettingKind::Pin.check(&raw, &[]);
    for raw in [RawValue::Text("0420".into()), RawValue::Untyped("0420".into())] {
        let pin = check(raw).expect("it fits");
        assert_eq!(pin.to_string(), "set");
        assert_eq!(format!("{pin:?}"), "Pin(StaffPin(set))");
    }
    let texts = ["", "042", "04201", "042a"].map(|text| RawValue::Text(text.into()));
    for raw in texts.into_iter().chain([RawValue::Whole(4201), list(&["0420"])]) {
        let why = check(raw).expect_err("it doesn't fit");
        assert_eq!(why, "a value that isn't shown, expected four digits in quotes");
    }
}
