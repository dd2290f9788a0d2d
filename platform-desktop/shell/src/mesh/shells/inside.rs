//! Containment of shells in others: winding numbers of sample points, by rays along z.

use super::edges::Connections;
use super::{Mesh, Shell, area_vector};
use std::collections::HashMap;

/// The most shells that are compared.
const MAX_COMPARED: usize = 4096;
/// The approximate number of points that are tried in all, and the most points of one shell.
const POINTS: usize = 8192;
const POINTS_OF_SHELL: usize = 32;

/// For each shell, the shells that contain it.
pub(super) struct Containment {
    containers: HashMap<usize, Vec<usize>>,
}

/// A point of a shell.
struct Sample {
    shell: usize,
    at: [f64; 3],
}

impl Containment {
    /// Returns a containment in which no shell lies inside another.
    pub(super) fn none() -> Self {
        Containment { containers: HashMap::new() }
    }

    /// Compares the shells that are `clear`. Returns `None` if there are more than [`MAX_COMPARED`].
    pub(super) fn find(
        mesh: &Mesh,
        connections: &Connections,
        shells: &[Shell],
        clear: &[usize],
    ) -> Option<Self> {
        if clear.len() > MAX_COMPARED {
            return None;
        }
        let mut samples = sample_shells(mesh, connections, shells, clear);
        samples.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
        // For each sample and shell, the winding number of the shell around the sample.
        let mut windings: HashMap<(usize, usize), i32> = HashMap::new();
        for (facet, triangle) in mesh.triangles.iter().enumerate() {
            let shell = connections.shell_of(facet);
            if clear.binary_search(&shell).is_err() {
                continue;
            }
            let corners = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
            let low = corners.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|c| c[0]).fold(f64::NEG_INFINITY, f64::max);
            let first = samples.partition_point(|sample| sample.at[0] < low);
            let near = samples[first..].iter().take_while(|sample| sample.at[0] <= high);
            let sign = if connections.is_turned(facet) { -1 } else { 1 };
            for (i, sample) in near.enumerate() {
                let crossed = crossing_above(&corners, sample.at);
                if crossed != 0 && sample.shell != shell {
                    *windings.entry((first + i, shell)).or_default() += sign * crossed;
                }
            }
        }
        Some(Self::from_windings(shells, &samples, &windings))
    }

    /// Finds containments: a shell lies inside another, larger one that winds around all its samples.
    fn from_windings(
        shells: &[Shell],
        samples: &[Sample],
        windings: &HashMap<(usize, usize), i32>,
    ) -> Self {
        let mut totals: HashMap<usize, usize> = HashMap::new();
        samples.iter().for_each(|sample| *totals.entry(sample.shell).or_default() += 1);
        let mut inside: HashMap<(usize, usize), usize> = HashMap::new();
        for (&(sample, container), &winding) in windings {
            let shell = samples[sample].shell;
            *inside.entry((shell, container)).or_default() += usize::from(winding != 0);
        }
        let mut found = Containment::none();
        for (&(shell, container), count) in &inside {
            let (a, b) = (&shells[shell], &shells[container]);
            let is_within = (0..3).all(|k| a.low[k] >= b.low[k] && a.high[k] <= b.high[k]);
            if is_within && Some(count) == totals.get(&shell) {
                found.containers.entry(shell).or_default().push(container);
            }
        }
        found
    }

    /// Returns the shells around a shell, in arbitrary order.
    pub(super) fn containers_of(&self, shell: usize) -> &[usize] {
        self.containers.get(&shell).map_or(&[], Vec::as_slice)
    }
}

/// Samples the middles of facets spread over each shell.
fn sample_shells(
    mesh: &Mesh,
    connections: &Connections,
    shells: &[Shell],
    clear: &[usize],
) -> Vec<Sample> {
    let most = (POINTS / clear.len().max(1)).clamp(1, POINTS_OF_SHELL);
    let mut seen = vec![0usize; shells.len()];
    let mut samples = Vec::new();
    for (facet, triangle) in mesh.triangles.iter().enumerate() {
        let shell = connections.shell_of(facet);
        let step = shells[shell].facets.div_ceil(most);
        let is_sampled = seen[shell].is_multiple_of(step);
        seen[shell] += 1;
        if is_sampled && clear.binary_search(&shell).is_ok() {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
            samples.push(Sample { shell, at: [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0) });
        }
    }
    samples
}

/// Returns 1 if the ray from a point along z leaves through the triangle's outer side, -1 if it enters there,
/// and 0 if it misses the triangle.
fn crossing_above(corners: &[[f64; 3]; 3], p: [f64; 3]) -> i32 {
    let [a, b, c] = corners;
    let around = [(a, b), (b, c), (c, a)].map(|(a, b)| crossing_of_edge(a, b, p));
    let winding: i32 = around.iter().sum();
    if winding == 0 {
        return 0;
    }
    let [normal_x, normal_y, normal_z] = area_vector(corners);
    let above = normal_x * (a[0] - p[0]) + normal_y * (a[1] - p[1]) + normal_z * (a[2] - p[2]);
    if (above > 0.0) == (normal_z > 0.0) { winding } else { 0 }
}

/// Returns 1 or -1 if the edge, projected to the plane z = 0, crosses the line from a point along x upwards
/// or downwards; 0 otherwise. Reversing the edge only changes the sign.
fn crossing_of_edge(a: &[f64; 3], b: &[f64; 3], p: [f64; 3]) -> i32 {
    if (a[1] > p[1]) == (b[1] > p[1]) {
        return 0;
    }
    let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
    let side = (high[0] - low[0]) * (p[1] - low[1]) - (high[1] - low[1]) * (p[0] - low[0]);
    match (side > 0.0, a[1] < b[1]) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}
