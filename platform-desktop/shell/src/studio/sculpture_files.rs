//! The files of one finished sculpture while they are made: STL, volume and picture. The picture is
//! drawn in a thread.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, World};

use super::DrawPicture;
use crate::rmap;
use crate::stl_export::{FinishedStl, StlExporter};

/// The extension and bytes of each file.
pub(super) type FilesByExtension = Vec<(&'static str, Vec<u8>)>;

/// The files made of a sculpture.
#[derive(Debug)]
pub(super) struct MadeSculpture {
    /// The files for the visitor; empty if they are written already.
    pub(super) files: FilesByExtension,
    /// The badge that the visitor was shown.
    pub(super) badge: Option<BadgeNumber>,
}

/// The files of a sculpture that have been made so far.
#[derive(Debug)]
pub(super) struct SculptureFiles {
    /// The print, once it is made.
    stl: Option<FinishedStl>,
    picture: PictureState,
    rmap: Vec<u8>,
    /// In a visit, the badge by which the sculpture is found.
    badge: Option<BadgeNumber>,
    /// `true` if the files are on the disk already, and only the receiver lacks the sculpture.
    is_written: bool,
}

#[derive(Debug)]
enum PictureState {
    Drawing(Receiver<Result<Vec<u8>, String>>),
    Drawn(Result<Vec<u8>, String>),
}

impl SculptureFiles {
    /// Starts the picture's thread and encodes the volume of a world whose session has just ended.
    pub(super) fn start<const N: usize>(
        world: &World<N, INTERVALS>,
        draw_picture: DrawPicture<N>,
    ) -> Self
    where
        Grid<N>: Size,
    {
        let maps = world.volume().maps();
        let mut copy = Box::new(RangeMaps::<N, INTERVALS>::new());
        copy.copy_from(maps);
        let (tell, drawing) = channel();
        thread::spawn(move || {
            // The receiver is gone if the studio was dropped.
            let _ = tell.send(draw_picture(&copy));
        });
        let picture = PictureState::Drawing(drawing);
        SculptureFiles {
            stl: None,
            picture,
            rmap: rmap::encode(maps),
            badge: None,
            is_written: false,
        }
    }

    /// Notes that the files are on the disk already.
    pub(super) const fn note_written(&mut self) {
        self.is_written = true;
    }

    /// Returns the volume file.
    pub(super) fn volume(&self) -> &[u8] {
        &self.rmap
    }

    /// Keeps the STL file if it is finished. Only the first one counts.
    pub(super) fn keep_stl(&mut self, stl: Option<FinishedStl>) {
        self.stl = self.stl.take().or(stl);
    }

    /// Notes the badge that the visitor is shown.
    pub(super) fn note_badge(&mut self, badge: BadgeNumber) {
        self.badge = Some(badge);
    }

    /// Waits for the picture and finishes the STL file.
    pub(super) fn make_files_to_end<const N: usize>(
        &mut self,
        stl_exporter: &mut StlExporter<'_, N, INTERVALS>,
    ) where
        Grid<N>: Size,
    {
        self.keep_stl(stl_exporter.run_export_to_end());
        self.wait_for_picture();
    }

    /// Waits for the picture, which a thread draws.
    pub(super) fn wait_for_picture(&mut self) {
        if let PictureState::Drawing(drawing) = &self.picture {
            let drawn = drawing.recv().unwrap_or_else(|_| Err("no picture was drawn".into()));
            self.picture = PictureState::Drawn(drawn);
        }
    }

    /// Returns the files, the STL file first, once all are ready; or the reason why there are none.
    pub(super) fn take_finished_files(&mut self) -> Option<Result<MadeSculpture, String>> {
        if let PictureState::Drawing(drawing) = &self.picture {
            self.picture = match drawing.try_recv() {
                Ok(drawn) => PictureState::Drawn(drawn),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    PictureState::Drawn(Err("no picture was drawn".into()))
                }
            };
        }
        let PictureState::Drawn(drawn) = &mut self.picture else { return None };
        let stl = self.stl.take()?;
        if stl.triangle_count == 0 {
            return Some(Err("nothing is left to print".into()));
        }
        let badge = self.badge;
        if self.is_written {
            return Some(Ok(MadeSculpture { files: Vec::new(), badge }));
        }
        let mut files = vec![("stl", stl.bytes), ("rmap", core::mem::take(&mut self.rmap))];
        if let Some(badge) = badge {
            files.push(("txt", describe_badge(badge).into_bytes()));
        }
        // A sculpture without its picture is better than none.
        if let Ok(png) = drawn {
            files.push(("png", core::mem::take(png)));
        }
        Some(Ok(MadeSculpture { files, badge }))
    }
}

/// Returns a badge's words, a line per language, and its number, for people who look for a sculpture among
/// files.
fn describe_badge(number: BadgeNumber) -> String {
    let badge = number.badge();
    let mut text = String::new();
    for language in Language::ALL {
        // Writing to a `String` can't fail.
        let _ = write_words(&mut text, &badge, language);
        text.push('\n');
    }
    text + &format!("badge {}\n", number.get())
}
