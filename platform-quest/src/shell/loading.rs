//! A session before its first frame: events are polled and a notice is shown while the renderer's programs are
//! compiled.

use std::ops::ControlFlow;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headset::start_up::StartUp;
use paros_shaders::upload::VolumeFormat;
use paros_shell::statics::Resident;

use super::{HeadsetShell, SessionEnd};
use crate::compilation::Compiled;
use crate::error::Error;
use crate::platform::Platform;
use crate::session_resources::OpenedSession;
use crate::test_commands::{CommandQueue, TestCommand};
use paros_headset::session_phase::SessionPhase;

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Compiles the renderer's programs on a thread, and runs the session meanwhile. Breaks if the session
    /// ends.
    pub(super) fn compile_in_session(
        &mut self,
        opened: &mut OpenedSession,
        platform: &mut dyn Platform,
    ) -> Result<ControlFlow<SessionEnd, Compiled>, Error> {
        let loading = StartUp::Loading { since: platform.since_boot() };
        platform.note_start_up(loading);
        let volume = VolumeFormat::of::<N, INTERVALS>();
        let mut compilation = opened.start_compiling(volume, self.studio.paths());
        loop {
            self.poll_events(&mut opened.session, &opened.runtime, platform)?;
            if let Some(end) = self.session_end() {
                return Ok(ControlFlow::Break(end));
            }
            if let Some(compiled) = compilation.take_result() {
                return Ok(ControlFlow::Continue(compiled?));
            }
            let notice = loading.notice("", platform.since_boot());
            match notice.as_ref().filter(|_| self.phase.is_running()) {
                Some(notice) => opened.wait_and_run_frame(notice)?,
                None => super::pause_between_polls(),
            }
            let status = platform.poll_status();
            self.note_health_and_log_warning(status.health, platform);
            let quits = self.run_loading_test_command(opened)?.is_break();
            if let Some(end) =
                self.follow_exit_request(&opened.session, quits | status.quit_requested)
            {
                return Ok(ControlFlow::Break(end));
            }
            self.studio.poll_background_work();
            self.log_notes(platform);
        }
    }

    /// Returns how the session has ended, if its phase is an end.
    pub(super) fn session_end(&self) -> Option<SessionEnd> {
        match self.phase {
            SessionPhase::Exited => Some(SessionEnd::Exited),
            SessionPhase::Lost if self.exit_requested_at.is_some() => Some(SessionEnd::Exited),
            SessionPhase::Lost => Some(SessionEnd::Lost),
            _ => None,
        }
    }

    fn run_loading_test_command(&self, opened: &OpenedSession) -> Result<ControlFlow<()>, Error> {
        match self.test_commands.and_then(CommandQueue::poll_next) {
            None => {}
            Some(TestCommand::PrintStatus) => {
                self.print_status("loading", &opened.gpu, &opened.runtime);
            }
            Some(TestCommand::CaptureFrame(prefix)) => {
                if let Some(layer) = &opened.notice {
                    layer.write_capture(&prefix)?;
                }
            }
            Some(TestCommand::Quit) => return Ok(ControlFlow::Break(())),
        }
        Ok(ControlFlow::Continue(()))
    }
}
