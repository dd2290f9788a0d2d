//! Instances of generic functions at the sizes in use.
//!
//! A crate that calls such a function reuses the instance that is compiled here. Otherwise every crate above
//! would compile its own, and the core several times over. In a release build rustc shares only instances of
//! functions that are `#[inline(never)]`.

use std::hint::black_box;

use paros_core::codec::trace::digest_start_volumes;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Baker, Exporter, Volume, World};

use crate::figures::Figure;
use crate::rmap;
use crate::statics::{Resident, ResidentBitGrid};
use crate::stl_export::{StlExporter, print_scale};
use crate::tick_runner::TickRunner;

/// Makes rustc compile the functions of all sizes. A call does nothing.
pub fn compile_instances() {
    compile_grid::<128>();
    compile_grid::<256>();
    compile_columns::<128, 1>();
    compile_columns::<128, 2>();
    compile_columns::<256, 1>();
    compile_columns::<256, 2>();
}

fn compile_grid<const N: usize>()
where
    Grid<N>: Size + ResidentBitGrid<N>,
{
    let bit_grid =
        [BitGrid::<N>::count_voxels as *const (), Exporter::<N>::start_export as *const ()];
    black_box(bit_grid);
}

fn compile_columns<const N: usize, const K: usize>()
where
    Grid<N>: Size + Resident<N, K>,
{
    let world = [
        TickRunner::<N, K>::run_tick as *const (),
        World::<N, K>::save as *const (),
        World::<N, K>::load as *const (),
        World::<N, K>::clear as *const (),
        World::<N, K>::part_digests as *const (),
        Volume::<N, K>::count_voxels as *const (),
        digest_start_volumes::<N, K> as *const (),
    ];
    let conversions = [
        Baker::<N, <Grid<N> as Resident<N, K>>::Windings>::clear as *const (),
        Baker::<N, <Grid<N> as Resident<N, K>>::Windings>::add_triangle as *const (),
        Baker::<N, <Grid<N> as Resident<N, K>>::Windings>::write_maps::<K> as *const (),
        Exporter::<N>::advance_export::<K> as *const (),
        Figure::rasterize_into::<N, K> as *const (),
        BitGrid::<N>::set_from_maps::<K> as *const (),
        BitGrid::<N>::write_closure::<K> as *const (),
        BitGrid::<N>::write_hulls::<K> as *const (),
    ];
    let files = [
        rmap::read::<N, K> as *const (),
        rmap::read_closed::<N, K> as *const (),
        rmap::encode::<N, K> as *const (),
        StlExporter::<N, K>::begin_export as *const (),
        StlExporter::<N, K>::advance_export_step as *const (),
        print_scale::<N, K> as *const (),
    ];
    black_box((world, conversions, files));
}
