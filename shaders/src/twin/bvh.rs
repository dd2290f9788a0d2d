//! Bounding volume hierarchy over triangles, split at the median of the longest axis.

use glam::Vec3;

/// A bounding volume hierarchy over numbered triangles.
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<BvhTriangle>,
}

/// A triangle, and the number that identifies it in a hit.
pub(crate) struct BvhTriangle {
    pub(crate) number: u32,
    pub(crate) corners: [Vec3; 3],
}

/// A ray's hit on a triangle.
#[derive(Clone, Copy)]
pub(crate) struct BvhHit {
    /// The triangle's number.
    pub(crate) triangle: u32,
    /// Distance from the ray's origin.
    pub(crate) distance: f32,
    /// The side that is hit.
    pub(crate) face: HitFace,
}

/// The side of a triangle that a ray hits.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum HitFace {
    /// The side from which the corners wind counter-clockwise.
    Front,
    Back,
}

/// An axis-aligned box. A leaf holds triangles `first..first + count`. An inner node has count 0; its
/// children are the next node and node `first`.
struct Node {
    lo: Vec3,
    hi: Vec3,
    first: u32,
    count: u32,
}

const LEAF: usize = 4;

impl Bvh {
    /// Builds the hierarchy.
    pub(crate) fn new(triangles: Vec<BvhTriangle>) -> Self {
        let mut bvh = Bvh { nodes: Vec::new(), triangles };
        if !bvh.triangles.is_empty() {
            bvh.build_node(0, bvh.triangles.len());
        }
        bvh
    }

    /// Returns the nearest hit of a ray between distances 0 and `max_distance`.
    pub(crate) fn nearest_hit(
        &self,
        origin: Vec3,
        direction: Vec3,
        max_distance: f32,
    ) -> Option<BvhHit> {
        let inverse = direction.recip();
        let (mut best, mut max_distance) = (None, max_distance);
        let mut stack = [0u32; 64];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let at = stack[height] as usize;
            let node = &self.nodes[at];
            if node.entry_distance(origin, inverse, max_distance).is_none() {
                continue;
            }
            if node.count == 0 {
                let halves = [at as u32 + 1, node.first];
                let [a, b] = halves
                    .map(|i| self.nodes[i as usize].entry_distance(origin, inverse, max_distance));
                let nearer =
                    if a.unwrap_or(f32::MAX) < b.unwrap_or(f32::MAX) { [1, 0] } else { [0, 1] };
                for k in nearer {
                    if [a, b][k].is_some() {
                        stack[height] = halves[k];
                        height += 1;
                    }
                }
                continue;
            }
            let (first, count) = (node.first as usize, node.count as usize);
            for triangle in &self.triangles[first..first + count] {
                if let Some(hit) = intersect_triangle(triangle, origin, direction, max_distance) {
                    (best, max_distance) = (Some(hit), hit.distance);
                }
            }
        }
        best
    }

    fn build_node(&mut self, first: usize, end: usize) {
        let part = &self.triangles[first..end];
        let corners = || part.iter().flat_map(|triangle| &triangle.corners);
        let lo = corners().fold(Vec3::splat(f32::MAX), |lo, p| lo.min(*p));
        let hi = corners().fold(Vec3::splat(f32::MIN), |hi, p| hi.max(*p));
        let at = self.nodes.len();
        let count = end - first;
        self.nodes.push(Node { lo, hi, first: first as u32, count: count as u32 });
        if count <= LEAF {
            return;
        }
        let extent = hi - lo;
        let axis = (0..3).max_by(|a, b| extent[*a].total_cmp(&extent[*b])).unwrap_or(0);
        let centroid_sum = |triangle: &BvhTriangle| {
            let [a, b, c] = triangle.corners;
            a[axis] + b[axis] + c[axis]
        };
        let half = first + count / 2;
        self.triangles[first..end]
            .select_nth_unstable_by(count / 2, |a, b| centroid_sum(a).total_cmp(&centroid_sum(b)));
        self.build_node(first, half);
        self.nodes[at].count = 0;
        self.nodes[at].first = self.nodes.len() as u32;
        self.build_node(half, end);
    }
}

impl Node {
    /// Slab test: returns the distance at which a ray enters the box, 0 if it starts inside.
    /// `inverse_direction` has the reciprocals of the direction's components.
    fn entry_distance(
        &self,
        origin: Vec3,
        inverse_direction: Vec3,
        max_distance: f32,
    ) -> Option<f32> {
        let inverse = inverse_direction;
        let (mut enter, mut leave) = (0.0f32, max_distance);
        for k in 0..3 {
            let (a, b) =
                ((self.lo[k] - origin[k]) * inverse[k], (self.hi[k] - origin[k]) * inverse[k]);
            let (near, away) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter { near } else { enter };
            leave = if away < leave { away } else { leave };
        }
        (enter <= leave).then_some(enter)
    }
}

/// Ray-triangle intersection (Moeller and Trumbore 1997).
fn intersect_triangle(
    triangle: &BvhTriangle,
    origin: Vec3,
    direction: Vec3,
    max_distance: f32,
) -> Option<BvhHit> {
    let [a, b, c] = &triangle.corners;
    let (e, f) = (*b - *a, *c - *a);
    let cross = direction.cross(f);
    let determinant = e.dot(cross);
    if determinant.abs() < 1e-14 {
        return None;
    }
    let offset = origin - *a;
    let u = offset.dot(cross) / determinant;
    let q = offset.cross(e);
    let v = direction.dot(q) / determinant;
    let distance = f.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    let face = if determinant > 0.0 { HitFace::Front } else { HitFace::Back };
    let hit = BvhHit { triangle: triangle.number, distance, face };
    (inside && distance > 0.0 && distance < max_distance).then_some(hit)
}
