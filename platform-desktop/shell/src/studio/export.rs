//! Export of a finished sculpture: an STL file, its volume and a picture. It takes the world after each tick
//! and returns files as bytes. It does not write them.

use std::mem;
use std::path::{Path, PathBuf};

use paros_core::World;
use paros_core::badge::BadgeNumber;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};

use super::DrawPicture;
use super::sculpture_files::{MadeSculpture, SculptureFiles};
use crate::file_writer::WriteJob;
use crate::stl_export::StlExporter;

/// The export of a finished sculpture, and the result of the last one.
pub(super) struct SculptureExport<'a, const N: usize>
where
    Grid<N>: Size,
{
    stl_exporter: StlExporter<'a, N, INTERVALS>,
    draw_picture: DrawPicture<N>,
    files: Option<SculptureFiles>,
    /// The number of sculptures whose files the writer has not answered for yet.
    being_written: usize,
    /// The path of the last STL file.
    session_stl_path: Option<PathBuf>,
    /// Jobs that failed in every folder, of finished sculptures and previous sessions.
    failed_jobs: Vec<WriteJob>,
}

impl<'a, const N: usize> SculptureExport<'a, N>
where
    Grid<N>: Size,
{
    /// Creates an export without a sculpture.
    pub(super) fn new(
        stl_exporter: StlExporter<'a, N, INTERVALS>,
        draw_picture: DrawPicture<N>,
    ) -> Self {
        let failed_jobs = Vec::new();
        SculptureExport {
            stl_exporter,
            draw_picture,
            files: None,
            being_written: 0,
            session_stl_path: None,
            failed_jobs,
        }
    }

    /// Returns the path of the last STL file.
    pub(super) fn session_stl_path(&self) -> Option<&Path> {
        self.session_stl_path.as_deref()
    }

    /// Sets the path of the session's STL file; `None` before there is one.
    pub(super) fn set_session_stl_path(&mut self, path: Option<PathBuf>) {
        self.session_stl_path = path;
    }

    /// Returns `true` if failed jobs are kept.
    pub(super) const fn has_failed_jobs(&self) -> bool {
        !self.failed_jobs.is_empty()
    }

    /// Keeps a failed job for a retry.
    pub(super) fn keep_failed_job(&mut self, job: WriteJob) {
        self.failed_jobs.push(job);
    }

    /// Removes and returns the failed jobs.
    pub(super) fn take_failed_jobs(&mut self) -> Vec<WriteJob> {
        mem::take(&mut self.failed_jobs)
    }

    /// Notes that a sculpture's files were submitted to the writer.
    pub(super) const fn note_submitted(&mut self) {
        self.being_written += 1;
    }

    /// Notes that the writer answered for a sculpture's files.
    pub(super) const fn note_answered(&mut self) {
        self.being_written -= 1;
    }

    /// Returns `true` while files are made or written.
    pub(super) const fn is_busy(&self) -> bool {
        self.files.is_some() || self.being_written > 0
    }

    /// Returns the number of sculptures whose files are being made, are being written, or failed.
    pub(super) fn count_unkept(&self) -> usize {
        usize::from(self.files.is_some()) + self.being_written + self.failed_jobs.len()
    }

    /// Returns `true` if files are being made that the writer doesn't have yet.
    pub(super) const fn is_making_files(&self) -> bool {
        self.files.is_some()
    }

    /// Returns the finished fraction of the print, 0 to 1.
    pub(super) fn part_made(&self) -> f32 {
        match &self.files {
            Some(_) => self.stl_exporter.part_made(),
            None => 1.0,
        }
    }

    /// Advances the STL export after a tick, or begins one if the tick finished the session.
    pub(super) fn advance_stl_after_tick(&mut self, world: &World<N, INTERVALS>) {
        let stl = self.stl_exporter.begin_if_finished_or_advance(world);
        if let Some(files) = &mut self.files {
            files.keep_stl(stl);
            // The world holds the badge until the next visitor comes.
            if let Some(badge) = world.visit().badge().and_then(BadgeNumber::new) {
                files.note_badge(badge);
            }
        }
    }

    /// Begins the export of a world whose session has ended earlier, with its STL file.
    pub(super) fn begin_anew(&mut self, world: &World<N, INTERVALS>) {
        self.stl_exporter.begin_export(world.volume().rows(), world.mask());
        self.start_making_files(world);
    }

    /// Starts to make the other files of a world whose session has just ended and whose STL file is begun.
    pub(super) fn start_making_files(&mut self, world: &World<N, INTERVALS>) {
        self.files = Some(SculptureFiles::start(world, self.draw_picture));
    }

    /// Notes that the files being made are on the disk already.
    pub(super) const fn note_written(&mut self) {
        if let Some(files) = &mut self.files {
            files.note_written();
        }
    }

    /// Returns the volume file of the sculpture whose files are being made.
    pub(super) fn volume(&self) -> Option<&[u8]> {
        self.files.as_ref().map(SculptureFiles::volume)
    }

    /// Returns the height of prints, in millimetres.
    pub(super) const fn model_height_mm(&self) -> f32 {
        self.stl_exporter.model_height_mm()
    }

    /// Waits for the picture.
    pub(super) fn wait_for_picture(&mut self) {
        if let Some(files) = &mut self.files {
            files.wait_for_picture();
        }
    }

    /// Waits for the picture and finishes the STL file.
    pub(super) fn make_files_to_end(&mut self) {
        if let Some(files) = &mut self.files {
            files.make_files_to_end(&mut self.stl_exporter);
        }
    }

    /// Returns the files once all are ready, or the reason why there are none. They are returned once.
    pub(super) fn take_finished_files(&mut self) -> Option<Result<MadeSculpture, String>> {
        let files = self.files.as_mut()?.take_finished_files()?;
        self.files = None;
        Some(files)
    }
}
