//! Tests of a program that ends during the export of a visit's sculpture, and of its next start.

mod program;

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use paros_core::limits::INTERVALS;
use paros_core::visit::{Presence, StaffCommand, VisitCommand, VisitInput, VisitPhase};
use paros_core::{RangeMaps, TickInput};

use super::Studio;
use crate::statics::Resident;
use crate::studio::DrawPicture;
use crate::studio_paths::StudioPaths;
use program::{run_program, sculpt_in_a_visit, told};

/// `true` if pictures may be drawn. Only one test at a time has the world, and one of them delays pictures.
static MAY_DRAW: AtomicBool = AtomicBool::new(true);

fn draw_no_picture(_: &RangeMaps<128, INTERVALS>) -> Result<Vec<u8>, String> {
    while !MAY_DRAW.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(5));
    }
    Err("no picture".into())
}

/// A guard that delays all pictures until it is dropped, also by a failed test.
struct DrawingPause;

impl DrawingPause {
    fn begin() -> Self {
        MAY_DRAW.store(false, Ordering::Relaxed);
        DrawingPause
    }
}

impl Drop for DrawingPause {
    fn drop(&mut self) {
        MAY_DRAW.store(true, Ordering::Relaxed);
    }
}

/// Staff restart the visits during an export, and the next visitor begins at once.
#[test]
fn a_sculpture_is_saved_until_its_files_are_made_whoever_comes_next() {
    let folder = std::env::temp_dir().join(format!("paros-next-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    run_program(&folder, draw_no_picture, |studio| {
        let pause = DrawingPause::begin();
        sculpt_in_a_visit(studio);
        assert_eq!(studio.count_unkept_sculptures(), 1, "it is being made");
        for presence in [Presence::Off, Presence::Worn] {
            let command = VisitCommand::Staff(StaffCommand::Reset);
            let visit = VisitInput { presence, is_used: false, command };
            studio.run_tick(&TickInput { visit, ..TickInput::default() });
        }
        assert_eq!(studio.world().visit().phase(), VisitPhase::Welcome);
        for _ in 0..4 {
            (0..300).for_each(|_| studio.run_tick(&told(VisitCommand::None)));
            while studio.file_writer().is_busy() {
                studio.poll_background_work();
            }
        }
        assert!(studio.is_exporting(), "its picture is still being drawn");
        drop(pause);
    });
    run_program(&folder, draw_no_picture, |studio| {
        assert!(studio.is_exporting(), "it is lost: {:?}", studio.world().visit().phase());
        // The next visitor's session may be saved once the writer has the files.
        studio.run_tick(&told(VisitCommand::Open));
        studio.save_session_and_wait();
        assert!(folder.join("sculptures/sculpture-001.stl").exists());
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// Files that could not be written are retried when the next visitor comes, not only at the program's end.
#[test]
fn a_visits_sculpture_that_could_not_be_written_is_written_for_the_next_visitor() {
    let folder = std::env::temp_dir().join(format!("paros-retried-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    run_program(&folder, draw_no_picture, |studio| {
        sculpt_in_a_visit(studio);
        // Files take the places of the folders.
        let folders = ["sculptures", "sessions"].map(|name| folder.join(name));
        let aside = folder.join("aside");
        studio.save_session_and_wait();
        let has_sculptures = folders[0].exists();
        fs::rename(&folders[1], &aside).expect("the sessions are moved");
        if has_sculptures {
            fs::remove_dir_all(&folders[0]).expect("nothing is in it");
        }
        folders.iter().for_each(|path| fs::write(path, "in the way").expect("a file"));
        for count in [1, 2] {
            (0..400).for_each(|_| studio.run_tick(&told(VisitCommand::None)));
            while studio.is_exporting() {
                studio.poll_background_work();
            }
            assert!(studio.has_writes_to_retry());
            assert_eq!(studio.count_unkept_sculptures(), count);
            if count == 1 {
                sculpt_in_a_visit(studio);
            }
        }
        folders.iter().for_each(|path| fs::remove_file(path).expect("it was there"));
        fs::rename(&aside, &folders[1]).expect("the sessions are back");
        studio.run_tick(&told(VisitCommand::Open));
        studio.save_session_and_wait();
        assert!(!studio.has_writes_to_retry());
        assert_eq!(studio.count_unkept_sculptures(), 0);
        for name in ["sculpture-001.stl", "sculpture-002.stl"] {
            assert!(folders[0].join(name).exists(), "{name}");
        }
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

#[test]
fn a_visits_sculpture_outlives_a_program_that_ends_before_its_files_are_written() {
    let folder = std::env::temp_dir().join(format!("paros-cut-off-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    let is_print = |path: std::path::PathBuf| path.extension().is_some_and(|end| end == "stl");
    let prints = || {
        let entries = folder.join("sculptures").read_dir();
        entries
            .map_or(0, |all| all.filter(|e| is_print(e.as_ref().expect("a file").path())).count())
    };
    run_program(&folder, draw_no_picture, |studio| {
        sculpt_in_a_visit(studio);
        assert!(studio.is_exporting());
        studio.save_session_and_wait();
    });
    assert_eq!(prints(), 0, "the end came first");
    run_program(&folder, draw_no_picture, |studio| {
        assert_eq!(studio.world().visit().phase(), VisitPhase::Export);
        assert!(studio.is_exporting(), "it is made again");
        // Ticks are faster here than the disk, and the visit continues with them.
        (0..400).for_each(|_| studio.run_tick(&told(VisitCommand::None)));
        while studio.is_exporting() {
            studio.poll_background_work();
        }
        assert!(studio.session_stl_path().is_some());
        studio.save_session_and_wait();
    });
    assert_eq!(prints(), 1);
    run_program(&folder, draw_no_picture, |studio| {
        assert!(!studio.is_exporting(), "it is there");
        assert!(studio.session_stl_path().is_some());
    });
    assert_eq!(prints(), 1);
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// The volume is found among many, including a user's own files with longer or numbered names.
#[test]
fn a_print_is_found_by_the_number_in_its_name() {
    let folder = std::env::temp_dir().join(format!("paros-numbered-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, volume: &[u8]| {
        fs::write(folder.join(name).with_extension("rmap"), volume).expect("a volume");
        fs::write(folder.join(name).with_extension("stl"), "a print").expect("a print");
    };
    (990..1002).for_each(|number| write(&format!("sculpture-{number:03}"), b"another"));
    write("sculpture-1002", b"the one");
    for own in ["sculpture-by-a-visitor-2026", "my-own-sculpture-99999", "sculpture-+2000"] {
        write(own, b"a user's own");
    }
    let find = |volume: &[u8]| super::find_print_of(&folder, volume);
    assert_eq!(find(b"the one"), Some(folder.join("sculpture-1002.stl")));
    assert_eq!(find(b"a user's own"), None);
    write("sculpture-999", b"an older one");
    assert_eq!(find(b"an older one"), None, "no visit's is so old");
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}
