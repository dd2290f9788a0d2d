//! `bench bake`: from triangles in memory to tight maps, against trimesh.

use paros_core::{Grid, MeshPlacement, Size, UpAxis};
use paros_headless::Error;
use paros_shell::mesh::Mesh;
use paros_shell::statics::Resident;

use super::clock::{best_in_turns_ms, time_ms};
use super::fixture::HasFixture;
use super::peers::{MissingPeer, PythonPeers};
use super::row::ReportRow;
use super::subject::Subject;

/// A rival slower than this is run [`SLOW_RUNS`] times only, and the row says so.
const SLOW_MS: f64 = 1000.0;
const SLOW_RUNS: usize = 3;

/// The rows, and why the rival did not run if it did not.
pub(super) fn measure_rows<const N: usize>(
    subject: &Subject,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
) -> Result<(Vec<ReportRow>, Option<String>), Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let (mesh, up) = subject.to_mesh(&mut fixture.start, &mut fixture.plane)?;
    let mut baker = Grid::<N>::lock_baker();
    let mut ours =
        || time_ms(|| mesh.bake_into_maps(up, &mut *baker, &mut fixture.start, &mut fixture.plane));
    let best = (0..runs).map(|_| ours()).fold(f64::INFINITY, f64::min);
    let row = |against: String| ReportRow::new("bake", subject.name(), N, against);
    let name = "voxelized().fill()";
    Ok(match time_with_peer(&mesh, voxel_pitch::<N>(&mesh, up), runs, peers, &mut ours) {
        Ok((version, times, count)) => {
            let few = if count < runs { format!(", best of {count}") } else { String::new() };
            let times = [best.min(times[0]), times[1]];
            (vec![row(format!("trimesh {version} {name}{few}")).with_times_ms(times)], None)
        }
        Err(why) => (
            vec![row(format!("trimesh {name}")).with_our_time_ms(best)],
            Some(format!("trimesh: {why}")),
        ),
    })
}

/// The rival's version, milliseconds of ours and theirs, and the number of runs compared.
fn time_with_peer(
    mesh: &Mesh,
    pitch: f64,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
    mut ours: impl FnMut() -> f64,
) -> Result<(String, [f64; 2], usize), String> {
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.send_mesh(mesh, pitch)?;
        let first = peers.run_ms("fill")?;
        let count = if first > SLOW_MS { SLOW_RUNS.min(runs) } else { runs };
        let [ours, theirs] = best_in_turns_ms(count, || Ok(ours()), || peers.run_ms("fill"))?;
        Ok((version, [ours, theirs.min(first)], count))
    };
    go().map_err(|missing: MissingPeer| missing.to_string())
}

/// The side of a voxel, in mesh units, when the mesh fills a grid of N.
fn voxel_pitch<const N: usize>(mesh: &Mesh, up: UpAxis) -> f64 {
    mesh.bounding_box()
        .and_then(|(min, max)| MeshPlacement::fit_bounds(min, max, up, N))
        .map_or(1.0, |placement| 1.0 / placement.voxels_per_unit())
}
