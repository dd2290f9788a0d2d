//! Bounding volume hierarchy over triangles, split at the median of the longest axis.

use glam::Vec3;

/// A bounding volume hierarchy over numbered triangles.
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<(u32, [Vec3; 3])>,
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
    pub(crate) fn new(triangles: Vec<(u32, [Vec3; 3])>) -> Self {
        let mut bvh = Bvh { nodes: Vec::new(), triangles };
        if !bvh.triangles.is_empty() {
            bvh.build_node(0, bvh.triangles.len());
        }
        bvh
    }

    /// The nearest triangle that a ray hits between distances 0 and `max_distance`: its number, the
    /// distance, and whether its front face is hit.
    pub(crate) fn nearest_hit(
        &self,
        origin: Vec3,
        direction: Vec3,
        max_distance: f32,
    ) -> Option<(u32, f32, bool)> {
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
            for (number, triangle) in &self.triangles[first..first + count] {
                if let Some((distance, outside)) =
                    intersect_triangle(triangle, origin, direction, max_distance)
                {
                    (best, max_distance) = (Some((*number, distance, outside)), distance);
                }
            }
        }
        best
    }

    fn build_node(&mut self, first: usize, end: usize) {
        let part = &self.triangles[first..end];
        let corners = || part.iter().flat_map(|(_, triangle)| triangle);
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
        let centroid_sum = |(_, t): &(u32, [Vec3; 3])| t[0][axis] + t[1][axis] + t[2][axis];
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
    /// Slab test: the distance at which a ray enters the box, 0 if it starts inside. `inverse` is the
    /// reciprocal of the direction.
    fn entry_distance(&self, origin: Vec3, inverse: Vec3, max_distance: f32) -> Option<f32> {
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

/// Ray-triangle intersection (Moeller and Trumbore 1997): the distance, and whether the front face
/// is hit.
fn intersect_triangle(
    [a, b, c]: &[Vec3; 3],
    origin: Vec3,
    direction: Vec3,
    max_distance: f32,
) -> Option<(f32, bool)> {
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
    (inside && distance > 0.0 && distance < max_distance).then_some((distance, determinant > 0.0))
}
