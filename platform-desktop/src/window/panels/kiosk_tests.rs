//! Tests of the texts that a kiosk's panels show or hide.

use paros_core::edit::UndoCounts;
use paros_core::session::SessionState;

use super::tests::{frame, sculpting_status, text_and_bare_text};
use super::{PanelAction, Panels, StudioStatus};

fn in_studio() -> Panels {
    let mut panels = Panels::new();
    panels.close_covering_panels();
    panels
}

/// In a kiosk, the next visitor can't go back to the last visitor's finished sculpture.
#[test]
fn the_next_visitor_is_not_offered_what_the_last_one_finished() {
    for kiosk in [false, true] {
        let status = StudioStatus { kiosk, session: SessionState::Finished, ..sculpting_status() };
        let mut panels = Panels::new();
        frame(&mut panels, &status, Vec::new());
        let [all, _] = text_and_bare_text(&mut panels, &status);
        assert!(all.iter().any(|text| text.contains("Free form")), "{all:?}");
        assert_eq!(all.iter().any(|text| text.contains("Back to")), !kiosk, "{all:?}");
    }
}

#[test]
fn a_kiosks_visitor_is_told_of_the_handover_over_every_panel_and_of_no_folders() {
    let words = |mut panels: Panels, status: &StudioStatus<'_>| {
        text_and_bare_text(&mut panels, status)[0].join("; ")
    };
    let path = std::path::Path::new("/srv/kiosk/sculpture-041.stl");
    let left = StudioStatus {
        kiosk: true,
        seconds_to_handover: Some(9),
        printed: Some(path),
        ..sculpting_status()
    };
    let finished = StudioStatus { session: SessionState::Finished, ..left };
    let mut asking = in_studio();
    asking.ask_to_start(PanelAction::StartRead);
    for panels in [in_studio(), Panels::new(), asking] {
        let told = words(panels, &left);
        assert!(told.contains("In 9 s your sculpture is finished"), "{told}");
    }
    let told = words(in_studio(), &finished);
    assert!(told.contains("the next visitor's turn") && told.contains("sculpture-041"), "{told}");
    assert!(!told.contains("/srv") && !told.contains(".rmap"), "{told}");
    assert!(words(in_studio(), &StudioStatus { kiosk: false, ..finished }).contains("/srv"));
    assert!(!words(Panels::new(), &finished).contains("In 9 s"), "the start is there already");
    let mut help = in_studio();
    help.toggle_help();
    let told = words(help, &StudioStatus { printed: None, ..left });
    assert!(told.contains("Mouse and keys") && !told.contains("file"), "{told}");
}

#[test]
fn the_next_visitor_is_told_what_the_last_one_has_learnt() {
    let told = |panels: &mut Panels, undoable| {
        let undo = UndoCounts { undoable, redoable: 0 };
        let status = StudioStatus { kiosk: true, undo, ..sculpting_status() };
        frame(panels, &status, Vec::new());
        text_and_bare_text(panels, &status)[0].join("; ")
    };
    let mut panels = in_studio();
    assert!(told(&mut panels, 0).contains("Hold the left button"), "the first gesture");
    assert!(!told(&mut panels, 1).contains("Hold the left button"), "it is known");
    panels.toggle_help();
    panels.forget_visitor();
    let text = told(&mut panels, 0);
    assert!(text.contains("Hold the left button") && !text.contains("Mouse and keys"), "{text}");
}
