//! The frame loop: events of the runtime, ticks that are due, and a frame that shows them.

mod booth;
mod events;
mod frame;
mod hosting;
mod loading;
mod session_loop;
mod ticks;
mod visits;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::{Grid, Size};
use paros_headset::frame_pacer::FramePacer;
use paros_headset::recentering::PendingRecentering;
use paros_headset::room_placement::{RoomPlacement, RoomTransform};
use paros_headset::start_up::StartUp;
use paros_headset::stick_presses::StickPresses;
use paros_protocol::Parcel;
use paros_shaders::{gpu, render_portrait_png};
use paros_shell::headset::device_health::{DeviceHealth, ThermalState};
use paros_shell::headset::hand_reader::HandReader;
use paros_shell::headset::haptics::FrameHaptics;
use paros_shell::headset::resolution::ResolutionPolicy;
use paros_shell::headset::visit::VisitPolicy;
use paros_shell::last_use::BootId;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::studio::{Notice, Studio};
use paros_shell::studio_paths::StudioPaths;
use paros_sound::{SoundDevice, Speaker};
use paros_upload::courier::Courier;
use paros_visit::{ChargerPanel, VisitHost};

use crate::error::Error;
use crate::log::{open_log_file, write_log_line};
use crate::options::ShellOptions;
use crate::platform::Platform;
use crate::session_resources::{OpenedSession, SessionResources};
use crate::start_keeper::StartKeeper;
use crate::test_commands::CommandQueue;
use crate::xr::NO_PROFILE;
use paros_headset::session_phase::SessionPhase;

pub(crate) use events::session_event;

/// The poll interval for events while no frames are made.
pub(crate) const IDLE_POLL_INTERVAL: Duration = Duration::from_millis(10);

/// The number of consecutive session losses after which the shell stops retrying, and the pause between
/// retries.
const MAX_LOSSES: u32 = 5;
const RETRY_PAUSE: Duration = Duration::from_secs(1);

/// A session that lasted this long resets the count of consecutive losses.
const STEADY_AFTER: Duration = Duration::from_secs(10);

/// The time that the runtime may take to end a session after an exit request. Android kills a program that
/// takes five seconds.
const EXIT_TIMEOUT: Duration = Duration::from_secs(3);

/// The minimum interval between log lines about dropped ticks.
const DROP_LOG_INTERVAL: Duration = Duration::from_secs(5);

/// The shell's state, which outlives sessions.
struct HeadsetShell<'a, const N: usize>
where
    Grid<N>: Size,
{
    studio: Studio<'a, N>,
    /// The connection to the booth, if the device is enrolled at one.
    courier: Option<Arc<Courier>>,
    options: &'a ShellOptions,
    test_commands: Option<&'a CommandQueue>,
    start: &'a mut StartKeeper,
    visit: VisitPolicy,
    /// The host of visits, if visits are enabled.
    host: Option<VisitHost>,
    phase: SessionPhase,
    exit_requested_at: Option<Instant>,
    pacer: FramePacer,
    recentering: PendingRecentering,
    hand_readers: [HandReader; 2],
    stick_presses: StickPresses,
    placement: RoomPlacement,
    /// `true` if the room was moved after the last tick.
    has_room_moved: bool,
    haptics: FrameHaptics,
    /// `None` if sound is off.
    speaker: Option<Speaker>,
    resolution: ResolutionPolicy,
    /// The thermal state that the runtime reported last; the operating system may report a hotter one.
    runtime_thermal: ThermalState,
    health: DeviceHealth,
    charger: ChargerPanel,
    /// The position of the frame's display time between the last tick and the next, 0 to 1.
    tick_fraction: f32,
    /// `true` if the core's session must restart with the next tick.
    start_anew: bool,
    /// `true` if the device was enrolled again and the courier doesn't use the new enrolment yet.
    is_enrolled_anew: bool,
    /// Parcels for which the previous courier had no room.
    without_room: Vec<Parcel>,
    boot: Option<BootId>,
    frames: u64,
    dropped: DroppedTicks,
    /// The path prefix for pictures of the next frame, if a test requested them.
    capture_prefix: Option<PathBuf>,
    last_note: String,
    validation_messages: Vec<String>,
}

/// The counts of dropped ticks and of those already logged.
#[derive(Clone, Copy, Default, Debug)]
struct DroppedTicks {
    count: u64,
    logged: u64,
    logged_at: Option<Instant>,
}

/// The way in which a session ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum SessionEnd {
    /// The visitor, the operating system or the runtime requested the end.
    Exited,
    /// The session was lost; a new one may be created.
    Lost,
}

/// Runs OpenXR sessions until the visitor, the operating system or the runtime quits. Returns the path of the
/// last exported print file, if there is one.
///
/// # Errors
/// [`Error::Unavailable`] if there is no runtime or headset, or any later failure. The sculpture has been
/// saved in any case.
pub fn run_shell<const N: usize>(
    platform: &mut dyn Platform,
    options: &ShellOptions,
) -> Result<Option<PathBuf>, Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let folder = options.folder.as_deref();
    let paths = folder.map_or_else(|| StudioPaths::for_user(None), StudioPaths::inside_folder);
    open_log_file(&paths.log_file());
    // Waits for an earlier run in this process, so that its failure is completely handled first.
    let mut resident = Grid::<N>::lock_world();
    let commands = options.test_commands.then(CommandQueue::spawn_reader);
    let mut start = StartKeeper::begin(platform, options, &paths);
    if start.wait_until_due(platform, options, commands.as_ref()).is_break() {
        return Ok(None);
    }
    let done =
        run_studio::<N>(platform, options, paths, &mut resident, commands.as_ref(), &mut start);
    match &done {
        Ok(_) => start.forget_failures(),
        Err(error) => start.show_failure(error, platform, options, commands.as_ref()),
    }
    done
}

/// Shows in the headset, if possible, an error that keeps the app from reaching [`run_shell`], until it has
/// been read.
pub fn show_failed_start(platform: &mut dyn Platform, options: &ShellOptions, error: &Error) {
    let paths = StudioPaths::for_user(None);
    StartKeeper::begin(platform, options, &paths).show_failure(error, platform, options, None);
}

/// Runs a studio's sessions until the app quits, and saves the studio.
fn run_studio<const N: usize>(
    platform: &mut dyn Platform,
    options: &ShellOptions,
    paths: StudioPaths,
    resident: &mut WorldWithStarts<N, INTERVALS>,
    commands: Option<&CommandQueue>,
    start: &mut StartKeeper,
) -> Result<Option<PathBuf>, Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    resident.generate_starts();
    let mut stl_buffers = Grid::<N>::lock_stl_buffers();
    let mut studio = Studio::new(resident, &mut stl_buffers, paths, render_portrait_png);
    match &options.record {
        Some(_) => studio.set_trace_path_at_exit(options.record.clone()),
        None if options.booth.sends_traces => {}
        None => studio.disable_recording(),
    }
    let courier = booth::bring_to_booth(&mut studio, options, platform, &mut Vec::new());
    let mut shell =
        HeadsetShell::new((studio, courier), options, commands, start, platform.boot_id());
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

fn pause_between_polls() {
    thread::sleep(IDLE_POLL_INTERVAL);
}

impl<'a, const N: usize> HeadsetShell<'a, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    fn new(
        (studio, courier): (Studio<'a, N>, Option<Arc<Courier>>),
        options: &'a ShellOptions,
        test_commands: Option<&'a CommandQueue>,
        start: &'a mut StartKeeper,
        boot: Option<BootId>,
    ) -> Self {
        let start_anew = options.record.is_some();
        let host = hosting::open_host(options, start_anew, studio.world().visit());
        let mode = if host.is_some() { SessionMode::None } else { options.mode };
        HeadsetShell {
            studio,
            courier,
            options,
            test_commands,
            start,
            visit: VisitPolicy::new(mode, options.handover_after),
            host,
            phase: SessionPhase::default(),
            exit_requested_at: None,
            pacer: FramePacer::default(),
            recentering: PendingRecentering::default(),
            hand_readers: [HandReader::default(); 2],
            stick_presses: StickPresses::default(),
            placement: RoomPlacement::new(options.snap_heights),
            has_room_moved: false,
            haptics: FrameHaptics::default(),
            speaker: Speaker::spawn(
                SoundDevice::of_system(),
                options.sound_percent,
                write_log_line,
            ),
            resolution: ResolutionPolicy::new(options.least_resolution_percent),
            runtime_thermal: ThermalState::default(),
            health: DeviceHealth::default(),
            charger: ChargerPanel::default(),
            tick_fraction: 0.0,
            start_anew,
            is_enrolled_anew: false,
            without_room: Vec::new(),
            boot,
            frames: 0,
            dropped: DroppedTicks::default(),
            capture_prefix: None,
            last_note: String::new(),
            validation_messages: Vec::new(),
        }
    }

    /// Runs sessions in a loop: a lost session is replaced by a new one, and the sculpture is kept.
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
        let mut opened = OpenedSession::create(platform, self.options, vulkan_out)?;
        let profiles = &opened.session.actions.profiles;
        for refusal in &profiles.refusals {
            platform.log(format_args!("{refusal}"));
        }
        if profiles.accepted == 0 {
            platform.log(format_args!("{NO_PROFILE}: bare hands sculpt"));
        }
        let (runtime, device) = (&opened.runtime.name, &opened.gpu.name);
        platform.log(format_args!("{runtime}, drawn by {device}"));
        self.phase = SessionPhase::default();
        self.hand_readers = [HandReader::default(); 2];
        self.pacer.pause();
        self.placement.restart_in_new_space();
        // Keep the height of the room from the lost session.
        if self.placement.room() != RoomTransform::default() {
            opened.session.move_room(self.placement.room())?;
        }
        self.visit.forget_poses();
        let compiled = match self.compile_in_session(&mut opened, platform)? {
            ControlFlow::Continue(compiled) => compiled,
            ControlFlow::Break(end) => return Ok(end),
        };
        let mut resources = SessionResources::create(opened, compiled, self.studio.world())?;
        platform.note_start_up(StartUp::Ready);
        // Write the cache now, so that the next start finds the compiled programs even after a crash.
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

    /// Logs the studio's notices to the visitor.
    fn log_notes(&mut self, platform: &mut dyn Platform) {
        for note in self.studio.take_notices() {
            let (Notice::Good(text) | Notice::Bad(text)) = note;
            platform.log(format_args!("{text}"));
            self.last_note = text;
        }
    }
}
