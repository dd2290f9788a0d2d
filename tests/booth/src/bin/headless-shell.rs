//! A shell without rendering, which holds visits one after the other and uploads them to a booth. Each visit
//! makes a different cut.
//!
//! `headless-shell FOLDER VISITS SEED`: the folder contains an enrolment beside its sessions. Standard output
//! reports `kept ID` when a visitor would read *kept here*, `signed ID` at *kept at the booth*, and `done`
//! once the booth has every sculpture.
#![forbid(unsafe_code)]

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use glam::Vec3;
use paros_core::TickInput;
use paros_core::badge::Language;
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, SessionState, Tool};
use paros_core::visit::{PanelAction, PlanSetting, Presence, VisitCommand, VisitInput, VisitPhase};
use paros_core::volume::Grid;
use paros_protocol::{LinkTimes, UploadStatus};
use paros_shell::settings::Settings;
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use paros_shell::studio_paths::StudioPaths;
use paros_upload::courier::{Courier, CourierLink, read_clock_ms};
use paros_upload::enrolment::Enrolment;
use paros_upload::{SendPlan, connect};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, visits, seed] = &arguments[..] else {
        eprintln!("expected FOLDER VISITS SEED");
        return ExitCode::from(2);
    };
    match (visits.parse(), seed.parse()) {
        (Ok(visits), Ok(seed)) => run(Path::new(folder), visits, seed),
        _ => {
            eprintln!("{visits} {seed}: expected numbers");
            ExitCode::from(2)
        }
    }
}

fn run(folder: &Path, visits: u32, seed: u64) -> ExitCode {
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    // Starts from plain blocks of stone: generating figures takes a second, and the tests don't need them.
    let blocks = resident.start_volumes.load(|_, maps| {
        maps.fill_block();
        Ok::<(), std::convert::Infallible>(())
    });
    let Ok(()) = blocks;
    let paths = StudioPaths::inside_folder(folder);
    let sessions = paths.sessions.clone();
    let no_picture = |_: &_| Err("no picture".into());
    let mut studio = Studio::new(&mut resident, &mut stl_buffers, paths, no_picture);
    let settings = Settings::default().booth;
    let courier = match Courier::open_enrolled(&settings, &sessions, read_clock_ms, open_link) {
        Ok(Some(courier)) => {
            let languages = vec![Language::Greek];
            let plan = SendPlan { sends_traces: false, languages };
            connect(&mut studio, courier, plan)
        }
        Ok(None) => {
            eprintln!("{}: not enrolled", sessions.display());
            return ExitCode::from(2);
        }
        Err(why) => {
            eprintln!("{why}");
            return ExitCode::FAILURE;
        }
    };
    let mut shell = Shell { studio, courier, told: Vec::new() };
    shell.run_to_the_end();
    for visit in 0..visits {
        shell.hold_visit(seed.wrapping_mul(1009).wrapping_add(visit.into()));
    }
    while shell.courier.summary().owed > 0 {
        shell.tell();
        thread::sleep(Duration::from_millis(20));
    }
    shell.tell();
    println!("done");
    ExitCode::SUCCESS
}

fn open_link(enrolment: &Enrolment) -> Result<CourierLink, String> {
    // A test that kills the booth shouldn't wait a minute for the request's timeout.
    let times = LinkTimes { put: Duration::from_secs(3), ..LinkTimes::default() };
    Ok(Box::new(paros_upload_https::open_link(&enrolment.booth_address(), times)))
}

/// Returns the tick's input with a visit command.
fn told(command: VisitCommand) -> TickInput {
    let visit = VisitInput { presence: Presence::Worn, is_used: true, command };
    TickInput { visit, ..TickInput::default() }
}

struct Shell<'a> {
    studio: Studio<'a, 128>,
    courier: Arc<Courier>,
    /// The last reported lines.
    told: Vec<String>,
}

impl Shell<'_> {
    /// Holds one visit, with a cut unique to its seed.
    fn hold_visit(&mut self, seed: u64) {
        let press = |action| told(VisitCommand::Press(action));
        for input in [
            told(VisitCommand::Open),
            told(VisitCommand::Set { setting: PlanSetting::HandsOff, value: 0 }),
            told(VisitCommand::SetStart(SessionMode::FreeForm)),
            told(VisitCommand::None),
            press(PanelAction::Confirm),
            press(PanelAction::Confirm),
            press(PanelAction::Skip { all: true }),
        ] {
            self.studio.run_tick(&input);
        }
        let item = BenchItem::Tool(Tool::Rotary).number() as u8;
        let pointer = PointerCommand::Take { hand: 1, item };
        self.studio.run_tick(&TickInput { pointer, ..told(VisitCommand::None) });
        for stroke in 0..4 {
            self.cut(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(16 * stroke));
        }
        self.studio.run_tick(&press(PanelAction::Finish));
        for _ in 0..5000 {
            if self.studio.world().session_state() == SessionState::Finished {
                break;
            }
            self.studio.run_tick(&told(VisitCommand::None));
        }
        self.run_to_the_end();
    }

    fn cut(&mut self, bits: u64) {
        let across = |shift: u64| 16.0 + ((bits >> shift) & 0xff) as f32 * (96.0 / 255.0);
        for tick in 0..40u16 {
            let position = Vec3::new(across(48), across(56), 145.0 - f32::from(tick));
            let mut input = told(VisitCommand::None);
            input.hands[1] =
                self.studio.world().hand_with_bit_at(1, &Pose { position, ..Pose::ZERO });
            input.hands[1].trigger = if tick < 3 { 0 } else { 255 };
            self.studio.run_tick(&input);
        }
    }

    /// Runs until a finished sculpture's files are written and its parcel is stored.
    fn run_to_the_end(&mut self) {
        loop {
            let state = self.courier.booth_state();
            let visit = self.studio.world().visit();
            let shows = visit.phase() == VisitPhase::Export && visit.badge().is_none();
            let command = match state.badge.filter(|_| shows) {
                Some(badge) => VisitCommand::Badge { number: badge.get() },
                None => VisitCommand::None,
            };
            if self.studio.world().session_state() == SessionState::Finished {
                self.studio.run_tick(&told(command));
            }
            self.studio.poll_background_work();
            self.tell();
            let is_made = state.status != Some(UploadStatus::Making);
            if !self.studio.is_exporting() && is_made {
                return;
            }
            thread::sleep(Duration::from_micros(200));
        }
    }

    fn tell(&mut self) {
        let state = self.courier.booth_state();
        let Some(id) = state.id else { return };
        let word = match state.status {
            Some(UploadStatus::Kept) => "kept",
            Some(UploadStatus::Sent) => "signed",
            _ => return,
        };
        let line = format!("{word} {id}");
        if self.told.last() != Some(&line) {
            println!("{line}");
            self.told.push(line);
        }
    }
}
