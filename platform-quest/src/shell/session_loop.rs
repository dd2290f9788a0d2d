//! The loop of a session whose world is drawn: events, frames, and the operating system's status, until the
//! session ends.

use std::ops::ControlFlow;
use std::time::Instant;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::headset::device_health::DeviceHealth;
use paros_shell::statics::Resident;

use super::{EXIT_TIMEOUT, HeadsetShell, SessionEnd, pause_between_polls};
use crate::error::Error;
use crate::foveation::Foveation;
use crate::platform::Platform;
use crate::session_resources::SessionResources;
use crate::test_commands::{CommandQueue, TestCommand};
use crate::xr::HeadsetSession;
use paros_headset::session_phase::SessionPhase;

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Polls events and makes frames until the session ends.
    pub(super) fn run_frames(
        &mut self,
        resources: &mut SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> Result<SessionEnd, Error> {
        loop {
            let was_running = self.phase.is_running();
            self.poll_events(&mut resources.session, &resources.runtime, platform)?;
            if let Some(end) = self.session_end() {
                return Ok(end);
            }
            if self.phase.is_running() {
                self.wait_and_run_frame(resources, platform)?;
            } else {
                if was_running {
                    self.submit_changed_pipeline_cache_between_frames(resources);
                }
                self.follow_booth(false, platform);
                pause_between_polls();
            }
            let status = platform.poll_status();
            self.note_health_and_log_warning(status.health, platform);
            self.update_foveation(resources, platform)?;
            let quits = self.run_test_command(resources, platform).is_break();
            if let Some(end) =
                self.follow_exit_request(&resources.session, quits | status.quit_requested)
            {
                return Ok(end);
            }
            self.keep_due_last_use();
            self.studio.poll_background_work();
            self.log_notes(platform);
        }
    }

    /// Requests the end of the session once, if the app must quit. Returns the end if the session isn't
    /// running, or if the runtime doesn't end it within [`EXIT_TIMEOUT`].
    pub(super) fn follow_exit_request(
        &mut self,
        session: &HeadsetSession,
        quits: bool,
    ) -> Option<SessionEnd> {
        if quits && self.exit_requested_at.is_none() {
            self.exit_requested_at = Some(Instant::now());
            self.save_studio_and_wait();
            if session.raw.request_exit().is_err() {
                // The session is not running: it has not begun, or has ended.
                return Some(SessionEnd::Exited);
            }
        }
        let is_late = self.exit_requested_at.is_some_and(|since| since.elapsed() > EXIT_TIMEOUT);
        is_late.then_some(SessionEnd::Exited)
    }

    /// Updates thermal state and battery, and logs a new warning once.
    pub(super) fn note_health_and_log_warning(
        &mut self,
        health: DeviceHealth,
        platform: &mut dyn Platform,
    ) {
        let thermal = health.thermal.max(self.runtime_thermal);
        let health = DeviceHealth { thermal, ..health };
        let before = core::mem::replace(&mut self.health, health);
        if let Some(warning) = health.new_warning(before) {
            platform.log(format_args!("{warning}"));
        }
        self.charger.follow_health(&health);
    }

    /// Sets the foveation level that thermal state and battery require, but not during a stroke. If the
    /// runtime refuses, the level stays as it is.
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

    /// Runs a test command, if one has arrived. Breaks if the session must end.
    fn run_test_command(
        &mut self,
        resources: &SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> ControlFlow<()> {
        match self.test_commands.and_then(CommandQueue::poll_next) {
            None => {}
            Some(TestCommand::PrintStatus) => {
                let phase = match self.phase {
                    SessionPhase::Focused => "focused",
                    SessionPhase::Visible => "seen",
                    _ => "unseen",
                };
                self.print_status(phase, &resources.gpu, &resources.runtime);
            }
            Some(TestCommand::CaptureFrame(prefix)) => self.capture_prefix = Some(prefix),
            Some(TestCommand::Quit) => {
                platform.log(format_args!("leaving"));
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}
