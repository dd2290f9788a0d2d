//! Texels that a picture's fragments fetch, counted by the instrumented copies of their programs.

use paros_shaders::Image;
use paros_shaders::gpu::{Drawn, FrameRequest, PixelCounts, RenderStyle};

use crate::{Error, HeadlessRenderer};

/// What the fragments of one or more pictures fetched. Of a fragment that was discarded too, as it costs as much.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FetchCounts {
    /// Pixels that show the sculpture.
    pub pixels: u64,
    /// Texels sampled and loaded; each of a filtered sample counts once.
    pub fetches: u64,
    /// Of the fragment that fetched most; 255 at most.
    pub most_fetches: u32,
    /// Turns of the march.
    pub turns: u64,
    /// Of the fragment that took most; 255 at most.
    pub most_turns: u32,
}

impl FetchCounts {
    /// Fetches for each pixel that shows the sculpture.
    #[must_use]
    pub fn mean_fetches(&self) -> f64 {
        self.fetches as f64 / self.pixels.max(1) as f64
    }

    /// Turns of the march for each such pixel.
    #[must_use]
    pub fn mean_turns(&self) -> f64 {
        self.turns as f64 / self.pixels.max(1) as f64
    }

    /// Those of both.
    #[must_use]
    pub fn and(self, other: FetchCounts) -> Self {
        FetchCounts {
            pixels: self.pixels + other.pixels,
            fetches: self.fetches + other.fetches,
            most_fetches: self.most_fetches.max(other.most_fetches),
            turns: self.turns + other.turns,
            most_turns: self.most_turns.max(other.most_turns),
        }
    }

    /// Those of a picture of counts. What no fragment has drawn is black.
    fn of_picture(picture: &Image) -> Self {
        let mut counts = FetchCounts::default();
        for &pixel in picture.pixels.as_chunks::<3>().0 {
            let PixelCounts { fetches, turns, hit } = PixelCounts::from_srgb(pixel);
            counts.pixels += u64::from(hit);
            counts.fetches += u64::from(fetches);
            counts.most_fetches = counts.most_fetches.max(fetches);
            counts.turns += u64::from(turns);
            counts.most_turns = counts.most_turns.max(turns);
        }
        counts
    }
}

impl HeadlessRenderer {
    /// Counts the fetches of the sculpture in the view of a request, for all of its eyes. `samples` are those of the
    /// picture that is meant: a pixel at the outline costs more with several. The renderer itself has one.
    ///
    /// # Errors
    /// A lost device.
    pub fn count_fetches(
        &mut self,
        request: &FrameRequest<'_>,
        samples: u32,
    ) -> Result<FetchCounts, Error> {
        let drawn = if samples > 1 { Drawn::CoverageCounts } else { Drawn::Counts };
        let style = RenderStyle { drawn, ..request.style };
        self.draw_frame(&FrameRequest { style, backdrop: [0.0; 3], ..*request }, &vec![])?;
        (0..request.eyes.len() as u32).try_fold(FetchCounts::default(), |sum, eye| {
            Ok(sum.and(FetchCounts::of_picture(&self.read_image(eye)?)))
        })
    }
}
