//! Counts of the texels that a picture's fragments fetch, by instrumented copies of the shaders.

use paros_shaders::Image;
use paros_shaders::gpu::{Drawn, FrameRequest, PixelCounts, RenderStyle};

use crate::{Error, HeadlessRenderer};

/// Counts of the texels that the fragments of one or more pictures fetched. Discarded fragments count too, as
/// they cost as much.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FetchCounts {
    /// Pixels that show the sculpture.
    pub pixels: u64,
    /// Texels sampled and loaded. Each texel of a filtered sample counts.
    pub fetches: u64,
    /// The most fetches of one fragment, capped at 255.
    pub most_fetches: u32,
    /// Iterations of the ray march.
    pub turns: u64,
    /// The most iterations of one fragment, capped at 255.
    pub most_turns: u32,
}

impl FetchCounts {
    /// Returns the mean number of fetches per pixel that shows the sculpture.
    #[must_use]
    pub fn mean_fetches(&self) -> f64 {
        self.fetches as f64 / self.pixels.max(1) as f64
    }

    /// Returns the mean number of ray march iterations per pixel that shows the sculpture.
    #[must_use]
    pub fn mean_turns(&self) -> f64 {
        self.turns as f64 / self.pixels.max(1) as f64
    }

    /// Combines two counts: adds the sums and takes the greater maxima.
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

    /// Sums the counts of a picture in which each pixel encodes its counts. Pixels that no fragment has drawn
    /// are black.
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
    /// Counts the fetches of the sculpture in the view of a request, for all of its eyes. `samples` is the
    /// number of samples per pixel to simulate: with several, a pixel at the outline costs more. The renderer
    /// itself uses one sample.
    ///
    /// # Errors
    /// Returns an error if the device is lost.
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
