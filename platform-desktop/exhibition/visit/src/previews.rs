//! Living previews of the choice of a start: each start turns and is worked on in a small world of its own, and a thread
//! draws pictures of them for the cards' cells.
//!
//! They are pictures: nothing of the visitor's world comes from them.

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

/// The previews of a choice while it is open.
#[derive(Debug, Default)]
pub(crate) struct LivingPreviews {
    worker: Option<PreviewWorker>,
    /// Of a choice that is over: it may still be at its last picture, for which nobody waits.
    ending: Option<PreviewWorker>,
}

impl LivingPreviews {
    /// Takes in a tick: the visit's phase in it, and the starts on offer.
    pub(crate) fn follow_tick(&mut self, phase: VisitPhase, starts: &[SessionMode]) {
        // With one there is nothing to choose, and no panel.
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

    /// Whether previews are under way.
    #[cfg(test)]
    pub(crate) const fn is_open(&self) -> bool {
        self.worker.is_some()
    }

    /// Whether a thread runs, or is about to end.
    #[cfg(test)]
    pub(crate) const fn is_running(&self) -> bool {
        self.worker.is_some() || self.ending.is_some()
    }

    fn take_picture(&self) -> Option<(u8, Image)> {
        self.worker.as_ref()?.take_picture()
    }
}

/// The cell of a card of the choice by its place, if it may have a picture.
pub(crate) fn cell_of_card(place: usize, start: SessionMode) -> Option<u8> {
    let has_cell = place < PANEL_CELLS && PreviewSubject::of_start(start).is_some();
    has_cell.then_some(place as u8)
}

impl VisitHost {
    /// Gives the pictures that are ready, and their cells, to a renderer before a frame; it returns whether it took one.
    pub fn hand_over_previews(&mut self, mut take: impl FnMut(u8, &Image) -> bool) {
        while let Some((cell, picture)) = self.previews.take_picture() {
            let is_taken = take(cell, &picture);
            debug_assert!(is_taken, "cell {cell} takes no picture");
        }
    }
}

#[cfg(test)]
mod tests;
