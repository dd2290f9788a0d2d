//! What the runtime tells between frames.

use std::io::{self, Write};

use openxr as xr;
use paros_core::size::{Grid, Size};
use paros_shell::statics::Resident;

use super::Shell;
use crate::error::{Doing, Error};
use crate::host::Host;
use crate::life::{Duty, Life, Told};
use crate::rig::Rig;
use crate::strain::Heat;
use crate::xr::VIEWS;

impl<const N: usize> Shell<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Takes in all that the runtime has to tell.
    pub(super) fn hear(&mut self, rig: &mut Rig<N>, host: &mut dyn Host) -> Result<(), Error> {
        let mut buffer = xr::EventDataBuffer::new();
        while let Some(event) =
            rig.runtime.instance.poll_event(&mut buffer).doing("ask what happened")?
        {
            match event {
                xr::Event::SessionStateChanged(change) => {
                    if let Some(told) = told(change.state()) {
                        self.told(told, rig, host)?;
                    }
                }
                xr::Event::InstanceLossPending(_) => self.told(Told::LossPending, rig, host)?,
                xr::Event::ReferenceSpaceChangePending(change)
                    if change.reference_space_type() == rig.session.room_kind =>
                {
                    self.recentre.pending(change.change_time().as_nanos());
                    host.log(format_args!("recentred"));
                }
                xr::Event::UserPresenceChangedEXT(change) => {
                    let present = change.is_user_present();
                    if self.visitor.presence(present, self.began.elapsed()) {
                        host.log(format_args!("another visitor"));
                    }
                    if !present {
                        self.studio.pause();
                    }
                }
                xr::Event::PerfSettingsEXT(change)
                    if change.sub_domain() == xr::PerfSettingsSubDomainEXT::THERMAL =>
                {
                    self.heat = heat(change.to_level());
                }
                xr::Event::EventsLost(lost) => {
                    host.log(format_args!("{} events are lost", lost.lost_event_count()));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn told(&mut self, told: Told, rig: &mut Rig<N>, host: &mut dyn Host) -> Result<(), Error> {
        host.log(format_args!("{told:?}"));
        let (life, duty) = self.life.told(told);
        self.life = life;
        match duty {
            Some(Duty::Begin) => {
                rig.session.raw.begin(VIEWS).doing("begin the session")?;
                rig.session.name_threads(&rig.runtime);
                self.beat.rest();
            }
            Some(Duty::Save) => self.save(),
            Some(Duty::End) => {
                self.keep_cache(rig);
                self.save();
                rig.session.raw.end().doing("end the session")?;
            }
            None => {}
        }
        Ok(())
    }

    /// Nobody can say when the headset is put on again.
    pub(super) fn save(&mut self) {
        self.studio.write_again();
        self.studio.pause();
    }

    /// Prints what there is to know, for a test to read.
    pub(super) fn say(&self, rig: &Rig<N>) {
        let world = self.studio.world();
        let held =
            [0, 1].map(|hand| world.held(hand).map_or("nothing", |(_, bit)| bit.data().name));
        let tracked = [0, 1].map(|hand| world.hand(hand).tracked);
        let seen = match self.life {
            Life::Focused => "focused",
            Life::Seen => "seen",
            _ => "unseen",
        };
        let (undo, redo) = world.undo_counts();
        let mut out = io::stdout().lock();
        // Nobody may be listening there.
        let _ = writeln!(
            out,
            "life {seen}; session {:?}; mode {:?}; voxels {}; holds {held:?}; tracked {tracked:?}; \
             undo {undo}; redo {redo}; ticks {}; frames {}; dropped {}; digest {:016x}; \
             device {}; runtime {}; note {}",
            world.session(),
            world.mode(),
            world.volume().count(),
            world.tick(),
            self.frames,
            self.dropped.ticks,
            world.digest(),
            rig.gpu.name,
            rig.runtime.name,
            self.last_note,
        );
    }
}

fn told(state: xr::SessionState) -> Option<Told> {
    Some(match state {
        xr::SessionState::IDLE => Told::Idle,
        xr::SessionState::READY => Told::Ready,
        xr::SessionState::SYNCHRONIZED => Told::Synchronized,
        xr::SessionState::VISIBLE => Told::Visible,
        xr::SessionState::FOCUSED => Told::Focused,
        xr::SessionState::STOPPING => Told::Stopping,
        xr::SessionState::LOSS_PENDING => Told::LossPending,
        xr::SessionState::EXITING => Told::Exiting,
        _ => return None,
    })
}

fn heat(level: xr::PerfSettingsNotificationLevelEXT) -> Heat {
    match level {
        xr::PerfSettingsNotificationLevelEXT::NORMAL => Heat::Normal,
        xr::PerfSettingsNotificationLevelEXT::WARNING => Heat::Warm,
        _ => Heat::Hot,
    }
}
