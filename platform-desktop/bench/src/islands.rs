//! `bench islands`: a whole pass over the bit rows, against the paper's queue of voxels.

use paros_core::RangeMaps;
use paros_core::edit::IslandReport;
use paros_core::internals::RemovalJournal;
use paros_core::limits::max_island_row_visits_per_tick;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_headless::Error;

use super::clock::{OursTheirs, min_in_turns_ms, min_of_each_tick_ms, time_ms};
use super::fixture::{Fixture, HasFixture, restore_start_volume};
use super::paper::{FillState, PAPER_VISITS, VoxelFill};
use super::row::ReportRow;
use super::subject::BenchSubject;

/// Number of layers cleared to separate an island from the ground.
const GAP: usize = 2;

pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let mut paper = VoxelFill::<N>::new();
    let mut rows = vec![];
    for PassCase { has_island, name: what } in PASS_CASES {
        load_pass_case(subject, fixture, has_island)?;
        check_agreement(fixture, &mut paper, has_island, subject.name())?;
        let row = |against: String| ReportRow::new("islands", subject.name(), N, against);
        let times = min_whole_pass_ms(fixture, &mut paper, runs)?;
        rows.push(row(format!("the paper's voxel queue at once, {what}")).with_times_ms(times));
        let times = worst_tick_ms(fixture, &mut paper, runs);
        rows.push(
            row(format!("the same {PAPER_VISITS} voxels a tick, worst tick")).with_times_ms(times),
        );
    }
    Ok(rows)
}

/// A case to measure: a pass with or without an island to remove.
#[derive(Clone, Copy)]
pub(super) struct PassCase {
    pub(super) has_island: bool,
    pub(super) name: &'static str,
}

pub(super) const PASS_CASES: [PassCase; 2] = [
    PassCase { has_island: false, name: "nothing to remove" },
    PassCase { has_island: true, name: "an island to remove" },
];

/// Loads a subject as the start volume, with the upper quarter cut off if it should have an island.
pub(super) fn load_pass_case<const N: usize>(
    subject: &BenchSubject,
    fixture: &mut Fixture<N>,
    has_island: bool,
) -> Result<(), Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    if has_island {
        let three_quarters = Fraction { numerator: 3, denominator: 4 };
        cut_gap(&mut fixture.start, &mut fixture.bit_grid, three_quarters);
    }
    Ok(())
}

/// A fraction of the occupied height.
#[derive(Clone, Copy)]
pub(super) struct Fraction {
    pub(super) numerator: usize,
    pub(super) denominator: usize,
}

/// Clears layers at a fraction of the occupied height: everything above becomes an island. Closure restores
/// nothing there, as a cleared layer has no columns along x and z.
pub(super) fn cut_gap<const N: usize, const K: usize>(
    maps: &mut RangeMaps<N, K>,
    bit_grid: &mut BitGrid<N>,
    height: Fraction,
) where
    Grid<N>: Size,
{
    let top = (0..N).rev().find(|&y| bit_grid.layer(y).iter().any(|row| !row.is_empty()));
    let cut = (top.unwrap_or(0) * height.numerator / height.denominator).max(1);
    for y in cut..(cut + GAP).min(N) {
        bit_grid.layer_mut(y).fill(<Grid<N> as Size>::Row::EMPTY);
    }
    bit_grid.write_closure(maps);
    bit_grid.set_from_maps(maps);
}

/// Checks that both sides produce the same tight maps, with fewer voxels if there was an island.
fn check_agreement<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    has_island: bool,
    name: &str,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    prepare_pass(fixture);
    let report = advance_pass(fixture, u32::MAX).unwrap_or_default();
    fixture.other.copy_from(&fixture.start);
    paper.remove_islands(&mut fixture.other);
    if &fixture.other != fixture.volume.maps() {
        return Err(Error::Failure(format!("{name} at {N}: the two ways leave different volumes")));
    }
    if has_island && report.removed == 0 {
        return Err(Error::Failure(format!("{name} at {N}: no island came loose")));
    }
    Ok(())
}

/// Returns the best time of a whole pass by each side, in milliseconds.
fn min_whole_pass_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    runs: usize,
) -> Result<OursTheirs<f64>, Error>
where
    Grid<N>: Size,
{
    let fixture = std::cell::RefCell::new(fixture);
    min_in_turns_ms(
        runs,
        || Ok(whole_pass_ms(*fixture.borrow_mut())),
        || Ok(whole_paper_pass_ms(*fixture.borrow_mut(), paper)),
    )
}

/// Returns the milliseconds of our whole pass over the start volume.
pub(super) fn whole_pass_ms<const N: usize, const K: usize>(fixture: &mut Fixture<N, K>) -> f64
where
    Grid<N>: Size,
{
    prepare_pass(fixture);
    time_ms(|| advance_pass(fixture, u32::MAX))
}

/// Returns the milliseconds of the paper's whole pass over the start volume.
pub(super) fn whole_paper_pass_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
) -> f64
where
    Grid<N>: Size,
{
    fixture.other.copy_from(&fixture.start);
    time_ms(|| paper.remove_islands(&mut fixture.other))
}

/// Returns the slowest tick of each side, in milliseconds.
fn worst_tick_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    paper: &mut VoxelFill<N>,
    runs: usize,
) -> OursTheirs<f64>
where
    Grid<N>: Size,
{
    let fixture = std::cell::RefCell::new(fixture);
    let ticks = min_of_each_tick_ms(
        runs,
        || our_ticks_ms(&mut fixture.borrow_mut(), max_island_row_visits_per_tick(N)),
        || {
            let fixture = &mut **fixture.borrow_mut();
            fixture.other.copy_from(&fixture.start);
            paper_ticks_ms(paper, &mut fixture.other, PAPER_VISITS)
        },
    );
    let worst = |ticks: Vec<f64>| ticks.into_iter().fold(0.0, f64::max);
    OursTheirs { ours: worst(ticks.ours), theirs: worst(ticks.theirs) }
}

/// Returns the milliseconds of each tick of our pass, in the order of the ticks.
pub(super) fn our_ticks_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    row_visits_per_tick: u32,
) -> Vec<f64>
where
    Grid<N>: Size,
{
    prepare_pass(fixture);
    let mut ticks = vec![];
    while fixture.islands.is_busy() {
        ticks.push(time_ms(|| advance_pass(fixture, row_visits_per_tick)));
    }
    ticks
}

/// Returns the milliseconds of each tick of the paper's pass, in the order of the ticks. The first tick
/// builds the voxel grid, the last shrinks the ranges.
pub(super) fn paper_ticks_ms<const N: usize>(
    paper: &mut VoxelFill<N>,
    maps: &mut RangeMaps<N>,
    voxel_visits_per_tick: usize,
) -> Vec<f64> {
    let mut ticks = vec![];
    let mut done = false;
    while !done {
        ticks.push(time_ms(|| {
            if ticks.is_empty() {
                paper.begin_pass(maps);
            }
            done = paper.visit_voxels(voxel_visits_per_tick) == FillState::Done;
            if done {
                paper.shrink_ranges_to_visited(maps);
            }
        }));
    }
    ticks
}

/// Restores the start volume, with an island pass pending.
fn prepare_pass<const N: usize, const K: usize>(fixture: &mut Fixture<N, K>)
where
    Grid<N>: Size,
{
    restore_start_volume(fixture);
    fixture.islands.request_pass();
}

/// Advances the present pass by at most `max_row_visits`. Returns its report once it is done.
pub(super) fn advance_pass<const N: usize, const K: usize>(
    fixture: &mut Fixture<N, K>,
    max_row_visits: u32,
) -> Option<IslandReport>
where
    Grid<N>: Size,
{
    let mut record = RemovalJournal { undo: &mut fixture.undo, dirty: &mut fixture.dirty };
    let report = fixture.islands.advance_pass(
        &mut fixture.volume,
        &fixture.mask,
        max_row_visits,
        &mut record,
    );
    fixture.dirty.end_edit();
    report
}
