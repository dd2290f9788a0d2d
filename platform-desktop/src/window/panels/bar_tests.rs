//! Tests of the tool bar: its position is stable, and its texts are in the visitor's language.

use egui::{Pos2, Shape};
use paros_core::edit::UndoCounts;
use paros_core::session::{SessionMode, Tool};
use paros_core::visit::VisitPhase;
use paros_shaders::panel::{Language, Message};

use super::tests::{click, flatten, sculpting_status, text_and_bare_text};
use super::words::bit_name;
use super::{Panels, StudioStatus};
use crate::window::hands::tool_bits_of;

fn in_studio() -> Panels {
    let mut panels = Panels::new();
    panels.close_covering_panels();
    panels
}

/// Returns the position of a text in a window, once all panels are measured.
fn find_text(panels: &mut Panels, size: [u32; 2], status: &StudioStatus<'_>, text: &str) -> Pos2 {
    let mut shapes = Vec::new();
    for _ in 0..4 {
        panels.input.time = Some(panels.context.input(|input| input.time) + 0.5);
        panels.set_window(size, 1.0);
        shapes.clear();
        let drawn = panels.lay_out(status).0.shapes;
        drawn.into_iter().for_each(|clipped| flatten(clipped.shape, &mut shapes));
    }
    let found = shapes.iter().find_map(|shape| match shape {
        Shape::Text(shown) if shown.galley.text() == text => Some(shown.pos),
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no {text}"))
}

#[test]
fn the_tools_stay_where_they_are_whatever_is_in_hand() {
    for size in [[640, 420], [1280, 800]] {
        let mut panels = in_studio();
        let mut places = Vec::new();
        for tool in [None].into_iter().chain(Tool::ALL.map(Some)) {
            let bit = tool.and_then(|tool| tool_bits_of(tool).next());
            // With a hint, then without one.
            for undoable in [0, 3] {
                let undo = UndoCounts { undoable, redoable: undoable };
                let held = tool.zip(bit);
                let status = StudioStatus { held, undo, ..sculpting_status() };
                let texts = ["1  Rotary", "4  Rasp", "Redo", "Mirror"];
                places.push(texts.map(|text| find_text(&mut panels, size, &status, text)));
            }
        }
        for place in &places {
            assert_eq!(place, &places[0], "in {size:?}");
        }
    }
}

/// During the guided cut the guide's panel takes the status line's place.
#[test]
fn the_status_gives_way_to_the_guide() {
    let shows = |has_guide| {
        let visit = Some(VisitPhase::Sculpting);
        let status = StudioStatus { visit, has_guide, ..sculpting_status() };
        let [all, _] = text_and_bare_text(&mut in_studio(), &status);
        all.iter().any(|text| text.contains("Free form"))
    };
    assert_eq!([true, false].map(shows), [false, true]);
}

/// The help is the only place that explains the keys, and touch has no F1: the tool bar has a button that
/// shows and hides the help.
#[test]
fn a_visitor_is_told_of_the_help_and_has_it_by_a_click() {
    for (language, name) in [(Language::English, "F1 help"), (Language::Greek, "F1 βοήθεια")]
    {
        for visit in [VisitPhase::Guided, VisitPhase::Sculpting] {
            let status = StudioStatus { language, visit: Some(visit), ..sculpting_status() };
            let mut panels = in_studio();
            let at = find_text(&mut panels, [1000, 700], &status, name);
            for is_shown in [true, false] {
                assert_eq!(click(&mut panels, &status, at), [], "no command of the hands");
                assert_eq!(panels.is_help_shown(), is_shown, "{visit:?} in {language:?}");
            }
        }
    }
}

/// Returns the tool bar's texts in a window of an ordinary size, row by row.
fn bar_rows(status: &StudioStatus<'_>) -> Vec<Vec<String>> {
    let mut panels = in_studio();
    find_text(&mut panels, [1280, 800], status, Message::BarMirror.text(status.language));
    let bar = panels.context.memory(|memory| memory.area_rect("tools")).expect("it is shown");
    let mut shapes = Vec::new();
    let drawn = panels.lay_out(status).0.shapes;
    drawn.into_iter().for_each(|clipped| flatten(clipped.shape, &mut shapes));
    let (mut rows, mut last) = (Vec::<Vec<String>>::new(), f32::NEG_INFINITY);
    for shape in shapes {
        let place = shape.visual_bounding_rect();
        let Shape::Text(shown) = shape else { continue };
        if !bar.contains_rect(place) {
            continue;
        }
        // The texts of a row have two sizes.
        if place.center().y > last + 16.0 {
            rows.push(Vec::new());
        }
        last = place.center().y;
        rows.last_mut().expect("a row").push(shown.galley.text().into());
    }
    rows
}

/// Greek words are longer, but the bar has as many rows as the English one, and a tool's bits fit in a row.
#[test]
fn a_greek_tool_bar_has_the_rows_of_an_english_one() {
    let visit = Some(VisitPhase::Sculpting);
    for tool in Tool::ALL {
        let bits: Vec<_> = tool_bits_of(tool).collect();
        for (bit, depth_mm) in bits.iter().flat_map(|bit| [9.0, 40.0, -20.0].map(|mm| (*bit, mm))) {
            let held = Some((tool, bit));
            let status = StudioStatus { held, visit, depth_mm, ..sculpting_status() };
            let rows = Language::ALL.map(|language| {
                let rows = bar_rows(&StudioStatus { language, ..status });
                let has = |row: &[String], name: Message| {
                    row.iter().any(|shown| shown == name.text(language))
                };
                let names = bits.iter().map(|bit| bit_name(*bit));
                assert!(names.into_iter().all(|name| has(&rows[0], name)), "{rows:#?}");
                // Both size buttons are in the same row.
                let sizes = |row: &Vec<String>| {
                    [Message::BarSmaller, Message::BarLarger].map(|name| has(row, name))
                };
                assert!(
                    rows.iter().map(sizes).all(|[smaller, larger]| smaller == larger),
                    "{rows:#?}"
                );
                rows
            });
            assert_eq!(rows[0].len(), rows[1].len(), "{rows:#?}");
        }
    }
}

/// A Greek visitor sees no English words. Names of keys, millimetres and numbers don't count.
#[test]
fn a_greek_visitor_reads_greek() {
    let keys = ["Shift", "Ctrl", "Enter", "Esc", "mm"];
    let (language, visit) = (Language::Greek, Some(VisitPhase::Sculpting));
    let modes = [SessionMode::FreeForm, SessionMode::Constrained { figure: 8 }];
    for tool in Tool::ALL {
        for (mode, undoable) in modes.into_iter().flat_map(|mode| [(mode, 0), (mode, 1)]) {
            let mut panels = in_studio();
            panels.toggle_help();
            panels.show_found(language, mode);
            let held = Some((tool, tool_bits_of(tool).next().expect("a bit")));
            let undo = UndoCounts { undoable, redoable: 0 };
            let status = StudioStatus {
                language,
                visit,
                mode,
                held,
                undo,
                symmetry: true,
                bared_percent: 40,
                ..sculpting_status()
            };
            let [all, bare] = text_and_bare_text(&mut panels, &status);
            assert!(bare.is_empty() && all.len() > 40, "{bare:?} of {all:?}");
            for text in all {
                let mut words = text.split(|letter: char| !letter.is_alphabetic());
                let english = words.find(|word| {
                    word.len() > 1 && word.is_ascii() && !keys.contains(word) && *word != "F"
                });
                assert_eq!(english, None, "{text}");
            }
        }
    }
}
