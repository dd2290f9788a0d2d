//! Counters for Prometheus.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

/// The counters since the start.
#[derive(Default)]
pub(crate) struct Metrics {
    /// The number of responses by the first digit of their status, from 2.
    answers: [AtomicU64; 4],
    /// Heartbeats answered.
    pub heartbeats: Count,
    /// Bytes of parcels that arrived.
    pub parcel_bytes: Count,
    /// Parcels kept.
    pub parcels: Count,
    /// Connections that are open.
    pub connections: Count,
    /// Connections that were rejected, as every open connection was kept by its holder.
    pub turned_away: Count,
    /// Connections that were closed to make room for others.
    pub closed_early: Count,
}

/// A counter that several threads may change.
#[derive(Default)]
pub(crate) struct Count(AtomicU64);

impl Count {
    /// Adds to the counter.
    pub(crate) fn add(&self, more: u64) {
        self.0.fetch_add(more, Ordering::Relaxed);
    }

    /// Subtracts one.
    pub(crate) fn subtract_one(&self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }

    /// Returns the count.
    #[must_use]
    pub(crate) fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Metrics {
    /// Counts a response.
    pub(crate) fn count_answer(&self, status: u16) {
        let place = usize::from(status / 100).clamp(2, 5) - 2;
        self.answers[place].fetch_add(1, Ordering::Relaxed);
    }

    /// Writes all counters in Prometheus' text format, followed by `gauges`: name, help, value.
    #[must_use]
    pub(crate) fn write(&self, gauges: &[(&str, &str, u64)]) -> String {
        let mut text = String::new();
        let head = |text: &mut String, name: &str, help: &str, kind: &str| {
            // Writing to a String doesn't fail.
            let _ = write!(text, "# HELP {name} {help}\n# TYPE {name} {kind}\n");
        };
        let name = "paros_booth_answers_total";
        head(&mut text, name, "Requests by the class of their answer's status.", "counter");
        for (k, answers) in self.answers.iter().enumerate() {
            let count = answers.load(Ordering::Relaxed);
            let _ = writeln!(text, "{name}{{class=\"{}xx\"}} {count}", k + 2);
        }
        for (name, help, count) in [
            ("paros_booth_heartbeats_total", "Heartbeats answered.", &self.heartbeats),
            ("paros_booth_parcel_bytes_total", "Bytes of parcels received.", &self.parcel_bytes),
            ("paros_booth_parcels_total", "Parcels kept.", &self.parcels),
            (
                "paros_booth_closed_early_total",
                "Connections closed to make room.",
                &self.closed_early,
            ),
            ("paros_booth_turned_away_total", "Connections turned away.", &self.turned_away),
        ] {
            head(&mut text, name, help, "counter");
            let _ = writeln!(text, "{name} {}", count.get());
        }
        let open = ("paros_booth_connections", "Connections open.", self.connections.get());
        for (name, help, value) in std::iter::once(&open).chain(gauges) {
            head(&mut text, name, help, "gauge");
            let _ = writeln!(text, "{name} {value}");
        }
        text
    }
}
