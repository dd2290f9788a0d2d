//! `bench mesh`: from bit rows to smoothed STL bytes, against VTK.

use paros_core::{BitGrid, ExportPhase, Exporter, Grid, RangeMaps, Size};
use paros_headless::Error;
use paros_shell::print::DEFAULT_HEIGHT_MM;
use paros_shell::statics::Resident;

use super::clock::{best_in_turns_ms, time_ms};
use super::fixture::HasFixture;
use super::peers::{MissingPeer, PythonPeers};
use super::row::ReportRow;
use super::subject::{Subject, export_stl};

/// Each request to the rival, and the name of its row.
const AGAINST: [(&str, &str); 2] =
    [("edges", "FlyingEdges3D"), ("smooth", "FlyingEdges3D, SmoothPolyDataFilter 2 x 0.5")];

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
    let exporter = &mut Grid::<N>::lock_print_buffers().exporter;
    subject.load_into(&mut fixture.start, &mut fixture.plane)?;
    let mut buffer = vec![0; export_stl(&fixture.plane, &fixture.mask, exporter).len()];
    let (mut rows, mut skipped) = (vec![], None);
    for (request, name) in AGAINST {
        let ours = || export_ms(&fixture.plane, &fixture.mask, exporter, &mut buffer);
        match time_with_peer(&fixture.plane, runs, peers, request, ours) {
            Ok((version, times)) => {
                let against = format!("VTK {version} {name}");
                rows.push(ReportRow::new("mesh", subject.name(), N, against).with_times_ms(times));
            }
            Err(why) => {
                let ours = (0..runs)
                    .map(|_| export_ms(&fixture.plane, &fixture.mask, exporter, &mut buffer));
                let best = ours.fold(f64::INFINITY, f64::min);
                let against = format!("VTK {name}");
                rows.push(
                    ReportRow::new("mesh", subject.name(), N, against).with_our_time_ms(best),
                );
                skipped = Some(format!("VTK: {why}"));
            }
        }
    }
    Ok((rows, skipped))
}

fn time_with_peer<const N: usize>(
    plane: &BitGrid<N>,
    runs: usize,
    peers: &mut Result<PythonPeers, MissingPeer>,
    request: &str,
    mut ours: impl FnMut() -> f64,
) -> Result<(String, [f64; 2]), String>
where
    Grid<N>: Size,
{
    let peers = peers.as_mut().map_err(|missing| missing.to_string())?;
    let mut go = || {
        let version = peers.send_voxels(plane)?;
        Ok((version, best_in_turns_ms(runs, || Ok(ours()), || peers.run_ms(request))?))
    };
    go().map_err(|missing: MissingPeer| missing.to_string())
}

/// Milliseconds from start to the last byte in the buffer, which the file just fills.
fn export_ms<const N: usize>(
    plane: &BitGrid<N>,
    mask: &RangeMaps<N>,
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
            let progress = exporter.advance_export(plane, mask, u32::MAX, &mut buffer[written..]);
            written += progress.written;
            if progress.phase == ExportPhase::Done {
                return written;
            }
        }
    })
}
