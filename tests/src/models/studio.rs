//! A world with start volumes, and what must hold of it after every tick.

use paros_core::input::{Input, Mode};
use paros_core::maps::{Axis, Maps};
use paros_core::plane::Plane;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::world::{Starts, World};
use paros_shell::figures::Figure;

/// All zero bytes at first; lives in a static.
#[derive(Debug)]
pub struct Studio<const N: usize>
where
    Grid<N>: Size,
{
    /// The world.
    pub world: World<N>,
    /// A volume of the visitor's own, offered where `has_own`.
    pub own: Maps<N>,
    /// Whether it is offered.
    pub has_own: bool,
    lump: Maps<N>,
    figure: Maps<N>,
    creative: Maps<N>,
    made: bool,
    plane: Plane<N>,
}

impl<const N: usize> Studio<N>
where
    Grid<N>: Size,
{
    /// For static initialisers only.
    #[allow(clippy::new_without_default)] // a Default would hand the studio about by value
    pub const fn new() -> Self {
        Studio {
            world: World::new(),
            own: Maps::new(),
            has_own: false,
            lump: Maps::new(),
            figure: Maps::new(),
            creative: Maps::new(),
            made: false,
            plane: Plane::new(),
        }
    }

    /// An empty world again, with the lump, one hidden figure and the toy.
    pub fn open(&mut self) -> &mut Self {
        if !self.made {
            Figure::Lump.carve_into(&mut self.plane, &mut self.lump);
            Figure::Owl.carve_into(&mut self.plane, &mut self.figure);
            Figure::Toy.carve_into(&mut self.plane, &mut self.creative);
            self.made = true;
        }
        self.has_own = false;
        self.world.clear();
        self
    }

    /// An empty world in which a session of this mode has started; its one figure is number 0.
    pub fn start(&mut self, mode: Mode) -> &mut Self {
        self.open();
        self.step(&Input { start: mode, ..Input::default() });
        self
    }

    /// Sets the visitor's own volume to the closure of voxels, and starts from it.
    pub fn start_from(&mut self, mut occupied: impl FnMut([usize; 3]) -> bool) -> &mut Self {
        self.open();
        self.plane.clear();
        for y in 0..N {
            for z in 0..N {
                let row = self.plane.row_mut(y, z);
                (0..N).filter(|&x| occupied([x, y, z])).for_each(|x| row.insert(x));
            }
        }
        self.plane.hulls(&mut self.own);
        self.has_own = true;
        self.step(&Input { start: Mode::Own, ..Input::default() });
        self
    }

    /// One tick.
    #[expect(clippy::disallowed_methods, reason = "the one place of the tests")]
    pub fn step(&mut self, input: &Input) {
        let figures = [&self.figure];
        let starts = Starts {
            lump: &self.lump,
            figures: &figures,
            creative: &self.creative,
            own: self.has_own.then_some(&self.own),
        };
        self.world.step(input, &starts);
    }

    /// The start volumes, beside the world.
    pub fn parts(&mut self) -> (&mut World<N>, &Maps<N>, &Maps<N>, &Maps<N>) {
        (&mut self.world, &self.lump, &self.figure, &self.creative)
    }

    /// The maps are tight and the rows follow them, the mask is part of the volume, the digest is
    /// what a recomputation gives.
    pub fn check(&mut self) {
        let world = &self.world;
        let tick = world.tick();
        assert_eq!(world.digest(), world.recompute_digest(), "tick {tick}: digest");
        assert!(world.volume().is_tight(), "tick {tick}: a range that isn't tight");
        self.plane.expand(world.volume().maps());
        for y in 0..N {
            assert!(
                self.plane.layer(y) == world.volume().rows().layer(y),
                "tick {tick}: layer {y}"
            );
            for z in 0..N {
                let gone = !world.volume().rows().row(y, z) & Grid::<N>::FULL;
                let lost = world.mask().row_among((y, z), gone);
                assert!(lost.is_empty(), "tick {tick}: mask voxels lost in row ({y}, {z})");
            }
        }
    }
}

/// Whether two pairs of maps are the same.
pub fn same<const N: usize>(a: &Maps<N>, b: &Maps<N>) -> bool {
    Axis::ALL.into_iter().all(|axis| (0..N).all(|line| a.line(axis, line) == b.line(axis, line)))
}
