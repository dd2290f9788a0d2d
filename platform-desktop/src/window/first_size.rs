//! How large a window is at first.

use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::monitor::MonitorHandle;

/// Where there is room, in points.
const SIZE: LogicalSize<f64> = LogicalSize::new(1180.0, 800.0);

/// What a desktop has beside a window, in points: its rim; its title, and a bar of the desktop's own.
const AROUND: LogicalSize<f64> = LogicalSize::new(16.0, 80.0);

/// The smallest window that panels are laid out for.
const LEAST: LogicalSize<f64> = LogicalSize::new(640.0, 420.0);

/// The size of a window at first: one that fits every monitor, as it isn't known on which it will be. What a script does
/// depends on no machine.
pub(super) fn first_size(events: &ActiveEventLoop, is_scripted: bool) -> LogicalSize<f64> {
    let size_of = |monitor: MonitorHandle| monitor.size().to_logical(monitor.scale_factor());
    let monitors = events.available_monitors().filter(|_| !is_scripted).map(size_of);
    monitors.fold(SIZE, fit_monitor)
}

/// A size no larger than a monitor's has room for.
fn fit_monitor(size: LogicalSize<f64>, monitor: LogicalSize<f64>) -> LogicalSize<f64> {
    let fit = |size: f64, monitor: f64, around: f64, least: f64| {
        let room = (monitor - around).max(least.min(monitor));
        // One of no size is none.
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
