//! What a frame costs the shell itself: memory, and time on a processor.

use std::collections::BTreeSet;
use std::fs;
use std::thread;
use std::time::{Duration, SystemTime};

use paros_core::frame::STOOL;
use paros_core::tools::Tool;
use paros_shell::require::require;

use super::layered::example;
use super::monado::{Hand, Hands, Monado, Shell, Tree};
use super::{REST, RIGHT, hands_at_rest, take};

/// Frames that may take memory, and those that are looked at.
const FIRST: u64 = 100;
const FRAMES: u64 = 1000;

/// Of these, frames in which the visitor sculpts.
const BUSY: u64 = 600;

/// Nanoseconds that a frame may take of the shell's own at the median.
const MOST: u64 = 300_000;

/// Memory is the shell's own, too: what drivers take is theirs.
#[test]
fn a_frame_takes_little_time_and_no_memory() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(frugal) = require(example("frugal")).unwrap() else { return };
    let monado = Monado::start(&tree, "frugal");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.shell_of(&frugal, &["files", &FRAMES.to_string()]);
    shell.until("a session", |said| said.field("session") == "Sculpting");
    take(&mut hands, &mut shell, Tool::Rotary);
    let before = shell.until("the first frames", |said| said.number("frames") > FIRST);
    let saves = sculpt(&monado, &mut hands, &mut shell);
    let gone = before.number("voxels") - shell.say().number("voxels");
    let (said, code, errors) = shell.last_words();
    println!("{gone} voxels, {saves} saves, nanoseconds: {}", said.all());
    assert_eq!(code, Some(0), "{errors}");
    assert!(gone > 1000 && saves > 4, "{gone} voxels are gone, {saves} saves");
    assert_eq!(said.number("frames"), FRAMES);
    assert!(said.number("first") > 0, "nothing counts");
    assert_eq!((said.number("allocating"), said.number("most")), (0, 0));
    assert!(said.number("calls") > 100 && said.number("steps") > 0, "what is taken off?");
    assert!(said.number("own") < MOST, "{}", said.all());
}

/// Goes over the stone with a running tool, stroke by stroke; how many saves appear.
fn sculpt(monado: &Monado, hands: &mut Hands, shell: &mut Shell) -> usize {
    let begun = shell.say().number("frames");
    let file = monado.folder.join("files/sessions/session-128.save");
    let reach = Tool::Rotary.length() as f32 * 1e-6;
    let mut saved: BTreeSet<SystemTime> = BTreeSet::new();
    let mut moves = 0u16;
    while shell.say().number("frames") < begun + BUSY {
        for _ in 0..20 {
            let t = f32::from(moves);
            let (x, y) = (0.1 * (t * 0.3).sin(), 0.27 + 0.05 * (t * 0.11).sin());
            let at = Hand::at(x, STOOL.y + y, reach - 0.3 - 0.0002 * t);
            hands.hold(RIGHT, Hand { trigger: f32::from(u8::from(moves % 40 < 30)), ..at });
            moves += 1;
            thread::sleep(Duration::from_millis(50));
        }
        saved.extend(fs::metadata(&file).and_then(|file| file.modified()));
    }
    hands.hold(RIGHT, REST);
    saved.len()
}
