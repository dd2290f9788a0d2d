//! The ticks of a frame: each with the poses of its own time.

use std::time::Instant;

use openxr as xr;
use paros_core::input::{HandInput, Input, RawPose};
use paros_core::size::{Grid, Size};
use paros_shell::stage::Pace;
use paros_shell::statics::Resident;

use super::{Shell, TELLING};
use crate::error::Error;
use crate::host::Host;
use crate::rig::Rig;
use crate::sample::HandSample;
use crate::xr::Session;

impl<const N: usize> Shell<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// The ticks up to a frame that is shown at a time, and what the hands feel of them.
    pub(super) fn ticks(
        &mut self,
        rig: &mut Rig<N>,
        shown_at: xr::Time,
        host: &mut dyn Host,
    ) -> Result<(), Error> {
        let due = self.beat.frame(shown_at.as_nanos());
        self.fraction = due.fraction;
        self.count_dropped(due.dropped, host);
        let (session, listens) = (&rig.session, self.life.listens());
        let menu = if listens {
            session.actions.sync(&session.raw)?;
            session.actions.menu(&session.raw)?
        } else {
            false
        };
        for at in due.times() {
            let jumped = self.recentre.breaks(at);
            let mut input = input(session, xr::Time::from_nanos(at), listens && !jumped)?;
            self.visitor.act(self.studio.world().session(), menu, &mut input);
            if core::mem::take(&mut self.fresh) {
                input.start = self.options.mode;
            }
            self.studio.tick_within(&input, |step| host.step(step));
            let world = self.studio.world();
            rig.show.note(world);
            self.pulses.note([world.hand(0).haptic, world.hand(1).haptic]);
        }
        for (hand, pulse) in self.pulses.take().into_iter().enumerate() {
            if let Some(pulse) = pulse.filter(|_| listens) {
                rig.session.actions.pulse(&rig.session.raw, hand, pulse)?;
            }
        }
        Ok(())
    }

    /// Counts the ticks that are not made up, and tells of them from time to time.
    fn count_dropped(&mut self, ticks: u32, host: &mut dyn Host) {
        let dropped = &mut self.dropped;
        dropped.ticks += u64::from(ticks);
        let told_long_ago = dropped.told_at.is_none_or(|told_at| told_at.elapsed() > TELLING);
        if dropped.ticks > dropped.told && told_long_ago {
            let (all, most) = (dropped.ticks, Pace::CATCH_UP);
            host.log(format_args!(
                "{all} ticks dropped so far: a frame makes up {most} at the most"
            ));
            (dropped.told, dropped.told_at) = (all, Some(Instant::now()));
        }
    }
}

/// Head and hands at a time, as the core takes them. `hands` are left out where they are another's.
fn input(session: &Session, at: xr::Time, hands: bool) -> Result<Input, Error> {
    let head = session.head(at)?;
    let head =
        head.map_or(RawPose::default(), |(position, rotation)| RawPose::new(position, rotation));
    let mut input = Input { head, ..Input::default() };
    if hands {
        for (hand, to) in input.hands.iter_mut().enumerate() {
            *to = hand_input(session, hand, at)?;
        }
    }
    Ok(input)
}

/// A controller, or the bare hand where it is put down.
fn hand_input(session: &Session, hand: usize, at: xr::Time) -> Result<HandInput, Error> {
    let held = session.actions.sample(&session.raw, &session.room, hand, at)?;
    let sample: HandSample = match &session.bare {
        Some(bare) if held.grip.is_none() => bare.sample(&session.room, hand, at)?.unwrap_or(held),
        _ => held,
    };
    Ok(sample.input())
}
