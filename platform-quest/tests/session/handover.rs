//! User presence: if the headset is put on again soon, the session continues; later, the next visitor's
//! session starts.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use paros_core::limits::INTERVALS;
use paros_core::session::Tool;
use paros_core::{RangeMaps, Volume};
use paros_shell::require::require_or_skip;
use paros_shell::rmap;

use super::layered::{assert_no_violations, find_rig, inject_event, read_log};
use super::monado::{MonadoService, MonadoTree, ShellEnd, wait_for};
use super::{carve_voxels, hands_at_rest, take_tool};

/// The handover time of this test: after a longer time off the head, the user is another visitor. It is
/// longer than the pauses in which the driver's head and hands don't move, which would count as unused.
const HANDOVER: Duration = Duration::from_secs(30);

#[test]
fn another_visitor_finds_a_new_stone_and_the_last_ones_sculpture_is_kept() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "handover");
    let mut hands = hands_at_rest(&monado);
    let seconds = HANDOVER.as_secs().to_string();
    let mut shell = monado.start_layered_shell(&layer, &["--handover", &seconds]);
    let whole = shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let whole = whole.number("voxels");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    carve_voxels(&mut hands, &mut shell, 1000);
    let before = shell.query_status();
    let voxels = before.number("voxels");

    // The same visitor.
    inject_event(&monado, "presence 0");
    inject_event(&monado, "presence 1");
    let after = shell.wait_frames(5);
    assert_eq!((after.number("voxels"), after.field("session")), (voxels, "Sculpting"));
    assert!(after.number("ticks") > before.number("ticks") && after.number("undo") > 0);
    assert!(finished_sculptures(&monado, "stl").is_empty());

    // Another visitor.
    inject_event(&monado, "presence 0");
    std::thread::sleep(HANDOVER + Duration::from_millis(500));
    let away = shell.query_status();
    assert_eq!((away.number("voxels"), away.field("session")), (voxels, "Sculpting"), "not yet");
    inject_event(&monado, "presence 1");
    let anew = shell.wait_until("a new stone", |said| said.number("voxels") == whole);
    assert_eq!((anew.field("session"), anew.number("undo")), ("Sculpting", 0));
    assert!(anew.number("ticks") < away.number("ticks"), "it starts from its first tick");
    wait_for("the print", || {
        ["stl", "png"].iter().all(|end| finished_sculptures(&monado, end).len() == 1)
    });
    let (mut maps, mut volume) =
        (Box::new(RangeMaps::<128, INTERVALS>::new()), Box::new(Volume::new()));
    rmap::read(&finished_sculptures(&monado, "rmap")[0], &mut maps).expect("a volume");
    volume.set_maps(&maps);
    assert_eq!(volume.count_voxels(), voxels, "what was sculpted, and all of it");

    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(errors.matches("another visitor\n").count(), 1, "{errors}");
    assert_no_violations(&read_log(&monado));
}

/// Returns the paths of the finished sculptures' files with an extension.
pub(crate) fn finished_sculptures(monado: &MonadoService, ending: &str) -> Vec<PathBuf> {
    let Ok(all) = fs::read_dir(monado.folder.join("files/sculptures")) else { return Vec::new() };
    let all = all.map(|entry| entry.expect("a file").path());
    all.filter(|path| path.extension().is_some_and(|end| end == ending)).collect()
}
