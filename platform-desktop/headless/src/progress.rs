//! Progress display on standard error, if that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Redraw interval while the work reports nothing.
const TICK: Duration = Duration::from_millis(100);

/// Shows a progress bar of `steps`, or a spinner if the number of steps is unknown. Dropping the result
/// clears it.
#[must_use]
pub fn show_progress(what: &'static str, steps: Option<u64>) -> ProgressDisplay {
    let (bar, template) = match steps {
        Some(steps) => (ProgressBar::new(steps), "{msg:10} {bar:40} {percent:>3} % {elapsed:>4}"),
        None => (ProgressBar::new_spinner(), "{msg:10} {spinner} {elapsed}"),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what);
    bar.enable_steady_tick(TICK);
    ProgressDisplay(bar)
}

/// A progress bar or spinner on standard error.
#[derive(Debug)]
pub struct ProgressDisplay(ProgressBar);

impl ProgressDisplay {
    /// Sets the number of steps done.
    pub fn set_steps_done(&self, steps: u64) {
        self.0.set_position(steps);
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
