//! The show: all previews of a choice, of which one world is stepped in each tick.

use paros_core::session::SessionMode;
use paros_shaders::Image;
use paros_shaders::limits::PANEL_CELLS;

use super::stage::{PreviewStage, PreviewSubject, draw_still};

/// Largest number of live previews. Further starts have a still picture.
pub(crate) const LIVE: usize = 3;

/// Ticks between two pictures: with three starts, each has three pictures a second.
const PICTURE_TICKS: u32 = 8;

/// Interval of the still pictures, in pictures, once each was drawn. They are repeated because a recreated
/// renderer, such as after a lost device, has none.
const STILL_PICTURES: u32 = 16;

/// The previews of the starts on offer, with one cell for each place.
#[derive(Debug)]
pub(crate) struct PreviewShow {
    live: Vec<(u8, PreviewSubject, Option<PreviewStage>)>,
    still: Vec<(u8, PreviewSubject)>,
    tick: u32,
    /// Number of pictures so far: live ones, and still ones.
    drawn: [u32; 2],
}

impl PreviewShow {
    /// Makes the show of these starts. Each world is made in its first turn.
    pub(crate) fn new(starts: &[SessionMode]) -> Self {
        let subject = |(cell, start): (u8, &SessionMode)| {
            PreviewSubject::of_start(*start).map(|subject| (cell, subject))
        };
        let mut live: Vec<_> = (0..PANEL_CELLS as u8).zip(starts).filter_map(subject).collect();
        let still = live.split_off(live.len().min(LIVE));
        let live = live.into_iter().map(|(cell, subject)| (cell, subject, None)).collect();
        PreviewShow { live, still, tick: 0, drawn: [0; 2] }
    }

    /// Steps one of the worlds. Returns a picture with its cell if one is due.
    pub(crate) fn run_tick(&mut self) -> Option<(u8, Image)> {
        let count = self.live.len() as u32;
        let turn = self.tick.checked_rem(count)?;
        let (_, subject, stage) = &mut self.live[turn as usize];
        stage.get_or_insert_with(|| PreviewStage::new(*subject)).run_tick();
        self.tick += 1;
        // Each preview is shown as soon as its world is made.
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
