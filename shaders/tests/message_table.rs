//! Tests of the build's check of the message table: which mistakes it rejects, and for which line it
//! reports them.

#[allow(dead_code)] // the build writes the rest of it down
#[path = "../build/text/table.rs"]
mod table;
#[allow(dead_code)] // panels use the rest
#[path = "../src/panel/wrap.rs"]
mod wrap;

use table::{FontMeasure, FontWeight, read_table};

/// A font whose letters are half a capital letter wide, bold ones six tenths; without a Z.
struct PlainFont;

impl FontMeasure for PlainFont {
    fn has_glyph(&self, _: FontWeight, character: char) -> bool {
        character != 'Z'
    }

    fn line_width(&self, weight: FontWeight, line: &str) -> f32 {
        let letter = if weight == FontWeight::Bold { 0.6 } else { 0.5 };
        letter * line.chars().count() as f32
    }
}

/// A table of two places and two texts. A line of `narrow` has 20 letters, one of `wide` 50 on two lines.
const GOOD: &str = r#"[places.narrow]
weight = "regular"
capital_mm = 30
width_mm = 300
lines = 1
[places.wide]
weight = "bold"
capital_mm = 25.0
width_mm = 751
lines = 2
[fillings]
count = ["8", "888"]
[messages.time-left]
place = "narrow"
english = "Time left"
greek = "Χρόνος"
[messages.many]
place = "wide"
english = "{count} left"
greek = "Μένουν {count}"
"#;

/// Asserts that the table with `line` replaced by `instead` has exactly one mistake, reported for that
/// line.
#[track_caller]
fn assert_mistake(line: usize, instead: &str, key: &str, problem: &str) {
    assert_mistake_at(line, line, instead, key, problem);
}

/// Asserts the same, with the mistake reported for the line `told`.
#[track_caller]
fn assert_mistake_at(told: usize, line: usize, instead: &str, key: &str, problem: &str) {
    let mut lines: Vec<&str> = GOOD.lines().collect();
    lines[line - 1] = instead;
    let mistakes = read_table(&lines.join("\n"), &PlainFont).expect_err(instead);
    let all: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
    assert_eq!(mistakes.len(), 1, "{all:?}");
    assert_eq!((mistakes[0].line, mistakes[0].key.as_str()), (told, key), "{all:?}");
    assert!(mistakes[0].problem.contains(problem), "{problem}: {all:?}");
}

#[test]
fn a_good_table_is_read() {
    let table = read_table(GOOD, &PlainFont).expect("no mistake");
    let keys: Vec<&str> = table.messages.iter().map(|row| row.key.as_str()).collect();
    assert_eq!(keys, ["many", "time-left"]);
    let many = &table.messages[0];
    assert_eq!(many.texts, ["{count} left", "Μένουν {count}"]);
    assert_eq!(many.fillings, ["count"]);
    assert_eq!(table.places[many.place].name, "wide");
    assert_eq!(table.places[many.place].lines, 2);
}

#[test]
fn a_missing_or_empty_line_is_a_mistake() {
    assert_mistake_at(13, 15, "", "messages.time-left", "english is missing");
    assert_mistake_at(13, 16, "", "messages.time-left", "greek is missing");
    assert_mistake(16, "greek = \"\"", "messages.time-left.greek", "empty");
    assert_mistake(16, "greek = \" \"", "messages.time-left.greek", "empty");
    assert_mistake_at(13, 14, "", "messages.time-left", "place is missing");
}

#[test]
fn an_unknown_key_is_a_mistake() {
    let mut lines: Vec<&str> = GOOD.lines().collect();
    lines.insert(16, "german = \"Zeit\"");
    let mistakes = read_table(&lines.join("\n"), &PlainFont).expect_err("german");
    assert_eq!(mistakes.len(), 1);
    assert_eq!((mistakes[0].line, mistakes[0].key.as_str()), (17, "messages.time-left.german"));
    assert_mistake(13, "[message.time-left]", "message", "unknown");
    assert_mistake(14, "place = \"nowhere\"", "messages.time-left", "no place \"nowhere\"");
    assert_mistake(13, "[messages.Time_left]", "messages.Time_left", "small letters");
}

#[test]
fn a_letter_that_the_font_lacks_is_a_mistake() {
    let key = "messages.time-left.english";
    assert_mistake(15, "english = \"Zeit\"", key, "the font has no 'Z'");
}

#[test]
fn a_text_too_wide_is_a_mistake() {
    let key = "messages.time-left.english";
    let twenty = GOOD.replace("Time left", "Twenty letters wide:");
    read_table(&twenty, &PlainFont).expect("20 letters fit");
    assert_mistake(15, "english = \"Twenty_letters_wide:!\"", key, "315 mm wide");
    assert_mistake(15, "english = \"Twenty letters and one\"", key, "2 lines of 300 mm");
}

/// The width is that of the widest filling, not of the placeholder's name.
#[test]
fn a_filled_text_is_measured_at_its_widest() {
    let key = "messages.many.english";
    let word = "a".repeat(47);
    read_table(&GOOD.replace("{count} left", &format!("{word}{{count}}")), &PlainFont)
        .expect("47 letters and 3 digits fit");
    assert_mistake(19, &format!("english = \"{word}a{{count}}\""), key, "765 mm wide");
}

#[test]
fn braces_are_checked() {
    let key = "messages.many.greek";
    assert_mistake(20, "greek = \"Μένουν {number}\"", key, "nothing is filled in for {number}");
    assert_mistake(20, "greek = \"Μένουν {count\"", key, "a brace without its other one");
    assert_mistake(20, "greek = \"Μένουν count}\"", key, "a brace without its other one");
    let lacks = "messages.many";
    assert_mistake(20, "greek = \"Μένουν\"", lacks, "english fills in [\"count\"], greek []");
}

#[test]
fn a_text_below_a_degree_is_a_mistake() {
    assert_mistake(3, "capital_mm = 20", "places.narrow", "a degree at 1.2 m");
}

#[test]
fn a_mistake_of_form_has_its_line() {
    let broken = GOOD.replace("lines = 2", "lines = ");
    let mistakes = read_table(&broken, &PlainFont).expect_err("no value");
    assert_eq!((mistakes.len(), mistakes[0].line), (1, 10));
    let text = read_table(&GOOD.replace("\"Time left\"", "8"), &PlainFont).expect_err("a number");
    assert_eq!((text.len(), text[0].line), (1, 15));
}
