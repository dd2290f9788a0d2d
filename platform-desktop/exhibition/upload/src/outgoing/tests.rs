//! The way of finished sculptures to a booth, with restarts at the worst times.

#[path = "../../../../shell/src/studio/cut_off_export/tests/program.rs"]
mod program;

use std::fs;
use std::path::Path;
use std::sync::atomic::Ordering;

use paros_core::TickInput;
use paros_core::visit::{Presence, VisitCommand};
use paros_protocol::Parcel;
use paros_shell::studio::DrawPicture;
use paros_shell::studio_paths::StudioPaths;

use super::*;
use crate::courier::test_booth::{Rig, wait};
use program::{run_program, sculpt_as_next_visitor, sculpt_in_a_visit, told};

fn plan() -> SendPlan {
    let languages = vec![Language::Greek, Language::English];
    SendPlan { sends_traces: true, languages }
}

fn run_to_the_end(studio: &mut Studio<'_, 128>) {
    wait("the files", || {
        studio.run_tick(&told(VisitCommand::None));
        studio.poll_background_work();
        (!studio.is_exporting()).then_some(())
    });
}

/// Returns the parcels in an outbox.
fn parcels(rig: &Rig) -> Vec<Parcel> {
    let files = rig.parcel_files().into_iter().map(|path| fs::read(path).unwrap());
    files.map(|file| Parcel::read(file).expect("whole")).collect()
}

fn prints(folder: &Path) -> Vec<Vec<u8>> {
    let names = fs::read_dir(folder.join("sculptures")).into_iter().flatten();
    let paths = names.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension() == Some("stl".as_ref()))
        .map(|p| fs::read(p).unwrap())
        .collect()
}

struct Place {
    folder: std::path::PathBuf,
    rig: Rig,
}

impl Place {
    fn new(test: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("paros-outgoing-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        Place { folder, rig: Rig::new(test) }
    }

    fn run(&self, test: impl FnOnce(&mut Studio<'_, 128>, &Courier)) {
        let draw_no_picture = |_: &_| Err("no picture".into());
        run_program(&self.folder, draw_no_picture, |studio| {
            let courier = connect(studio, self.rig.start(None), plan());
            test(studio, &courier);
        });
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Shows the visitor's badge as soon as it is available.
fn show_badge(studio: &mut Studio<'_, 128>, courier: &Courier) -> BadgeNumber {
    assert!(studio.is_badge_awaited());
    let badge = wait("a badge", || courier.booth_state().badge);
    studio.run_tick(&told(VisitCommand::Badge { number: badge.get() }));
    badge
}

#[test]
fn a_visits_sculpture_is_announced_kept_and_sent() {
    let place = Place::new("visit");
    place.rig.is_down.store(true, Ordering::Relaxed);
    place.run(|studio, courier| {
        sculpt_in_a_visit(studio);
        let status = || courier.booth_state().status;
        assert_eq!(status(), Some(UploadStatus::Making));
        let badge = show_badge(studio, courier);
        run_to_the_end(studio);
        wait("kept here", || (status() == Some(UploadStatus::Kept)).then_some(()));
        let [parcel] = &parcels(&place.rig)[..] else { panic!("one parcel") };
        let facts = parcel.facts();
        assert_eq!(prints(&place.folder).len(), 1);
        assert_eq!((facts.badge, facts.language), (Some(badge), *b"el"));
        assert!(facts.trace_bytes > 0, "the recording has no other visitor");
        assert_eq!((facts.cause, facts.height_mm_tenths), (FinishCause::Finished, 1200));
        place.rig.is_down.store(false, Ordering::Relaxed);
        wait("kept at the booth", || (status() == Some(UploadStatus::Sent)).then_some(()));
    });
}

/// A recording continues from one visitor to the next, and also while the studio has no receiver.
#[test]
fn no_parcel_has_the_trace_of_another_visitor() {
    let place = Place::new("visitors");
    place.rig.is_down.store(true, Ordering::Relaxed);
    run_program(
        &place.folder,
        |_| Err("no picture".into()),
        |studio| {
            sculpt_in_a_visit(studio);
            run_to_the_end(studio);
            while studio.world().visit().phase() != VisitPhase::Attract {
                let mut nobody = TickInput::default();
                nobody.visit.presence = Presence::Off;
                studio.run_tick(&nobody);
            }
            let courier = connect(studio, place.rig.start(None), plan());
            sculpt_as_next_visitor(studio);
            show_badge(studio, &courier);
            run_to_the_end(studio);
            studio.save_session_and_wait();
        },
    );
    let [parcel] = &parcels(&place.rig)[..] else { panic!("one parcel") };
    assert_eq!(parcel.facts().trace_bytes, 0);
}

#[test]
fn what_a_program_s_end_cut_off_is_sent_once_under_its_own_id() {
    let place = Place::new("cut-off");
    place.rig.is_down.store(true, Ordering::Relaxed);
    let mut announced = None;
    // The first start ends before its print is made.
    place.run(|studio, courier| {
        sculpt_in_a_visit(studio);
        announced = courier.booth_state().id;
        studio.save_session_and_wait();
    });
    assert!(parcels(&place.rig).is_empty() && announced.is_some());
    // The second start makes the print, but can't store the parcel before it ends: a folder is in its place.
    let id = announced.expect("it was announced");
    let name = place.rig.folder.join(format!("{id}.parcel"));
    fs::create_dir(&name).expect("a folder");
    place.run(|studio, courier| {
        show_badge(studio, courier);
        run_to_the_end(studio);
        studio.save_session_and_wait();
    });
    fs::remove_dir(&name).expect("it is empty");
    assert_eq!((parcels(&place.rig).len(), prints(&place.folder).len()), (0, 1));
    // The third start has the print, and makes only the parcel.
    place.run(|studio, _| run_to_the_end(studio));
    // The fourth start finds nothing left to do.
    place.run(|studio, _| run_to_the_end(studio));
    let [parcel] = &parcels(&place.rig)[..] else { panic!("one parcel") };
    assert_eq!((parcel.facts().id, parcel.facts().cause), (id, FinishCause::CutOff));
    assert_eq!(prints(&place.folder).len(), 1);
}
