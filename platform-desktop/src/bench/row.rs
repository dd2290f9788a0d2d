//! Rows: what was measured, as JSON or as a table.

use serde::Serialize;

/// One measurement of ours beside one of another's.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Row {
    /// Which bench.
    pub bench: &'static str,
    /// What it was run on.
    pub volume: String,
    /// Voxels along an edge.
    pub size: usize,
    /// Milliseconds of ours. None for what is no time.
    pub ours_ms: Option<f64>,
    /// What it is measured against, or the name of a figure that stands alone.
    pub against: String,
    /// Milliseconds of the other's. None where it didn't run, or where there is none.
    pub against_ms: Option<f64>,
    /// The other's time over ours: above 1 ours is faster.
    pub ratio: Option<f64>,
    /// Instructions, where those were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instructions: Option<u64>,
    /// Bytes, where that is the figure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
}

impl Row {
    /// A row without figures.
    pub(super) fn new(
        bench: &'static str,
        volume: &str,
        size: usize,
        against: impl Into<String>,
    ) -> Self {
        Row {
            bench,
            volume: volume.into(),
            size,
            ours_ms: None,
            against: against.into(),
            against_ms: None,
            ratio: None,
            instructions: None,
            bytes: None,
        }
    }

    /// With the times of both sides.
    pub(super) fn times(self, [ours, theirs]: [f64; 2]) -> Self {
        Row { ours_ms: Some(ours), against_ms: Some(theirs), ratio: Some(theirs / ours), ..self }
    }

    /// With our time alone.
    pub(super) fn ours(self, ours: f64) -> Self {
        Row { ours_ms: Some(ours), ..self }
    }
}

/// The rows as an aligned table.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    const HEAD: [&str; 7] = ["bench", "volume", "size", "ours", "theirs", "ratio", "against"];
    let mut cells = vec![HEAD.map(String::from)];
    cells.extend(rows.iter().map(row_cells));
    let width = |i: usize| cells.iter().map(|row| row[i].chars().count()).max();
    let widths: Vec<usize> = (0..HEAD.len()).filter_map(width).collect();
    let mut lines = String::new();
    for row in &cells {
        for (i, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            let last = i == HEAD.len() - 1;
            match i {
                2..=5 => lines.push_str(&format!("{cell:>width$}  ")),
                _ if last => lines.push_str(cell),
                _ => lines.push_str(&format!("{cell:width$}  ")),
            }
        }
        lines.push('\n');
    }
    lines
}

fn row_cells(row: &Row) -> [String; 7] {
    let ms = |ms: Option<f64>| ms.map_or_else(|| "-".into(), milliseconds);
    let figure = match (row.instructions, row.bytes) {
        (Some(count), _) => format!("{count} instructions"),
        (_, Some(bytes)) => format!("{bytes} bytes"),
        _ => ms(row.ours_ms),
    };
    [
        row.bench.into(),
        row.volume.clone(),
        row.size.to_string(),
        figure,
        ms(row.against_ms),
        row.ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.2}")),
        row.against.clone(),
    ]
}

/// Four digits or more.
fn milliseconds(ms: f64) -> String {
    match ms {
        ms if ms < 0.1 => format!("{:.2} us", ms * 1e3),
        ms if ms < 10.0 => format!("{ms:.3} ms"),
        ms => format!("{ms:.1} ms"),
    }
}
