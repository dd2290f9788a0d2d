//! `bench mesh`: the time from bit rows to smoothed STL bytes, against VTK.

use paros_core::convert::ExportPhase;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Exporter, RangeMaps};
use paros_headless::Error;
use paros_shell::statics::Resident;
use paros_shell::stl_export::DEFAULT_HEIGHT_MM;

use super::clock::{min_in_turns_ms, time_ms};
use super::fixture::HasFixture;
use super::peers::{MissingPeer, PeerTiming, PythonPeers};
use super::row::{Measured, ReportRow};
use super::subject::{BenchSubject, export_stl};

/// Each request to the rival, and the name of its row.
const AGAINST: [(&str, &str); 2] =
    [("edges", "FlyingEdges3D"), ("smooth", "FlyingEdges3D, SmoothPolyDataFilter 2 x 0.5")];

pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
) -> Result<Measured, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let exporter = &mut Grid::<N>::lock_stl_buffers().exporter;
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    let mut buffer = vec![0; export_stl(&fixture.bit_grid, &fixture.mask, exporter).len()];
    let (mut rows, mut skipped) = (vec![], None);
    for (request, name) in AGAINST {
        let ours = || export_ms(&fixture.bit_grid, &fixture.mask, exporter, &mut buffer);
        match time_export_with_peer(&fixture.bit_grid, runs, peers, request, ours) {
            Ok(PeerTiming { version, times_ms, .. }) => {
                let against = format!("VTK {version} {name}");
                rows.push(
                    ReportRow::new("mesh", subject.name(), N, against).with_times_ms(times_ms),
                );
            }
            Err(why) => {
                let ours = (0..runs)
                    .map(|_| export_ms(&fixture.bit_grid, &fixture.mask, exporter, &mut buffer));
                let best = ours.fold(f64::INFINITY, f64::min);
                let against = format!("VTK {name}");
                rows.push(
                    ReportRow::new("mesh", subject.name(), N, against).with_our_time_ms(best),
                );
                skipped = Some(format!("VTK: {why}"));
            }
        }
    }
    Ok(Measured { rows, skipped })
}

/// Times our export and the rival's answer to `request`. Returns the reason if the rival can't be run.
fn time_export_with_peer<const N: usize>(
    bit_grid: &BitGrid<N>,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
    request: &str,
    mut run_ours_ms: impl FnMut() -> f64,
) -> Result<PeerTiming, String>
where
    Grid<N>: Size,
{
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.send_voxels(bit_grid)?;
        let theirs = || peers.run_request_ms(request);
        let times_ms = min_in_turns_ms(runs, || Ok(run_ours_ms()), theirs)?;
        Ok(PeerTiming { version, times_ms, runs })
    };
    go().map_err(|missing: MissingPeer| missing.to_string())
}

/// Returns the milliseconds from the start to the last byte in the buffer, which the file fills exactly.
pub(super) fn export_ms<const N: usize, const K: usize>(
    bit_grid: &BitGrid<N>,
    mask: &RangeMaps<N, K>,
    exporter: &mut Exporter<N>,
    buffer: &mut [u8],
) -> f64
where
    Grid<N>: Size,
{
    time_ms(|| {
        exporter.start_export(DEFAULT_HEIGHT_MM).expect("a usual height");
        let mut written = 0;
        loop {
            let progress =
                exporter.advance_export(bit_grid, mask, u32::MAX, &mut buffer[written..]);
            written += progress.written;
            if progress.phase == ExportPhase::Done {
                return written;
            }
        }
    })
}
