//! Tests that panels stay within the window at every window size, and that no part of them is cut off.

use egui::{Rect, Shape, Vec2};
use paros_core::session::{SessionMode, SessionState, Tool};
use paros_core::visit::VisitPhase;
use paros_shaders::Image;
use paros_shaders::panel::Language;
use paros_shell::studio::Notice;

use super::tests::sculpting_status;
use super::{PanelAction, Panels, StudioStatus, browser::Browser};
use crate::window::hands::tool_bits_of;
use crate::window::slowness::SlownessWatch;

/// Window sizes in pixels, with their scales.
const WINDOWS: [([u32; 2], f32); 8] = [
    ([640, 420], 1.0),
    ([640, 420], 2.0),
    ([800, 600], 1.0),
    ([800, 600], 2.0),
    ([1280, 720], 1.0),
    ([1280, 720], 2.0),
    ([1920, 1080], 1.0),
    ([1920, 1080], 2.0),
];

/// Lays out a frame of panels in a window, after the frames in which they are measured and fade in.
fn lay_out(
    panels: &mut Panels,
    window: ([u32; 2], f32),
    status: &StudioStatus<'_>,
) -> (Rect, Vec<egui::epaint::ClippedShape>) {
    let mut shapes = Vec::new();
    for _ in 0..4 {
        panels.input.time = Some(panels.context.input(|input| input.time) + 0.5);
        panels.set_window(window.0, window.1);
        shapes = panels.lay_out(status).0.shapes;
    }
    (panels.context.content_rect(), shapes)
}

/// Lists the shapes that lie outside the window or are cut off at the sides. Above and below, a shape counts
/// only if it can't be scrolled to.
fn find_cut_off(screen: Rect, shapes: &[egui::epaint::ClippedShape]) -> Vec<String> {
    let mut cut = Vec::new();
    for clipped in shapes {
        let mut parts = Vec::new();
        super::tests::flatten(clipped.shape.clone(), &mut parts);
        for part in parts {
            // The shadow around a panel fades out beyond it.
            if matches!(&part, Shape::Rect(rect) if rect.blur_width > 0.0) {
                continue;
            }
            let place = part.visual_bounding_rect();
            let seen = clipped.clip_rect.intersect(screen).expand(0.6);
            let scrolls = clipped.clip_rect.height() + 1.0 < screen.height();
            let across = place.left() >= seen.left() && place.right() <= seen.right();
            let down = place.top() >= seen.top() && place.bottom() <= seen.bottom();
            if place.is_positive() && !(across && (down || scrolls)) {
                let text = match &part {
                    Shape::Text(text) => text.galley.text(),
                    _ => "a shape",
                };
                cut.push(format!("{text} at {place:?} of {seen:?}"));
            }
        }
    }
    cut
}

fn in_studio() -> Panels {
    let mut panels = Panels::new();
    panels.close_covering_panels();
    panels
}

fn with_pictures() -> Panels {
    let mut panels = Panels::new();
    panels.set_start_pictures(&Image { width: 720, height: 96, pixels: vec![90; 3 * 720 * 96] });
    panels
}

/// Returns the panels of each state of the studio, by name.
fn panels_of_all_states() -> Vec<(&'static str, Panels, StudioStatus<'static>)> {
    let mut watch = SlownessWatch::default();
    for _ in 0..5 {
        let ticks = paros_shell::tick_runner::ClockTicks { due: 4, dropped: 68 };
        watch.note_frame(std::time::Duration::from_secs(1), ticks);
    }
    let long: &str =
        "/home/somebody/a folder with a long name/and another one in it/without an end";
    let status = sculpting_status();
    let finished = StudioStatus {
        session: SessionState::Finished,
        printed: Some(std::path::Path::new(long)),
        ..status
    };
    let troubled = StudioStatus {
        mode: SessionMode::Constrained { figure: 2 },
        symmetry: true,
        fast: false,
        fault: Some(long),
        opening: Some(std::path::Path::new(long)),
        slow: watch.verdict(),
        device: "the name of a device, as drivers tell it (LLVM 19.1.7, 256 bits)",
        ..status
    };
    let mut states = vec![
        ("start", Panels::new(), StudioStatus { session: SessionState::Waiting, ..status }),
        ("start anew", Panels::new(), StudioStatus { one_before: true, ..status }),
        ("start with pictures", with_pictures(), StudioStatus { one_before: true, ..status }),
        ("finished", in_studio(), finished),
        ("unwritten", in_studio(), StudioStatus { printed: None, unwritten: true, ..finished }),
        ("troubled", in_studio(), troubled),
        ("left", in_studio(), StudioStatus { seconds_to_handover: Some(20), ..status }),
        ("beyond", in_studio(), StudioStatus { pastes_beyond_box: true, ..status }),
    ];
    let opened: [(_, fn(&mut Panels)); 5] = [
        ("help", |panels| panels.toggle_help()),
        ("graph", |panels| panels.toggle_graph()),
        ("question", |panels| panels.ask_to_start(PanelAction::StartRead)),
        ("browser", |panels| panels.browser = Some(Browser::new())),
        ("confirmation", |panels| panels.confirm_start_or_ask_to_finish(SessionState::Sculpting)),
    ];
    for (name, open) in opened {
        let mut panels = in_studio();
        open(&mut panels);
        states.push((name, panels, troubled));
    }
    for bit in Tool::ALL.into_iter().filter_map(|tool: Tool| tool_bits_of(tool).last()) {
        let held = Some((bit.spec().tool, bit));
        let undo = paros_core::edit::UndoCounts { undoable: 0, redoable: 0 };
        let hinted = StudioStatus { held, depth_mm: 40.0, undo, ..status };
        states.push((bit.spec().name, in_studio(), hinted));
        let (language, visit) = (Language::Greek, Some(VisitPhase::Sculpting));
        let mode = SessionMode::Constrained { figure: 2 };
        let greek = StudioStatus { language, visit, mode, symmetry: true, ..hinted };
        states.push(("Greek", in_studio(), greek));
        let mut help = in_studio();
        help.toggle_help();
        states.push(("Greek help", help, greek));
    }
    states
}

#[test]
fn panels_lie_within_windows_of_every_size_and_nothing_is_cut_off() {
    for window in WINDOWS {
        for (name, mut panels, status) in panels_of_all_states() {
            let (screen, shapes) = lay_out(&mut panels, window, &status);
            assert!(shapes.len() > 2, "{name} is drawn");
            let cut = find_cut_off(screen, &shapes);
            assert!(cut.is_empty(), "{name} in {window:?}: {cut:#?}");
            for layer in ["status", "hint", "tools", "start", "help", "notes", "graph", "handover"]
            {
                let area = panels.context.memory(|memory| memory.area_rect(layer));
                let inside = area.is_none_or(|area| screen.expand(0.6).contains_rect(area));
                assert!(inside, "{layer} of {name} in {window:?}: {area:?} of {screen:?}");
            }
        }
    }
}

#[test]
fn notices_stay_within_the_smallest_window() {
    let mut panels = in_studio();
    for number in 0..4 {
        let text = format!("{number} {}", "something long to read ".repeat(20));
        panels.show_notice(Notice::Bad(text.clone()));
        panels.show_notice(Notice::Bad(text));
        assert_eq!(panels.notices.len(), number + 1, "the same one twice is one");
    }
    let (screen, shapes) = lay_out(&mut panels, WINDOWS[0], &sculpting_status());
    assert_eq!(find_cut_off(screen, &shapes), [""; 0]);
    assert!(!panels.notices.is_empty(), "the latest stays");
}

#[test]
fn a_hint_about_the_bit_in_hand_is_one_row_of_the_smallest_window() {
    use paros_core::session::ToolBit;
    use paros_shell::figures::{Figure, HiddenStart, StoneThickness};
    let mode = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Half }.mode();
    for (bit, bared_percent, words) in [
        (ToolBit::RoughingBall, 40, "So large a ball"),
        (ToolBit::MediumBall, 0, "Much stone"),
        (ToolBit::MediumBall, 90, "It bares no more"),
    ] {
        let held = Some((Tool::Rotary, bit));
        let status = StudioStatus {
            mode,
            held,
            bared_percent,
            runs: true,
            is_on_figure: true,
            ..sculpting_status()
        };
        let mut panels = in_studio();
        let mut shown = (Rect::NOTHING, Vec::new());
        for tick in (0..=1080).step_by(36) {
            shown = lay_out(&mut panels, WINDOWS[0], &StudioStatus { tick, ..status });
        }
        let (screen, shapes) = shown;
        assert_eq!(find_cut_off(screen, &shapes), [""; 0]);
        let rows = shapes.iter().find_map(|clipped| match &clipped.shape {
            Shape::Text(text) => {
                text.galley.text().starts_with(words).then(|| text.galley.rows.len())
            }
            _ => None,
        });
        assert_eq!(rows, Some(1), "{words}");
    }
}

#[test]
fn what_a_small_window_has_no_room_for_can_be_scrolled_to() {
    let mut panels = in_studio();
    panels.toggle_help();
    let last_row = |shapes: &[egui::epaint::ClippedShape]| {
        shapes.iter().any(|clipped| match &clipped.shape {
            Shape::Text(text) => {
                let place = text.visual_bounding_rect();
                text.galley.text().contains("paper's path")
                    && clipped.clip_rect.contains_rect(place)
            }
            _ => false,
        })
    };
    let (screen, shapes) = lay_out(&mut panels, WINDOWS[0], &sculpting_status());
    assert!(!last_row(&shapes), "the help is higher than the window");
    let over = screen.right_center() - Vec2::new(60.0, 0.0);
    panels.input.events.push(egui::Event::PointerMoved(over));
    for _ in 0..20 {
        panels.input.events.push(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: Vec2::new(0.0, -3.0),
            modifiers: egui::Modifiers::NONE,
        });
    }
    let (_, shapes) = lay_out(&mut panels, WINDOWS[0], &sculpting_status());
    assert!(last_row(&shapes));
}

#[test]
fn a_low_window_shows_all_starts_without_scrolling() {
    let waiting = StudioStatus { session: SessionState::Waiting, ..sculpting_status() };
    let with_all = StudioStatus { one_before: true, ..sculpting_status() };
    for (window, status) in [([640, 420], waiting), ([640, 520], with_all), ([1280, 720], with_all)]
    {
        let (screen, shapes) = lay_out(&mut with_pictures(), (window, 1.0), &status);
        for name in ["Carve a", "Free form", "Creative", "all of it", "Owl", "Dolphin", "F1"] {
            let is_whole = shapes.iter().any(|clipped| match &clipped.shape {
                Shape::Text(text) => {
                    let place = text.visual_bounding_rect();
                    let seen = clipped.clip_rect.intersect(screen);
                    // If a button's words wrapped, they would continue under its picture.
                    let rows = text.galley.text().lines().count();
                    text.galley.text().starts_with(name)
                        && seen.contains_rect(place)
                        && text.galley.rows.len() == rows
                }
                _ => false,
            });
            assert!(is_whole, "{name} in {window:?}");
        }
    }
}

#[test]
fn the_part_that_the_tool_bar_covers_stays_as_the_bar_changes_and_begins_anew_with_a_size() {
    let mut panels = in_studio();
    assert_eq!(panels.covered_part(), 0.0);
    let status = sculpting_status();
    lay_out(&mut panels, WINDOWS[0], &status);
    let covered = panels.covered_part();
    assert!((0.2..0.5).contains(&covered), "{covered} of the smallest window");
    lay_out(&mut panels, WINDOWS[0], &StudioStatus { held: None, ..status });
    assert_eq!(panels.covered_part(), covered, "the bar is lower, the picture stays");
    lay_out(&mut panels, ([1920, 1080], 1.0), &status);
    assert!(panels.covered_part() < 0.14, "{}", panels.covered_part());
}

#[test]
fn a_finished_sculpture_lies_above_its_panel_as_above_the_tool_bar() {
    let mut panels = in_studio();
    let finished = StudioStatus { session: SessionState::Finished, ..sculpting_status() };
    lay_out(&mut panels, WINDOWS[0], &finished);
    let area = panels.context.memory(|memory| memory.area_rect("finished")).expect("it is shown");
    let covered = 1.0 - area.top() / WINDOWS[0].0[1] as f32;
    let told = panels.covered_part();
    assert!(told > 0.3 && (told - covered).abs() < 0.01, "{told} of {covered}");
    lay_out(&mut panels, ([1920, 1080], 1.0), &finished);
    assert!(panels.covered_part() < 0.2, "another size: {}", panels.covered_part());
}

#[test]
fn a_pixel_of_the_window_is_the_same_place_of_the_panels() {
    let mut panels = Panels::new();
    panels.set_window([1920, 1080], 2.0);
    panels.move_cursor([960.0, 540.0]);
    assert_eq!(panels.cursor, Some(egui::pos2(480.0, 270.0)));
    panels.set_window([320, 210], 1.0);
    panels.move_cursor([320.0, 210.0]);
    assert_eq!(panels.cursor, Some(egui::pos2(640.0, 420.0)));
}
