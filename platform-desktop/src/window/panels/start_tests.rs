//! Tests of the start panel without a window: pictures, and the stone thickness over a hidden figure.

use egui::{Event, Modifiers, PointerButton, Pos2, Rect};
use paros_core::session::{SessionMode, SessionState};

use super::tests::{click, frame, sculpting_status, shapes_of};
use super::{PanelAction, Panels, StudioStatus};

#[test]
fn how_much_stone_hides_a_figure_is_chosen() {
    let status =
        StudioStatus { session: SessionState::Waiting, unfinished: false, ..sculpting_status() };
    let mut panels = Panels::new();
    let mut start_owl_under = |words: Option<&str>| {
        for text in words.into_iter().chain(["Owl"]) {
            frame(&mut panels, &status, Vec::new());
            let place = place_of_text(&status, text);
            let asked = click(&mut panels, &status, place);
            if text == "Owl" {
                return asked;
            }
            assert_eq!(asked, [], "{text}");
        }
        unreachable!("the owl is clicked last");
    };
    for (words, figure) in
        [(None, 8), (Some("all of it"), 0), (Some("half the stone"), 4), (Some("a thin coat"), 8)]
    {
        let expected = PanelAction::Start(SessionMode::Constrained { figure });
        assert_eq!(start_owl_under(words), [expected], "{words:?}");
    }
}

/// Returns the middle of a text that new panels show.
fn place_of_text(status: &StudioStatus<'_>, text: &str) -> Pos2 {
    let shown = shapes_of(&mut Panels::new(), status).into_iter().find_map(|shape| match shape {
        egui::Shape::Text(shown) if shown.galley.text() == text => {
            Some(shown.galley.rect.translate(shown.pos.to_vec2()).center())
        }
        _ => None,
    });
    shown.unwrap_or_else(|| panic!("{text:?} isn't shown"))
}

#[test]
fn each_start_shows_its_own_picture_and_is_chosen_by_it() {
    use crate::window::start_pictures::{PICTURE_SIZE, pictured_figures};
    let with_pictures = || {
        let mut panels = Panels::new();
        let [width, height] = PICTURE_SIZE;
        let width = width * pictured_figures().count();
        let pixels = vec![90; 3 * width * height];
        panels.set_start_pictures(&paros_shaders::Image { width, height, pixels });
        panels
    };
    let status =
        StudioStatus { session: SessionState::Waiting, unfinished: false, ..sculpting_status() };
    let shown: Vec<_> = shapes_of(&mut with_pictures(), &status)
        .into_iter()
        .filter_map(|shape| match shape {
            egui::Shape::Mesh(mesh) => {
                let parts: Vec<_> = mesh.vertices.iter().map(|vertex| vertex.uv).collect();
                Some((mesh.calc_bounds(), Rect::from_points(&parts).center()))
            }
            _ => None,
        })
        .collect();
    assert_eq!(shown.len(), pictured_figures().count());
    let mut chosen = Vec::new();
    for (place, part) in &shown {
        let mut panels = with_pictures();
        frame(&mut panels, &status, Vec::new());
        let asked = click(&mut panels, &status, place.center());
        let number = (part.x * shown.len() as f32) as usize;
        chosen.push((pictured_figures().nth(number).expect("a figure").name(), asked));
    }
    let start = |mode| vec![PanelAction::Start(mode)];
    let mut expected =
        vec![("lump", start(SessionMode::FreeForm)), ("toy", start(SessionMode::Creative))];
    for (figure, name) in (8..).zip(["owl", "cat", "amphora", "dolphin"]) {
        expected.push((name, start(SessionMode::Constrained { figure })));
    }
    assert_eq!(chosen, expected);
}

/// If frames take seconds, a click takes seconds too.
#[test]
fn a_click_may_take_as_long_as_frames_do() {
    let status = StudioStatus { unfinished: false, ..sculpting_status() };
    let mut panels = Panels::new();
    let pos = Pos2::new(300.0, 400.0);
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let mut asked = Vec::new();
    for (seconds, event) in [
        (1.0, None),
        (3.0, Some(Event::PointerMoved(pos))),
        (5.0, Some(button(true))),
        (9.0, Some(button(false))),
    ] {
        panels.input.time = Some(seconds);
        asked.extend(frame(&mut panels, &status, event.into_iter().collect()));
    }
    assert!(matches!(asked[..], [PanelAction::Start(_)]), "{asked:?}");
}
