//! The cost of a frame in the shell itself: allocations and CPU time.

use std::collections::BTreeSet;
use std::fs;
use std::thread;
use std::time::{Duration, SystemTime};

use paros_core::internals::STOOL_TOP;
use paros_core::session::Tool;
use paros_shell::require::require_or_skip;

use super::layered::find_rig;
use super::monado::{MonadoService, MonadoTree, RemoteHand, RemoteHands, ShellEnd, ShellProcess};
use super::{REST, RIGHT, hands_at_rest, take_tool};

/// Warm-up frames, which may allocate, and measured frames.
const FIRST: u64 = 100;
const FRAMES: u64 = 500;

/// Measured frames in which the visitor sculpts.
const BUSY: u64 = 320;

/// The limit of the median CPU time of a frame, without the clock's own, as a multiple of the reference
/// calculation, which the program runs between its frames (some 0.2 ms on the machines of CI). Measured: 1.3.
/// A limit in nanoseconds failed on machines where the clock alone took half of it.
const MOST_REFERENCES: u64 = 2;

/// Counts only the shell's own allocations, not those of drivers.
#[test]
fn a_frame_takes_little_time_and_no_memory() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(frugal) = require_or_skip(find_rig("frugal")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "frugal");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.start_program(&frugal, &["files", &FRAMES.to_string()]);
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    let before = shell.wait_until("the first frames", |said| said.number("frames") > FIRST);
    let saves = sculpt_while_busy(&monado, &mut hands, &mut shell);
    let gone = before.number("voxels") - shell.query_status().number("voxels");
    let (said, ShellEnd { code, errors }) = shell.wait_for_last_status();
    println!("{gone} voxels, {saves} saves, nanoseconds: {}", said.text());
    assert_eq!(code, Some(0), "{errors}");
    assert!(gone > 1000 && saves > 2, "{gone} voxels are gone, {saves} saves");
    assert_eq!(said.number("frames"), FRAMES);
    assert!(said.number("first") > 0, "nothing counts");
    assert_eq!((said.number("allocating"), said.number("most")), (0, 0));
    assert!(said.number("calls") > 100 && said.number("steps") > 0, "what is taken off?");
    let own = said.number("own").saturating_sub(said.number("clock"));
    assert!(own > 0 && said.number("reference") > 0, "what is measured? {}", said.text());
    assert!(own < MOST_REFERENCES * said.number("reference"), "{}", said.text());
}

/// Sculpts with a running tool, stroke by stroke, for [`BUSY`] frames. Returns the number of written saves.
fn sculpt_while_busy(
    monado: &MonadoService,
    hands: &mut RemoteHands,
    shell: &mut ShellProcess,
) -> usize {
    let begun = shell.query_status().number("frames");
    let file = monado.folder.join("files/sessions/session-128.save");
    let reach = Tool::Rotary.length_um() as f32 * 1e-6;
    let mut saved: BTreeSet<SystemTime> = BTreeSet::new();
    let mut moves = 0u16;
    while shell.query_status().number("frames") < begun + BUSY {
        for _ in 0..20 {
            let t = f32::from(moves);
            let (x, y) = (0.1 * (t * 0.3).sin(), 0.27 + 0.05 * (t * 0.11).sin());
            let at = RemoteHand::at(x, STOOL_TOP.y + y, reach - 0.3 - 0.0002 * t);
            hands.place_hand(
                RIGHT,
                RemoteHand { trigger: f32::from(u8::from(moves % 40 < 30)), ..at },
            );
            moves += 1;
            thread::sleep(Duration::from_millis(50));
        }
        saved.extend(fs::metadata(&file).and_then(|file| file.modified()));
    }
    hands.place_hand(RIGHT, REST);
    saved.len()
}
