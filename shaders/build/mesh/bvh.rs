//! Rays against triangles: a tree of boxes, halved at the median.

use glam::Vec3;

/// A tree over triangles.
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<(u32, [Vec3; 3])>,
}

/// A box and what it holds: triangles `first..first + count`, or without any the two nodes that
/// follow: the next one and `first`.
struct Node {
    lo: Vec3,
    hi: Vec3,
    first: u32,
    count: u32,
}

const LEAF: usize = 4;

impl Bvh {
    /// The tree of numbered triangles.
    pub(crate) fn new(triangles: Vec<(u32, [Vec3; 3])>) -> Self {
        let mut bvh = Bvh { nodes: Vec::new(), triangles };
        if !bvh.triangles.is_empty() {
            bvh.split(0, bvh.triangles.len());
        }
        bvh
    }

    /// The nearest triangle that a ray meets between distances 0 and `far`: its number, the
    /// distance, and whether the ray comes from outside.
    pub(crate) fn hit(&self, from: Vec3, way: Vec3, far: f32) -> Option<(u32, f32, bool)> {
        let inverse = way.recip();
        let (mut best, mut far) = (None, far);
        let mut stack = [0u32; 64];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let at = stack[height] as usize;
            let node = &self.nodes[at];
            if node.met(from, inverse, far).is_none() {
                continue;
            }
            if node.count == 0 {
                let halves = [at as u32 + 1, node.first];
                let [a, b] = halves.map(|i| self.nodes[i as usize].met(from, inverse, far));
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
                if let Some((distance, outside)) = meet(triangle, from, way, far) {
                    (best, far) = (Some((*number, distance, outside)), distance);
                }
            }
        }
        best
    }

    fn split(&mut self, first: usize, end: usize) {
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
        let size = hi - lo;
        let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(0);
        let middle = |(_, t): &(u32, [Vec3; 3])| t[0][axis] + t[1][axis] + t[2][axis];
        let half = first + count / 2;
        self.triangles[first..end]
            .select_nth_unstable_by(count / 2, |a, b| middle(a).total_cmp(&middle(b)));
        self.split(first, half);
        self.nodes[at].count = 0;
        self.nodes[at].first = self.nodes.len() as u32;
        self.split(half, end);
    }
}

impl Node {
    /// Where a ray enters the box, if it does.
    fn met(&self, from: Vec3, inverse: Vec3, far: f32) -> Option<f32> {
        let (mut enter, mut leave) = (0.0f32, far);
        for k in 0..3 {
            let (a, b) = ((self.lo[k] - from[k]) * inverse[k], (self.hi[k] - from[k]) * inverse[k]);
            let (near, away) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter { near } else { enter };
            leave = if away < leave { away } else { leave };
        }
        (enter <= leave).then_some(enter)
    }
}

/// Where a ray meets a triangle (Moeller and Trumbore 1997).
fn meet([a, b, c]: &[Vec3; 3], from: Vec3, way: Vec3, far: f32) -> Option<(f32, bool)> {
    let (e, f) = (*b - *a, *c - *a);
    let across = way.cross(f);
    let size = e.dot(across);
    if size.abs() < 1e-14 {
        return None;
    }
    let offset = from - *a;
    let u = offset.dot(across) / size;
    let turned = offset.cross(e);
    let v = way.dot(turned) / size;
    let distance = f.dot(turned) / size;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (inside && distance > 0.0 && distance < far).then_some((distance, size > 0.0))
}
