//! Tests of saves: when a session is saved, when a save must wait, and which saves are rejected.

use std::fs;
use std::time::Duration;

use glam::{Quat, Vec3};
use paros_core::limits::max_save_bytes;
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionMode, SessionState, TICK_RATE, Tool, commands,
};
use paros_core::volume::Grid;
use paros_core::{HandInput, TickInput};

use super::{CarvingOn, Notice, SessionToStart, Studio};
use crate::last_use::{BootId, LastUse};
use crate::statics::Resident;
use crate::studio_paths::StudioPaths;

#[test]
fn a_save_waits_for_the_one_before_it() {
    let folder = std::env::temp_dir().join(format!("paros-studio-{}", std::process::id()));
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    let places = StudioPaths::inside_folder(&folder);
    let mut studio =
        Studio::new(&mut resident, &mut stl_buffers, places, |_| Err("no picture".into()));
    studio.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    studio.save_session();
    studio.run_tick(&TickInput::default());
    // The first save is being written or collected: its buffer can't be reused yet.
    studio.save_session();
    assert!(studio.autosave.is_writing() && studio.autosave.is_due());
    while studio.autosave.is_writing() {
        studio.poll_background_work();
    }
    let saved = |studio: &Studio<'_, 128>| {
        let bytes = fs::read(studio.paths().session_file(128)).expect("a save");
        u64::from_le_bytes(bytes[16..24].try_into().expect("a tick"))
    };
    assert_eq!((saved(&studio), studio.autosave.is_due()), (1, true));
    studio.run_tick(&TickInput::default());
    assert!(
        studio.autosave.is_writing() && !studio.autosave.is_due(),
        "it comes with the next tick"
    );
    // At the end nothing is left due, whatever is still pending.
    studio.run_tick(&TickInput::default());
    studio.save_all_and_wait().expect("a disk");
    assert_eq!((saved(&studio), studio.world().tick()), (4, 4));
    drop(studio);
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// In the first seconds of a session, the changes of the start are saved when a stroke ends, not when a hand
/// without a tool releases the trigger.
#[test]
fn a_stroke_that_ends_is_saved() {
    let folder = std::env::temp_dir().join(format!("paros-strokes-{}", std::process::id()));
    for (item, saved) in [(Some(BenchItem::Tool(Tool::Rotary)), true), (None, false)] {
        let (mut resident, mut stl_buffers) =
            (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
        let _ = fs::remove_dir_all(&folder);
        resident.world.clear();
        let places = StudioPaths::inside_folder(&folder);
        let mut studio =
            Studio::new(&mut resident, &mut stl_buffers, places, |_| Err("no picture".into()));
        let pointer = item.map_or(PointerCommand::None, |item| PointerCommand::Take {
            hand: 1,
            item: item.number() as u8,
        });
        studio.run_tick(&TickInput {
            start: SessionMode::FreeForm,
            pointer,
            ..TickInput::default()
        });
        let pulled = |trigger| {
            let grip = RawPose::quantise(Vec3::Y, Quat::IDENTITY);
            let hand =
                HandInput { grip, aim: grip, trigger, tracked: true, ..HandInput::default() };
            TickInput { hands: [HandInput::default(), hand], ..TickInput::default() }
        };
        (0..TICK_RATE).for_each(|_| studio.run_tick(&pulled(255)));
        assert!(!studio.autosave.is_writing(), "{item:?}: a stroke is under way");
        studio.run_tick(&pulled(0));
        assert_eq!(studio.autosave.is_writing(), saved, "{item:?}");
        drop(studio);
    }
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// While the print is on its way to the disk, the finished panel must not say that there is none.
#[test]
fn a_sculpture_is_exported_until_it_is_written() {
    let folder = std::env::temp_dir().join(format!("paros-export-{}", std::process::id()));
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    let places = StudioPaths::inside_folder(&folder);
    resident.start_volumes.offer_visitor_volume().fill_block();
    let mut studio =
        Studio::new(&mut resident, &mut stl_buffers, places, |_| Ok(b"a picture".into()));
    studio.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
    studio.run_tick(&TickInput { commands: commands::FINISH, ..TickInput::default() });
    assert!(studio.is_exporting());
    while studio.is_exporting() {
        assert_eq!(studio.session_stl_path(), None, "it is written, then said to be");
        studio.run_tick(&TickInput::default());
        studio.poll_background_work();
    }
    let stl = studio.session_stl_path().expect("a print").to_path_buf();
    assert!(stl.exists() && stl.with_extension("rmap").exists());
    drop(studio);
    resident.start_volumes.withdraw_visitor_volume();
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// A save with one interval per column, from before sculptures had two.
#[test]
fn a_saved_session_of_one_interval_is_put_aside() {
    let folder = std::env::temp_dir().join(format!("paros-of-one-{}", std::process::id()));
    let places = StudioPaths::inside_folder(&folder);
    let mut save = vec![0; max_save_bytes(128, 1)];
    let len = <Grid<128> as Resident<128, 1>>::lock_world().world.save(&mut save);
    save.truncate(len);
    fs::create_dir_all(folder.join("sessions")).expect("a folder");
    fs::write(places.session_file(128), &save).expect("a file");
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    let mut studio =
        Studio::new(&mut resident, &mut stl_buffers, places, |_| Err("no picture".into()));
    let notices: Vec<_> = studio.take_notices().collect();
    let aside = folder.join("sessions/session-128.unreadable-1");
    let expected = format!(
        "the saved session can't be read: intervals a column: 1 as saved, 2 here; it is kept as {}",
        aside.display()
    );
    assert_eq!(notices, [Notice::Bad(expected)]);
    assert!(fs::read(&aside).expect("it is kept") == save);
    assert!(!studio.paths().session_file(128).exists());
    drop(studio);
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// Runs a test with a studio in which a session of a block has begun, and whose pictures can't be drawn.
fn with_own_studio(paths: StudioPaths, test: impl FnOnce(&mut Studio<'_, 128>)) {
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    resident.start_volumes.offer_visitor_volume().fill_block();
    let mut studio =
        Studio::new(&mut resident, &mut stl_buffers, paths, |_| Err("no picture".into()));
    studio.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
    test(&mut studio);
    drop(studio);
    resident.start_volumes.withdraw_visitor_volume();
}

/// A previous sculpture that can't be read stays on the disk, and doesn't affect the current one.
#[test]
fn a_bad_save_of_the_sculpture_before_leaves_this_one_alone() {
    let folder = std::env::temp_dir().join(format!("paros-before-{}", std::process::id()));
    let places = StudioPaths::inside_folder(&folder);
    let before = places.left_unfinished_session_file(128);
    fs::create_dir_all(&places.sessions).expect("a folder");
    fs::write(&before, "no save").expect("a file");
    with_own_studio(places, |studio| {
        let digest = studio.world().digest();
        assert!(studio.has_one_before());
        studio.bring_back_the_one_before();
        assert!(!studio.has_one_before() && studio.world().digest() == digest);
        let notices: Vec<_> = studio.take_notices().collect();
        assert!(matches!(&notices[..], [Notice::Bad(why)] if why.contains("can't be read")));
        assert_eq!(fs::read(&before).expect("it is kept"), b"no save");
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// A finished sculpture that is continued is the same sculpture, not a new one from its stone.
#[test]
fn carving_on_takes_the_end_back_and_leaves_the_rest_as_it_was() {
    let folder = std::env::temp_dir().join(format!("paros-carve-on-{}", std::process::id()));
    let places = StudioPaths::inside_folder(&folder);
    with_own_studio(places, |studio| {
        studio.run_tick(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
        let (digest, tick) = (studio.world().digest(), studio.world().tick());
        let finish = TickInput { commands: commands::FINISH, ..TickInput::default() };
        studio.run_tick(&finish);
        studio.run_tick(&finish);
        assert_eq!(studio.world().session_state(), SessionState::Finished);
        assert_eq!(studio.carve_on(), CarvingOn::GoesOn);
        assert_eq!((studio.world().digest(), studio.world().tick()), (digest, tick));
        assert!(studio.world().is_mirrored(), "as it was");
        // Without the save before the finish, a new session starts.
        studio.run_tick(&finish);
        studio.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
        let anew = CarvingOn::Starts(SessionToStart { mode: SessionMode::Own });
        assert_eq!(studio.carve_on(), anew);
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

fn used_at(seconds: u64) -> LastUse {
    let boot = BootId::parse_uuid("6af84ad0-079a-4d3a-a5d5-bbed09b02c54").expect("a boot");
    LastUse { boot, since_boot: Duration::from_secs(seconds) }
}

/// The time of a visitor's last use is never stored beside the previous visitor's session: after a kill that
/// session would be this visitor's.
#[test]
fn the_last_use_is_kept_once_its_session_is() {
    let folder = std::env::temp_dir().join(format!("paros-last-use-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    with_own_studio(StudioPaths::inside_folder(&folder), |studio| {
        assert!(studio.read_last_use().is_err_and(|why| why.contains("session-128.last-use: ")));
        studio.keep_last_use(used_at(1));
        studio.poll_background_work();
        studio.file_writer().wait_for_next_outcome();
        assert!(studio.read_last_use().is_err(), "no session is on the disk");
        studio.save_session_and_wait();
        assert_eq!(studio.read_last_use(), Ok(used_at(1)));
        studio.keep_last_use(used_at(2));
        while studio.read_last_use() != Ok(used_at(2)) {
            studio.poll_background_work();
        }
        // Another session starts while the save of this one is still being written.
        studio.run_tick(&TickInput { commands: commands::FINISH, ..TickInput::default() });
        assert!(studio.autosave.is_writing());
        studio.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
        studio.keep_last_use(used_at(3));
        while studio.autosave.is_writing() {
            studio.poll_background_work();
        }
        studio.poll_background_work();
        while studio.file_writer().is_busy() {
            studio.poll_background_work();
        }
        assert_eq!(studio.read_last_use(), Ok(used_at(2)), "that on the disk is the one before");
        studio.save_all_and_wait().expect("a disk");
        assert_eq!(studio.read_last_use(), Ok(used_at(3)));
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// A bad last-use file doesn't make the session unreadable, and is reported with file and offset.
#[test]
fn a_bad_last_use_is_told_and_costs_no_session() {
    let folder = std::env::temp_dir().join(format!("paros-bad-use-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    let places = StudioPaths::inside_folder(&folder);
    with_own_studio(places.clone(), |studio| {
        let path = places.last_use_file(128);
        studio.save_session_and_wait();
        let digest = studio.world().digest();
        let good = used_at(1).encode();
        for (bytes, why) in [
            (&b""[..], "offset 0: expected more bytes"),
            (b"SULP, and more", "offset 0: expected PLUS"),
            (&good[..20], "offset 6: expected more bytes"),
            (&[0; 1000], "it has 1000 bytes; expected at most 38"),
        ] {
            fs::write(&path, bytes).expect("a file");
            let told = studio.read_last_use().expect_err("it is bad");
            assert!(told.contains("session-128.last-use") && told.contains(why), "{told}");
        }
        let save = fs::read(places.session_file(128)).expect("a save");
        studio.session.world.load(&save).expect("a save that the core reads");
        assert_eq!(studio.world().digest(), digest);
        // If it can't be written, that is reported once, and the session is still saved.
        fs::remove_file(&path).expect("it is there");
        fs::create_dir(&path).expect("a folder in its place");
        for seconds in 2..5 {
            studio.keep_last_use(used_at(seconds));
            studio.save_session_and_wait();
        }
        let told = studio.take_notices().filter(
            |notice| matches!(notice, Notice::Bad(why) if why.contains("the time of the last use")),
        );
        assert_eq!(told.count(), 1);
        assert!(studio.save_error().is_none());
    });
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}
