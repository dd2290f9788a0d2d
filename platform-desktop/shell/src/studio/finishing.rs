//! A finished sculpture on its way to the disk: the print, the volume and a picture.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_core::world::World;

use super::Portrait;
use crate::print::{Print, Printer};
use crate::rmap;

/// How the files' names end.
pub(super) const ENDINGS: [&str; 3] = ["stl", "png", "rmap"];

/// Files and what is in them.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// What there is of it so far.
#[derive(Debug)]
pub(super) struct Finishing {
    stem: PathBuf,
    print: Option<Print>,
    picture: Picture,
    rmap: Vec<u8>,
}

#[derive(Debug)]
enum Picture {
    Drawing(Receiver<Result<Vec<u8>, String>>),
    Drawn(Result<Vec<u8>, String>),
}

impl Finishing {
    /// Begins with a world whose session has just ended; `stem` becomes the files' names.
    pub(super) fn begin<const N: usize>(
        world: &World<N>,
        stem: PathBuf,
        portrait: Portrait<N>,
    ) -> Self
    where
        Grid<N>: Size,
    {
        let maps = world.volume().maps();
        let mut copy = Box::new(Maps::<N>::new());
        copy.copy_from(maps);
        let (tell, drawing) = channel();
        thread::spawn(move || {
            // Nobody listens any more if the window was closed in a hurry.
            let _ = tell.send(portrait(&copy));
        });
        let picture = Picture::Drawing(drawing);
        Finishing { stem, print: None, picture, rmap: rmap::encode(maps) }
    }

    /// Takes the print, once it is whole.
    pub(super) fn take_print(&mut self, print: Option<Print>) {
        self.print = self.print.take().or(print);
    }

    /// Waits for the picture and makes what is left of the print.
    pub(super) fn complete<const N: usize>(&mut self, printer: &mut Printer<'_, N>)
    where
        Grid<N>: Size,
    {
        self.take_print(printer.complete());
        self.wait_for_picture();
    }

    /// Waits for the picture.
    pub(super) fn wait_for_picture(&mut self) {
        if let Picture::Drawing(drawing) = &self.picture {
            let drawn = drawing.recv().unwrap_or_else(|_| Err("no picture was drawn".into()));
            self.picture = Picture::Drawn(drawn);
        }
    }

    /// The files, the print first, once all are there; or why there are none.
    pub(super) fn files(&mut self) -> Option<Result<Files, String>> {
        if let Picture::Drawing(drawing) = &self.picture {
            self.picture = match drawing.try_recv() {
                Ok(drawn) => Picture::Drawn(drawn),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    Picture::Drawn(Err("no picture was drawn".into()))
                }
            };
        }
        let Picture::Drawn(drawn) = &mut self.picture else { return None };
        let print = self.print.take()?;
        if print.triangles == 0 {
            return Some(Err("nothing is left to print".into()));
        }
        let file = |ending, bytes| (self.stem.with_extension(ending), bytes);
        let mut files = vec![file("stl", print.stl), file("rmap", core::mem::take(&mut self.rmap))];
        // A sculpture without its picture is better than none.
        if let Ok(png) = drawn {
            files.push(file("png", core::mem::take(png)));
        }
        Some(Ok(files))
    }
}
