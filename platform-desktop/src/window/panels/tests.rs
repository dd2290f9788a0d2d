//! Tests of the panels without a window, by clicks on a grid of points.

use std::time::Duration;

use egui::{Event, Modifiers, PointerButton, Pos2, Rect, Vec2};
use paros_core::edit::UndoCounts;
use paros_core::session::{BenchItem, BitSize, SessionMode, SessionState, Tool, ToolBit, commands};
use paros_shaders::gpu::FrameTimes;
use paros_shaders::panel::Language;
use paros_shell::studio::Notice;
use paros_shell::tick_runner::ClockTicks;

use super::{PanelAction, Panels, StudioStatus};
use crate::window::slowness::SlownessWatch;

const SIZE: Vec2 = Vec2::new(1000.0, 700.0);

pub(in crate::window) fn sculpting_status() -> StudioStatus<'static> {
    StudioStatus {
        session: SessionState::Sculpting,
        mode: SessionMode::FreeForm,
        held: Some((Tool::Impact, ToolBit::PointChisel)),
        size: BitSize::NATURAL,
        is_steadied: true,
        language: Language::English,
        visit: None,
        has_guide: false,
        is_asking: false,
        kiosk: false,
        seconds_to_handover: None,
        depth_mm: 5.0,
        print_scale: Some(0.25),
        bared_percent: 0,
        tick: 0,
        runs: false,
        is_on_figure: false,
        pastes_beyond_box: false,
        symmetry: false,
        undo: UndoCounts { undoable: 3, redoable: 1 },
        unfinished: true,
        one_before: false,
        printing: false,
        printed: None,
        unwritten: false,
        slow: None,
        grid_side: 128,
        fault: None,
        opening: None,
        drops: true,
        fast: true,
        device: "a device",
        times: FrameTimes::default(),
        outline: None,
        mirror: None,
        glow: None,
    }
}

pub(super) fn frame(
    panels: &mut Panels,
    status: &StudioStatus<'_>,
    events: Vec<Event>,
) -> Vec<PanelAction> {
    panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
    panels.input.events = events;
    panels.lay_out(status).1
}

pub(super) fn click(panels: &mut Panels, status: &StudioStatus<'_>, pos: Pos2) -> Vec<PanelAction> {
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let mut asked = frame(panels, status, vec![Event::PointerMoved(pos)]);
    asked.extend(frame(panels, status, vec![button(true)]));
    asked.extend(frame(panels, status, vec![button(false)]));
    asked
}

/// Returns all actions that clicks on the grid of points cause, each click on panels from `make`.
fn clicked_everywhere(make: impl Fn() -> Panels, status: &StudioStatus<'_>) -> Vec<PanelAction> {
    let mut all = Vec::new();
    let mut panels = make();
    frame(&mut panels, status, Vec::new());
    for (x, y) in (0..50).flat_map(|y| (0..25).map(move |x| (x, y))) {
        let pos = Pos2::new(20.0 + 40.0 * x as f32, 7.0 + 14.0 * y as f32);
        let asked = click(&mut panels, status, pos);
        let fresh = make();
        let moved_on = panels.is_sculpture_uncovered() != fresh.is_sculpture_uncovered()
            || panels.asked_start != fresh.asked_start
            || panels.browser.is_some();
        if !asked.is_empty() || moved_on || panels.finishing {
            panels = make();
            frame(&mut panels, status, Vec::new());
        }
        for asked in asked {
            if !all.contains(&asked) {
                all.push(asked);
            }
        }
    }
    all
}

pub(super) fn in_studio() -> Panels {
    let mut panels = Panels::new();
    panels.close_covering_panels();
    panels
}

#[test]
fn every_mode_can_be_started() {
    let status =
        StudioStatus { session: SessionState::Waiting, unfinished: false, ..sculpting_status() };
    let asked = clicked_everywhere(Panels::new, &status);
    // The default is a thin coat of stone over a hidden figure.
    let figures = (8..12).map(|figure| SessionMode::Constrained { figure });
    for mode in [SessionMode::FreeForm, SessionMode::Creative].into_iter().chain(figures) {
        assert!(asked.contains(&PanelAction::Start(mode)), "{mode:?} is not among {asked:?}");
    }
}

#[test]
fn tools_bits_and_commands_can_be_clicked() {
    let asked = clicked_everywhere(in_studio, &sculpting_status());
    let mut expected: Vec<_> =
        Tool::ALL.map(|tool| PanelAction::Take(BenchItem::Tool(tool))).into();
    expected.push(PanelAction::Take(BenchItem::Bit(ToolBit::FlatChisel)));
    expected.extend([-1, 1].map(PanelAction::Resize));
    for command in [commands::UNDO, commands::REDO, commands::SYMMETRY] {
        expected.push(PanelAction::Command(command));
    }
    for one in expected {
        assert!(asked.contains(&one), "{one:?} is not among {asked:?}");
    }
    assert!(!asked.contains(&PanelAction::Finish), "the end is asked for twice");
}

#[test]
fn the_end_is_asked_for_twice_and_can_be_taken_back() {
    let mut panels = in_studio();
    panels.confirm_start_or_ask_to_finish(SessionState::Sculpting);
    assert_eq!(frame(&mut panels, &sculpting_status(), Vec::new()), []);
    panels.close_topmost_or_toggle_start(SessionState::Sculpting);
    panels.confirm_start_or_ask_to_finish(SessionState::Sculpting);
    assert_eq!(frame(&mut panels, &sculpting_status(), Vec::new()), []);
    panels.confirm_start_or_ask_to_finish(SessionState::Sculpting);
    assert_eq!(frame(&mut panels, &sculpting_status(), Vec::new()), [PanelAction::Finish]);
    panels.confirm_start_or_ask_to_finish(SessionState::Finished);
    assert_eq!(frame(&mut panels, &sculpting_status(), Vec::new()), []);
}

/// Clicks on the panel where a start is chosen. Returns the actions so far.
fn choose_a_start(panels: &mut Panels, status: &StudioStatus<'_>) -> Vec<PanelAction> {
    frame(panels, status, Vec::new());
    let asked = click(panels, status, Pos2::new(300.0, 400.0));
    assert!(panels.asked_start.is_some() || !asked.is_empty(), "a click on a start");
    asked
}

#[test]
fn a_start_that_leaves_a_sculpture_is_asked_for_twice_and_can_be_taken_back() {
    let status = StudioStatus { session: SessionState::Sculpting, ..sculpting_status() };
    let mut panels = Panels::new();
    assert_eq!(choose_a_start(&mut panels, &status), []);
    panels.close_topmost_or_toggle_start(SessionState::Sculpting);
    assert!(panels.start, "the start panel is back");
    panels.confirm_start_or_ask_to_finish(SessionState::Sculpting);
    assert_eq!(frame(&mut panels, &status, Vec::new()), [], "the question was taken back");
    choose_a_start(&mut panels, &status);
    panels.confirm_start_or_ask_to_finish(SessionState::Sculpting);
    assert!(matches!(frame(&mut panels, &status, Vec::new())[..], [PanelAction::Start(_)]));
    // There is nothing to lose, so that no confirmation is needed.
    let untouched = StudioStatus { unfinished: false, ..status };
    assert!(matches!(choose_a_start(&mut Panels::new(), &untouched)[..], [PanelAction::Start(_)]));
}

#[test]
fn the_question_can_be_answered_by_clicks() {
    let asked = || {
        let mut panels = in_studio();
        panels.ask_to_start(PanelAction::StartRead);
        panels
    };
    let said = clicked_everywhere(asked, &sculpting_status());
    assert_eq!(said, [PanelAction::StartRead]);
    let mut taken_back = 0;
    for x in (20..1000).step_by(40) {
        let mut panels = asked();
        frame(&mut panels, &sculpting_status(), Vec::new());
        let said = click(&mut panels, &sculpting_status(), Pos2::new(x as f32, 395.0));
        taken_back += u32::from(said.is_empty() && panels.is_sculpture_uncovered());
    }
    assert!(taken_back > 0, "nothing stays with the sculpture");
}

#[test]
fn the_one_before_is_offered_where_there_is_one() {
    let offers = |one_before| {
        let status = StudioStatus { one_before, ..sculpting_status() };
        clicked_everywhere(Panels::new, &status).contains(&PanelAction::OneBefore)
    };
    assert_eq!([true, false].map(offers), [true, false]);
}

#[test]
fn the_start_stays_until_there_is_a_session() {
    let mut panels = Panels::new();
    panels.close_topmost_or_toggle_start(SessionState::Waiting);
    assert!(!panels.is_sculpture_uncovered());
    panels.close_topmost_or_toggle_start(SessionState::Sculpting);
    assert!(panels.is_sculpture_uncovered());
    panels.close_topmost_or_toggle_start(SessionState::Sculpting);
    assert!(!panels.is_sculpture_uncovered());
}

#[test]
fn panels_fit_the_overlay() {
    let mut panels = in_studio();
    panels.toggle_help();
    panels.toggle_graph();
    for i in 0..200 {
        panels.add_frame_time(0.001 * i as f32);
    }
    panels.show_notice(Notice::Bad("something long to read ".repeat(20)));
    use crate::window::paint::{BufferLengths, EguiBuffers};
    let mut egui_buffers = EguiBuffers::new();
    let mut lay_out = || {
        panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
        let (output, _) = panels.lay_out(&sculpting_status());
        egui_buffers.apply_atlas_changes(&output.textures_delta);
        output.shapes
    };
    // Panels are measured in a frame before they are drawn.
    lay_out();
    let shapes = lay_out();
    let triangles = panels.context.tessellate(shapes, 1.0);
    egui_buffers.set_triangles_of_frame(&triangles, 1.0);
    let BufferLengths { vertices, indices, runs } = egui_buffers.buffer_lengths();
    use paros_shaders::gpu::overlay::{MAX_INDICES, MAX_RUNS, MAX_VERTICES};
    assert!(vertices > 1000 && indices > vertices && runs > 0);
    assert!(vertices * 2 < MAX_VERTICES && indices * 2 < MAX_INDICES && runs * 2 < MAX_RUNS);
}

/// Returns the shapes of a frame of panels, in drawing order.
pub(super) fn shapes_of(panels: &mut Panels, status: &StudioStatus<'_>) -> Vec<egui::Shape> {
    let mut lay_out = |time: f64| {
        panels.input.time = Some(time);
        panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
        panels.lay_out(status).0.shapes
    };
    // Panels are measured in a frame before they are drawn, and fade in.
    lay_out(0.0);
    lay_out(1.0);
    let mut shapes = Vec::new();
    for clipped in lay_out(2.0) {
        flatten(clipped.shape, &mut shapes);
    }
    shapes
}

pub(super) fn flatten(shape: egui::Shape, into: &mut Vec<egui::Shape>) {
    match shape {
        egui::Shape::Vec(shapes) => shapes.into_iter().for_each(|shape| flatten(shape, into)),
        shape => into.push(shape),
    }
}

/// Returns all texts of a frame, and the texts that have no panel behind them.
pub(super) fn text_and_bare_text(
    panels: &mut Panels,
    status: &StudioStatus<'_>,
) -> [Vec<String>; 2] {
    let (mut grounds, mut all, mut bare) = (Vec::new(), Vec::new(), Vec::new());
    for shape in shapes_of(panels, status) {
        match shape {
            egui::Shape::Rect(rect) if rect.fill == super::style::PANEL => grounds.push(rect.rect),
            egui::Shape::Text(text) => {
                let place = text.galley.rect.translate(text.pos.to_vec2()).shrink(0.5);
                let words = text.galley.text().to_owned();
                if !grounds.iter().any(|ground: &Rect| ground.contains_rect(place)) {
                    bare.push(words.clone());
                }
                all.push(words);
            }
            _ => {}
        }
    }
    [all, bare]
}

#[test]
fn all_text_has_a_panel_under_it() {
    let mut panels = in_studio();
    panels.toggle_help();
    panels.show_notice(Notice::Bad("something".into()));
    let mut watch = SlownessWatch::default();
    for _ in 0..5 {
        watch.note_frame(Duration::from_secs(1), ClockTicks { due: 4, dropped: 68 });
    }
    let status =
        StudioStatus { fault: Some("a full disk"), slow: watch.verdict(), ..sculpting_status() };
    let [all, bare] = text_and_bare_text(&mut panels, &status);
    assert_eq!(bare, [""; 0]);
    for words in
        ["Free form", "F1 help", "too slow: 1 picture a second", "Not saved", "something", "undo"]
    {
        assert!(all.iter().any(|text| text.contains(words)), "{words} is not in {all:?}");
    }
    let finished = StudioStatus { session: SessionState::Finished, ..sculpting_status() };
    let mut asking = in_studio();
    asking.ask_to_start(PanelAction::StartRead);
    for (mut panels, status) in
        [(Panels::new(), &status), (in_studio(), &finished), (asking, &status)]
    {
        let [all, bare] = text_and_bare_text(&mut panels, status);
        assert!(bare.is_empty() && all.len() > 2, "{bare:?} of {all:?}");
    }
}

#[test]
fn the_help_has_visitors_keys_first_and_developers_under_them() {
    let mut panels = in_studio();
    panels.toggle_help();
    let help: Vec<_> = shapes_of(&mut panels, &sculpting_status())
        .into_iter()
        .filter_map(|shape| match shape {
            egui::Shape::Text(text) => Some((text.pos.y, text.galley.text().to_owned())),
            _ => None,
        })
        .collect();
    let height = |words: &str| {
        let found = help.iter().find(|(_, text)| text == words);
        found.unwrap_or_else(|| panic!("{words} is not in {help:?}")).0
    };
    let divide = height("For developers");
    for keys in ["left button", "wheel", "Z, Y", "Enter, Space", "Esc"] {
        assert!(height(keys) < divide, "{keys} is a visitor's");
    }
    for keys in ["R", "F2", "F3"] {
        assert!(height(keys) > divide, "{keys} is a developer's");
    }
}

#[test]
fn the_tool_bar_hints_at_what_the_visitor_has_not_done_yet() {
    let mut panels = in_studio();
    let mut shows = |undoable, redoable, words: &str| {
        let status = StudioStatus { undo: UndoCounts { undoable, redoable }, ..sculpting_status() };
        let [all, bare] = text_and_bare_text(&mut panels, &status);
        assert!(bare.is_empty(), "{bare:?}");
        all.iter().any(|text| text.contains(words))
    };
    assert!(shows(0, 0, "Hold the left button"));
    assert!(!shows(1, 0, "Hold the left button") && shows(1, 0, "Z takes it back"));
    assert!(!shows(0, 1, "Z takes it back"));
}

#[test]
fn files_are_to_be_dropped_only_where_they_can_be() {
    let says_so = |drops| {
        let mut panels = Panels::new();
        let mut lay_out = || {
            panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
            panels.lay_out(&StudioStatus { drops, ..sculpting_status() }).0.shapes
        };
        // Panels are measured in a frame before they are drawn.
        lay_out();
        lay_out().iter().any(|shape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text().contains("drop a file"),
            _ => false,
        })
    };
    assert_eq!([true, false].map(says_so), [true, false]);
}
