//! `bench bake`: the time from triangles in memory to tight maps, with one interval a column and with two,
//! against trimesh.

use paros_core::Baker;
use paros_core::convert::{MeshPlacement, UpAxis, Windings};
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shell::mesh::{Mesh, MeshBounds};
use paros_shell::statics::Resident;

use super::clock::{OursTheirs, min_in_turns_ms, time_ms};
use super::fixture::{Fixture, HasFixture};
use super::peers::{MissingPeer, PeerTiming, PythonPeers};
use super::row::{Measured, ReportRow};
use super::subject::BenchSubject;

/// A rival slower than this is only run [`SLOW_RUNS`] times, and the row states that.
const SLOW_MS: f64 = 1000.0;
const SLOW_RUNS: usize = 3;

/// Suffix of a row in which our columns have two intervals.
const OURS_OF_TWO: &str = ", ours of two intervals";

pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
) -> Result<Measured, Error>
where
    Grid<N>: Size + HasFixture<N> + Resident<N, 2>,
{
    let (one, two) = (&mut *Grid::<N>::lock_fixture(), &mut *Grid::<N>::lock_fixture_of_two());
    let (mesh, up) = subject.to_mesh(&mut one.start, &mut one.bit_grid)?;
    let baker_of_two = &mut *<Grid<N> as Resident<N, 2>>::lock_baker();
    let baker = &mut *<Grid<N> as Resident<N, 1>>::lock_baker();
    let mut best_of_two = f64::INFINITY;
    let mut run_ours_ms = || {
        let ms = bake_ms(&mesh, up, baker_of_two, two);
        best_of_two = best_of_two.min(ms);
        bake_ms(&mesh, up, baker, one)
    };
    let best = (0..runs).map(|_| run_ours_ms()).fold(f64::INFINITY, f64::min);
    let pitch = voxel_pitch::<N>(&mesh, up);
    let timed = time_bake_with_peer(&mesh, pitch, runs, peers, &mut run_ours_ms);
    let row = |against: String| ReportRow::new("bake", subject.name(), N, against);
    let name = "voxelized().fill()";
    Ok(match timed {
        Ok(PeerTiming { version, times_ms, runs: count }) => {
            let few = if count < runs { format!(", best of {count}") } else { String::new() };
            let with_ours_ms =
                |row: ReportRow, ours| row.with_times_ms(OursTheirs { ours, ..times_ms });
            let against = format!("trimesh {version} {name}{few}");
            let of_two = row(format!("{against}{OURS_OF_TWO}"));
            let rows = vec![
                with_ours_ms(row(against), best.min(times_ms.ours)),
                with_ours_ms(of_two, best_of_two),
            ];
            Measured { rows, skipped: None }
        }
        Err(why) => {
            let against = format!("trimesh {name}");
            let of_two = row(format!("{against}{OURS_OF_TWO}"));
            let rows =
                vec![row(against).with_our_time_ms(best), of_two.with_our_time_ms(best_of_two)];
            Measured { rows, skipped: Some(format!("trimesh: {why}")) }
        }
    })
}

/// Returns the milliseconds from triangles in memory to the tight maps of a fixture.
pub(super) fn bake_ms<const N: usize, const K: usize, W: Windings<N>>(
    mesh: &Mesh,
    up: UpAxis,
    baker: &mut Baker<N, W>,
    fixture: &mut Fixture<N, K>,
) -> f64
where
    Grid<N>: Size,
{
    time_ms(|| mesh.bake_into_maps(up, baker, &mut fixture.start, &mut fixture.bit_grid))
}

/// Times our bake and the rival's in turns. Returns the reason if the rival can't be run. `voxel_pitch` is a
/// voxel's side in mesh units.
fn time_bake_with_peer(
    mesh: &Mesh,
    voxel_pitch: f64,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
    mut run_ours_ms: impl FnMut() -> f64,
) -> Result<PeerTiming, String> {
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.send_mesh(mesh, voxel_pitch)?;
        let first = peers.run_request_ms("fill")?;
        let count = if first > SLOW_MS { SLOW_RUNS.min(runs) } else { runs };
        let best = min_in_turns_ms(count, || Ok(run_ours_ms()), || peers.run_request_ms("fill"))?;
        let times_ms = OursTheirs { theirs: best.theirs.min(first), ..best };
        Ok(PeerTiming { version, times_ms, runs: count })
    };
    go().map_err(|missing: MissingPeer| missing.to_string())
}

/// Returns the side of a voxel, in mesh units, for a mesh that fills a grid of N.
fn voxel_pitch<const N: usize>(mesh: &Mesh, up: UpAxis) -> f64 {
    mesh.bounding_box()
        .and_then(|MeshBounds { min, max }| MeshPlacement::stand_bounds_on_floor(min, max, up, N))
        .map_or(1.0, |placement| 1.0 / placement.voxels_per_unit())
}
