//! A session that only shows a notice: it needs no input, no programs and no images of eyes, as any of these
//! may be the cause of the failed start.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use openxr as xr;
use paros_headset::start_up::StartNotice;
use paros_shaders::gpu::{self, Gpu};

use crate::error::{CallContext, Error};
use crate::options::ShellOptions;
use crate::platform::Platform;
use crate::shell::{IDLE_POLL_INTERVAL, session_event};
use crate::test_commands::{CommandQueue, TestCommand};
use crate::xr::{FrameCalls, NoticeLayer, Runtime, VIEW_CONFIGURATION, create_raw_session};
use paros_headset::session_phase::{SessionDuty, SessionPhase};

/// The session. Fields are dropped in this order.
pub(crate) struct NoticeSession {
    layer: NoticeLayer,
    raw: xr::Session<xr::Vulkan>,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    _gpu: Arc<Gpu>,
    runtime: Runtime,
    phase: SessionPhase,
}

impl NoticeSession {
    /// Creates the session.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn create(
        platform: &mut dyn Platform,
        options: &ShellOptions,
    ) -> Result<Self, Error> {
        let runtime = Runtime::create(platform, options)?;
        let wanted = gpu::Options { validation: options.validation, ..gpu::Options::default() };
        let gpu = runtime.create_gpu(runtime.create_vulkan(&wanted)?, &wanted)?;
        let (raw, waiter, stream) = create_raw_session(&runtime, &gpu)?;
        let layer = NoticeLayer::create(&raw, &gpu, options.test_commands)?;
        let phase = SessionPhase::default();
        Ok(NoticeSession { layer, raw, waiter, stream, _gpu: gpu, runtime, phase })
    }

    /// Shows the notice that `notice_at` returns for the time since boot, until it returns none. Breaks if
    /// the app must quit.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn run(
        &mut self,
        platform: &mut dyn Platform,
        commands: Option<&CommandQueue>,
        notice_at: &dyn Fn(Duration) -> Option<StartNotice>,
    ) -> Result<ControlFlow<()>, Error> {
        while let Some(notice) = notice_at(platform.since_boot()) {
            self.poll_events()?;
            match self.phase {
                SessionPhase::Exited => return Ok(ControlFlow::Break(())),
                SessionPhase::Lost => return Ok(ControlFlow::Continue(())),
                phase if phase.is_running() => {
                    let NoticeSession { waiter, stream, layer, runtime, .. } = self;
                    let calls = FrameCalls { waiter, stream, blend_mode: runtime.blend_mode };
                    layer.wait_and_run_frame(calls, &notice)?;
                }
                _ => thread::sleep(IDLE_POLL_INTERVAL),
            }
            let quits = self.run_test_command(commands, &notice)?.is_break();
            if quits || platform.poll_status().quit_requested {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn poll_events(&mut self) -> Result<(), Error> {
        let mut buffer = xr::EventDataBuffer::new();
        let instance = &self.runtime.instance;
        while let Some(event) = instance.poll_event(&mut buffer).could_not("ask what happened")? {
            let event = match event {
                xr::Event::SessionStateChanged(change) => session_event(change.state()),
                _ => None,
            };
            let Some(change) = event.map(|event| self.phase.after_event(event)) else { continue };
            self.phase = change.phase;
            match change.duty {
                Some(SessionDuty::Begin) => {
                    self.raw.begin(VIEW_CONFIGURATION).could_not("begin the session")?;
                }
                Some(SessionDuty::SaveAndEnd) => {
                    self.raw.end().could_not("end the session")?;
                }
                // There is nothing to save.
                Some(SessionDuty::Save) | None => {}
            }
        }
        Ok(())
    }

    fn run_test_command(
        &self,
        commands: Option<&CommandQueue>,
        notice: &StartNotice,
    ) -> Result<ControlFlow<()>, Error> {
        match commands.and_then(CommandQueue::poll_next) {
            None => {}
            Some(TestCommand::PrintStatus) => {
                // Standard output may be closed.
                let _ = writeln!(io::stdout().lock(), "life notice; notice {notice:?}");
            }
            Some(TestCommand::CaptureFrame(prefix)) => self.layer.write_capture(&prefix)?,
            Some(TestCommand::Quit) => return Ok(ControlFlow::Break(())),
        }
        Ok(ControlFlow::Continue(()))
    }
}
