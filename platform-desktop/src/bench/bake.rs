//! `bench bake`: from triangles in memory to tight maps, against trimesh.

use paros_core::bake::{Placement, Up};
use paros_core::size::{Grid, Size};
use paros_shell::statics::Resident;

use super::clock::{duel, timed};
use super::peers::{Missing, Peers};
use super::rig::Rigged;
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;
use crate::mesh::Mesh;

/// A peer that takes longer than so many milliseconds is run fewer times, and the row says so.
const SLOW_MS: f64 = 1000.0;
const SLOW_RUNS: usize = 3;

/// The rows, and why the peer is missing if it is.
pub(super) fn rows<const N: usize>(
    subject: &Subject,
    runs: usize,
    peers: &mut Result<Peers, Missing>,
) -> Result<(Vec<Row>, Option<String>), Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    let (mesh, up) = subject.triangles(&mut rig.start, &mut rig.plane)?;
    let mut baker = Grid::<N>::baker();
    let mut ours = || timed(|| mesh.bake(up, &mut *baker, &mut rig.start, &mut rig.plane));
    let best = (0..runs).map(|_| ours()).fold(f64::INFINITY, f64::min);
    let row = |against: String| Row::new("bake", subject.name(), N, against);
    let name = "voxelized().fill()";
    Ok(match against(&mesh, pitch::<N>(&mesh, up), runs, peers, &mut ours) {
        Ok((version, times, count)) => {
            let few = if count < runs { format!(", best of {count}") } else { String::new() };
            let times = [best.min(times[0]), times[1]];
            (vec![row(format!("trimesh {version} {name}{few}")).times(times)], None)
        }
        Err(why) => {
            (vec![row(format!("trimesh {name}")).ours(best)], Some(format!("trimesh: {why}")))
        }
    })
}

/// The peer's version, the times of both, and how many runs the peer's is the best of.
fn against(
    mesh: &Mesh,
    pitch: f64,
    runs: usize,
    peers: &mut Result<Peers, Missing>,
    mut ours: impl FnMut() -> f64,
) -> Result<(String, [f64; 2], usize), String> {
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.mesh(mesh, pitch)?;
        let first = peers.run("fill")?;
        let count = if first > SLOW_MS { SLOW_RUNS.min(runs) } else { runs };
        let [ours, theirs] = duel(count, || Ok(ours()), || peers.run("fill"))?;
        Ok((version, [ours, theirs.min(first)], count))
    };
    go().map_err(|missing: Missing| missing.to_string())
}

/// The side of a voxel in mesh units.
fn pitch<const N: usize>(mesh: &Mesh, up: Up) -> f64 {
    mesh.bounds()
        .and_then(|(min, max)| Placement::fit(min, max, up, N))
        .map_or(1.0, |placement| 1.0 / placement.voxels_per_unit())
}
