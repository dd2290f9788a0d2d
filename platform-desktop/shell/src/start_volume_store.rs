//! The volumes that sessions start from: the figures, generated or loaded once, and one volume of the
//! visitor's own. It knows no files.

use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{RangeMaps, StartVolumes};

use crate::figures::Figure;

/// Buffers for all start volumes of a size. All zero bytes at first: it lives in a static.
#[derive(Debug)]
pub struct StartVolumeStore<const N: usize, const K: usize> {
    figures: [RangeMaps<N, K>; Figure::ALL.len()],
    visitor_volume: RangeMaps<N, K>,
    has_figures: bool,
    offers_visitor_volume: bool,
}

impl<const N: usize, const K: usize> StartVolumeStore<N, K>
where
    Grid<N>: Size,
{
    /// An empty store. For static initialisers only: it is large.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volumes about by value
    pub const fn new() -> Self {
        StartVolumeStore {
            figures: [const { RangeMaps::new() }; Figure::ALL.len()],
            visitor_volume: RangeMaps::new(),
            has_figures: false,
            offers_visitor_volume: false,
        }
    }

    /// Generates the figures unless they are there already. `on_fraction_done` is
    /// called with the fraction done, 0 to 1.
    pub fn generate_figures_once(
        &mut self,
        scratch: &mut BitGrid<N>,
        on_fraction_done: impl Fn(f32),
    ) {
        if self.has_figures {
            return;
        }
        for (i, figure) in Figure::ALL.into_iter().enumerate() {
            on_fraction_done(i as f32 / Figure::ALL.len() as f32);
            figure.rasterize_into(&mut self.figures[i], scratch);
        }
        self.has_figures = true;
    }

    /// Loads the figures instead of generating them: `load_into` writes each into its maps.
    ///
    /// # Errors
    /// The first error of `load_into`. The store then counts as empty.
    pub fn load_figures<E>(
        &mut self,
        mut load_into: impl FnMut(Figure, &mut RangeMaps<N, K>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.has_figures = false;
        for figure in Figure::ALL {
            load_into(figure, &mut self.figures[figure as usize])?;
        }
        self.has_figures = true;
        Ok(())
    }

    /// The visitor's own volume, to be overwritten. From now on it is offered as a start volume.
    pub fn offer_visitor_volume(&mut self) -> &mut RangeMaps<N, K> {
        self.offers_visitor_volume = true;
        &mut self.visitor_volume
    }

    /// No longer offers a volume of the visitor's own.
    pub fn withdraw_visitor_volume(&mut self) {
        self.offers_visitor_volume = false;
    }

    /// The figures hidden in the lump, indexed by their number in the constrained mode.
    #[must_use]
    pub fn hidden_figures(&self) -> [&RangeMaps<N, K>; Figure::HIDDEN.len()] {
        Figure::HIDDEN.map(|figure| self.figure(figure))
    }

    /// One figure's maps; empty before [`StartVolumeStore::generate_figures_once`].
    #[must_use]
    pub fn figure(&self, figure: Figure) -> &RangeMaps<N, K> {
        &self.figures[figure as usize]
    }

    /// The start volumes for a tick; `hidden_figures` is the result of
    /// [`StartVolumeStore::hidden_figures`].
    #[must_use]
    pub fn start_volumes<'a>(
        &'a self,
        hidden_figures: &'a [&'a RangeMaps<N, K>],
    ) -> StartVolumes<'a, N, K> {
        StartVolumes {
            lump: self.figure(Figure::Lump),
            figures: hidden_figures,
            creative: self.figure(Figure::Toy),
            own: self.offers_visitor_volume.then_some(&self.visitor_volume),
        }
    }
}
