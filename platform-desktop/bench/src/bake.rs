//! `bench bake`: from triangles in memory to tight maps, against trimesh.

use paros_core::convert::{MeshPlacement, UpAxis};
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shell::mesh::{Mesh, MeshBounds};
use paros_shell::statics::Resident;

use super::clock::{OursTheirs, min_in_turns_ms, time_ms};
use super::fixture::HasFixture;
use super::peers::{MissingPeer, PeerTiming, PythonPeers};
use super::row::{Measured, ReportRow};
use super::subject::Subject;

/// A rival slower than this is run [`SLOW_RUNS`] times only, and the row says so.
const SLOW_MS: f64 = 1000.0;
const SLOW_RUNS: usize = 3;

pub(super) fn measure_rows<const N: usize>(
    subject: &Subject,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
) -> Result<Measured, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let (mesh, up) = subject.to_mesh(&mut fixture.start, &mut fixture.bit_grid)?;
    let mut baker = Grid::<N>::lock_baker();
    let mut ours = || {
        time_ms(|| mesh.bake_into_maps(up, &mut *baker, &mut fixture.start, &mut fixture.bit_grid))
    };
    let best = (0..runs).map(|_| ours()).fold(f64::INFINITY, f64::min);
    let row = |against: String| ReportRow::new("bake", subject.name(), N, against);
    let name = "voxelized().fill()";
    Ok(match time_bake_with_peer(&mesh, voxel_pitch::<N>(&mesh, up), runs, peers, &mut ours) {
        Ok(PeerTiming { version, times_ms, runs: count }) => {
            let few = if count < runs { format!(", best of {count}") } else { String::new() };
            let times_ms = OursTheirs { ours: best.min(times_ms.ours), ..times_ms };
            let row = row(format!("trimesh {version} {name}{few}")).with_times_ms(times_ms);
            Measured { rows: vec![row], skipped: None }
        }
        Err(why) => Measured {
            rows: vec![row(format!("trimesh {name}")).with_our_time_ms(best)],
            skipped: Some(format!("trimesh: {why}")),
        },
    })
}

/// Times ours beside the rival's, or tells why the rival can't be run. `voxel_pitch` is a voxel's side
/// in mesh units.
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

/// The side of a voxel, in mesh units, when the mesh fills a grid of N.
fn voxel_pitch<const N: usize>(mesh: &Mesh, up: UpAxis) -> f64 {
    mesh.bounding_box()
        .and_then(|MeshBounds { min, max }| MeshPlacement::stand_bounds_on_floor(min, max, up, N))
        .map_or(1.0, |placement| 1.0 / placement.voxels_per_unit())
}
