//! The frame loop: events of the runtime, ticks that are due, and a frame that shows them.

mod events;
mod frame;
mod ticks;
mod visits;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shaders::{gpu, render_portrait_png};
use paros_shell::headset::device_health::{DeviceHealth, ThermalState};
use paros_shell::headset::frame_pacer::FramePacer;
use paros_shell::headset::hand_reader::HandReader;
use paros_shell::headset::haptics::FrameHaptics;
use paros_shell::headset::recentering::PendingRecentering;
use paros_shell::headset::resolution::ResolutionPolicy;
use paros_shell::headset::room_placement::RoomPlacement;
use paros_shell::headset::visit::{BootId, VisitPolicy};
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::stl_export::{DEFAULT_HEIGHT_MM, StlExporter};
use paros_shell::studio::{Notice, Studio};
use paros_shell::studio_paths::StudioPaths;

use crate::error::Error;
use crate::foveation::Foveation;
use crate::options::ShellOptions;
use crate::platform::Platform;
use crate::session_phase::SessionPhase;
use crate::session_resources::SessionResources;
use crate::test_commands::{CommandQueue, TestCommand};
use crate::xr::NO_PROFILE;

/// How often events are polled while no frames are made.
const IDLE_POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Session losses in a row after which the runtime is given up, and the pause between them.
const MAX_LOSSES: u32 = 5;
const RETRY_PAUSE: Duration = Duration::from_secs(1);

/// A session that has lasted for this long ends a row of losses.
const STEADY_AFTER: Duration = Duration::from_secs(10);

/// How long the runtime may take to end a session after an exit request: Android kills a program that
/// takes five seconds.
const EXIT_TIMEOUT: Duration = Duration::from_secs(3);

/// How often dropped ticks are logged at most.
const DROP_LOG_INTERVAL: Duration = Duration::from_secs(5);

/// The shell's state, which outlives sessions.
struct HeadsetShell<'a, const N: usize>
where
    Grid<N>: Size,
{
    studio: Studio<'a, N>,
    options: &'a ShellOptions,
    test_commands: Option<CommandQueue>,
    visit: VisitPolicy,
    phase: SessionPhase,
    pacer: FramePacer,
    recentering: PendingRecentering,
    hand_readers: [HandReader; 2],
    placement: RoomPlacement,
    /// The room was moved after the last tick.
    has_room_moved: bool,
    haptics: FrameHaptics,
    resolution: ResolutionPolicy,
    /// The thermal state that the runtime notified; the operating system may report a hotter one.
    runtime_thermal: ThermalState,
    health: DeviceHealth,
    /// Where the frame's display time lies between the last tick and the next, 0 to 1.
    tick_fraction: f32,
    /// A session of the core is to start anew with the next tick.
    start_anew: bool,
    boot: Option<BootId>,
    frames: u64,
    dropped: DroppedTicks,
    /// Where pictures of the next frame go, if a test wants them.
    capture_prefix: Option<PathBuf>,
    last_note: String,
    validation_messages: Vec<String>,
}

/// Ticks that were dropped, and how many of them have been logged.
#[derive(Clone, Copy, Default, Debug)]
struct DroppedTicks {
    count: u64,
    logged: u64,
    logged_at: Option<Instant>,
}

/// How a session ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum SessionEnd {
    /// The visitor, the operating system or the runtime wanted it over.
    Exited,
    /// It was lost, and may be created anew.
    Lost,
}

/// Runs OpenXR sessions until the visitor, the operating system or the runtime quits. Returns the
/// path of the last print, if there is one.
///
/// # Errors
/// [`Error::Unavailable`] where there is nothing to run on, or what went wrong later. What was
/// sculpted has been saved in any case.
pub fn run_shell<const N: usize>(
    platform: &mut dyn Platform,
    options: &ShellOptions,
) -> Result<Option<PathBuf>, Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let mut volumes = Grid::<N>::lock_start_volumes();
    volumes.generate_once(&mut Grid::<N>::lock_bit_grid(), |_| {});
    let (mut world, mut stl_buffers) = (Grid::<N>::lock_world(), Grid::<N>::lock_stl_buffers());
    let stl_exporter = StlExporter::new(&mut stl_buffers, DEFAULT_HEIGHT_MM);
    let stl_exporter = stl_exporter.map_err(|height| Error::Input(format!("{height:?}")))?;
    let folder = options.folder.as_deref();
    let places = folder.map_or_else(|| StudioPaths::for_user(None), StudioPaths::inside_folder);
    let mut studio =
        Studio::new(&mut world, &mut volumes, stl_exporter, places, render_portrait_png);
    match &options.record {
        Some(_) => studio.set_trace_path_at_exit(options.record.clone()),
        None => studio.disable_recording(),
    }
    let mut shell = HeadsetShell::new(studio, options, platform.boot_id());
    shell.resume_session(platform);
    let done = shell.run_sessions(platform);
    shell.keep_last_use_before_pause();
    let saved = shell.studio.save_all_and_wait();
    shell.log_notes(platform);
    if let (Err(_), Err(error)) = (&done, &saved) {
        platform.log(format_args!("{error}"));
    }
    shell.validation_messages.sort();
    shell.validation_messages.dedup();
    let messages = shell.validation_messages.join("\n");
    if done.is_err() && !messages.is_empty() {
        platform.log(format_args!("validation: {messages}"));
    }
    done?;
    saved?;
    if !messages.is_empty() {
        return Err(Error::Unavailable(format!("validation: {messages}")));
    }
    Ok(shell.studio.session_stl_path().map(Path::to_path_buf))
}

impl<'a, const N: usize> HeadsetShell<'a, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    fn new(studio: Studio<'a, N>, options: &'a ShellOptions, boot: Option<BootId>) -> Self {
        HeadsetShell {
            studio,
            options,
            test_commands: options.test_commands.then(CommandQueue::spawn_reader),
            visit: VisitPolicy::new(options.mode, options.handover_after),
            phase: SessionPhase::default(),
            pacer: FramePacer::default(),
            recentering: PendingRecentering::default(),
            hand_readers: [HandReader::default(); 2],
            placement: RoomPlacement::default(),
            has_room_moved: false,
            haptics: FrameHaptics::default(),
            resolution: ResolutionPolicy::new(options.least_resolution_percent),
            runtime_thermal: ThermalState::default(),
            health: DeviceHealth::default(),
            tick_fraction: 0.0,
            start_anew: options.record.is_some(),
            boot,
            frames: 0,
            dropped: DroppedTicks::default(),
            capture_prefix: None,
            last_note: String::new(),
            validation_messages: Vec::new(),
        }
    }

    /// Runs session after session: one that is lost is created anew, and the sculpture is kept.
    fn run_sessions(&mut self, platform: &mut dyn Platform) -> Result<(), Error> {
        let (mut losses, mut has_run) = (0, false);
        loop {
            let begun = Instant::now();
            let why = match self.run_session(platform) {
                Ok(SessionEnd::Exited) => return Ok(()),
                Ok(SessionEnd::Lost) => None,
                Err(error) if error.is_recoverable_loss() || has_run || self.frames > 0 => {
                    Some(error)
                }
                Err(error) => return Err(error),
            };
            self.save_session_before_pause();
            has_run = true;
            losses = if begun.elapsed() > STEADY_AFTER { 1 } else { losses + 1 };
            let text = why.as_ref().map_or("the session is lost".into(), ToString::to_string);
            if losses > MAX_LOSSES {
                return Err(why.unwrap_or(Error::Unavailable(text)));
            }
            platform.log(format_args!("{text}; the sculpture is kept, and a new session is made"));
            thread::sleep(RETRY_PAUSE);
        }
    }

    /// Runs one session from its creation to its end, and collects the messages of Vulkan's validation.
    fn run_session(&mut self, platform: &mut dyn Platform) -> Result<SessionEnd, Error> {
        let mut vulkan = None;
        let end = self.create_and_run_session(platform, &mut vulkan);
        let messages = vulkan.map(|vulkan| vulkan.validation_messages()).unwrap_or_default();
        self.validation_messages.extend(messages);
        end
    }

    fn create_and_run_session(
        &mut self,
        platform: &mut dyn Platform,
        vulkan_out: &mut Option<Arc<gpu::Instance>>,
    ) -> Result<SessionEnd, Error> {
        let (world, paths) = (self.studio.world(), self.studio.paths());
        let mut resources =
            SessionResources::create(platform, self.options, world, paths, vulkan_out)?;
        let profiles = &resources.session.actions.profiles;
        for refusal in &profiles.refusals {
            platform.log(format_args!("{refusal}"));
        }
        if profiles.accepted == 0 {
            platform.log(format_args!("{NO_PROFILE}: bare hands sculpt"));
        }
        let (runtime, device) = (&resources.runtime.name, &resources.gpu.name);
        platform.log(format_args!("{runtime}, drawn by {device}"));
        self.phase = SessionPhase::default();
        self.hand_readers = [HandReader::default(); 2];
        self.pacer.pause();
        self.placement.restart_in_new_space();
        self.visit.forget_poses();
        // Whatever ends the session, the next start finds the compiled programs.
        self.submit_changed_pipeline_cache_between_frames(&mut resources);
        let end = self.run_frames(&mut resources, platform);
        self.submit_changed_pipeline_cache_between_frames(&mut resources);
        end
    }

    fn submit_changed_pipeline_cache_between_frames(
        &mut self,
        resources: &mut SessionResources<N>,
    ) {
        let places = self.studio.paths().clone();
        resources.submit_changed_pipeline_cache_between_frames(&places, self.studio.file_writer());
    }

    /// Polls events and makes frames until the session ends.
    fn run_frames(
        &mut self,
        resources: &mut SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> Result<SessionEnd, Error> {
        let mut exit_requested_at: Option<Instant> = None;
        loop {
            self.poll_events(resources, platform)?;
            match self.phase {
                SessionPhase::Exited => return Ok(SessionEnd::Exited),
                SessionPhase::Lost if exit_requested_at.is_some() => return Ok(SessionEnd::Exited),
                SessionPhase::Lost => return Ok(SessionEnd::Lost),
                phase if phase.is_running() => self.wait_and_run_frame(resources, platform)?,
                _ => thread::sleep(IDLE_POLL_INTERVAL),
            }
            let status = platform.poll_status();
            self.note_health_and_log_warning(status.health, platform);
            self.update_foveation(resources, platform)?;
            let quit =
                self.run_test_command(resources, platform).is_break() || status.quit_requested;
            if quit && exit_requested_at.is_none() {
                exit_requested_at = Some(Instant::now());
                self.save_studio_and_wait();
                if resources.session.raw.request_exit().is_err() {
                    // The session is not running: it has not begun, or has ended.
                    return Ok(SessionEnd::Exited);
                }
            }
            if exit_requested_at.is_some_and(|since| since.elapsed() > EXIT_TIMEOUT) {
                return Ok(SessionEnd::Exited);
            }
            self.keep_due_last_use();
            self.studio.poll_background_work();
            self.log_notes(platform);
        }
    }

    /// Logs the studio's notes to the visitor.
    fn log_notes(&mut self, platform: &mut dyn Platform) {
        for note in self.studio.take_notices() {
            let (Notice::Good(text) | Notice::Bad(text)) = note;
            platform.log(format_args!("{text}"));
            self.last_note = text;
        }
    }

    /// Takes in thermal state and battery, and logs a warning once.
    fn note_health_and_log_warning(&mut self, health: DeviceHealth, platform: &mut dyn Platform) {
        let thermal = health.thermal.max(self.runtime_thermal);
        let health = DeviceHealth { thermal, ..health };
        let before = core::mem::replace(&mut self.health, health);
        if let Some(warning) = health.new_warning(before) {
            platform.log(format_args!("{warning}"));
        }
    }

    /// Sets the foveation level that thermal state and battery call for; not in the middle of a stroke.
    /// Where the runtime refuses, frames go on as they are.
    fn update_foveation(
        &self,
        resources: &mut SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        let is_integrated = resources.gpu.is_integrated();
        let wanted = Foveation::choose(self.health, self.options.foveation, is_integrated);
        let world = self.studio.world();
        let in_stroke = (0..2).any(|hand| world.hand_state(hand).trigger);
        if in_stroke || !resources.eyes.needs_foveation(wanted) {
            return Ok(());
        }
        match resources.eyes.set_foveation(&resources.session.raw, wanted) {
            Err(error) if error.is_recoverable_loss() => return Err(error),
            Err(error) => platform.log(format_args!("{error}")),
            Ok(()) => platform.log(format_args!("foveation {wanted}")),
        }
        Ok(())
    }

    /// Runs a command of a test, if one has arrived. Breaks if the session is to end.
    fn run_test_command(
        &mut self,
        resources: &SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> ControlFlow<()> {
        match self.test_commands.as_ref().and_then(CommandQueue::poll_next) {
            None => {}
            Some(TestCommand::PrintStatus) => self.print_status(resources),
            Some(TestCommand::CaptureFrame(prefix)) => self.capture_prefix = Some(prefix),
            Some(TestCommand::Quit) => {
                platform.log(format_args!("leaving"));
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}
