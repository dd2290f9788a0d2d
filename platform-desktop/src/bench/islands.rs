//! `bench islands`: a whole pass over the bit rows against the paper's queue of voxels.

use paros_core::islands::IslandReport;
use paros_core::limits::row_visits;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::tick::Record;

use super::clock::{best_ticks, duel, timed};
use super::paper::{PAPER_VISITS, VoxelFill};
use super::rig::{Rig, Rigged, reset};
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

/// Layers cleared to cut an island loose.
const GAP: usize = 2;

pub(super) fn rows<const N: usize>(subject: &Subject, runs: usize) -> Result<Vec<Row>, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    let mut paper = VoxelFill::<N>::new();
    let mut rows = vec![];
    for (loose, what) in [(false, "nothing to remove"), (true, "an island to remove")] {
        subject.load(&mut rig.start, &mut rig.plane)?;
        if loose {
            cut_loose(&mut rig.plane, &mut rig.start, [3, 4]);
        }
        agree(rig, &mut paper, loose, subject.name())?;
        let row = |against: String| Row::new("islands", subject.name(), N, against);
        let times = at_once(rig, &mut paper, runs)?;
        rows.push(row(format!("the paper's voxel queue at once, {what}")).times(times));
        let times = worst_ticks(rig, &mut paper, runs);
        rows.push(row(format!("the same {PAPER_VISITS} voxels a tick, worst tick")).times(times));
    }
    Ok(rows)
}

/// Clears layers at a part of the height: all above is an island. Closure brings nothing
/// back there, as a cleared layer has no columns along x and z.
pub(super) fn cut_loose<const N: usize>(
    plane: &mut Plane<N>,
    maps: &mut Maps<N>,
    [part, of]: [usize; 2],
) where
    Grid<N>: Size,
{
    let top = (0..N).rev().find(|&y| plane.layer(y).iter().any(|row| !row.is_empty()));
    let cut = (top.unwrap_or(0) * part / of).max(1);
    for y in cut..(cut + GAP).min(N) {
        plane.layer_mut(y).fill(<Grid<N> as Size>::Row::EMPTY);
    }
    plane.hulls(maps);
    plane.expand(maps);
}

/// Both sides from the start to tight maps: the same ones, and smaller if there was an island.
fn agree<const N: usize>(
    rig: &mut Rig<N>,
    paper: &mut VoxelFill<N>,
    loose: bool,
    name: &str,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    prepare(rig);
    let report = pass(rig, u32::MAX).unwrap_or_default();
    rig.other.copy_from(&rig.start);
    paper.pass(&mut rig.other);
    if &rig.other != rig.volume.maps() {
        return Err(Error::Failure(format!("{name} at {N}: the two ways leave different volumes")));
    }
    if loose && report.removed == 0 {
        return Err(Error::Failure(format!("{name} at {N}: no island came loose")));
    }
    Ok(())
}

fn at_once<const N: usize>(
    rig: &mut Rig<N>,
    paper: &mut VoxelFill<N>,
    runs: usize,
) -> Result<[f64; 2], Error>
where
    Grid<N>: Size,
{
    let rig = std::cell::RefCell::new(rig);
    duel(
        runs,
        || {
            let rig = &mut **rig.borrow_mut();
            prepare(rig);
            Ok(timed(|| pass(rig, u32::MAX)))
        },
        || {
            let rig = &mut **rig.borrow_mut();
            rig.other.copy_from(&rig.start);
            Ok(timed(|| paper.pass(&mut rig.other)))
        },
    )
}

/// The slowest tick of each side.
fn worst_ticks<const N: usize>(rig: &mut Rig<N>, paper: &mut VoxelFill<N>, runs: usize) -> [f64; 2]
where
    Grid<N>: Size,
{
    let rig = std::cell::RefCell::new(rig);
    let ticks = best_ticks(
        runs,
        || our_ticks(&mut rig.borrow_mut(), row_visits(N)),
        || {
            let rig = &mut **rig.borrow_mut();
            rig.other.copy_from(&rig.start);
            paper_ticks(paper, &mut rig.other, PAPER_VISITS)
        },
    );
    ticks.map(|ticks| ticks.into_iter().fold(0.0, f64::max))
}

/// Milliseconds of the ticks of our pass, so many rows a tick.
pub(super) fn our_ticks<const N: usize>(rig: &mut Rig<N>, budget: u32) -> Vec<f64>
where
    Grid<N>: Size,
{
    prepare(rig);
    let mut ticks = vec![];
    while rig.islands.is_busy() {
        ticks.push(timed(|| pass(rig, budget)));
    }
    ticks
}

/// The paper's pass in ticks of so many voxels: the first makes them, the last shrinks the ranges.
pub(super) fn paper_ticks<const N: usize>(
    paper: &mut VoxelFill<N>,
    maps: &mut Maps<N>,
    visits: usize,
) -> Vec<f64> {
    let mut ticks = vec![];
    let mut done = false;
    while !done {
        ticks.push(timed(|| {
            if ticks.is_empty() {
                paper.begin(maps);
            }
            done = paper.visit(visits);
            if done {
                paper.finish(maps);
            }
        }));
    }
    ticks
}

/// The volume as it starts, and a pass called for.
fn prepare<const N: usize>(rig: &mut Rig<N>)
where
    Grid<N>: Size,
{
    reset(rig);
    rig.islands.edited();
}

pub(super) fn pass<const N: usize>(rig: &mut Rig<N>, budget: u32) -> Option<IslandReport>
where
    Grid<N>: Size,
{
    let mut record = Record { undo: &mut rig.undo, dirty: &mut rig.dirty };
    let report = rig.islands.advance(&mut rig.volume, &rig.mask, budget, &mut record);
    rig.dirty.close();
    report
}
