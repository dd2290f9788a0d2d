//! Connected surfaces: their winding, whether they are closed, and which are cavities.
//!
//! Facets are connected over edges that exactly two facets use. Within a surface all facets are turned to
//! agree with most of its area, and closed surfaces are turned outwards. A closed surface wound inwards is
//! kept if it lies inside an outward one: it is a cavity.

mod edges;
mod inside;

use super::{Mesh, area_vector, outlier};
use edges::Connections;
use inside::Containment;

/// The most surfaces that are examined; a mesh with more is not changed.
const MAX_SHELLS: usize = 1 << 18;

/// A connected surface.
#[derive(Clone, Debug)]
pub(super) struct Shell {
    pub(super) facets: usize,
    /// The least and the greatest coordinates.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Six times the signed volume of the tetrahedra from the mesh's origin, with facets turned to agree with
    /// the first one.
    volume: f64,
    /// Twice the sum of the facets' area vectors.
    area_vector: [f64; 3],
    /// Twice the area of the facets that agree with the first one, and of the others.
    area: [f64; 2],
    /// The number of facets that agree with the first one, and of the others.
    facets_by_turn: [usize; 2],
    /// Facets at a rim, and the sum of their first corners.
    rim_facets: usize,
    rim_sum: [f64; 3],
    /// `true` if its facets can't all be wound alike, as on a Moebius strip.
    is_one_sided: bool,
}

impl Shell {
    const EMPTY: Shell = Shell {
        facets: 0,
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
        volume: 0.0,
        area_vector: [0.0; 3],
        area: [0.0; 2],
        facets_by_turn: [0; 2],
        rim_facets: 0,
        rim_sum: [0.0; 3],
        is_one_sided: false,
    };

    fn add_facet(&mut self, corners: &[[f64; 3]; 3], is_turned: bool, is_at_rim: bool) {
        for p in corners {
            self.low = [0, 1, 2].map(|k| self.low[k].min(p[k]));
            self.high = [0, 1, 2].map(|k| self.high[k].max(p[k]));
        }
        let a = corners[0];
        let normal = area_vector(corners);
        let sign = if is_turned { -1.0 } else { 1.0 };
        for k in 0..3 {
            self.area_vector[k] += sign * normal[k];
            self.volume += sign * a[k] * normal[k];
        }
        self.area[usize::from(is_turned)] += normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        self.facets_by_turn[usize::from(is_turned)] += 1;
        self.facets += 1;
        if is_at_rim {
            self.rim_facets += 1;
            (0..3).for_each(|k| self.rim_sum[k] += a[k]);
        }
    }

    fn total_area(&self) -> f64 {
        self.area[0] + self.area[1]
    }

    /// Returns `true` if no facet is at a rim and the area vectors cancel out.
    fn is_closed(&self) -> bool {
        let left = self.area_vector.iter().map(|c| c * c).sum::<f64>().sqrt();
        self.rim_facets == 0 && left <= 1e-5 * self.total_area()
    }

    /// Returns 1.0 if the surface, turned to agree with its first facet, is wound outwards, -1.0 if inwards.
    /// Returns `None` if it has large holes or no volume. A surface with small holes counts only if
    /// `may_be_open`.
    fn outward_sign(&self, may_be_open: bool) -> Option<f64> {
        let area = self.total_area();
        let volume = if self.is_closed() {
            self.volume
        } else {
            let missing = self.area_vector.iter().map(|c| c * c).sum::<f64>().sqrt();
            if !may_be_open || self.rim_facets == 0 || missing > 0.15 * area {
                return None;
            }
            // Measured from the rim's middle, the missing facets matter least.
            let middle = self.rim_sum.map(|sum| sum / self.rim_facets as f64);
            self.volume - (0..3).map(|k| middle[k] * self.area_vector[k]).sum::<f64>()
        };
        // Six times the volume of the ball with that area.
        let ball = 0.5 * area * (0.5 * area / std::f64::consts::PI).sqrt();
        let least = if self.is_closed() { 1e-6 } else { 0.1 };
        (!self.is_one_sided && volume.abs() > least * ball).then_some(volume.signum())
    }

    /// Returns `true` if the facets that agree with the first one must be turned, so that most of the area
    /// keeps its winding.
    fn is_mostly_turned(&self) -> bool {
        self.area[1] > self.area[0]
    }
}

/// Turns facets and shells outwards, and stores the findings.
pub(super) fn orient(mesh: &mut Mesh) {
    let connections = Connections::find(&mesh.triangles, mesh.positions.len());
    mesh.findings.winding_faults = connections.repeated_edges;
    mesh.findings.open_edges = connections.open_edges;
    if connections.shell_count() > MAX_SHELLS {
        return;
    }
    let shells = measure(mesh, &connections);
    mesh.findings.closed_shells = shells.iter().filter(|shell| shell.is_closed()).count();
    mesh.findings.outlier = outlier::find(&shells);
    let turns = decide_turns(mesh, &connections, &shells);
    for (facet, triangle) in mesh.triangles.iter_mut().enumerate() {
        let shell = connections.shell_of(facet);
        if turns[shell] != connections.is_turned(facet) && !shells[shell].is_one_sided {
            triangle.swap(1, 2);
        }
    }
}

fn measure(mesh: &Mesh, connections: &Connections) -> Vec<Shell> {
    let mut shells = vec![Shell::EMPTY; connections.shell_count()];
    for (facet, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
        let shell = &mut shells[connections.shell_of(facet)];
        shell.add_facet(&corners, connections.is_turned(facet), connections.is_at_rim(facet));
        shell.is_one_sided |= connections.is_one_sided(facet);
    }
    shells
}

/// Decides for each shell whether the facets that agree with its first one are turned over.
fn decide_turns(mesh: &mut Mesh, connections: &Connections, shells: &[Shell]) -> Vec<bool> {
    let mut turns: Vec<bool> = shells.iter().map(Shell::is_mostly_turned).collect();
    let findings = &mut mesh.findings;
    for (shell, &turned) in shells.iter().zip(&turns) {
        if !shell.is_one_sided {
            findings.turned_facets += shell.facets_by_turn[usize::from(!turned)];
        }
    }
    // If a body consists of several open surfaces, the wall of a hole is an open surface that is rightly
    // wound inwards.
    let area_of = |is_counted: fn(&Shell) -> bool| {
        shells.iter().filter(|shell| is_counted(shell)).map(Shell::total_area).sum::<f64>()
    };
    let may_be_open = area_of(Shell::is_closed) > 0.5 * area_of(|_| true);
    // The winding of most of the area: 1 outwards, -1 inwards.
    let sign_of = |(shell, turned): (&Shell, &bool)| {
        let sign = shell.outward_sign(may_be_open)?;
        Some(if *turned { -sign } else { sign })
    };
    let signs: Vec<Option<f64>> = shells.iter().zip(&turns).map(sign_of).collect();
    if !signs.contains(&Some(-1.0)) {
        return turns;
    }
    let clear: Vec<usize> = (0..shells.len()).filter(|&shell| signs[shell].is_some()).collect();
    let is_mixed = signs.contains(&Some(1.0));
    let containment =
        is_mixed.then(|| Containment::find(mesh, connections, shells, &clear)).flatten();
    let Some(containment) = containment.or_else(|| (!is_mixed).then(Containment::none)) else {
        return turns;
    };
    let findings = &mut mesh.findings;
    let is_outermost = |shell: &&usize| containment.containers_of(**shell).is_empty();
    findings.is_inside_out =
        clear.iter().filter(is_outermost).all(|&shell| signs[shell] == Some(-1.0));
    let inward = if findings.is_inside_out { 1.0 } else { -1.0 };
    if findings.is_inside_out {
        turns.iter_mut().for_each(|turn| *turn = !*turn);
    }
    for &shell in &clear {
        let is_inward = signs[shell] == Some(inward);
        let is_cavity = is_inward
            && containment.containers_of(shell).iter().any(|&c| signs[c] == Some(-inward));
        findings.cavities += usize::from(is_cavity);
        findings.turned_shells += usize::from(is_inward && !is_cavity);
        turns[shell] ^= is_inward && !is_cavity;
    }
    turns
}
