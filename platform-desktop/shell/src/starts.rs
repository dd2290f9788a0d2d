//! The volumes that sessions start from, made once and kept.

use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::world::Starts;

use crate::figures::Figure;

/// Room for all start volumes of a size, and one of the visitor's own. All zero bytes at first.
#[derive(Debug)]
pub struct StartVolumes<const N: usize> {
    figures: [Maps<N>; Figure::ALL.len()],
    own: Maps<N>,
    made: bool,
    has_own: bool,
}

impl<const N: usize> StartVolumes<N>
where
    Grid<N>: Size,
{
    /// Nothing made yet. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volumes about by value
    pub const fn new() -> Self {
        StartVolumes {
            figures: [const { Maps::new() }; Figure::ALL.len()],
            own: Maps::new(),
            made: false,
            has_own: false,
        }
    }

    /// Makes the figures, if that hasn't been done. `progress` hears the share done.
    pub fn make(&mut self, plane: &mut Plane<N>, progress: impl Fn(f32)) {
        if self.made {
            return;
        }
        for (i, figure) in Figure::ALL.into_iter().enumerate() {
            progress(i as f32 / Figure::ALL.len() as f32);
            figure.carve_into(plane, &mut self.figures[i]);
        }
        self.made = true;
    }

    /// Takes the figures from elsewhere instead of making them: `fill` writes each into its maps.
    ///
    /// # Errors
    /// The first of `fill`'s. Then they are still to be made.
    pub fn take<E>(
        &mut self,
        mut fill: impl FnMut(Figure, &mut Maps<N>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.made = false;
        for figure in Figure::ALL {
            fill(figure, &mut self.figures[figure as usize])?;
        }
        self.made = true;
        Ok(())
    }

    /// Room for a volume of the visitor's own; it counts from now on.
    pub fn own_mut(&mut self) -> &mut Maps<N> {
        self.has_own = true;
        &mut self.own
    }

    /// Leaves no volume of the visitor's own.
    pub fn forget_own(&mut self) {
        self.has_own = false;
    }

    /// The hidden figures, by their numbers in the constrained mode.
    #[must_use]
    pub fn hidden(&self) -> [&Maps<N>; Figure::HIDDEN.len()] {
        Figure::HIDDEN.map(|figure| self.figure(figure))
    }

    /// One figure.
    #[must_use]
    pub fn figure(&self, figure: Figure) -> &Maps<N> {
        &self.figures[figure as usize]
    }

    /// What a tick may start from, with [`StartVolumes::hidden`] as figures.
    #[must_use]
    pub fn starts<'a>(&'a self, hidden: &'a [&'a Maps<N>]) -> Starts<'a, N> {
        Starts {
            lump: self.figure(Figure::Lump),
            figures: hidden,
            creative: self.figure(Figure::Toy),
            own: self.has_own.then_some(&self.own),
        }
    }
}
