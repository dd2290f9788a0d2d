//! Export of a finished sculpture: a print, its volume and a picture. It takes the world after each
//! tick and gives files as bytes. It knows neither where they go nor how they are written.

use std::path::{Path, PathBuf};

use paros_core::{Grid, Size, World};

use super::DrawPicture;
use super::sculpture_files::{NamedFiles, SculptureFiles};
use crate::file_writer::WriteJob;
use crate::print::StlPrinter;

/// The export of a finished sculpture, and the result of the last one.
pub(super) struct SculptureExport<'a, const N: usize>
where
    Grid<N>: Size,
{
    printer: StlPrinter<'a, N>,
    draw_picture: DrawPicture<N>,
    files: Option<SculptureFiles>,
    /// The path of the last print.
    last_print: Option<PathBuf>,
    /// Jobs that failed in every folder, of finished sculptures and previous sessions.
    unwritten: Vec<WriteJob>,
}

impl<'a, const N: usize> SculptureExport<'a, N>
where
    Grid<N>: Size,
{
    /// Nothing to export yet.
    pub(super) fn new(printer: StlPrinter<'a, N>, draw_picture: DrawPicture<N>) -> Self {
        let unwritten = Vec::new();
        SculptureExport { printer, draw_picture, files: None, last_print: None, unwritten }
    }

    /// The path of the last print.
    pub(super) fn last_print_path(&self) -> Option<&Path> {
        self.last_print.as_deref()
    }

    /// Sets the path of the session's print; `None` before there is one.
    pub(super) fn set_last_print_path(&mut self, path: Option<PathBuf>) {
        self.last_print = path;
    }

    /// Whether failed jobs are kept.
    pub(super) const fn has_unwritten(&self) -> bool {
        !self.unwritten.is_empty()
    }

    /// Keeps a failed job, to be submitted again.
    pub(super) fn keep_unwritten(&mut self, job: WriteJob) {
        self.unwritten.push(job);
    }

    /// Removes and returns the failed jobs.
    pub(super) fn take_unwritten(&mut self) -> impl Iterator<Item = WriteJob> {
        self.unwritten.drain(..)
    }

    /// Whether a print is being made.
    pub(super) const fn is_busy(&self) -> bool {
        self.files.is_some()
    }

    /// Advances the print after a tick; begins one where the tick finished the session.
    pub(super) fn advance_print(&mut self, world: &World<N>) {
        let print = self.printer.advance_after_tick(world);
        if let Some(files) = &mut self.files {
            files.take_print(print);
        }
    }

    /// Starts the export of a world whose session has just ended.
    pub(super) fn start_files(&mut self, world: &World<N>) {
        self.files = Some(SculptureFiles::start(world, self.draw_picture));
    }

    /// Waits for the picture.
    pub(super) fn wait_for_picture(&mut self) {
        if let Some(files) = &mut self.files {
            files.wait_for_picture();
        }
    }

    /// Waits for the picture and makes what is left of the print.
    pub(super) fn finish_files(&mut self) {
        if let Some(files) = &mut self.files {
            files.finish_parts(&mut self.printer);
        }
    }

    /// The files once all are ready, or why there are none. They are returned once.
    pub(super) fn take_files(&mut self) -> Option<Result<NamedFiles, String>> {
        let files = self.files.as_mut()?.take_files()?;
        self.files = None;
        Some(files)
    }
}
