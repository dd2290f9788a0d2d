//! The headset is put off and on again: by the same visitor soon, by another one later.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use paros_core::maps::Maps;
use paros_core::tools::Tool;
use paros_core::volume::Volume;
use paros_shell::require::require;
use paros_shell::rmap;

use super::layered::{example, inject, log, nothing_is_violated};
use super::monado::{Monado, Tree, wait_for};
use super::{carve, hands_at_rest, take};

/// How long the headset is off for the next one to be another visitor; here, at least.
const HANDOVER: Duration = Duration::from_secs(4);

#[test]
fn another_visitor_finds_a_new_stone_and_the_last_ones_sculpture_is_kept() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "handover");
    let mut hands = hands_at_rest(&monado);
    let seconds = HANDOVER.as_secs().to_string();
    let mut shell = monado.layered_shell(&layer, &["--handover", &seconds]);
    let whole = shell.until("a session", |said| said.field("session") == "Sculpting");
    let whole = whole.number("voxels");
    take(&mut hands, &mut shell, Tool::Rotary);
    carve(&mut hands, &mut shell, 1000);
    let before = shell.say();
    let voxels = before.number("voxels");

    // The same one.
    inject(&monado, "presence 0");
    inject(&monado, "presence 1");
    let after = shell.frames(5);
    assert_eq!((after.number("voxels"), after.field("session")), (voxels, "Sculpting"));
    assert!(after.number("ticks") > before.number("ticks") && after.number("undo") > 0);
    assert!(sculptures(&monado, "stl").is_empty());

    // Another one.
    inject(&monado, "presence 0");
    std::thread::sleep(HANDOVER + Duration::from_millis(500));
    let away = shell.say();
    assert_eq!((away.number("voxels"), away.field("session")), (voxels, "Sculpting"), "not yet");
    inject(&monado, "presence 1");
    let anew = shell.until("a new stone", |said| said.number("voxels") == whole);
    assert_eq!((anew.field("session"), anew.number("undo")), ("Sculpting", 0));
    assert!(anew.number("ticks") < away.number("ticks"), "it starts from its first tick");
    wait_for("the print", || ["stl", "png"].iter().all(|end| sculptures(&monado, end).len() == 1));
    let (mut maps, mut volume) = (Box::new(Maps::<128>::new()), Box::new(Volume::new()));
    rmap::read(&sculptures(&monado, "rmap")[0], &mut maps).expect("a volume");
    volume.set_maps(&maps);
    assert_eq!(volume.count(), voxels, "what was sculpted, and all of it");

    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(errors.matches("another visitor\n").count(), 1, "{errors}");
    nothing_is_violated(&log(&monado));
}

/// Finished sculptures' files of a kind.
fn sculptures(monado: &Monado, ending: &str) -> Vec<PathBuf> {
    let Ok(all) = fs::read_dir(monado.folder.join("files/sculptures")) else { return Vec::new() };
    let all = all.map(|entry| entry.expect("a file").path());
    all.filter(|path| path.extension().is_some_and(|end| end == ending)).collect()
}
