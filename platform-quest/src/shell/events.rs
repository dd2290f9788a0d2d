//! The runtime's events, polled between frames, and the status line for tests.

use std::io::{self, Write};

use openxr as xr;
use paros_core::edit::UndoCounts;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shaders::gpu::Gpu;
use paros_shell::headset::device_health::ThermalState;
use paros_shell::statics::Resident;

use super::HeadsetShell;
use crate::error::{CallContext, Error};
use crate::platform::Platform;
use crate::xr::{HeadsetSession, Runtime, VIEW_CONFIGURATION};
use paros_headset::session_phase::{PhaseChange, SessionDuty, SessionEvent};

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Polls the event queue (`xrPollEvent`) until it is empty, and handles each event.
    ///
    /// # Errors
    /// A call that failed: polling itself, or beginning or ending the session.
    pub(super) fn poll_events(
        &mut self,
        session: &mut HeadsetSession,
        runtime: &Runtime,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        let mut buffer = xr::EventDataBuffer::new();
        while let Some(event) =
            runtime.instance.poll_event(&mut buffer).could_not("ask what happened")?
        {
            match event {
                xr::Event::SessionStateChanged(change) => {
                    if let Some(event) = session_event(change.state()) {
                        self.on_session_event(event, session, runtime, platform)?;
                    }
                }
                xr::Event::InstanceLossPending(_) => {
                    let event = SessionEvent::LossPending;
                    self.on_session_event(event, session, runtime, platform)?;
                }
                xr::Event::ReferenceSpaceChangePending(change)
                    if change.reference_space_type() == session.room_type =>
                {
                    self.recentering.schedule_change(change.change_time().as_nanos());
                    platform.log(format_args!("recentred"));
                }
                xr::Event::UserPresenceChangedEXT(change) => {
                    self.on_user_presence_changed(change.is_user_present(), platform);
                }
                xr::Event::PerfSettingsEXT(change)
                    if change.sub_domain() == xr::PerfSettingsSubDomainEXT::THERMAL =>
                {
                    self.runtime_thermal = thermal_state(change.to_level());
                }
                xr::Event::EventsLost(lost) => {
                    platform.log(format_args!("{} events are lost", lost.lost_event_count()));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Advances the session's phase by an event, and fulfils the resulting duty.
    fn on_session_event(
        &mut self,
        event: SessionEvent,
        session: &mut HeadsetSession,
        runtime: &Runtime,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        platform.log(format_args!("{event:?}"));
        let PhaseChange { phase, duty } = self.phase.after_event(event);
        self.phase = phase;
        match duty {
            Some(SessionDuty::Begin) => {
                session.raw.begin(VIEW_CONFIGURATION).could_not("begin the session")?;
                session.set_thread_types(runtime);
                for refusal in session.request_performance_levels(runtime) {
                    platform.log(format_args!("{refusal}"));
                }
                self.pacer.pause();
                self.resolution.pause();
            }
            Some(SessionDuty::Save) => self.save_studio_and_wait(),
            Some(SessionDuty::SaveAndEnd) => {
                self.save_studio_and_wait();
                session.raw.end().could_not("end the session")?;
            }
            None => {}
        }
        Ok(())
    }

    /// Prints the status line of the test command `say`, for a session on this device and runtime.
    pub(super) fn print_status(&self, phase: &str, gpu: &Gpu, runtime: &Runtime) {
        let world = self.studio.world();
        let held =
            [0, 1].map(|hand| world.held_tool(hand).map_or("nothing", |(_, bit)| bit.spec().name));
        let tracked = [0, 1].map(|hand| world.hand_state(hand).tracked);
        let sources = self.hand_readers.map(|reader| reader.source());
        let room = self.placement.room();
        let UndoCounts { undoable: undo, redoable: redo } = world.undo_counts();
        let mut out = io::stdout().lock();
        // Standard output may be closed.
        let _ = writeln!(
            out,
            "life {phase}; session {:?}; mode {:?}; voxels {}; holds {held:?}; tracked {tracked:?}; \
             sources {sources:?}; undo {undo}; redo {redo}; ticks {}; frames {}; dropped {}; digest {:016x}; \
             room {:.3} {:.4} {:.4}; {}; device {}; runtime {}; note {}",
            world.session_state(),
            world.mode(),
            world.volume().count_voxels(),
            world.tick(),
            self.frames,
            self.dropped.count,
            world.digest(),
            room.yaw,
            room.origin.x,
            room.origin.y,
            self.visit_status(),
            gpu.name,
            runtime.name,
            self.last_note,
        );
    }
}

/// Returns the event for a session state (`XrSessionState`); `None` for states of later OpenXR versions.
pub(crate) fn session_event(state: xr::SessionState) -> Option<SessionEvent> {
    Some(match state {
        xr::SessionState::IDLE => SessionEvent::Idle,
        xr::SessionState::READY => SessionEvent::Ready,
        xr::SessionState::SYNCHRONIZED => SessionEvent::Synchronized,
        xr::SessionState::VISIBLE => SessionEvent::Visible,
        xr::SessionState::FOCUSED => SessionEvent::Focused,
        xr::SessionState::STOPPING => SessionEvent::Stopping,
        xr::SessionState::LOSS_PENDING => SessionEvent::LossPending,
        xr::SessionState::EXITING => SessionEvent::Exiting,
        _ => return None,
    })
}

/// Returns the thermal state for a notification level of `XR_EXT_performance_settings`.
fn thermal_state(level: xr::PerfSettingsNotificationLevelEXT) -> ThermalState {
    match level {
        xr::PerfSettingsNotificationLevelEXT::NORMAL => ThermalState::Normal,
        xr::PerfSettingsNotificationLevelEXT::WARNING => ThermalState::Warm,
        _ => ThermalState::Hot,
    }
}
