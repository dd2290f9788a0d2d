//! The panels' texts and their atlas, as Rust tables and a picture.

mod font;
mod sources;
pub(crate) mod table;
#[allow(dead_code)] // panels use the rest
#[path = "../../src/panel/wrap.rs"]
mod wrap;

use std::fs;
use std::path::Path;

use paros_core::badge::{BadgeColour, Language, Pictogram};

use crate::atlas;
use font::Font;
use sources::{atlas_source, messages_source};
use table::TextTable;

const TABLE: &str = "text/messages.toml";

/// Writes `messages.rs`, `panel_atlas.rs` and `panel_atlas.zlib` into the folder `out`. Prints the mistakes
/// in the table of texts, if there are any, and ends the build.
pub(crate) fn write_texts(out: &Path) {
    println!("cargo::rerun-if-changed=text");
    println!("cargo::rerun-if-changed=src/panel/wrap.rs");
    let text = fs::read_to_string(TABLE).unwrap_or_else(|error| panic!("{TABLE}: {error}"));
    let font = Font::new();
    let table = table::read_table(&text, &font).unwrap_or_else(|mistakes| {
        for mistake in &mistakes {
            eprintln!("{TABLE}:{}: {}: {}", mistake.line, mistake.key, mistake.problem);
        }
        std::process::exit(1);
    });
    fs::write(out.join("messages.rs"), messages_source(&table)).expect("OUT_DIR takes files");
    let lines = spoken_lines(&table);
    let (atlas, source) = atlas_source(&font, &lines);
    fs::write(out.join("panel_atlas.rs"), source).expect("OUT_DIR takes files");
    fs::write(out.join("panel_atlas.zlib"), atlas::compress_texels(&atlas))
        .expect("OUT_DIR takes files");
}

/// Returns every line that panels may show: ASCII characters, texts, fillings, and the badges' words.
fn spoken_lines(table: &TextTable) -> Vec<String> {
    let mut lines: Vec<String> = (' '..='~').map(String::from).collect();
    lines.extend(table.messages.iter().flat_map(|message| message.texts.clone()));
    lines.extend(table.fillings.iter().flat_map(|(_, texts)| texts.clone()));
    for language in Language::ALL {
        lines.extend(BadgeColour::ALL.map(|colour| colour.name(language).to_owned()));
        lines.extend(Pictogram::all().map(|pictogram| pictogram.name(language).to_owned()));
    }
    lines
}
