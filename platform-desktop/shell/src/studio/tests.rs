//! When a session is saved, and when that has to wait.

use std::fs;

use paros_core::input::{Input, Mode};
use paros_core::size::Grid;

use super::Studio;
use crate::places::Places;
use crate::print::{HEIGHT_MM, Printer};
use crate::statics::Resident;

#[test]
fn a_save_waits_for_the_one_before_it() {
    let folder = std::env::temp_dir().join(format!("paros-studio-{}", std::process::id()));
    let (mut world, mut volumes) = (Grid::<128>::world(), Grid::<128>::start_volumes());
    let mut press = Grid::<128>::press();
    let printer = Printer::new(&mut press, HEIGHT_MM).expect("a height");
    let places = Places::within(&folder);
    let mut studio =
        Studio::new(&mut world, &mut volumes, printer, places, |_| Err("no picture".into()));
    studio.tick(&Input { start: Mode::FreeForm, ..Input::default() });
    studio.save();
    studio.tick(&Input::default());
    // The first is being written, or waits to be taken in: nothing holds its bytes anew.
    studio.save();
    assert!(studio.saving.is_none() && studio.due);
    while studio.saving.is_none() {
        studio.poll();
    }
    let saved = |studio: &Studio<'_, 128>| {
        let bytes = fs::read(studio.places().session(128)).expect("a save");
        u64::from_le_bytes(bytes[16..24].try_into().expect("a tick"))
    };
    assert_eq!((saved(&studio), studio.due), (1, true));
    studio.tick(&Input::default());
    assert!(studio.saving.is_none() && !studio.due, "it comes with the next tick");
    // At the end nothing is left due, whatever is under way.
    studio.tick(&Input::default());
    studio.close().expect("a disk");
    assert_eq!((saved(&studio), studio.world().tick()), (4, 4));
    drop(studio);
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}
