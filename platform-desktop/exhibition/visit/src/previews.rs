//! Live previews of the choice of a start. Each start is carved in a small world of its own while it turns. A
//! thread draws pictures of these worlds for the cells of the cards.
//!
//! They are only pictures: the visitor's world doesn't use them.

mod show;
mod stage;
mod worker;

use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use paros_shaders::Image;
use paros_shaders::limits::PANEL_CELLS;

use crate::host::VisitHost;
use stage::PreviewSubject;
use worker::PreviewWorker;

/// The previews while a choice is open.
#[derive(Debug, Default)]
pub(crate) struct LivingPreviews {
    worker: Option<PreviewWorker>,
    /// The worker of a closed choice. It may still draw its last picture, which is discarded.
    ending: Option<PreviewWorker>,
}

impl LivingPreviews {
    /// Processes a tick, with the visit's phase and the starts on offer.
    pub(crate) fn follow_tick(&mut self, phase: VisitPhase, starts: &[SessionMode]) {
        // With a single start there is no choice, and no panel.
        let is_open = phase == VisitPhase::Choice && starts.len() > 1;
        if self.ending.as_ref().is_some_and(PreviewWorker::has_ended) {
            self.ending = None;
        }
        match &mut self.worker {
            Some(worker) if is_open => worker.pass_tick(),
            Some(worker) => {
                worker.close();
                self.ending = self.worker.take();
            }
            None if is_open && self.ending.is_none() => self.worker = PreviewWorker::spawn(starts),
            None => {}
        }
    }

    /// Returns `true` while previews are shown.
    #[cfg(test)]
    pub(crate) const fn is_open(&self) -> bool {
        self.worker.is_some()
    }

    /// Returns `true` while a thread runs, or is about to end.
    #[cfg(test)]
    pub(crate) const fn is_running(&self) -> bool {
        self.worker.is_some() || self.ending.is_some()
    }

    fn take_picture(&self) -> Option<(u8, Image)> {
        self.worker.as_ref()?.take_picture()
    }
}

/// Returns the cell of a card by its place; `None` if the card has no picture.
pub(crate) fn cell_of_card(place: usize, start: SessionMode) -> Option<u8> {
    let has_cell = place < PANEL_CELLS && PreviewSubject::of_start(start).is_some();
    has_cell.then_some(place as u8)
}

impl VisitHost {
    /// Passes finished pictures and their cells to a renderer before a frame. `take` returns `true` if it
    /// took the picture.
    pub fn hand_over_previews(&mut self, mut take: impl FnMut(u8, &Image) -> bool) {
        while let Some((cell, picture)) = self.previews.take_picture() {
            let is_taken = take(cell, &picture);
            debug_assert!(is_taken, "cell {cell} takes no picture");
        }
    }
}

#[cfg(test)]
mod tests;
