//! Documents generated from the table of settings: a template of the file, a Markdown table, and Android's
//! app restrictions, from which device management consoles build their forms.

use std::fmt::Write;

use super::table::{SETTINGS, Setting, SettingScope};
use super::value::{SettingDefault, SettingKind};
use crate::modes::named_modes;

/// The width of the template's comments, in characters.
const COMMENT_WIDTH: usize = 98;

/// Returns a settings file in which each setting is commented out, with its description, bounds and default.
#[must_use]
pub fn write_template() -> String {
    let mut text = String::from(
        "# paros.toml: the settings of Paros, each with its default. To set one, take its # away.\n\
         # `paros settings check paros.toml` tells what is wrong.\n",
    );
    for setting in &SETTINGS {
        text.push('\n');
        push_comment(&mut text, &format!("{} ({})", setting.summary, setting.scope.name()));
        let expected = setting.kind.describe(&[]);
        push_comment(&mut text, &format!("Expected: {expected}. Default: {}.", setting.default));
        push_comment(&mut text, &format!("Why: {}.", setting.reason));
        // Writing to a `String` can't fail.
        let _ = writeln!(text, "#{} = {}", setting.name, setting.example());
    }
    text
}

/// Returns the table in Markdown.
#[must_use]
pub fn write_documentation() -> String {
    let mut text = String::from(
        "# Settings\n\n\
         Made of the table in `src/settings/table.rs`; a test holds this file against it.\n\n\
         | setting | value | default | shell | what it does | why so |\n|---|---|---|---|---|---|\n",
    );
    for setting in &SETTINGS {
        let Setting { name, summary, reason, .. } = setting;
        let (expected, default) = (setting.kind.describe(&[]), setting.default);
        let scope = setting.scope.name();
        let default = match default {
            SettingDefault::Unset(what) => what.into(),
            _ => format!("`{default}`"),
        };
        let _ = writeln!(
            text,
            "| `{name}` | {expected} | {default} | {scope} | {summary} | {reason} |"
        );
    }
    text
}

/// The key of the fleet file in a managed configuration. It is not a setting, as its text is a secret.
pub const FLEET_FILE_KEY: &str = "fleet_file";

/// The description of the fleet file in a console's form.
const FLEET_FILE_SUMMARY: &str = "The booth at which the headset enrols by itself. Expected: the file that paros-booth \
    fleet-file prints, or the same in base64 where the form keeps no lines. Whoever has it can enrol a headset.";

/// The resources of a package from which management consoles read the headset's settings.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RestrictionFiles {
    /// `res/xml/app_restrictions.xml`.
    pub restrictions: String,
    /// `res/values/settings.xml`: the texts and lists to which `restrictions` refers.
    pub values: String,
}

/// Returns the restrictions of a package with these operator's own figures.
#[must_use]
pub fn write_restrictions(own_figures: &[String]) -> RestrictionFiles {
    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
    let mut restrictions = format!(
        "{HEAD}<restrictions xmlns:android=\"http://schemas.android.com/apk/res/android\">\n"
    );
    let mut values = format!("{HEAD}<resources>\n");
    for setting in SETTINGS.iter().filter(|setting| setting.scope.is_for_headset()) {
        let (name, kind) = (setting.name, setting.restriction_type());
        let expected = setting.kind.describe(own_figures);
        let title = name.replace('_', " ");
        let mut description = format!("{} Expected: {expected}.", setting.summary);
        if setting.kind.is_list() {
            // Android's multi-select restrictions have no order and no limits.
            description += " Written in one line, with commas between.";
        }
        let title = escape_resource(&(title[..1].to_uppercase() + &title[1..]));
        let description = escape_resource(&description);
        let _ = writeln!(values, "  <string name=\"{name}_title\">{title}</string>");
        let _ = writeln!(values, "  <string name=\"{name}_description\">{description}</string>");
        let _ = write!(
            restrictions,
            "  <restriction android:key=\"{name}\" android:restrictionType=\"{kind}\" \
             android:title=\"@string/{name}_title\" android:description=\"@string/{name}_description\""
        );
        if let Some(entries) = setting.entries(own_figures) {
            let _ = writeln!(values, "  <string-array name=\"{name}_entries\">");
            for entry in entries {
                let _ = writeln!(values, "    <item>{}</item>", escape_resource(&entry));
            }
            values += "  </string-array>\n";
            let list = format!("@array/{name}_entries");
            let _ =
                write!(restrictions, " android:entries=\"{list}\" android:entryValues=\"{list}\"");
        }
        match setting.default {
            SettingDefault::Unset(_) => {}
            SettingDefault::Word(word) => {
                let _ = write!(restrictions, " android:defaultValue=\"{word}\"");
            }
            SettingDefault::Words(words) => {
                let _ = write!(restrictions, " android:defaultValue=\"{}\"", words.join(","));
            }
            default => {
                let _ = write!(restrictions, " android:defaultValue=\"{default}\"");
            }
        }
        restrictions += " />\n";
    }
    push_fleet_file(&mut restrictions, &mut values);
    restrictions += "</restrictions>\n";
    values += "</resources>\n";
    RestrictionFiles { restrictions, values }
}

/// Adds the fleet file to the restrictions and to their texts.
fn push_fleet_file(restrictions: &mut String, values: &mut String) {
    let name = FLEET_FILE_KEY;
    let _ = writeln!(values, "  <string name=\"{name}_title\">Fleet file</string>");
    let _ = writeln!(
        values,
        "  <string name=\"{name}_description\">{}</string>",
        escape_resource(FLEET_FILE_SUMMARY)
    );
    let _ = writeln!(
        restrictions,
        "  <restriction android:key=\"{name}\" android:restrictionType=\"string\" \
         android:title=\"@string/{name}_title\" android:description=\"@string/{name}_description\" />"
    );
}

impl Setting {
    /// Returns an example for the template: the default, or else a valid value.
    fn example(&self) -> String {
        match (self.default, self.kind) {
            (SettingDefault::Unset(_), SettingKind::Numbers(numbers)) => numbers[0].to_string(),
            (SettingDefault::Unset(_), SettingKind::Pin) => "\"0000\"".into(),
            (SettingDefault::Unset(_), _) => "\"session.trace\"".into(),
            (default, _) => default.to_string(),
        }
    }

    /// Returns Android's name of the setting's type (`android.content.RestrictionEntry`).
    fn restriction_type(&self) -> &'static str {
        match self.kind {
            SettingKind::Switch => "bool",
            SettingKind::Whole { .. } | SettingKind::ZeroOr { .. } => "integer",
            SettingKind::Numbers(_) | SettingKind::Words(_) | SettingKind::Mode => "choice",
            SettingKind::Path
            | SettingKind::WordList(_)
            | SettingKind::ModeList { .. }
            | SettingKind::Pin => "string",
        }
    }

    /// Returns the entries of a choice; `None` for other kinds.
    fn entries(&self, own_figures: &[String]) -> Option<Vec<String>> {
        match self.kind {
            SettingKind::Numbers(numbers) => Some(numbers.iter().map(u32::to_string).collect()),
            SettingKind::Words(words) => Some(words.iter().map(ToString::to_string).collect()),
            SettingKind::Mode => {
                let names = named_modes().map(|(name, _)| name.to_owned());
                Some(names.chain(own_figures.iter().cloned()).collect())
            }
            _ => None,
        }
    }
}

impl SettingScope {
    /// Returns the scope's name for readers.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            SettingScope::Headset => "headset",
            SettingScope::Window => "window",
            SettingScope::Both => "headset and window",
            SettingScope::Booth => "booth",
        }
    }

    /// Returns `true` if a headset uses settings of this scope.
    #[must_use]
    pub const fn is_for_headset(self) -> bool {
        matches!(self, SettingScope::Headset | SettingScope::Both)
    }
}

/// Adds a text as lines of comment.
fn push_comment(text: &mut String, comment: &str) {
    let mut line = String::from("#");
    for word in comment.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > COMMENT_WIDTH {
            let _ = writeln!(text, "{line}");
            line = String::from("#");
        }
        let _ = write!(line, " {word}");
    }
    let _ = writeln!(text, "{line}");
}

/// Escapes a text for an Android string resource: XML's special characters as entities, quotes and
/// backslashes with a backslash.
fn escape_resource(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '\'' | '"' | '\\' => {
                escaped.push('\\');
                escaped.push(c);
            }
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use std::{env, fs};

    use super::{
        FLEET_FILE_KEY, escape_resource, write_documentation, write_restrictions, write_template,
    };
    use crate::settings::table::SETTINGS;
    use crate::settings::{LoadedSettings, SettingsLayer};

    #[test]
    fn the_template_sets_nothing_and_its_lines_set_the_defaults() {
        let template = write_template();
        let layer = SettingsLayer::parse_toml("t", &template, &[]);
        assert!(layer.entries.is_empty() && layer.faults.is_empty(), "{layer:?}");
        let is_example = |line: &&str| line.starts_with('#') && !line.starts_with("# ");
        let examples: Vec<_> = template.lines().filter(is_example).map(|line| &line[1..]).collect();
        let layer = SettingsLayer::parse_toml("t", &examples.join("\n"), &[]);
        assert!(layer.faults.is_empty(), "{:?}", layer.faults);
        assert_eq!(layer.entries.len(), SETTINGS.len());
        let (set, unset) = (LoadedSettings::merge(&[layer]), LoadedSettings::merge(&[]));
        for (setting, (set, unset)) in SETTINGS.iter().zip(set.origins.iter().zip(&unset.origins)) {
            assert!(!unset.is_set || set.value == unset.value, "{}", setting.name);
        }
        assert!(template.lines().all(|line| line.chars().count() <= 98));
    }

    #[test]
    fn the_documentation_is_that_of_the_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/SETTINGS.md");
        if env::var_os("PAROS_GOLDEN").is_some_and(|golden| golden == "write") {
            fs::write(path, write_documentation()).expect("room on the disk");
        }
        let written = fs::read_to_string(path).expect("it is part of the sources");
        assert!(written == write_documentation(), "write it anew: PAROS_GOLDEN=write");
    }

    #[test]
    fn restrictions_are_the_headsets_settings() {
        let files = write_restrictions(&["lion".into()]);
        for setting in &SETTINGS {
            let key = format!("android:key=\"{}\"", setting.name);
            let is_headsets = setting.scope.name().contains("headset");
            assert_eq!(files.restrictions.matches(&key).count(), usize::from(is_headsets), "{key}");
        }
        assert!(files.values.contains("<item>lion</item>"));
        // The fleet file is there too, though it is no setting, as its text is a secret.
        let key = format!("android:key=\"{FLEET_FILE_KEY}\" android:restrictionType=\"string\"");
        assert_eq!(files.restrictions.matches(&key).count(), 1, "{}", files.restrictions);
        assert!(SETTINGS.iter().all(|setting| setting.name != FLEET_FILE_KEY));
        assert_eq!(escape_resource("a<b & \"c\" 'd' \\"), "a&lt;b &amp; \\\"c\\\" \\'d\\' \\\\");
    }
}
