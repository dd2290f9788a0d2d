//! All previews of a choice, a world a tick.

use paros_core::session::SessionMode;
use paros_shaders::Image;
use paros_shaders::limits::PANEL_CELLS;

use super::stage::{PreviewStage, PreviewSubject, draw_still};

/// Starts that are worked on; of the others there is a still picture each.
pub(crate) const LIVE: usize = 3;

/// Ticks from one picture to the next: with three starts each has three in a second.
const PICTURE_TICKS: u32 = 8;

/// Pictures from one of what stands still to the next, once there is one of each: a renderer that was made anew, as after
/// the loss of its device, has none.
const STILL_PICTURES: u32 = 16;

/// The previews of the starts on offer, a cell each by their place.
#[derive(Debug)]
pub(crate) struct PreviewShow {
    live: Vec<(u8, PreviewSubject, Option<PreviewStage>)>,
    still: Vec<(u8, PreviewSubject)>,
    tick: u32,
    /// Pictures so far, of what lives and what stands still.
    drawn: [u32; 2],
}

impl PreviewShow {
    /// Of these starts; worlds are made when their turn comes.
    pub(crate) fn new(starts: &[SessionMode]) -> Self {
        let subject = |(cell, start): (u8, &SessionMode)| {
            PreviewSubject::of_start(*start).map(|subject| (cell, subject))
        };
        let mut live: Vec<_> = (0..PANEL_CELLS as u8).zip(starts).filter_map(subject).collect();
        let still = live.split_off(live.len().min(LIVE));
        let live = live.into_iter().map(|(cell, subject)| (cell, subject, None)).collect();
        PreviewShow { live, still, tick: 0, drawn: [0; 2] }
    }

    /// Steps one of the worlds. The cell and the picture of one that is due.
    pub(crate) fn run_tick(&mut self) -> Option<(u8, Image)> {
        let count = self.live.len() as u32;
        let turn = self.tick.checked_rem(count)?;
        let (_, subject, stage) = &mut self.live[turn as usize];
        stage.get_or_insert_with(|| PreviewStage::new(*subject)).run_tick();
        self.tick += 1;
        // Each is seen as soon as it is made.
        let is_due = self.tick <= count || self.tick.is_multiple_of(PICTURE_TICKS);
        is_due.then(|| self.draw_next()).flatten()
    }

    fn draw_next(&mut self) -> Option<(u8, Image)> {
        let [live, still] = self.drawn;
        let is_new = (still as usize) < self.still.len();
        let all_live = live >= self.live.len() as u32;
        let is_still_due = all_live && (is_new || (live + still).is_multiple_of(STILL_PICTURES));
        if is_still_due && !self.still.is_empty() {
            let (cell, subject) = self.still[still as usize % self.still.len()];
            self.drawn[1] += 1;
            return Some((cell, draw_still(subject)));
        }
        self.drawn[0] += 1;
        let turn = live as usize % self.live.len();
        let (cell, _, stage) = &mut self.live[turn];
        stage.as_mut().map(|stage| (*cell, stage.draw()))
    }
}
