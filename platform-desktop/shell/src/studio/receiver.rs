//! The receiver of a studio's finished sculptures, which carries them to a place outside the studio.

use std::thread;
use std::time::{Duration, Instant};

use paros_core::World;
use paros_core::badge::BadgeNumber;
use paros_core::limits::INTERVALS;
use paros_core::visit::{PlanSetting, VisitPhase};
use paros_core::volume::{Grid, Size};

use super::Studio;
use crate::statics::Resident;

/// The time for which a save that would replace a sculpture's save waits for the receiver to keep the
/// sculpture. A full disk takes longer, and the save does not wait for it.
const KEEP_TIMEOUT: Duration = Duration::from_secs(2);

/// Receives a studio's finished sculptures, one at a time.
pub trait SculptureReceiver<const N: usize>
where
    Grid<N>: Size,
{
    /// Begins a finished sculpture, whose files are being made: its volume's `.rmap`, and its print's height in millimetres.
    /// `is_cut_off` is `true` if the receiver did not see it finished: an earlier run finished it, or the receiver was set
    /// later. `encode_trace` returns the session's trace, or `None` if it is not whole or has several visitors.
    fn begin(
        &mut self,
        world: &World<N, INTERVALS>,
        volume: &[u8],
        height_mm: f32,
        is_cut_off: bool,
        encode_trace: &dyn Fn() -> Option<Vec<u8>>,
    );

    /// Keeps the sculpture that was begun last, once its files are made. `badge` is the badge that its visitor was shown.
    fn keep(&mut self, badge: Option<BadgeNumber>);

    /// Abandons the sculpture that was begun last: it has no files.
    fn abandon(&mut self);

    /// Returns `true` from the beginning of a sculpture until it is kept or abandoned, which takes a disk's time.
    fn is_keeping(&self) -> bool;

    /// Follows a tick that led to `world`. A sculpture that the tick finished was begun before.
    fn follow_tick(&mut self, world: &World<N, INTERVALS>);
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Sets the receiver of sculptures that are finished from now on; `None` removes it.
    pub fn set_receiver(&mut self, receiver: Option<Box<dyn SculptureReceiver<N>>>) {
        self.receiver = receiver;
    }

    /// Begins the sculpture whose files are being made in the receiver, as cut off. If no files are being made and
    /// `makes_files` is `true`, those of the finished sculpture in the world are made for the receiver alone.
    pub fn begin_cut_off(&mut self, makes_files: bool) {
        if makes_files && !self.export.is_making_files() {
            self.export.begin_anew(self.session.world);
            self.export.note_written();
        }
        self.begin_in_receiver(true);
    }

    /// Returns `true` if the files of a visit's sculpture wait for the badge number, which is part of them.
    #[must_use]
    pub fn is_badge_awaited(&self) -> bool {
        let visit = self.world().visit();
        self.receiver.is_some()
            && visit.phase() == VisitPhase::Export
            && visit.plan().value(PlanSetting::Badges) != 0
            && visit.badge().is_none()
    }

    /// Begins the sculpture whose files are being made, if there is one, in the receiver.
    pub(super) fn begin_in_receiver(&mut self, is_cut_off: bool) {
        let (Some(receiver), Some(volume)) = (&mut self.receiver, self.export.volume()) else {
            return;
        };
        let (height_mm, recorder) = (self.export.model_height_mm(), &self.recorder);
        let encode_trace = || recorder.visitors_own_trace();
        receiver.begin(self.session.world, volume, height_mm, is_cut_off, &encode_trace);
    }

    /// Returns `true` if the receiver has not kept the last sculpture yet.
    pub(super) fn is_receiver_keeping(&self) -> bool {
        self.receiver.as_ref().is_some_and(|receiver| receiver.is_keeping())
    }

    /// Waits until the receiver has kept the last sculpture, at most for [`KEEP_TIMEOUT`].
    pub(super) fn wait_for_receiver(&self) {
        let begun = Instant::now();
        while self.is_receiver_keeping() && begun.elapsed() < KEEP_TIMEOUT {
            thread::sleep(Duration::from_millis(5));
        }
    }
}
