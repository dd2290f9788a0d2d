//! Rows of measured values, as JSON or as a table.

use paros_headless::FetchCounts;
use paros_shell::edit_totals::EditTotals;
use serde::Serialize;

use super::clock::OursTheirs;

/// A measurement of ours beside a rival's.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct ReportRow {
    /// Name of the benchmark.
    pub bench: &'static str,
    /// Name of the volume or other input.
    pub volume: String,
    /// Voxels along an edge.
    pub size: usize,
    /// Our time in milliseconds; `None` for values that are no time.
    pub ours_ms: Option<f64>,
    /// Name of the rival, or of a value that stands alone.
    pub against: String,
    /// The rival's time in milliseconds; `None` if it didn't run or there is no rival.
    pub against_ms: Option<f64>,
    /// The rival's time over ours: above 1 ours is faster.
    pub ratio: Option<f64>,
    /// Number of instructions, if counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instructions: Option<u64>,
    /// Number of bytes, if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// The device that drew, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Fraction of the image that the sculpture fills, if it was drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filled: Option<f32>,
    /// Texels that a pixel fetches, if counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fetches: Option<PixelFetches>,
    /// Additional time of ours in percent, if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub added_percent: Option<f64>,
    /// Our time as a fraction of the whole frame's, or of 1/72 s, in `bench paper`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// The fraction that the paper published.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published: Option<f64>,
    /// Share of voxels that closure refuses, in `bench layers`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refusal: Option<RefusalShare>,
    /// Voxels that a tool removes in a second, if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels_per_second: Option<f64>,
    /// The reason why the row has no values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
}

/// Texels fetched by the pixels that show a sculpture, in a ring of views.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct PixelFetches {
    /// Mean number of texels sampled and loaded.
    pub mean: f64,
    /// Largest number of texels of a fragment.
    pub most: u32,
    /// Mean number of steps of the ray march.
    pub mean_turns: f64,
    /// Largest number of steps of a fragment.
    pub most_turns: u32,
}

impl From<FetchCounts> for PixelFetches {
    fn from(counts: FetchCounts) -> Self {
        PixelFetches {
            mean: counts.mean_fetches(),
            most: counts.most_fetches,
            mean_turns: counts.mean_turns(),
            most_turns: counts.most_turns,
        }
    }
}

impl PixelFetches {
    fn to_text(self) -> String {
        let PixelFetches { mean, most, mean_turns, most_turns } = self;
        format!("{mean:.2} fetches (at most {most}), {mean_turns:.2} turns (at most {most_turns})")
    }
}

/// Share of voxels that closure restores, in percent of the removed and restored voxels together.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct RefusalShare {
    /// The share with one interval a column.
    pub one_percent: f64,
    /// The number of voxels that `one_percent` refers to.
    pub one_voxels: u64,
    /// The share with two intervals a column.
    pub two_percent: f64,
    /// The number of voxels that `two_percent` refers to.
    pub two_voxels: u64,
    /// The largest share of a volume with two intervals, if there are several volumes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_two_percent: Option<f64>,
}

impl RefusalShare {
    /// Returns the shares of the edits with one interval and with two.
    pub(super) fn new(one: &EditTotals, two: &EditTotals) -> Self {
        RefusalShare {
            one_percent: one.closure_percent(),
            one_voxels: one.removed_or_closed(),
            two_percent: two.closure_percent(),
            two_voxels: two.removed_or_closed(),
            worst_two_percent: None,
        }
    }

    fn to_text(self) -> String {
        let worst = self.worst_two_percent.map(|worst| format!(" (at worst {worst:.2} %)"));
        let RefusalShare { one_percent, one_voxels, two_percent, two_voxels, .. } = self;
        let worst = worst.unwrap_or_default();
        format!(
            "refused {two_percent:.2} % of {two_voxels}{worst}, with one {one_percent:.2} % of {one_voxels}"
        )
    }
}

/// Rows, and the reason if some values are missing.
#[derive(Debug)]
pub(super) struct Measured {
    pub(super) rows: Vec<ReportRow>,
    pub(super) skipped: Option<String>,
}

impl ReportRow {
    /// Returns a row without measurements.
    pub(super) fn new(
        bench: &'static str,
        volume: &str,
        grid_side: usize,
        compared_with: impl Into<String>,
    ) -> Self {
        ReportRow {
            bench,
            volume: volume.into(),
            size: grid_side,
            ours_ms: None,
            against: compared_with.into(),
            against_ms: None,
            ratio: None,
            instructions: None,
            bytes: None,
            device: None,
            filled: None,
            fetches: None,
            added_percent: None,
            share: None,
            published: None,
            refusal: None,
            voxels_per_second: None,
            skipped: None,
        }
    }

    /// Returns `true` if another row makes the same comparison, on any volume.
    pub(super) fn is_same_comparison(&self, other: &ReportRow) -> bool {
        (self.bench, self.size, &self.against) == (other.bench, other.size, &other.against)
    }

    /// Returns the row with both sides' milliseconds and their ratio, theirs over ours.
    pub(super) fn with_times_ms(self, OursTheirs { ours, theirs }: OursTheirs<f64>) -> Self {
        ReportRow {
            ours_ms: Some(ours),
            against_ms: Some(theirs),
            ratio: Some(theirs / ours),
            ..self
        }
    }

    /// Returns the row with our milliseconds only.
    pub(super) fn with_our_time_ms(self, ours_ms: f64) -> Self {
        ReportRow { ours_ms: Some(ours_ms), ..self }
    }
}

/// Formats the rows as an aligned text table, after a line for each device that drew.
#[must_use]
pub fn format_table(rows: &[ReportRow]) -> String {
    const HEAD: [&str; COLUMNS] =
        ["bench", "volume", "size", "ours", "theirs", "ratio", "published", "against"];
    let mut cells = vec![HEAD.map(String::from)];
    cells.extend(rows.iter().map(row_cells));
    let width = |i: usize| cells.iter().map(|row| row[i].chars().count()).max();
    let widths: Vec<usize> = (0..COLUMNS).filter_map(width).collect();
    let mut lines = String::new();
    let mut devices: Vec<_> = rows.iter().filter_map(|row| row.device.as_ref()).collect();
    devices.dedup();
    for device in devices {
        lines.push_str(&format!("on {device}\n"));
    }
    let has_published = rows.iter().any(|row| row.published.is_some());
    for row in &cells {
        for (i, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            match i {
                PUBLISHED if !has_published => {}
                2..=PUBLISHED => lines.push_str(&format!("{cell:>width$}  ")),
                _ if i == COLUMNS - 1 => lines.push_str(cell),
                _ => lines.push_str(&format!("{cell:width$}  ")),
            }
        }
        lines.push('\n');
    }
    lines
}

const COLUMNS: usize = 8;
/// Index of the column with the paper's value.
const PUBLISHED: usize = 6;

fn row_cells(row: &ReportRow) -> [String; COLUMNS] {
    let ms = |ms: Option<f64>| ms.map_or_else(|| "-".into(), format_ms);
    let number = |ratio: Option<f64>| ratio.map_or_else(|| "-".into(), format_significant);
    let figure = match (row.instructions, row.bytes) {
        (Some(count), Some(bytes)) => format!("{count} instructions, {bytes} bytes"),
        (Some(count), _) => format!("{count} instructions"),
        (_, Some(bytes)) => format!("{bytes} bytes"),
        _ => match row.voxels_per_second {
            Some(speed) => format!("{speed:.0} voxels/s"),
            None => ms(row.ours_ms),
        },
    };
    let ratio = match row.added_percent {
        Some(percent) => format!("{percent:+.1} %"),
        None => number(row.ratio.or(row.share)),
    };
    let told = row
        .skipped
        .as_ref()
        .map(|why| format!("skipped: {why}"))
        .or(row.refusal.map(RefusalShare::to_text))
        .or(row.fetches.map(PixelFetches::to_text));
    let against = told.map_or(row.against.clone(), |told| format!("{}; {told}", row.against));
    [
        row.bench.into(),
        row.volume.clone(),
        row.size.to_string(),
        figure,
        ms(row.against_ms),
        ratio,
        number(row.published),
        against,
    ]
}

/// Formats a number with three significant digits, or with all digits before the point.
fn format_significant(number: f64) -> String {
    let rounded = format!("{number:.2e}");
    let exponent: i32 = rounded.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    format!("{number:.*}", usize::try_from(2 - exponent).unwrap_or(0))
}

/// Formats milliseconds, in microseconds below 0.1 ms.
fn format_ms(ms: f64) -> String {
    match ms {
        ms if ms < 0.1 => format!("{:.2} us", ms * 1e3),
        ms if ms < 10.0 => format!("{ms:.3} ms"),
        ms => format!("{ms:.1} ms"),
    }
}

#[cfg(test)]
mod tests {
    use super::format_significant;

    #[test]
    fn numbers_have_three_significant_digits() {
        let numbers =
            [0.0, 0.000_123_4, 0.004_267, 0.9996, 1.25, 7.349, 28.06, 99.96, 418.2, 12_345.6];
        let told = numbers.map(format_significant);
        let expected =
            ["0.00", "0.000123", "0.00427", "1.00", "1.25", "7.35", "28.1", "100", "418", "12346"];
        assert_eq!(told, expected);
    }
}
