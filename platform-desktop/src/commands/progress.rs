//! Progress on standard error, where that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// How often a bar moves while its work reports nothing.
const TICK: Duration = Duration::from_millis(100);

/// A bar of `steps`, or without a known number of them a spinner. It clears itself when dropped.
pub(super) fn bar(what: &'static str, steps: Option<u64>) -> Bar {
    let (bar, template) = match steps {
        Some(steps) => (ProgressBar::new(steps), "{msg:10} {bar:40} {percent:>3} % {elapsed:>4}"),
        None => (ProgressBar::new_spinner(), "{msg:10} {spinner} {elapsed}"),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what);
    bar.enable_steady_tick(TICK);
    Bar(bar)
}

/// A bar on the screen.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn advance_to(&self, step: u64) {
        self.0.set_position(step);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
