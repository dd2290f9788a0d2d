//! `bench layers`: the share of cuts that closure refuses, with one interval a column and with two, at 128
//! voxels a side. The cost of two intervals is measured in `layer_costs.rs`.

use std::f32::consts::{SQRT_2, TAU};
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::Brush;
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::limits::max_save_bytes;
use paros_core::volume::{BitGrid, BitSet, Grid};
use paros_headless::Error;
use paros_shell::edit_totals::EditTotals;
use paros_shell::tick_runner::{TickRunner, with_fresh_world};
use paros_shell::trace::Trace;

use super::clock::{OursTheirs, time_ms};
use super::edit::{CARVE, try_edit};
use super::fixture::{Fixture, HasFixture, restore_start_volume};
use super::layer_costs::{name_intervals, size_row};
use super::row::{RefusalShare, ReportRow};

/// Voxels along an edge.
const SIDE: usize = 128;

/// The radius of the ball that is cut, in voxels.
const BALL_RADIUS: f32 = 56.0;

/// Number of balls for each kind of cut, each turned differently.
const SEEDS: usize = 8;

/// Number of cuts in a ball.
const CUTS: usize = 12;

/// A kind of cut. In every ball its brushes are carved in order, each until nothing changes.
struct CutKind {
    name: &'static str,
    brushes: fn(seed: usize) -> Vec<Brush>,
}

const CUT_KINDS: [CutKind; 5] = [
    CutKind { name: "12 holes of radius 4, 25 deep", brushes: drills },
    CutKind { name: "12 bent undercuts, 18 deep", brushes: undercuts },
    CutKind { name: "slot 2 thick, 20 deep, at 4 degrees", brushes: |seed| slot(seed, 4.0) },
    CutKind { name: "slot 2 thick, 20 deep, at 10 degrees", brushes: |seed| slot(seed, 10.0) },
    CutKind { name: "slot 2 thick, 20 deep, at 45 degrees", brushes: |seed| slot(seed, 45.0) },
];

/// Measures the share of the cuts that closure refuses, in a row for each kind.
pub(super) fn measure_cuts() -> Vec<ReportRow> {
    let one = &mut *Grid::<SIDE>::lock_fixture();
    let two = &mut *Grid::<SIDE>::lock_fixture_of_two();
    set_to_ball(&mut one.bit_grid);
    one.bit_grid.write_closure(&mut one.start);
    one.bit_grid.write_closure(&mut two.start);
    let row = |kind: &CutKind| {
        let cuts = (0..SEEDS).map(|seed| {
            let brushes = (kind.brushes)(seed);
            OursTheirs {
                ours: carve_each_until_unchanged(two, &brushes),
                theirs: carve_each_until_unchanged(one, &brushes),
            }
        });
        let cuts: Vec<_> = cuts.collect();
        let sum = |of: fn(&OursTheirs<TimedEdits>) -> &TimedEdits| {
            cuts.iter().map(of).fold(TimedEdits::default(), TimedEdits::sum_with)
        };
        let (ours, theirs) = (sum(|cut| &cut.ours), sum(|cut| &cut.theirs));
        let worst = cuts.iter().map(|cut| cut.ours.totals.closure_percent()).fold(0.0, f64::max);
        let times = OursTheirs { ours: ours.ms, theirs: theirs.ms };
        ReportRow {
            refusal: Some(RefusalShare {
                worst_two_percent: Some(worst),
                ..RefusalShare::new(&theirs.totals, &ours.totals)
            }),
            ..ReportRow::new("layers", kind.name, SIDE, "one interval a column")
                .with_times_ms(times)
        }
    };
    CUT_KINDS.iter().map(row).collect()
}

/// Measures the share of a recorded session's edits that closure refuses, with its input played with one
/// interval and with two. With two the hands meet a different volume, so that the sessions diverge.
pub(super) fn measure_refusals_of_session(path: &Path) -> Result<Vec<ReportRow>, Error> {
    let trace = Trace::read(path).map_err(Error::input)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    if usize::from(trace.header().side) != SIDE {
        let expected = format!("{}: expected a session at {SIDE}", path.display());
        return Err(Error::Input(expected));
    }
    let one = with_fresh_world::<SIDE, 1, _>(|mut runner| play(&mut runner, &trace));
    let two = with_fresh_world::<SIDE, 2, _>(|mut runner| play(&mut runner, &trace));
    let played = ReportRow {
        refusal: Some(RefusalShare::new(&one.edits.totals, &two.edits.totals)),
        ..ReportRow::new("layers", &name, SIDE, "its input with one interval a column")
            .with_times_ms(OursTheirs { ours: two.edits.ms, theirs: one.edits.ms })
    };
    let save = |intervals, bytes| {
        let what = format!("size of a save at its end, {}", name_intervals(intervals));
        size_row(&name, SIDE, what, bytes)
    };
    Ok(vec![played, save(1, one.save_bytes), save(2, two.save_bytes)])
}

/// The result of playing a session.
struct PlayedSession {
    edits: TimedEdits,
    /// Length of a save of the world at the session's end.
    save_bytes: usize,
}

/// The effect of edits, and their time in milliseconds.
#[derive(Clone, Copy, Default)]
struct TimedEdits {
    totals: EditTotals,
    ms: f64,
}

impl TimedEdits {
    fn sum_with(self, other: &Self) -> Self {
        TimedEdits { totals: self.totals.sum_with(&other.totals), ms: self.ms + other.ms }
    }
}

/// Plays the ticks of a trace, without comparing digests.
fn play<const K: usize>(runner: &mut TickRunner<'_, SIDE, K>, trace: &Trace) -> PlayedSession {
    let mut edits = TimedEdits::default();
    for record in trace.records() {
        edits.ms += time_ms(|| runner.run_tick(&record.input));
        edits.totals.add_tick(runner.world());
    }
    let save_bytes = runner.world().save(&mut vec![0; max_save_bytes(SIDE, K)]);
    PlayedSession { edits, save_bytes }
}

/// Carves brushes into the start volume in order. Voxels of a brush that remain once its edits change nothing
/// count as refused, once.
fn carve_each_until_unchanged<const K: usize>(
    fixture: &mut Fixture<SIDE, K>,
    brushes: &[Brush],
) -> TimedEdits {
    restore_start_volume(fixture);
    let mut sum = TimedEdits::default();
    for brush in brushes {
        let before = count_occupied(fixture.volume.rows(), brush);
        sum.ms += time_ms(|| while try_edit(fixture, brush, CARVE) {});
        let left = count_occupied(fixture.volume.rows(), brush);
        sum.totals.removed += before - left;
        sum.totals.refused_by_closure += left;
    }
    sum
}

/// Counts the occupied voxels within a brush.
fn count_occupied(volume: &BitGrid<SIDE>, brush: &Brush) -> u64 {
    let rows = (0..SIDE).flat_map(|y| (0..SIDE).map(move |z| (y, z)));
    rows.map(|(y, z)| (brush.row_bits::<SIDE>(y, z) & volume.row(y, z)).count_ones())
        .map(u64::from)
        .sum()
}

fn set_to_ball(bit_grid: &mut BitGrid<SIDE>) {
    bit_grid.clear();
    let middle = SIDE as f32 / 2.0;
    let ball = sphere_brush(Vec3::splat(middle), BALL_RADIUS);
    for y in 0..SIDE {
        for z in 0..SIDE {
            *bit_grid.row_mut(y, z) = ball.row_bits::<SIDE>(y, z);
        }
    }
}

fn drills(seed: usize) -> Vec<Brush> {
    let drill =
        |out| capsule_about_middle(out * (BALL_RADIUS + 4.0), out * (BALL_RADIUS - 25.0), 4.0);
    spread_directions(seed).map(drill).collect()
}

/// Returns undercuts: down by nine voxels, then as far again along a slope of 45 degrees.
fn undercuts(seed: usize) -> Vec<Brush> {
    let undercut = |out: Vec3| {
        let bend = out * (BALL_RADIUS - 9.0);
        let slope = (out.any_orthonormal_vector() - out) / SQRT_2;
        [
            capsule_about_middle(out * (BALL_RADIUS + 4.0), bend, 3.0),
            capsule_about_middle(bend, bend + slope * 9.0 * SQRT_2, 3.0),
        ]
    };
    spread_directions(seed).flat_map(undercut).collect()
}

/// Returns a slot in the plane across an axis of the grid, turned by an angle about another axis.
fn slot(seed: usize, degrees: f32) -> Vec<Brush> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let (normal, out) = (axes[seed % 3], axes[(seed % 3 + 1 + seed / 3 % 2) % 3]);
    let along = normal.cross(out);
    let turn = Quat::from_axis_angle(if seed < 6 { out } else { along }, degrees.to_radians());
    let half_extents = normal + out * 10.0 + along.abs() * 20.0;
    let position = Vec3::splat(SIDE as f32 / 2.0) + turn * out * (BALL_RADIUS - 10.0);
    vec![Brush::oriented_box(to_subunits(half_extents), &Pose { position, rotation: turn })]
}

/// Returns directions spread over the sphere by a spiral of the golden angle, turned differently for each
/// seed.
fn spread_directions(seed: usize) -> impl Iterator<Item = Vec3> {
    let golden_angle = TAU * (1.0 - 2.0 / (1.0 + 5.0f32.sqrt()));
    let axis = Vec3::new(1.0, 2.0 + seed as f32, 3.0).normalize();
    let turn = Quat::from_axis_angle(axis, 1.0 + seed as f32);
    (0..CUTS).map(move |i| {
        let height = 1.0 - (2 * i + 1) as f32 / CUTS as f32;
        let (sine, cosine) = (i as f32 * golden_angle).sin_cos();
        let across = (1.0 - height * height).sqrt();
        turn * Vec3::new(across * cosine, height, across * sine)
    })
}

/// Returns a capsule whose ends are relative to the ball's middle, in voxels.
fn capsule_about_middle(from: Vec3, to: Vec3, radius: f32) -> Brush {
    let subunits = |place: Vec3| to_subunits(place + Vec3::splat(SIDE as f32 / 2.0));
    Brush::capsule(subunits(from), subunits(to), (radius * SUBUNITS_PER_VOXEL as f32) as i32)
}

fn sphere_brush(centre: Vec3, radius: f32) -> Brush {
    Brush::sphere(to_subunits(centre), (radius * SUBUNITS_PER_VOXEL as f32) as i32)
}

fn to_subunits(voxels: Vec3) -> glam::IVec3 {
    (voxels * SUBUNITS_PER_VOXEL as f32).round().as_ivec3()
}
