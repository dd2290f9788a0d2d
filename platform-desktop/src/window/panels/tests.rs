//! The panels without a window: clicked everywhere.

use egui::{Event, Modifiers, PointerButton, Pos2, Rect, Vec2};
use paros_core::input::{Mode, commands};
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::Session;
use paros_shaders::gpu::Times;
use paros_shell::studio::Note;

use super::{Asked, Panels, Shown};

const SIZE: Vec2 = Vec2::new(1000.0, 700.0);

fn shown() -> Shown<'static> {
    Shown {
        session: Session::Sculpting,
        mode: Mode::FreeForm,
        held: Some((Tool::Impact, Bit::PointChisel)),
        depth: 5.0,
        symmetry: false,
        undo: (3, 1),
        printing: false,
        printed: None,
        unwritten: false,
        fault: None,
        opening: None,
        drops: true,
        fast: true,
        device: "a device",
        times: Times::default(),
        outline: None,
    }
}

fn frame(panels: &mut Panels, shown: &Shown<'_>, events: Vec<Event>) -> Vec<Asked> {
    panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
    panels.input.events = events;
    panels.lay_out(shown).1
}

fn click(panels: &mut Panels, shown: &Shown<'_>, pos: Pos2) -> Vec<Asked> {
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let mut asked = frame(panels, shown, vec![Event::PointerMoved(pos)]);
    asked.extend(frame(panels, shown, vec![button(true)]));
    asked.extend(frame(panels, shown, vec![button(false)]));
    asked
}

/// What clicks all over the picture ask for, each on panels that `make` made.
fn clicked_everywhere(make: impl Fn() -> Panels, shown: &Shown<'_>) -> Vec<Asked> {
    let mut all = Vec::new();
    let mut panels = make();
    frame(&mut panels, shown, Vec::new());
    for (x, y) in (0..50).flat_map(|y| (0..25).map(move |x| (x, y))) {
        let pos = Pos2::new(20.0 + 40.0 * x as f32, 7.0 + 14.0 * y as f32);
        let asked = click(&mut panels, shown, pos);
        let moved_on = panels.is_open() != make().is_open() || panels.browser.is_some();
        if !asked.is_empty() || moved_on || panels.finishing {
            panels = make();
            frame(&mut panels, shown, Vec::new());
        }
        for asked in asked {
            if !all.contains(&asked) {
                all.push(asked);
            }
        }
    }
    all
}

fn in_studio() -> Panels {
    let mut panels = Panels::new();
    panels.started();
    panels
}

#[test]
fn every_mode_can_be_started() {
    let asked = clicked_everywhere(Panels::new, &Shown { session: Session::Waiting, ..shown() });
    let figures = (0..4).map(|figure| Mode::Constrained { figure });
    for mode in [Mode::FreeForm, Mode::Creative].into_iter().chain(figures) {
        assert!(asked.contains(&Asked::Start(mode)), "{mode:?} is not among {asked:?}");
    }
}

#[test]
fn tools_bits_and_commands_can_be_clicked() {
    let asked = clicked_everywhere(in_studio, &shown());
    let mut expected: Vec<_> = Tool::ALL.map(|tool| Asked::Take(Item::Tool(tool))).into();
    expected.push(Asked::Take(Item::Bit(Bit::FlatChisel)));
    for command in [commands::UNDO, commands::REDO, commands::SYMMETRY] {
        expected.push(Asked::Command(command));
    }
    for one in expected {
        assert!(asked.contains(&one), "{one:?} is not among {asked:?}");
    }
    assert!(!asked.contains(&Asked::Finish), "the end is asked for twice");
}

#[test]
fn the_end_is_asked_for_twice_and_can_be_taken_back() {
    let mut panels = in_studio();
    panels.finish(Session::Sculpting);
    assert_eq!(frame(&mut panels, &shown(), Vec::new()), []);
    panels.back(Session::Sculpting);
    panels.finish(Session::Sculpting);
    assert_eq!(frame(&mut panels, &shown(), Vec::new()), []);
    panels.finish(Session::Sculpting);
    assert_eq!(frame(&mut panels, &shown(), Vec::new()), [Asked::Finish]);
    panels.finish(Session::Finished);
    assert_eq!(frame(&mut panels, &shown(), Vec::new()), []);
}

#[test]
fn the_start_stays_until_there_is_a_session() {
    let mut panels = Panels::new();
    panels.back(Session::Waiting);
    assert!(!panels.is_open());
    panels.back(Session::Sculpting);
    assert!(panels.is_open());
    panels.back(Session::Sculpting);
    assert!(!panels.is_open());
}

#[test]
fn panels_fit_the_overlay() {
    let mut panels = in_studio();
    panels.switch_help();
    panels.switch_graph();
    for i in 0..200 {
        panels.frame_took(0.001 * i as f32);
    }
    panels.note(Note::Bad("something long to read ".repeat(20)));
    let mut painted = crate::window::paint::Painted::new();
    let mut lay_out = || {
        panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
        let (output, _) = panels.lay_out(&shown());
        painted.take_textures(&output.textures_delta);
        output.shapes
    };
    // A panel is measured before it is seen.
    lay_out();
    let shapes = lay_out();
    let triangles = panels.context.tessellate(shapes, 1.0);
    painted.take_triangles(&triangles, 1.0);
    let (vertices, indices, runs) = painted.lengths();
    use paros_shaders::gpu::overlay::{INDICES, RUNS, VERTICES};
    assert!(vertices > 1000 && indices > vertices && runs > 0);
    assert!(vertices * 2 < VERTICES && indices * 2 < INDICES && runs * 2 < RUNS);
}

#[test]
fn files_are_to_be_dropped_only_where_they_can_be() {
    let says_so = |drops| {
        let mut panels = Panels::new();
        let mut lay_out = || {
            panels.input.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, SIZE));
            panels.lay_out(&Shown { drops, ..shown() }).0.shapes
        };
        // A panel is measured before it is seen.
        lay_out();
        lay_out().iter().any(|shape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text().contains("drop a file"),
            _ => false,
        })
    };
    assert_eq!([true, false].map(says_so), [true, false]);
}
