//! Initial size of the window.

use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::monitor::MonitorHandle;

/// Preferred size, in points.
const SIZE: LogicalSize<f64> = LogicalSize::new(1180.0, 800.0);

/// Space that a desktop needs beside a window, in points: its border, its title bar and a task bar.
const AROUND: LogicalSize<f64> = LogicalSize::new(16.0, 80.0);

/// The smallest window size that panels are laid out for, in points.
const LEAST: LogicalSize<f64> = LogicalSize::new(640.0, 420.0);

/// Returns the initial size: a size that fits every monitor, as the window may open on any. A script's window
/// has a fixed size on every machine.
pub(super) fn first_size(events: &ActiveEventLoop, is_scripted: bool) -> LogicalSize<f64> {
    let size_of = |monitor: MonitorHandle| monitor.size().to_logical(monitor.scale_factor());
    let monitors = events.available_monitors().filter(|_| !is_scripted).map(size_of);
    monitors.fold(SIZE, fit_monitor)
}

/// Limits a size to the room on a monitor.
fn fit_monitor(size: LogicalSize<f64>, monitor: LogicalSize<f64>) -> LogicalSize<f64> {
    let fit = |size: f64, monitor: f64, around: f64, least: f64| {
        let room = (monitor - around).max(least.min(monitor));
        // A size of 0 means that the monitor's size is unknown.
        if monitor > 0.0 { size.min(room) } else { size }
    };
    LogicalSize::new(
        fit(size.width, monitor.width, AROUND.width, LEAST.width),
        fit(size.height, monitor.height, AROUND.height, LEAST.height),
    )
}

#[cfg(test)]
mod tests {
    use super::{LogicalSize, SIZE, fit_monitor};

    #[test]
    fn a_window_fits_its_monitor_with_what_a_desktop_has_around_it() {
        let fitting = |width, height| {
            let size = fit_monitor(SIZE, LogicalSize::new(width, height));
            [size.width, size.height]
        };
        assert_eq!(fitting(1920.0, 1080.0), [1180.0, 800.0]);
        assert_eq!(fitting(1366.0, 768.0), [1180.0, 688.0]);
        assert_eq!(fitting(1024.0, 768.0), [1008.0, 688.0]);
        assert_eq!(fitting(1080.0, 1920.0), [1064.0, 800.0], "upright");
        assert_eq!(fitting(640.0, 480.0), [640.0, 420.0], "as panels need it");
        assert_eq!(fitting(320.0, 240.0), [320.0, 240.0], "never larger");
        assert_eq!(fitting(0.0, 0.0), [1180.0, 800.0], "one that tells nothing");
    }
}
