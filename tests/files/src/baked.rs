//! Invariants of every baked mesh.

use std::sync::Mutex;

use paros_core::convert::{BakeReport, MeshPlacement, UpAxis, Windings};
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_core::{Baker, RangeMaps};
use paros_models::bake::Triangle;
use paros_models::bake_harness::{N, check_bake};
use paros_shell::mesh::{Mesh, MeshBounds};
use paros_shell::statics::Resident;

use crate::shapes::with_holes_closed;

/// Bakes an upright mesh.
///
/// # Panics
/// The mesh isn't a solid.
pub fn bake<const M: usize, const K: usize, W: Windings<M>>(
    mesh: &Mesh,
    baker: &Mutex<Baker<M, W>>,
    maps: &Mutex<RangeMaps<M, K>>,
    bits: &Mutex<BitGrid<M>>,
) -> BakeReport
where
    Grid<M>: Size,
{
    let (mut baker, mut maps) = (baker.lock().unwrap(), maps.lock().unwrap());
    mesh.bake_into_maps(UpAxis::Y, &mut baker, &mut maps, &mut bits.lock().unwrap()).unwrap()
}

/// Asserts that an open mesh and the same mesh with its hole closed bake to nearly the same voxels.
///
/// # Panics
/// The voxels differ by more.
pub fn assert_open_base_bakes_alike(open: &Mesh) {
    static BAKER: Mutex<Baker<128>> = Mutex::new(Baker::new());
    static MAPS: Mutex<RangeMaps<128>> = Mutex::new(RangeMaps::new());
    static PLANES: [Mutex<BitGrid<128>>; 2] = [const { Mutex::new(BitGrid::new()) }; 2];
    let whole = with_holes_closed(open);
    assert!(whole.triangles.len() > open.triangles.len(), "the mesh has no hole to close");
    let whole_report = bake(&whole, &BAKER, &MAPS, &PLANES[1]);
    let report = bake(open, &BAKER, &MAPS, &PLANES[0]);
    assert!(!report.flipped, "{report:?}");
    // Not zero, because the fan that closes a hole may cut through the surface beside it.
    assert!(
        whole_report.opened_columns * 20 < report.opened_columns,
        "{report:?} {whole_report:?}"
    );
    let [a, b] = [PLANES[0].lock().unwrap(), PLANES[1].lock().unwrap()];
    let rows = (0..128 * 128).map(|i| (i / 128, i % 128));
    let apart: u64 = rows.map(|(y, z)| u64::from((a.row(y, z) ^ b.row(y, z)).count_ones())).sum();
    println!("{apart} of {} voxels differ", b.count_voxels());
    assert!(apart * 200 < b.count_voxels(), "{apart} of {} voxels differ", b.count_voxels());
}

/// Asserts that a mesh bakes as in the dense model, and so does the mesh turned inside out.
///
/// # Panics
/// A result differs.
pub fn assert_bakes_as_model_also_inside_out(mesh: &Mesh) {
    let MeshBounds { min, max } = mesh.bounding_box().unwrap();
    let placement = MeshPlacement::stand_bounds_on_floor(min, max, UpAxis::Y, N).unwrap();
    let place = |i: u32| placement.snap_point(mesh.positions[i as usize]).to_array();
    let triangles: Vec<Triangle> = mesh.triangles.iter().map(|t| t.map(place)).collect();
    check_bake(&triangles).unwrap();
    let inside_out: Vec<Triangle> = triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
    check_bake(&inside_out).unwrap();
}

/// Returns a mesh's voxels at grid side M, in columns of two intervals, as `paros bake` makes them.
///
/// # Panics
/// The mesh has no extent.
#[must_use]
pub fn bake_voxels<const M: usize>(mesh: &Mesh, up: UpAxis) -> Box<BitGrid<M>>
where
    Grid<M>: Size + Resident<M, 2>,
{
    let mut bits = Box::new(BitGrid::new());
    let mut maps = Box::new(RangeMaps::<M, 2>::new());
    let mut baker = <Grid<M> as Resident<M, 2>>::lock_baker();
    mesh.bake_into_maps(up, &mut *baker, &mut maps, &mut bits).expect("a mesh with an extent");
    bits
}

/// Returns the intersection over union of two grids.
#[must_use]
pub fn share_in_common<const M: usize>(a: &BitGrid<M>, b: &BitGrid<M>) -> f64
where
    Grid<M>: Size,
{
    let rows = (0..M * M).map(|i| (i / M, i % M));
    let (mut both, mut either) = (0, 0);
    for (y, z) in rows {
        both += u64::from((a.row(y, z) & b.row(y, z)).count_ones());
        either += u64::from((a.row(y, z) | b.row(y, z)).count_ones());
    }
    both as f64 / either as f64
}
