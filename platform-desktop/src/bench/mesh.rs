//! `bench mesh`: from bit rows to smoothed STL bytes, against VTK.

use paros_core::export::{Exporter, Stage};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_shell::print::HEIGHT_MM;
use paros_shell::statics::Resident;

use super::clock::{duel, timed};
use super::peers::{Missing, Peers};
use super::rig::Rigged;
use super::row::Row;
use super::subject::{Subject, print};
use crate::error::Error;

/// What the rows are called, and what the peer calls it.
const AGAINST: [(&str, &str); 2] =
    [("edges", "FlyingEdges3D"), ("smooth", "FlyingEdges3D, SmoothPolyDataFilter 2 x 0.5")];

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
    let exporter = &mut Grid::<N>::press().exporter;
    subject.load(&mut rig.start, &mut rig.plane)?;
    let mut buffer = vec![0; print(&rig.plane, &rig.mask, exporter).len()];
    let (mut rows, mut skipped) = (vec![], None);
    for (request, name) in AGAINST {
        let ours = || export(&rig.plane, &rig.mask, exporter, &mut buffer);
        match against(&rig.plane, runs, peers, request, ours) {
            Ok((version, times)) => {
                let against = format!("VTK {version} {name}");
                rows.push(Row::new("mesh", subject.name(), N, against).times(times));
            }
            Err(why) => {
                let ours = (0..runs).map(|_| export(&rig.plane, &rig.mask, exporter, &mut buffer));
                let best = ours.fold(f64::INFINITY, f64::min);
                let against = format!("VTK {name}");
                rows.push(Row::new("mesh", subject.name(), N, against).ours(best));
                skipped = Some(format!("VTK: {why}"));
            }
        }
    }
    Ok((rows, skipped))
}

fn against<const N: usize>(
    plane: &Plane<N>,
    runs: usize,
    peers: &mut Result<Peers, Missing>,
    request: &str,
    mut ours: impl FnMut() -> f64,
) -> Result<(String, [f64; 2]), String>
where
    Grid<N>: Size,
{
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.voxels(plane)?;
        Ok((version, duel(runs, || Ok(ours()), || peers.run(request))?))
    };
    go().map_err(|missing: Missing| missing.to_string())
}

/// Milliseconds from start to the last byte in the buffer, which the file just fills.
fn export<const N: usize>(
    plane: &Plane<N>,
    mask: &Maps<N>,
    exporter: &mut Exporter<N>,
    buffer: &mut [u8],
) -> f64
where
    Grid<N>: Size,
{
    timed(|| {
        exporter.start(HEIGHT_MM).expect("a usual height");
        let mut written = 0;
        loop {
            let progress = exporter.advance(plane, mask, u32::MAX, &mut buffer[written..]);
            written += progress.written;
            if progress.stage == Stage::Done {
                return written;
            }
        }
    })
}
