//! Another start while a sculpture exists: confirmation, a fresh session, and the way back.

use paros_shaders::Image;
use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{
    STROKE, ScriptedWindow, XvfbDisplay, check_program, count_differing, empty_folder,
};

/// Size of the window in pixels.
const SIZE: [usize; 2] = [1180, 800];

/// A window with its start panel.
struct Visit {
    display: XvfbDisplay,
    window: ScriptedWindow,
}

impl Visit {
    /// Clicks on a point of the window.
    fn click(&mut self, x: u32, y: u32) {
        self.display.xdotool(&format!("mousemove {x} {y}"));
        self.window.do_step("frames 3");
        self.display.xdotool("click 1");
        self.window.do_step("frames 4");
    }

    /// Returns the picture, with the cursor off the stone.
    fn look(&mut self, name: &str) -> Image {
        self.display.xdotool("mousemove 20 780");
        self.window.screenshot(&self.display, name)
    }

    fn voxels(&mut self) -> u64 {
        self.window.voxel_count()
    }
}

#[test]
fn another_start_is_asked_for_and_the_one_before_comes_back() -> Result<(), MissingDependency> {
    let folder = empty_folder("starts");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, SIZE))? else {
        return Ok(());
    };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let window = ScriptedWindow::new(&display);
    let mut visit = Visit { display, window };
    visit.window.do_all(&["start free", "wait 4"]);
    let (whole, fresh) = (visit.voxels(), visit.look("1-fresh"));
    // A start that discards nothing needs no confirmation.
    visit.window.do_all(&["key escape", "frames 2"]);
    visit.look("2-start-of-untouched");
    visit.click(590, 284);
    assert_eq!(&*visit.window.ask_state("session"), "Sculpting");
    visit.window.do_all(&["wheel 9", "key m", "wait 2"]);
    visit.window.do_all(&STROKE);
    visit.window.do_all(&["zoom 3", "move 3 97", "wait 100"]);
    let left = visit.voxels();
    assert!(left + 300 < whole, "{left} voxels are left of {whole}");
    let carved = visit.look("3-carved");
    assert!(count_differing(&fresh, &carved, [0, SIZE[0]], [0, SIZE[1]]) > 50_000);
    // Cancelled by a key, twice.
    visit.window.do_all(&["key escape", "frames 2"]);
    visit.click(590, 284);
    visit.look("4-asked");
    assert_eq!(visit.voxels(), left);
    visit.window.do_all(&["key escape", "frames 2", "key escape", "frames 2"]);
    assert_eq!(visit.voxels(), left);
    // Confirmed: everything is as at the first start.
    visit.window.do_all(&["key escape", "frames 2"]);
    visit.click(590, 284);
    visit.window.do_all(&["key enter", "frames 4"]);
    assert_eq!(visit.voxels(), whole);
    let again = visit.look("5-anew");
    // Everything except the line of hints, where the hint about cutting is gone.
    let rows = [[0, 630], [662, SIZE[1]]];
    let others: usize =
        rows.into_iter().map(|rows| count_differing(&fresh, &again, [0, SIZE[0]], rows)).sum();
    assert!(others < 100, "eye, depth and mirror: {others} pixels are others");
    // The previous sculpture is back, with its strokes to undo.
    visit.window.do_all(&["key escape", "frames 2"]);
    visit.look("6-offered");
    visit.click(590, 244);
    assert_eq!((visit.voxels(), &*visit.window.ask_state("undo")), (left, "1"));
    let back = visit.look("7-back");
    let groove = count_differing(&again, &back, [400, 780], [200, 560]);
    assert!(groove > 500, "the groove is seen in {groove} pixels");
    visit.window.do_all(&["key z", "wait 2"]);
    assert_eq!(visit.voxels(), whole);
    assert_eq!(visit.window.close(), (Some(0), String::new()));
    Ok(())
}
