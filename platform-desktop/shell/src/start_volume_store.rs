//! The volumes that sessions start from: the figures, generated or loaded once, and one volume of the
//! visitor's own. It knows no files.

use paros_core::{BitGrid, Grid, RangeMaps, Size, StartVolumes};

use crate::figures::Figure;

/// Buffers for all start volumes of a size. All zero bytes at first: it lives in a static.
#[derive(Debug)]
pub struct StartVolumeStore<const N: usize> {
    figures: [RangeMaps<N>; Figure::ALL.len()],
    own: RangeMaps<N>,
    made: bool,
    has_own: bool,
}

impl<const N: usize> StartVolumeStore<N>
where
    Grid<N>: Size,
{
    /// An empty store. For static initialisers only: it is large.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volumes about by value
    pub const fn new() -> Self {
        StartVolumeStore {
            figures: [const { RangeMaps::new() }; Figure::ALL.len()],
            own: RangeMaps::new(),
            made: false,
            has_own: false,
        }
    }

    /// Generates the figures unless they are there already. `plane` is scratch memory. `progress` is
    /// called with the fraction done, 0 to 1.
    pub fn generate_figures(&mut self, plane: &mut BitGrid<N>, progress: impl Fn(f32)) {
        if self.made {
            return;
        }
        for (i, figure) in Figure::ALL.into_iter().enumerate() {
            progress(i as f32 / Figure::ALL.len() as f32);
            figure.carve_into(plane, &mut self.figures[i]);
        }
        self.made = true;
    }

    /// Loads the figures instead of generating them: `fill` writes each into its maps.
    ///
    /// # Errors
    /// The first error of `fill`. The store then counts as empty.
    pub fn load_figures<E>(
        &mut self,
        mut fill: impl FnMut(Figure, &mut RangeMaps<N>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.made = false;
        for figure in Figure::ALL {
            fill(figure, &mut self.figures[figure as usize])?;
        }
        self.made = true;
        Ok(())
    }

    /// The visitor's own volume, to be overwritten. From now on it is offered as a start volume.
    pub fn own_volume_mut(&mut self) -> &mut RangeMaps<N> {
        self.has_own = true;
        &mut self.own
    }

    /// No longer offers a volume of the visitor's own.
    pub fn clear_own_volume(&mut self) {
        self.has_own = false;
    }

    /// The figures hidden in the lump, indexed by their number in the constrained mode.
    #[must_use]
    pub fn hidden_figures(&self) -> [&RangeMaps<N>; Figure::HIDDEN.len()] {
        Figure::HIDDEN.map(|figure| self.figure(figure))
    }

    /// One figure's maps; empty before [`StartVolumeStore::generate_figures`].
    #[must_use]
    pub fn figure(&self, figure: Figure) -> &RangeMaps<N> {
        &self.figures[figure as usize]
    }

    /// The start volumes for a tick; `hidden` is the result of [`StartVolumeStore::hidden_figures`].
    #[must_use]
    pub fn start_volumes<'a>(&'a self, hidden: &'a [&'a RangeMaps<N>]) -> StartVolumes<'a, N> {
        StartVolumes {
            lump: self.figure(Figure::Lump),
            figures: hidden,
            creative: self.figure(Figure::Toy),
            own: self.has_own.then_some(&self.own),
        }
    }
}
