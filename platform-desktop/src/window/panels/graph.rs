//! Graph of the latest frame times.

use egui::{Align2, Area, Color32, Context, Id, Pos2, Rect, RichText, Sense, Vec2};
use paros_core::session::TICK_RATE;

use super::{StudioStatus, style};

/// Frames that are shown.
const FRAMES: usize = 160;

/// Seconds at the graph's top.
const TOP_SECONDS: f32 = 0.05;

/// Target frame time in seconds, a headset's.
const TARGET_SECONDS: f32 = 1.0 / TICK_RATE as f32;

/// A ring buffer of frame times.
#[derive(Clone, Debug)]
pub(super) struct FrameTimeGraph {
    seconds: [f32; FRAMES],
    at: usize,
}

impl FrameTimeGraph {
    pub(super) const fn new() -> Self {
        FrameTimeGraph { seconds: [0.0; FRAMES], at: 0 }
    }

    pub(super) fn push(&mut self, seconds: f32) {
        self.seconds[self.at] = seconds;
        self.at = (self.at + 1) % FRAMES;
    }

    pub(super) fn show(&self, context: &Context, status: &StudioStatus<'_>) {
        let area = Area::new(Id::new("graph")).anchor(Align2::LEFT_CENTER, Vec2::new(12.0, 0.0));
        area.interactable(false).show(context, |ui| {
            style::card_frame().inner_margin(10).show(ui, |ui| {
                let ms = |nanoseconds: u64| nanoseconds as f32 * 1e-6;
                let frame = self.seconds[(self.at + FRAMES - 1) % FRAMES] * 1e3;
                let times = format!(
                    "frame {frame:.1} ms   device {:.2} ms   sculpture {:.2} ms",
                    ms(status.times.total_ns),
                    ms(status.times.tiles_ns + status.times.sculpture_ns),
                );
                ui.label(RichText::new(times).size(12.0));
                let size = Vec2::new(2.0 * FRAMES as f32, 70.0);
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                self.draw_bars(ui.painter(), rect);
                ui.label(style::quiet_text(status.device).size(12.0));
            });
        });
    }

    fn draw_bars(&self, painter: &egui::Painter, rect: Rect) {
        let height = |seconds: f32| (seconds / TOP_SECONDS).min(1.0) * rect.height();
        for i in 0..FRAMES {
            let seconds = self.seconds[(self.at + i) % FRAMES];
            let left = rect.left() + 2.0 * i as f32;
            let top = Pos2::new(left, rect.bottom() - height(seconds));
            let bar = Rect::from_min_max(top, Pos2::new(left + 1.5, rect.bottom()));
            let late = seconds > 1.2 * TARGET_SECONDS;
            painter.rect_filled(bar, 0.0, if late { style::WARNING } else { style::ACCENT });
        }
        let goal = rect.bottom() - height(TARGET_SECONDS);
        painter.hline(rect.x_range(), goal, (1.0, Color32::from_white_alpha(60)));
    }
}
