//! The volumes that sessions start from: the figures, generated or loaded once, and one volume of the
//! visitor's own. The store does not access files.

use std::ops::Deref;

use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{HiddenFigure, RangeMaps, StartVolumes};

use crate::figures::{Figure, HiddenStart, MAX_FIGURE_NAME_BYTES, MAX_OWN_FIGURES, StoneThickness};

/// A volume that sessions need at their start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StartVolume {
    /// A figure, hidden or not, or the lump.
    Figure(Figure),
    /// The stone around a hidden figure.
    Stone(HiddenStart),
}

/// The number of start volumes. The stones of whole thickness are the lump, which is among the figures.
const COUNT: usize = Figure::ALL.len() + HiddenStart::ALL.len() - Figure::HIDDEN.len();

impl StartVolume {
    /// Returns all start volumes.
    pub fn all() -> impl Iterator<Item = StartVolume> {
        let stones = HiddenStart::ALL.into_iter().map(StartVolume::Stone);
        let figures = Figure::ALL.into_iter().map(StartVolume::Figure);
        figures.chain(stones.skip(Figure::HIDDEN.len()))
    }

    /// Returns its name in a package.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            StartVolume::Figure(figure) => figure.name().into(),
            StartVolume::Stone(start) => format!("{}-stone", start.name()),
        }
    }

    /// Returns its index in [`StartVolume::all`].
    const fn place(self) -> usize {
        match self {
            StartVolume::Figure(figure) => figure as usize,
            StartVolume::Stone(start) => match start.thickness {
                StoneThickness::Whole => Figure::Lump as usize,
                StoneThickness::Half | StoneThickness::Near => {
                    Figure::ALL.len() - Figure::HIDDEN.len() + start.number() as usize
                }
            },
        }
    }
}

/// A hidden figure of the operator's own.
#[derive(Debug)]
struct OwnFigure<const N: usize, const K: usize> {
    figure: RangeMaps<N, K>,
    stone: RangeMaps<N, K>,
    /// Its name, padded with zero bytes.
    name: [u8; MAX_FIGURE_NAME_BYTES],
}

/// The most hidden figures: the built-in ones and the operator's own.
const MAX_HIDDEN: usize = HiddenStart::ALL.len() + MAX_OWN_FIGURES;

/// The hidden figures and their stones, indexed by their number in the constrained mode.
#[derive(Clone, Copy, Debug)]
pub struct HiddenFigures<'a, const N: usize, const K: usize> {
    all: [HiddenFigure<'a, N, K>; MAX_HIDDEN],
    count: usize,
}

impl<'a, const N: usize, const K: usize> Deref for HiddenFigures<'a, N, K> {
    type Target = [HiddenFigure<'a, N, K>];

    fn deref(&self) -> &Self::Target {
        &self.all[..self.count]
    }
}

/// Buffers for all start volumes of a size. It starts as all zero bytes, to live in a static.
#[derive(Debug)]
pub struct StartVolumeStore<const N: usize, const K: usize> {
    /// The volumes in the order of [`StartVolume::all`].
    volumes: [RangeMaps<N, K>; COUNT],
    own_figures: [OwnFigure<N, K>; MAX_OWN_FIGURES],
    own_figure_count: usize,
    visitor_volume: RangeMaps<N, K>,
    has_volumes: bool,
    offers_visitor_volume: bool,
}

impl<const N: usize, const K: usize> StartVolumeStore<N, K>
where
    Grid<N>: Size,
{
    /// Creates an empty store. For static initialisers only, as it is large.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volumes about by value
    pub const fn new() -> Self {
        StartVolumeStore {
            volumes: [const { RangeMaps::new() }; COUNT],
            own_figures: [const {
                OwnFigure {
                    figure: RangeMaps::new(),
                    stone: RangeMaps::new(),
                    name: [0; MAX_FIGURE_NAME_BYTES],
                }
            }; MAX_OWN_FIGURES],
            own_figure_count: 0,
            visitor_volume: RangeMaps::new(),
            has_volumes: false,
            offers_visitor_volume: false,
        }
    }

    /// Generates the volumes unless they are there already. Calls `on_fraction_done` with the fraction done,
    /// 0 to 1.
    pub fn generate_once(&mut self, scratch: &mut BitGrid<N>, on_fraction_done: impl Fn(f32)) {
        if self.has_volumes {
            return;
        }
        for (i, volume) in StartVolume::all().enumerate() {
            on_fraction_done(i as f32 / COUNT as f32);
            let (before, maps) = self.volumes.split_at_mut(i);
            match volume {
                StartVolume::Figure(figure) => figure.rasterize_into(&mut maps[0], scratch),
                StartVolume::Stone(start) => {
                    maps[0].copy_from(&before[Figure::Lump as usize]);
                    start.rasterize_stone_into(&mut maps[0], scratch);
                }
            }
        }
        self.has_volumes = true;
    }

    /// Returns `true` if the volumes have been generated or loaded.
    #[must_use]
    pub const fn has_volumes(&self) -> bool {
        self.has_volumes
    }

    /// Loads the volumes instead of generating them: `load_into` writes each into its maps.
    ///
    /// # Errors
    /// Returns the first error of `load_into`. The store then counts as empty.
    pub fn load<E>(
        &mut self,
        mut load_into: impl FnMut(StartVolume, &mut RangeMaps<N, K>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.has_volumes = false;
        for (volume, maps) in StartVolume::all().zip(&mut self.volumes) {
            load_into(volume, maps)?;
        }
        self.has_volumes = true;
        Ok(())
    }

    /// Returns the visitor's own volume, to be overwritten. From now on it is offered as a start volume.
    pub fn offer_visitor_volume(&mut self) -> &mut RangeMaps<N, K> {
        self.offers_visitor_volume = true;
        &mut self.visitor_volume
    }

    /// Stops offering a volume of the visitor's own.
    pub fn withdraw_visitor_volume(&mut self) {
        self.offers_visitor_volume = false;
    }

    /// Loads the operator's own hidden figures, whose names [`check_own_figure_names`] accepted. `load_into`
    /// writes each figure and its stone into their maps.
    ///
    /// # Errors
    /// Returns the first error of `load_into`. The store then has none of these figures.
    ///
    /// [`check_own_figure_names`]: crate::figures::check_own_figure_names
    pub fn load_own_figures<E>(
        &mut self,
        names: &[String],
        mut load_into: impl FnMut(&str, &mut RangeMaps<N, K>, &mut RangeMaps<N, K>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.own_figure_count = 0;
        for (name, own) in names.iter().zip(&mut self.own_figures) {
            load_into(name, &mut own.figure, &mut own.stone)?;
            own.name = [0; MAX_FIGURE_NAME_BYTES];
            own.name.iter_mut().zip(name.bytes()).for_each(|(at, byte)| *at = byte);
        }
        self.own_figure_count = names.len().min(MAX_OWN_FIGURES);
        Ok(())
    }

    /// Returns the name of the hidden figure with a number in the constrained mode, without its stone's
    /// thickness.
    #[must_use]
    pub fn hidden_figure_name(&self, number: u8) -> Option<&str> {
        if let Some(start) = HiddenStart::from_number(number) {
            return Some(start.figure.name());
        }
        let place = usize::from(number).checked_sub(HiddenStart::ALL.len())?;
        let name = &self.own_figures[..self.own_figure_count].get(place)?.name;
        let name = name.split(|byte| *byte == 0).next()?;
        core::str::from_utf8(name).ok()
    }

    /// Returns the hidden figures and their stones: the built-in ones, then the operator's own.
    #[must_use]
    pub fn hidden_figures(&self) -> HiddenFigures<'_, N, K> {
        let all = core::array::from_fn(|number| match HiddenStart::ALL.get(number) {
            Some(start) => HiddenFigure {
                figure: self.figure(start.figure),
                stone: self.volume(StartVolume::Stone(*start)),
            },
            None => {
                let own = &self.own_figures[number - HiddenStart::ALL.len()];
                HiddenFigure { figure: &own.figure, stone: &own.stone }
            }
        });
        HiddenFigures { all, count: HiddenStart::ALL.len() + self.own_figure_count }
    }

    /// Returns one volume's maps; empty before [`StartVolumeStore::generate_once`].
    #[must_use]
    pub fn volume(&self, volume: StartVolume) -> &RangeMaps<N, K> {
        &self.volumes[volume.place()]
    }

    /// Returns one figure's maps; empty before [`StartVolumeStore::generate_once`].
    #[must_use]
    pub fn figure(&self, figure: Figure) -> &RangeMaps<N, K> {
        self.volume(StartVolume::Figure(figure))
    }

    /// Returns the start volumes for a tick. `hidden_figures` is the result of
    /// [`StartVolumeStore::hidden_figures`].
    #[must_use]
    pub fn start_volumes<'a>(
        &'a self,
        hidden_figures: &'a [HiddenFigure<'a, N, K>],
    ) -> StartVolumes<'a, N, K> {
        StartVolumes {
            lump: self.figure(Figure::Lump),
            figures: hidden_figures,
            creative: self.figure(Figure::Toy),
            own: self.offers_visitor_volume.then_some(&self.visitor_volume),
        }
    }
}
