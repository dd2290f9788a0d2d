//! A print's hash, which a thread of its own makes: the file has megabytes, and a frame no time for them.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use paros_core::outbox::messages::ContentHash;
use sha2::{Digest as _, Sha256};

use crate::stl_export::FinishedStl;

/// A finished print.
#[derive(Debug)]
pub(super) struct SealedStl {
    pub(super) stl: FinishedStl,
    /// What is needed of it to be sent.
    pub(super) seal: Option<StlSeal>,
}

/// SHA-256 of a print, and a copy of it where it is sent itself.
#[derive(Debug)]
pub(super) struct StlSeal {
    pub(super) hash: ContentHash,
    pub(super) copy: Option<Vec<u8>>,
}

/// How far a print is.
#[derive(Debug)]
pub(super) enum StlState {
    /// It is being made.
    Making,
    /// Its hash is.
    Sealing(Receiver<SealedStl>),
    /// It is done; `None` if the thread failed, or it was taken.
    Done(Option<SealedStl>),
}

impl StlState {
    /// Takes a print that is made; the first one counts. `sends_copy` is `None` where none of it is sent.
    pub(super) fn keep(&mut self, stl: FinishedStl, sends_copy: Option<bool>) {
        let StlState::Making = self else { return };
        let Some(sends_copy) = sends_copy else {
            *self = StlState::Done(Some(SealedStl { stl, seal: None }));
            return;
        };
        let (tell, sealing) = channel();
        thread::spawn(move || {
            let hash = ContentHash(Sha256::digest(&stl.bytes).into());
            let copy = sends_copy.then(|| stl.bytes.clone());
            // The receiver is gone if the studio was dropped.
            let _ = tell.send(SealedStl { stl, seal: Some(StlSeal { hash, copy }) });
        });
        *self = StlState::Sealing(sealing);
    }

    /// Waits for the hash.
    pub(super) fn wait(&mut self) {
        if let StlState::Sealing(sealing) = self {
            *self = StlState::Done(sealing.recv().ok());
        }
    }

    /// Takes the print, once it is done; `Some(None)` where its thread failed.
    pub(super) fn take_done(&mut self) -> Option<Option<SealedStl>> {
        if let StlState::Sealing(sealing) = self {
            match sealing.try_recv() {
                Ok(sealed) => *self = StlState::Done(Some(sealed)),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => *self = StlState::Done(None),
            }
        }
        match self {
            StlState::Done(sealed) => Some(sealed.take()),
            StlState::Making | StlState::Sealing(_) => None,
        }
    }
}
