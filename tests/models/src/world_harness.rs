//! Test harness of the world: a world with start volumes, and the invariants that hold after every tick.

use paros_core::session::SessionMode;
use paros_core::volume::{Axis, BitGrid, BitSet, Grid, Size};
use paros_core::{HiddenFigure, RangeMaps, StartVolumes, TickInput, World};
use paros_shell::figures::{Figure, HiddenStart};

use crate::dense::DenseVolume;

/// A world and its start volumes. All its bytes are zero initially, so that it can be a static.
#[derive(Debug)]
pub struct WorldHarness<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The world.
    pub world: World<N, K>,
    /// The start volume of the mode `Own`, offered if `has_own`.
    pub own: RangeMaps<N, K>,
    /// `true` if `own` is offered.
    pub has_own: bool,
    lump: RangeMaps<N, K>,
    figure: RangeMaps<N, K>,
    creative: RangeMaps<N, K>,
    made: bool,
    plane: BitGrid<N>,
}

/// A world, and the start volumes of every session of the harness.
#[derive(Debug)]
pub struct WorldAndStarts<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The world.
    pub world: &'a mut World<N, K>,
    /// The lump of the free mode.
    pub lump: &'a RangeMaps<N, K>,
    /// The one hidden figure.
    pub figure: &'a RangeMaps<N, K>,
    /// The toy of the creative mode.
    pub creative: &'a RangeMaps<N, K>,
}

impl<const N: usize, const K: usize> WorldHarness<N, K>
where
    Grid<N>: Size,
{
    /// Creates an empty harness; `const` for statics.
    #[allow(clippy::new_without_default)] // a Default would hand the studio about by value
    pub const fn new() -> Self {
        WorldHarness {
            world: World::new(),
            own: RangeMaps::new(),
            has_own: false,
            lump: RangeMaps::new(),
            figure: RangeMaps::new(),
            creative: RangeMaps::new(),
            made: false,
            plane: BitGrid::new(),
        }
    }

    /// Clears the world. Its start volumes are the lump, one hidden figure and the toy.
    pub fn reset(&mut self) -> &mut Self {
        if !self.made {
            let figures = [Figure::Lump, Figure::Owl, Figure::Toy];
            let starts = [&mut self.lump, &mut self.figure, &mut self.creative];
            for (figure, maps) in figures.into_iter().zip(starts) {
                figure.rasterize_into(maps, &mut self.plane);
            }
            self.made = true;
        }
        self.has_own = false;
        self.world.clear();
        self
    }

    /// Clears the world and starts a session of a mode; the one hidden figure is number 0.
    pub fn start_session(&mut self, mode: SessionMode) -> &mut Self {
        self.reset();
        self.step(&TickInput { start: mode, ..TickInput::default() });
        self
    }

    /// Clears the world and starts a session from the closure of these voxels.
    pub fn start_from_voxels(&mut self, mut occupied: impl FnMut([usize; 3]) -> bool) -> &mut Self {
        self.reset();
        self.plane.clear();
        for y in 0..N {
            for z in 0..N {
                let row = self.plane.row_mut(y, z);
                (0..N).filter(|&x| occupied([x, y, z])).for_each(|x| row.insert(x));
            }
        }
        self.plane.write_closure(&mut self.own);
        self.has_own = true;
        self.step(&TickInput { start: SessionMode::Own, ..TickInput::default() });
        self
    }

    /// Clears the world. Its sessions start from the closure of `volume`, and the only hidden figure is the
    /// closure of `mask`, which is part of `volume`.
    pub fn reset_to_voxels(&mut self, volume: &DenseVolume, mask: &DenseVolume) -> &mut Self {
        for (voxels, maps) in [(volume, &mut self.lump), (mask, &mut self.figure)] {
            self.plane.clear();
            voxels.insert_into_empty_bits(&mut self.plane);
            self.plane.write_closure(maps);
        }
        self.reset_to_lump()
    }

    /// Clears the world. Its sessions start from `start`, whose figure is number 0.
    pub fn reset_to_hidden(&mut self, start: HiddenStart) -> &mut Self {
        start.figure.rasterize_into(&mut self.figure, &mut self.plane);
        Figure::Lump.rasterize_into(&mut self.lump, &mut self.plane);
        start.rasterize_stone_into(&mut self.lump, &mut self.plane);
        self.reset_to_lump()
    }

    /// Clears the world, and makes every start volume except the hidden figure a copy of the current lump.
    fn reset_to_lump(&mut self) -> &mut Self {
        self.creative.copy_from(&self.lump);
        self.own.copy_from(&self.lump);
        (self.made, self.has_own) = (false, true);
        self.world.clear();
        self
    }

    /// Runs one tick.
    pub fn step(&mut self, input: &TickInput) {
        self.step_then(input, |_, _| ());
    }

    /// Runs one tick, then passes the world and the start volumes to `show`.
    #[expect(clippy::disallowed_methods, reason = "the one place of the tests")]
    pub fn step_then<T>(
        &mut self,
        input: &TickInput,
        show: impl FnOnce(&World<N, K>, &StartVolumes<'_, N, K>) -> T,
    ) -> T {
        // The second figure is bare from the start.
        let figures =
            [&self.lump, &self.figure].map(|stone| HiddenFigure { figure: &self.figure, stone });
        let starts = StartVolumes {
            lump: &self.lump,
            figures: &figures,
            creative: &self.creative,
            own: self.has_own.then_some(&self.own),
        };
        self.world.step(input, &starts);
        show(&self.world, &starts)
    }

    /// Returns the world, and the start volumes of lump, figure and toy.
    pub fn world_and_start_volumes(&mut self) -> WorldAndStarts<'_, N, K> {
        let WorldHarness { world, lump, figure, creative, .. } = self;
        WorldAndStarts { world, lump, figure, creative }
    }

    /// Asserts the invariants: the maps are tight and saturated, the rows match them, the mask is part of the
    /// volume, and the digest equals a recomputation.
    ///
    /// # Panics
    /// An invariant is violated.
    pub fn check_invariants(&mut self) {
        let world = &self.world;
        let tick = world.tick();
        assert_eq!(world.digest(), world.recompute_digest(), "tick {tick}: digest");
        assert!(world.volume().are_ranges_tight(), "tick {tick}: a range that isn't tight");
        assert!(world.volume().is_saturated(), "tick {tick}: a column that isn't saturated");
        self.plane.set_from_maps(world.volume().maps());
        for y in 0..N {
            assert!(
                self.plane.layer(y) == world.volume().rows().layer(y),
                "tick {tick}: layer {y}"
            );
            for z in 0..N {
                let gone = !world.volume().rows().row(y, z) & Grid::<N>::FULL;
                let lost = world.mask().occupied_among((y, z), gone);
                assert!(lost.is_empty(), "tick {tick}: mask voxels lost in row ({y}, {z})");
            }
        }
    }
}

/// Returns `true` if two sets of maps contain the same ranges.
pub fn maps_are_equal<const N: usize, const K: usize>(
    a: &RangeMaps<N, K>,
    b: &RangeMaps<N, K>,
) -> bool {
    Axis::ALL.into_iter().all(|axis| (0..N).all(|line| a.line(axis, line) == b.line(axis, line)))
}

/// Makes tests of scenarios, which are functions of a [`WorldHarness`] at 64: each runs with one interval a
/// column and with two, in modules `one` and `two`.
#[macro_export]
macro_rules! test_with_one_and_two_intervals {
    ($($scenario:ident),+ $(,)?) => {
        mod one {
            $crate::test_with_intervals!(1: $($scenario),+);
        }
        mod two {
            $crate::test_with_intervals!(2: $($scenario),+);
        }
    };
}

/// Makes tests of scenarios with K intervals a column, on a shared harness.
#[macro_export]
macro_rules! test_with_intervals {
    ($intervals:literal: $($scenario:ident),+) => {
        type Harness = $crate::world_harness::WorldHarness<64, $intervals>;
        static HARNESS: std::sync::Mutex<Harness> = std::sync::Mutex::new(Harness::new());
        $(
            #[test]
            fn $scenario() {
                let held = HARNESS.lock();
                super::$scenario(&mut held.unwrap_or_else(std::sync::PoisonError::into_inner));
            }
        )+
    };
}
