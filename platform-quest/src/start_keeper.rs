//! Keeps the state of the start, also on the disk: a failure before the first frame is shown in the headset,
//! and the next start is delayed.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::thread;

use paros_headset::start_up::{FailedStarts, StartUp};
use paros_shell::durable;
use paros_shell::last_use::BootId;
use paros_shell::studio_paths::StudioPaths;

use crate::error::Error;
use crate::notice_session::NoticeSession;
use crate::options::ShellOptions;
use crate::platform::Platform;
use crate::shell::IDLE_POLL_INTERVAL;
use crate::test_commands::CommandQueue;

/// The state of the start.
pub(crate) struct StartKeeper {
    start: StartUp,
    /// The record of failed starts; `None` if they aren't counted.
    record: Option<StartRecord>,
}

/// The failed starts of this boot, and the file that stores them.
struct StartRecord {
    path: PathBuf,
    boot: BootId,
    row: Option<FailedStarts>,
}

impl StartKeeper {
    /// Begins a start. Failed starts are only counted on a headset that visitors share (one with a folder of
    /// its own), not for developers.
    pub(crate) fn begin(
        platform: &dyn Platform,
        options: &ShellOptions,
        paths: &StudioPaths,
    ) -> Self {
        let path = options.folder.as_ref().map(|_| paths.failed_starts_file());
        let record = path.zip(platform.boot_id()).map(|(path, boot)| {
            // An unreadable record is ignored, so that no start is delayed by mistake.
            let bytes = durable::read_regular_file_up_to(&path, FailedStarts::BYTES as u64);
            let row = bytes.ok().and_then(|bytes| FailedStarts::decode(&bytes).ok());
            StartRecord { path, boot, row }
        });
        let failed = record.as_ref().and_then(|record| record.row);
        let boot = record.as_ref().map(|record| record.boot);
        let start = StartUp::begin(failed, boot, platform.since_boot());
        StartKeeper { start, record }
    }

    /// Waits until this start is due, and records it as failed until its first frame. Breaks if the app must
    /// quit.
    pub(crate) fn wait_until_due(
        &mut self,
        platform: &mut dyn Platform,
        options: &ShellOptions,
        commands: Option<&CommandQueue>,
    ) -> ControlFlow<()> {
        if let StartUp::Waiting { until } = self.start {
            let wait = until.saturating_sub(platform.since_boot()).as_secs_f32();
            let failed = self.record.as_ref().and_then(|record| record.row);
            let count = failed.map_or(0, |failed| failed.count());
            platform.log(format_args!(
                "starts failed in a row, {count}: the next one is in {wait:.1} s"
            ));
            let session = create_notice_session(platform, options);
            self.show_while_it_lasts(session, "", platform, commands)?;
        }
        let now = platform.since_boot();
        self.keep_row(platform, |row, boot| FailedStarts::after_failure(row, boot, now));
        ControlFlow::Continue(())
    }

    /// Notes that a frame of the studio was submitted: the start has succeeded.
    pub(crate) fn note_frame(&mut self) {
        if self.start == StartUp::Ready {
            return;
        }
        self.start = StartUp::Ready;
        self.forget_failures();
    }

    /// Deletes the record of failed starts, as this one has succeeded.
    pub(crate) fn forget_failures(&self) {
        if let Some(record) = &self.record {
            // If it can't be deleted, the next start only waits needlessly.
            let _ = std::fs::remove_file(&record.path);
        }
    }

    /// Shows an error in the headset and records the failed start. Does nothing after the first frame. If no
    /// picture can be shown, the reason is logged.
    pub(crate) fn show_failure(
        &mut self,
        error: &Error,
        platform: &mut dyn Platform,
        options: &ShellOptions,
        commands: Option<&CommandQueue>,
    ) {
        if self.start == StartUp::Ready {
            return;
        }
        let cause = error.message_with_remedy();
        platform.log(format_args!("the start failed: {cause}"));
        self.note_failed(platform);
        if platform.poll_status().quit_requested {
            return;
        }
        let session = create_notice_session(platform, options);
        if session.is_none() {
            return;
        }
        self.start = self.start.after_error(platform.since_boot());
        let _ = self.show_while_it_lasts(session, &cause, platform, commands);
        self.note_failed(platform);
    }

    /// Shows the start's notice until it is over, or waits for the same time if there is no session.
    fn show_while_it_lasts(
        &mut self,
        session: Option<NoticeSession>,
        cause: &str,
        platform: &mut dyn Platform,
        commands: Option<&CommandQueue>,
    ) -> ControlFlow<()> {
        let begun = self.start;
        let notice_at = |now| begun.notice(cause, now).filter(|_| begun.after_time(now) == begun);
        if let Some(mut session) = session {
            match session.run(platform, commands, &notice_at) {
                Ok(end) => end?,
                Err(why) => platform.log(format_args!("{why}")),
            }
        }
        while notice_at(platform.since_boot()).is_some() {
            if platform.poll_status().quit_requested {
                return ControlFlow::Break(());
            }
            thread::sleep(IDLE_POLL_INTERVAL);
        }
        self.start = begun.after_time(platform.since_boot());
        ControlFlow::Continue(())
    }

    /// Records that the current start has failed now.
    fn note_failed(&mut self, platform: &mut dyn Platform) {
        let now = platform.since_boot();
        self.keep_row(platform, |row, boot| {
            row.map_or_else(
                || FailedStarts::after_failure(None, boot, now),
                |row| row.failed_at(now),
            )
        });
    }

    fn keep_row(
        &mut self,
        platform: &mut dyn Platform,
        change: impl FnOnce(Option<FailedStarts>, BootId) -> FailedStarts,
    ) {
        let Some(StartRecord { path, boot, row }) = &mut self.record else { return };
        let changed = row.insert(change(*row, *boot));
        let folder = path.parent().map_or(Ok(()), durable::make_folder);
        if let Err(why) = folder.and_then(|()| durable::write_file(path, &changed.encode())) {
            platform.log(format_args!("failed starts can't be counted: {why}"));
        }
    }
}

/// Creates a session to show a notice in. A failure is logged.
fn create_notice_session(
    platform: &mut dyn Platform,
    options: &ShellOptions,
) -> Option<NoticeSession> {
    let session = NoticeSession::create(platform, options);
    let session = session.map_err(|why| {
        platform.log(format_args!("no picture can tell of it in the headset: {why}"));
    });
    session.ok()
}
