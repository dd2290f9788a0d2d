//! `bench islands`: a whole pass over the bit rows against the paper's queue of voxels.

use paros_core::internals::RemovalJournal;
use paros_core::limits::island_row_visits;
use paros_core::{BitGrid, BitSet, Grid, IslandReport, RangeMaps, Size};
use paros_headless::Error;

use super::clock::{best_in_turns_ms, best_ticks_ms, time_ms};
use super::fixture::{Fixture, HasFixture, reset_fixture};
use super::paper::{PAPER_VISITS, VoxelFill};
use super::row::ReportRow;
use super::subject::Subject;

/// Layers cleared to separate an island from the ground.
const GAP: usize = 2;

pub(super) fn measure_rows<const N: usize>(
    subject: &Subject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let mut paper = VoxelFill::<N>::new();
    let mut rows = vec![];
    for (loose, what) in [(false, "nothing to remove"), (true, "an island to remove")] {
        subject.load_into(&mut fixture.start, &mut fixture.plane)?;
        if loose {
            cut_loose(&mut fixture.plane, &mut fixture.start, [3, 4]);
        }
        check_agreement(fixture, &mut paper, loose, subject.name())?;
        let row = |against: String| ReportRow::new("islands", subject.name(), N, against);
        let times = at_once_ms(fixture, &mut paper, runs)?;
        rows.push(row(format!("the paper's voxel queue at once, {what}")).with_times_ms(times));
        let times = worst_ticks_ms(fixture, &mut paper, runs);
        rows.push(
            row(format!("the same {PAPER_VISITS} voxels a tick, worst tick")).with_times_ms(times),
        );
    }
    Ok(rows)
}

/// Clears layers at the fraction `part / of` of the height: all above is an island. Closure restores
/// nothing there, as a cleared layer has no columns along x and z.
pub(super) fn cut_loose<const N: usize>(
    plane: &mut BitGrid<N>,
    maps: &mut RangeMaps<N>,
    [part, of]: [usize; 2],
) where
    Grid<N>: Size,
{
    let top = (0..N).rev().find(|&y| plane.layer(y).iter().any(|row| !row.is_empty()));
    let cut = (top.unwrap_or(0) * part / of).max(1);
    for y in cut..(cut + GAP).min(N) {
        plane.layer_mut(y).fill(<Grid<N> as Size>::Row::EMPTY);
    }
    plane.write_hulls(maps);
    plane.set_from_maps(maps);
}

/// Checks that both sides leave the same tight maps, and fewer voxels if there was an island.
fn check_agreement<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    loose: bool,
    name: &str,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    prepare_pass(fixture);
    let report = run_pass(fixture, u32::MAX).unwrap_or_default();
    fixture.other.copy_from(&fixture.start);
    paper.run_pass(&mut fixture.other);
    if &fixture.other != fixture.volume.maps() {
        return Err(Error::Failure(format!("{name} at {N}: the two ways leave different volumes")));
    }
    if loose && report.removed == 0 {
        return Err(Error::Failure(format!("{name} at {N}: no island came loose")));
    }
    Ok(())
}

fn at_once_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    runs: usize,
) -> Result<[f64; 2], Error>
where
    Grid<N>: Size,
{
    let fixture = std::cell::RefCell::new(fixture);
    best_in_turns_ms(
        runs,
        || {
            let fixture = &mut **fixture.borrow_mut();
            prepare_pass(fixture);
            Ok(time_ms(|| run_pass(fixture, u32::MAX)))
        },
        || {
            let fixture = &mut **fixture.borrow_mut();
            fixture.other.copy_from(&fixture.start);
            Ok(time_ms(|| paper.run_pass(&mut fixture.other)))
        },
    )
}

/// The slowest tick of each side, in milliseconds.
fn worst_ticks_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    runs: usize,
) -> [f64; 2]
where
    Grid<N>: Size,
{
    let fixture = std::cell::RefCell::new(fixture);
    let ticks = best_ticks_ms(
        runs,
        || our_ticks_ms(&mut fixture.borrow_mut(), island_row_visits(N)),
        || {
            let fixture = &mut **fixture.borrow_mut();
            fixture.other.copy_from(&fixture.start);
            paper_ticks_ms(paper, &mut fixture.other, PAPER_VISITS)
        },
    );
    ticks.map(|ticks| ticks.into_iter().fold(0.0, f64::max))
}

/// Milliseconds of each tick of our pass, with `budget` row visits a tick.
pub(super) fn our_ticks_ms<const N: usize>(fixture: &mut Fixture<N>, budget: u32) -> Vec<f64>
where
    Grid<N>: Size,
{
    prepare_pass(fixture);
    let mut ticks = vec![];
    while fixture.islands.is_busy() {
        ticks.push(time_ms(|| run_pass(fixture, budget)));
    }
    ticks
}

/// Milliseconds of each tick of the paper's pass, with `visits` voxels a tick. The first tick builds
/// the voxel grid, the last shrinks the ranges.
pub(super) fn paper_ticks_ms<const N: usize>(
    paper: &mut VoxelFill<N>,
    maps: &mut RangeMaps<N>,
    visits: usize,
) -> Vec<f64> {
    let mut ticks = vec![];
    let mut done = false;
    while !done {
        ticks.push(time_ms(|| {
            if ticks.is_empty() {
                paper.begin_pass(maps);
            }
            done = paper.visit_voxels(visits);
            if done {
                paper.finish_pass(maps);
            }
        }));
    }
    ticks
}

/// Restores the start volume, with an island pass pending.
fn prepare_pass<const N: usize>(fixture: &mut Fixture<N>)
where
    Grid<N>: Size,
{
    reset_fixture(fixture);
    fixture.islands.request_pass();
}

pub(super) fn run_pass<const N: usize>(
    fixture: &mut Fixture<N>,
    budget: u32,
) -> Option<IslandReport>
where
    Grid<N>: Size,
{
    let mut record = RemovalJournal { undo: &mut fixture.undo, dirty: &mut fixture.dirty };
    let report =
        fixture.islands.advance_pass(&mut fixture.volume, &fixture.mask, budget, &mut record);
    fixture.dirty.end_edit();
    report
}
