//! The table of texts, `text/messages.toml`: read and checked. It depends on the font only through
//! [`FontMeasure`].

use std::fmt;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::wrap::WrappedLines;

/// The names of the languages' lines in the table.
pub(crate) const LANGUAGES: [&str; 2] = ["english", "greek"];

/// Height of the smallest capital letter, in millimetres: a degree at 1.2 m, the distance of panels.
pub(crate) const LEAST_CAPITAL_MM: f32 = 21.0;

/// A weight of the font.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FontWeight {
    Regular,
    Bold,
}

/// The measures of a font that the check needs.
pub(crate) trait FontMeasure {
    /// Returns `true` if there is a glyph for a character.
    fn has_glyph(&self, weight: FontWeight, character: char) -> bool;
    /// Returns the width of a line, in heights of a capital letter.
    fn line_width(&self, weight: FontWeight, line: &str) -> f32;
}

/// Size and room of a text.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Place {
    pub(crate) name: String,
    pub(crate) weight: FontWeight,
    pub(crate) capital_mm: f32,
    pub(crate) width_mm: f32,
    pub(crate) lines: u32,
}

/// A text in every language.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct MessageRow {
    pub(crate) key: String,
    /// Index of the text's place.
    pub(crate) place: usize,
    /// The texts, indexed by language.
    pub(crate) texts: [String; 2],
    /// Names of the placeholders, sorted.
    pub(crate) fillings: Vec<String>,
}

/// A table without mistakes.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TextTable {
    pub(crate) places: Vec<Place>,
    pub(crate) messages: Vec<MessageRow>,
    /// Placeholders, each with the widest texts that can be filled in for it.
    pub(crate) fillings: Vec<(String, Vec<String>)>,
}

/// A mistake in the table.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct TableMistake {
    /// Line of the file, from 1.
    pub(crate) line: usize,
    /// The key, after the keys of the tables that hold it.
    pub(crate) key: String,
    pub(crate) problem: String,
}

impl fmt::Display for TableMistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}: {}", self.line, self.key, self.problem)
    }
}

/// Reads and checks a table.
pub(crate) fn read_table(
    text: &str,
    font: &dyn FontMeasure,
) -> Result<TextTable, Vec<TableMistake>> {
    let mut reader = TableReader { text, font, mistakes: Vec::new() };
    let table = reader.read();
    if reader.mistakes.is_empty() {
        Ok(table)
    } else {
        reader.mistakes.sort_by_key(|mistake| mistake.line);
        Err(reader.mistakes)
    }
}

/// Returns the names of a text's placeholders, sorted, or what is wrong with its braces.
pub(crate) fn names_in_braces(text: &str) -> Result<Vec<String>, String> {
    let (mut names, mut rest) = (Vec::new(), text);
    while let Some(open) = rest.find(['{', '}']) {
        let close = rest[open..].find('}').filter(|close| *close > 0);
        let Some(close) = close else {
            return Err(format!("a brace without its other one: {:?}", &rest[open..]));
        };
        names.push(rest[open + 1..open + close].to_owned());
        rest = &rest[open + close + 1..];
    }
    names.sort();
    names.dedup();
    Ok(names)
}

struct TableReader<'a> {
    text: &'a str,
    font: &'a dyn FontMeasure,
    mistakes: Vec<TableMistake>,
}

type Entry<'t, 'i> = (&'t Spanned<std::borrow::Cow<'i, str>>, &'t Spanned<DeValue<'i>>);

impl TableReader<'_> {
    fn note(&mut self, at: Range<usize>, key: &str, problem: impl Into<String>) {
        let line = 1 + self.text[..at.start.min(self.text.len())].matches('\n').count();
        self.mistakes.push(TableMistake { line, key: key.into(), problem: problem.into() });
    }

    fn read(&mut self) -> TextTable {
        let mut table = TextTable { places: vec![], messages: vec![], fillings: vec![] };
        let document = match DeTable::parse(self.text) {
            Ok(document) => document,
            Err(error) => {
                self.note(error.span().unwrap_or(0..0), "the file", error.message());
                return table;
            }
        };
        let mut sections: [Vec<_>; 3] = Default::default();
        for (key, value) in document.get_ref() {
            let section =
                ["places", "fillings", "messages"].iter().position(|s| s == key.get_ref());
            match (section, value.get_ref().as_table()) {
                (Some(section), Some(entries)) => sections[section].extend(entries.iter()),
                _ => self.note(key.span(), key.get_ref(), "unknown: places, fillings or messages"),
            }
        }
        let [places, fillings, messages] = sections;
        table.places = places.into_iter().filter_map(|entry| self.read_place(entry)).collect();
        table.fillings =
            fillings.into_iter().filter_map(|entry| self.read_filling(entry)).collect();
        for entry in messages {
            if let Some(row) = self.read_message(&table, entry) {
                table.messages.push(row);
            }
        }
        table
    }

    /// Returns the values of an entry's keys, in the order of `known`. Reports unknown and missing keys.
    fn fields<'t, 'i, const N: usize>(
        &mut self,
        path: &str,
        (key, value): Entry<'t, 'i>,
        known: [&str; N],
    ) -> Option<[&'t Spanned<DeValue<'i>>; N]> {
        let Some(fields) = value.get_ref().as_table() else {
            self.note(key.span(), path, "a table is expected");
            return None;
        };
        for name in fields.keys().filter(|name| !known.contains(&name.get_ref().as_ref())) {
            let problem = format!("unknown: {} are expected", known.join(", "));
            self.note(name.span(), &format!("{path}.{}", name.get_ref()), problem);
        }
        let found = known.map(|name| fields.get(name));
        for (name, _) in known.iter().zip(&found).filter(|(_, found)| found.is_none()) {
            self.note(key.span(), path, format!("{name} is missing"));
        }
        let all = found.iter().all(Option::is_some);
        all.then(|| found.map(|value| value.expect("all are there")))
    }

    fn text_of<'t>(&mut self, path: &str, value: &'t Spanned<DeValue<'_>>) -> Option<&'t str> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.note(value.span(), path, "a text in quotes is expected");
        }
        text
    }

    fn number_of(&mut self, path: &str, value: &Spanned<DeValue<'_>>) -> Option<f32> {
        let number = match value.get_ref() {
            DeValue::Integer(number) => number.as_str().parse::<f32>().ok(),
            DeValue::Float(number) => number.as_str().parse::<f32>().ok(),
            _ => None,
        };
        let good = number.filter(|number| *number > 0.0 && *number < 10_000.0);
        if good.is_none() {
            self.note(value.span(), path, "a number above 0 is expected");
        }
        good
    }

    fn read_place(&mut self, entry: Entry<'_, '_>) -> Option<Place> {
        let name = entry.0.get_ref().to_string();
        let path = format!("places.{name}");
        let known = ["weight", "capital_mm", "width_mm", "lines"];
        let [weight, capital, width, lines] = self.fields(&path, entry, known)?;
        let font_weight = match self.text_of(&path, weight)? {
            "regular" => FontWeight::Regular,
            "bold" => FontWeight::Bold,
            _ => {
                self.note(weight.span(), &path, "weight is regular or bold");
                return None;
            }
        };
        self.check_key(&entry.0.span(), &path, &name);
        let capital_mm = self.number_of(&path, capital)?;
        if capital_mm < LEAST_CAPITAL_MM {
            let problem = format!("capital_mm is below {LEAST_CAPITAL_MM}, a degree at 1.2 m");
            self.note(capital.span(), &path, problem);
        }
        let width_mm = self.number_of(&path, width)?;
        let lines = self.number_of(&path, lines)? as u32;
        Some(Place { name, weight: font_weight, capital_mm, width_mm, lines })
    }

    fn read_filling(&mut self, (key, value): Entry<'_, '_>) -> Option<(String, Vec<String>)> {
        let name = key.get_ref().to_string();
        let path = format!("fillings.{name}");
        let all = value.get_ref().as_array().filter(|all| !all.is_empty());
        let Some(all) = all else {
            self.note(key.span(), &path, "a list of the widest texts is expected");
            return None;
        };
        let texts: Vec<String> =
            all.iter().filter_map(|text| self.text_of(&path, text)).map(str::to_owned).collect();
        Some((name, texts))
    }

    /// Reports a key that can't be converted to the name of an enum variant.
    fn check_key(&mut self, at: &Range<usize>, path: &str, key: &str) {
        let parts = || key.split('-');
        let good = parts().all(|part| {
            part.starts_with(|c: char| c.is_ascii_lowercase())
                && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        });
        if !good {
            self.note(at.clone(), path, "a key is words of small letters, joined by hyphens");
        }
    }

    fn read_message(&mut self, table: &TextTable, entry: Entry<'_, '_>) -> Option<MessageRow> {
        let key = entry.0.get_ref().to_string();
        let path = format!("messages.{key}");
        self.check_key(&entry.0.span(), &path, &key);
        let [place, english, greek] = self.fields(&path, entry, ["place", "english", "greek"])?;
        let name = self.text_of(&path, place)?;
        let index = table.places.iter().position(|place| place.name == name);
        let Some(index) = index else {
            self.note(place.span(), &path, format!("there is no place {name:?}"));
            return None;
        };
        let mut texts = [String::new(), String::new()];
        let mut fillings = [None, None];
        for (k, value) in [english, greek].into_iter().enumerate() {
            let path = format!("{path}.{}", LANGUAGES[k]);
            let text = self.text_of(&path, value)?;
            match self.check_text(table, &table.places[index], text) {
                Ok(names) => fillings[k] = Some(names),
                Err(problem) => self.note(value.span(), &path, problem),
            }
            texts[k] = text.to_owned();
        }
        let [Some(fillings), Some(others)] = fillings else { return None };
        if fillings != others {
            let problem = format!("english fills in {fillings:?}, greek {others:?}");
            self.note(greek.span(), &path, problem);
        }
        Some(MessageRow { key, place: index, texts, fillings })
    }

    /// Checks that a text fits its place. Returns the names of its placeholders.
    fn check_text(
        &self,
        table: &TextTable,
        place: &Place,
        text: &str,
    ) -> Result<Vec<String>, String> {
        if text.trim().is_empty() {
            return Err("the text is empty".into());
        }
        if text.trim() != text || text.contains("  ") || text.contains(['\n', '\t']) {
            return Err("spaces stand single and between words; the program breaks lines".into());
        }
        let names = names_in_braces(text)?;
        let mut widest = text.to_owned();
        for name in &names {
            let filling = table.fillings.iter().find(|(known, _)| known == name);
            let Some((_, texts)) = filling else {
                return Err(format!("nothing is filled in for {{{name}}}"));
            };
            let width = |text: &&String| self.font.line_width(place.weight, text);
            let text = texts.iter().max_by(|a, b| width(a).total_cmp(&width(b)));
            widest = widest.replace(&format!("{{{name}}}"), text.map_or("", String::as_str));
        }
        let lacking = widest.chars().find(|&c| !self.font.has_glyph(place.weight, c));
        if let Some(lacking) = lacking {
            return Err(format!("the font has no {lacking:?}"));
        }
        self.check_room(place, &widest).map(|()| names)
    }

    fn check_room(&self, place: &Place, text: &str) -> Result<(), String> {
        let width_mm = |line: &str| place.capital_mm * self.font.line_width(place.weight, line);
        let lines: Vec<&str> = WrappedLines::new(text, place.width_mm, width_mm).collect();
        let widest = lines.iter().map(|line| width_mm(line)).fold(0.0, f32::max);
        let Place { name, width_mm, .. } = place;
        if widest > *width_mm {
            return Err(format!("{widest:.0} mm wide: the place {name:?} has {width_mm}"));
        }
        if lines.len() > place.lines as usize {
            let (count, room) = (lines.len(), place.lines);
            return Err(format!("{count} lines of {width_mm} mm: the place {name:?} has {room}"));
        }
        Ok(())
    }
}
