//! `bench layers`: the cost of two intervals a column compared to one, on the same voxels. In the rows, two
//! intervals are always "ours".

use paros_core::World;
use paros_core::limits::max_save_bytes;
use paros_core::volume::{BitSet, Grid, Size};
use paros_headless::Error;
use paros_shaders::gpu::{PaperVariant, RenderPath};
use paros_shell::rmap::RmapHeader;
use paros_shell::sizes::GRID_SIDES;
use paros_shell::statics::Resident;
use paros_shell::with_size;

use super::bake::bake_ms;
use super::clock::{OursTheirs, min_in_turns_ms};
use super::edit::{CARVE, FILL, mean_edit_in_one_stroke_ms, sample_surface_voxels};
use super::fixture::{Fixture, HasFixture};
use super::frames::{FrameFormat, FrameTimer, RenderSetup};
use super::islands::{PASS_CASES, PassCase, load_pass_case, whole_paper_pass_ms, whole_pass_ms};
use super::mesh::export_ms;
use super::paper::VoxelFill;
use super::render::load_and_fit_framings;
use super::row::ReportRow;
use super::subject::{BenchSubject, export_stl};

const BENCH: &str = "layers";

/// One eye and one sample, and a headset's frame.
const FRAME_FORMATS: [FrameFormat; 2] = [FrameFormat::ALL[0], FrameFormat::HEADSET];

/// Measures the time of an edit, an island pass, an export and a bake.
pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N> + Resident<N, 2>,
{
    let (one, two) = (&mut *Grid::<N>::lock_fixture(), &mut *Grid::<N>::lock_fixture_of_two());
    let mut rows = measure_edits(subject, runs, one, two)?;
    rows.extend(measure_passes(subject, runs, one, two)?);
    rows.push(measure_export(subject, runs, one, two)?);
    rows.push(measure_bake(subject, runs, one, two)?);
    Ok(rows)
}

/// Measures the time of a frame by the paper's path, on the device's clock.
pub(super) fn measure_frames(
    subject: &BenchSubject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error> {
    let framings = load_and_fit_framings(subject, &FRAME_FORMATS, timer)?;
    let path = RenderPath::Paper(PaperVariant::Whole);
    let setups: Vec<RenderSetup> = framings
        .iter()
        .flat_map(|framing| [framing.of_two_intervals(), *framing])
        .map(|framing| RenderSetup::picture(framing, path))
        .collect();
    let mut rows = vec![];
    for format in FRAME_FORMATS {
        let times_ms = timer.mean_of_best_ms_per_setup(&setups, format, runs)?;
        for (framing, &[ours, theirs]) in framings.iter().zip(times_ms.as_chunks::<2>().0) {
            let against = format!("the paper's path with one interval a column; {}", format.name());
            rows.push(ReportRow {
                device: Some(timer.device_name().into()),
                filled: Some(framing.filled),
                ..ReportRow::new(BENCH, subject.name(), framing.volume.grid_side(), against)
                    .with_times_ms(OursTheirs { ours, theirs })
            });
        }
    }
    Ok(rows)
}

/// Returns rows for the bytes of the world, of a volume's file, and of the largest save.
pub(super) fn size_rows() -> Vec<ReportRow> {
    let rows = |side| with_size!(side, N => [size_rows_at::<N, 1>(), size_rows_at::<N, 2>()]);
    GRID_SIDES.into_iter().flat_map(rows).flatten().collect()
}

fn size_rows_at<const N: usize, const K: usize>() -> [ReportRow; 3]
where
    Grid<N>: Size,
{
    let header = RmapHeader { version: K as u16, grid_side: N, intervals_per_column: K };
    [
        (format!("size of World<{N}, {K}>"), size_of::<World<N, K>>()),
        (format!("size of a volume's file, {}", name_intervals(K)), header.file_length()),
        (format!("size of a save at most, {}", name_intervals(K)), max_save_bytes(N, K)),
    ]
    .map(|(what, bytes)| size_row("any", N, what, bytes))
}

/// Names the number of intervals; `count` is 1 or 2.
pub(super) fn name_intervals(count: usize) -> &'static str {
    if count == 1 { "one interval a column" } else { "two intervals a column" }
}

/// Returns a row that only has a number of bytes.
pub(super) fn size_row(volume: &str, grid_side: usize, what: String, bytes: usize) -> ReportRow {
    ReportRow { bytes: Some(bytes as u64), ..ReportRow::new(BENCH, volume, grid_side, what) }
}

/// Measures the carve and the fill of `bench edit`.
fn measure_edits<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    one: &mut Fixture<N>,
    two: &mut Fixture<N, 2>,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    subject.load_into(&mut one.start, &mut one.bit_grid)?;
    one.bit_grid.write_closure(&mut two.start);
    let voxels = sample_surface_voxels(&one.bit_grid);
    let mut rows = vec![];
    for (operation, name) in [(CARVE, "a carve"), (FILL, "a fill")] {
        let times_ms = min_in_turns_ms(
            runs,
            || Ok::<_, Error>(mean_edit_in_one_stroke_ms(two, &voxels, operation)),
            || Ok(mean_edit_in_one_stroke_ms(one, &voxels, operation)),
        )?;
        let against = format!("{name} of radius 6 with one interval a column");
        rows.push(ReportRow::new(BENCH, subject.name(), N, against).with_times_ms(times_ms));
    }
    Ok(rows)
}

/// Measures the passes of `bench islands` with two intervals, beside one interval and beside the paper's
/// queue, which has one interval.
fn measure_passes<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    one: &mut Fixture<N>,
    two: &mut Fixture<N, 2>,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let mut paper = VoxelFill::<N>::new();
    let mut rows = vec![];
    for PassCase { has_island, name: what } in PASS_CASES {
        load_pass_case(subject, one, has_island)?;
        one.bit_grid.write_closure(&mut two.start);
        let mut of_paper = f64::INFINITY;
        let times_ms = min_in_turns_ms(
            runs,
            || Ok::<_, Error>(whole_pass_ms(two)),
            || {
                of_paper = of_paper.min(whole_paper_pass_ms(one, &mut paper));
                Ok(whole_pass_ms(one))
            },
        )?;
        check_two_keeps_no_more(one, two, subject.name())?;
        let row =
            |against: &str| ReportRow::new(BENCH, subject.name(), N, format!("{against}, {what}"));
        rows.push(row("an island pass with one interval a column").with_times_ms(times_ms));
        let times_ms = OursTheirs { theirs: of_paper, ..times_ms };
        rows.push(row("the paper's voxel queue at once").with_times_ms(times_ms));
    }
    Ok(rows)
}

/// Compares the results of passes with one interval and with two on the same voxels. Closure with two
/// intervals must not keep more than with one.
fn check_two_keeps_no_more<const N: usize>(
    one: &Fixture<N>,
    two: &Fixture<N, 2>,
    name: &str,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    let (one, two) = (one.volume.rows(), two.volume.rows());
    let is_within = |y| one.layer(y).iter().zip(two.layer(y)).all(|(a, b)| (*b & !*a).is_empty());
    if !(0..N).all(is_within) {
        let what = format!("{name} at {N}: a pass keeps more with two intervals a column");
        return Err(Error::Failure(what));
    }
    Ok(())
}

/// Measures the export of `bench mesh`.
fn measure_export<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    one: &mut Fixture<N>,
    two: &mut Fixture<N, 2>,
) -> Result<ReportRow, Error>
where
    Grid<N>: Size + HasFixture<N> + Resident<N, 2>,
{
    subject.load_into(&mut one.start, &mut one.bit_grid)?;
    one.bit_grid.write_closure(&mut two.start);
    two.bit_grid.set_from_maps(&two.start);
    let exporter_of_one = &mut <Grid<N> as Resident<N, 1>>::lock_stl_buffers().exporter;
    let exporter_of_two = &mut <Grid<N> as Resident<N, 2>>::lock_stl_buffers().exporter;
    let mut file_of_one = export_stl(&one.bit_grid, &one.mask, exporter_of_one);
    let mut file_of_two = export_stl(&two.bit_grid, &two.mask, exporter_of_two);
    if file_of_one != file_of_two {
        let what = format!("{} at {N}: the exports of the same voxels differ", subject.name());
        return Err(Error::Failure(what));
    }
    let times_ms = min_in_turns_ms(
        runs,
        || Ok::<_, Error>(export_ms(&two.bit_grid, &two.mask, exporter_of_two, &mut file_of_two)),
        || Ok(export_ms(&one.bit_grid, &one.mask, exporter_of_one, &mut file_of_one)),
    )?;
    let against = "an export with one interval a column";
    Ok(ReportRow::new(BENCH, subject.name(), N, against).with_times_ms(times_ms))
}

/// Measures the bake of `bench bake`. Its gaps are the mesh's own.
fn measure_bake<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    one: &mut Fixture<N>,
    two: &mut Fixture<N, 2>,
) -> Result<ReportRow, Error>
where
    Grid<N>: Size + HasFixture<N> + Resident<N, 2>,
{
    let (mesh, up) = subject.to_mesh(&mut one.start, &mut one.bit_grid)?;
    let baker_of_one = &mut *<Grid<N> as Resident<N, 1>>::lock_baker();
    let baker_of_two = &mut *<Grid<N> as Resident<N, 2>>::lock_baker();
    let times_ms = min_in_turns_ms(
        runs,
        || Ok::<_, Error>(bake_ms(&mesh, up, baker_of_two, two)),
        || Ok(bake_ms(&mesh, up, baker_of_one, one)),
    )?;
    let against = "a bake with one interval a column";
    Ok(ReportRow::new(BENCH, subject.name(), N, against).with_times_ms(times_ms))
}
