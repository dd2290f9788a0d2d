//! Dynamic resolution, by the runtime's recommendation, or by the GPU's frame times, which are long for the
//! fast display that the layer reports.

use std::fs;

use paros_shell::require::require_or_skip;

use super::layered::{assert_no_violations, find_rig, read_log};
use super::monado::{MonadoService, MonadoTree, ShellEnd, wait_for};
use super::{hands_at_rest, read_frame, visitor_eyes};

/// Returns the submitted rectangles, in order.
fn submitted(monado: &MonadoService) -> Vec<[u32; 2]> {
    submitted_in_frames(monado).into_iter().map(|[width, height, _]| [width, height]).collect()
}

/// Returns the submitted rectangles, each with the number of the first frame that had it.
fn submitted_in_frames(monado: &MonadoService) -> Vec<[u32; 3]> {
    let log = read_log(monado);
    let lines = log.lines().filter_map(|line| line.strip_prefix("submitted "));
    let numbers = |line: &str| {
        let (size, frame) = line.split_once(" in frame ")?;
        let (width, height) = size.split_once('x')?;
        Some([width, height, frame].map(|number| number.parse().expect("a number")))
    };
    lines.filter_map(numbers).collect()
}

#[test]
fn pictures_shrink_under_load_and_follow_the_runtime() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "resolution");
    let mut hands = hands_at_rest(&monado);
    hands.place_eyes(&visitor_eyes());
    fs::create_dir_all(monado.folder.join("layer")).expect("a folder");
    fs::write(monado.folder.join("layer/fast-display"), "").expect("a wish");
    let mut shell = monado.start_layered_shell(&layer, &["--least-resolution", "85"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    // Three windows of nine frames, with two frames in flight after each: less than a second's frames.
    wait_for("three steps", || submitted(&monado).len() == 4);
    let changes = submitted_in_frames(&monado);
    let frames = changes[3][2] - changes[0][2];
    let sizes = submitted(&monado);
    for (size, percent) in sizes.iter().zip([100, 95, 90, 85]) {
        for (k, pixels) in size.iter().enumerate() {
            let exact = f64::from(sizes[0][k] * percent) / 100.0;
            assert!((f64::from(*pixels) - exact).abs() <= 1.0, "{sizes:?}");
        }
    }
    assert!(frames <= 3 * (9 + 2) + 3, "{frames} frames: {changes:?}");

    let [width, height] = sizes[0];
    let recommended = [width * 9 / 10 + 1, height * 19 / 20];
    let file = monado.folder.join("layer/recommended");
    fs::write(&file, format!("{} {}", recommended[0], recommended[1])).expect("a wish");
    wait_for("the runtime's wish", || submitted(&monado).last() == Some(&recommended));
    fs::write(&file, "1 100000").expect("a wish");
    wait_for("its bounds", || submitted(&monado).last() == Some(&[sizes[3][0], height]));
    fs::remove_file(&file).expect("it is ours");
    wait_for("the shell's own", || submitted(&monado).last() == Some(&sizes[3]));
    let [seen, _] = shell.capture_eyes(&monado.folder, "small").map(|path| read_frame(&path));
    assert_eq!([seen.width as u32, seen.height as u32], sizes[3], "what was drawn is read back");

    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("pictures of 85 % a side"), "{errors}");
    assert_no_violations(&read_log(&monado));
}
