//! Graph of the latest frame times.

use egui::{Align2, Area, Color32, Context, Id, Pos2, Rect, RichText, Sense, Vec2};
use paros_core::session::TICK_RATE;

use super::{StudioStatus, style};

/// Number of frames shown.
const FRAMES: usize = 160;

/// Target frame time in seconds, a headset's.
const TARGET_SECONDS: f32 = 1.0 / TICK_RATE as f32;

/// Least time at the graph's top, in seconds. Keeps the bars of fast frames low.
const LEAST_TOP_SECONDS: f32 = 2.0 * TARGET_SECONDS;

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
                    "frame {frame:.1} ms, slowest {:.1}   device {:.2} ms   picture {:.2} ms",
                    self.slowest_seconds() * 1e3,
                    ms(status.times.total_ns),
                    ms(status.times.tiles_ns + status.times.pass_ns),
                );
                ui.label(RichText::new(times).size(12.0));
                let size = Vec2::new(2.0 * FRAMES as f32, 70.0);
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                self.draw_bars(ui.painter(), rect);
                ui.label(style::quiet_text(status.device).size(12.0));
            });
        });
    }

    /// Returns the duration of the slowest frame shown.
    fn slowest_seconds(&self) -> f32 {
        self.seconds.into_iter().fold(0.0, f32::max)
    }

    /// Returns the time at the graph's top, which no frame exceeds.
    fn top_seconds(&self) -> f32 {
        self.slowest_seconds().max(LEAST_TOP_SECONDS)
    }

    fn draw_bars(&self, painter: &egui::Painter, rect: Rect) {
        let top_seconds = self.top_seconds();
        let height = |seconds: f32| seconds / top_seconds * rect.height();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the heights of the bars in a graph 100 points high, the latest last.
    fn bar_heights(graph: &FrameTimeGraph) -> Vec<f32> {
        let context = Context::default();
        let rect = Rect::from_min_size(Pos2::new(0.0, 20.0), Vec2::new(2.0 * FRAMES as f32, 100.0));
        let output = context.run(egui::RawInput::default(), |context| {
            graph.draw_bars(&context.layer_painter(egui::LayerId::background()), rect);
        });
        let bars = output.shapes.iter().filter_map(|clipped| match &clipped.shape {
            egui::Shape::Rect(bar) => {
                assert!(rect.expand(0.01).contains_rect(bar.rect), "{bar:?} leaves the graph");
                Some(bar.rect.height())
            }
            _ => None,
        });
        bars.collect()
    }

    #[test]
    fn the_slowest_frame_shown_fills_the_graph_and_frames_keep_their_proportions() {
        let mut graph = FrameTimeGraph::new();
        for seconds in [0.2, 0.4, 0.1] {
            graph.push(seconds);
        }
        let shown = bar_heights(&graph);
        let latest = &shown[FRAMES - 3..];
        for (height, expected) in latest.iter().zip([50.0, 100.0, 25.0]) {
            assert!((height - expected).abs() < 0.1, "{latest:?}");
        }
        // Once the slow frame has left the graph, the scale follows the remaining frames.
        (0..FRAMES - 1).for_each(|_| graph.push(0.1));
        assert!((bar_heights(&graph)[FRAMES - 2] - 100.0).abs() < 0.1);
        // On a machine at its full rate the bars have half the height.
        (0..FRAMES).for_each(|_| graph.push(TARGET_SECONDS));
        assert!(bar_heights(&graph).iter().all(|height| (height - 50.0).abs() < 0.1));
    }
}
