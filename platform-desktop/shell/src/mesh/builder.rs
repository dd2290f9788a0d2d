//! Collection of a file's facets, with vertices welded by position while they are read.

use super::{COORDINATE_BOUND, MAX_TRIANGLES, Mesh, MeshFault, area_vector, malformed, shells};

/// An index into the positions of a [`MeshBuilder`].
pub(super) type VertexIndex = u32;

/// Marks a free slot of the table.
const FREE: VertexIndex = VertexIndex::MAX;

/// A mesh that is being read.
#[derive(Default)]
pub(super) struct MeshBuilder {
    /// Different positions, in the file's units.
    positions: Vec<[f64; 3]>,
    /// A hash table of the indices of all positions, with linear probing; at most half full.
    slots: Vec<VertexIndex>,
    triangles: Vec<[VertexIndex; 3]>,
    /// Facets with fewer than three different corners.
    dropped: usize,
}

impl MeshBuilder {
    /// Returns the vertex at a position, adding it if it is new. The coordinates may be any numbers: they are
    /// checked when a facet uses them.
    pub(super) fn add_vertex(&mut self, position: [f64; 3]) -> VertexIndex {
        if self.positions.len() * 2 >= self.slots.len() {
            self.grow();
        }
        // Adding zero turns -0.0 into 0.0.
        let position = position.map(|c| c + 0.0);
        let bits = position.map(f64::to_bits);
        let mask = self.slots.len() - 1;
        let mut at = hash(bits) as usize & mask;
        loop {
            match self.slots[at] {
                FREE => {
                    let index = self.positions.len() as VertexIndex;
                    self.slots[at] = index;
                    self.positions.push(position);
                    return index;
                }
                index if self.positions[index as usize].map(f64::to_bits) == bits => return index,
                _ => at = (at + 1) & mask,
            }
        }
    }

    fn grow(&mut self) {
        let length = (self.slots.len() * 2).max(1 << 10);
        self.slots.clear();
        self.slots.resize(length, FREE);
        for (index, position) in (0..).zip(&self.positions) {
            let mut at = hash(position.map(f64::to_bits)) as usize & (length - 1);
            while self.slots[at] != FREE {
                at = (at + 1) & (length - 1);
            }
            self.slots[at] = index;
        }
    }

    /// Reserves memory for that many triangles at once.
    pub(super) fn reserve_triangles(&mut self, count: usize) {
        self.triangles.reserve_exact(count.min(MAX_TRIANGLES));
    }

    /// Checks that `more` triangles stay within [`MAX_TRIANGLES`]. Call it before memory is allocated for
    /// them.
    pub(super) fn check_room(&self, more: usize) -> Result<(), MeshFault> {
        let count = (self.triangles.len() + self.dropped).saturating_add(more);
        if count <= MAX_TRIANGLES { Ok(()) } else { Err(MeshFault::TooManyTriangles { count }) }
    }

    /// Adds a triangle. The error names a coordinate that is NaN or out of bounds; the caller adds the place
    /// in the file.
    #[inline]
    pub(super) fn add_triangle(&mut self, corners: [VertexIndex; 3]) -> Result<(), MeshFault> {
        self.check_room(1)?;
        for corner in corners {
            let position = self.positions[corner as usize];
            if let Some(value) = position.iter().find(|c| c.is_nan() || c.abs() > COORDINATE_BOUND)
            {
                return malformed(format!(
                    "found the coordinate {value:e}; expected a number of at most \
                     {COORDINATE_BOUND:e} either way"
                ));
            }
        }
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            self.dropped += 1;
        } else {
            self.triangles.push(corners);
        }
        Ok(())
    }

    /// Adds a polygon as a triangle fan. A polygon of fewer than three corners is dropped and counted.
    pub(super) fn add_polygon(&mut self, corners: &[VertexIndex]) -> Result<(), MeshFault> {
        self.check_room(corners.len().saturating_sub(2))?;
        if corners.len() < 3 {
            self.dropped += 1;
        }
        for pair in corners.windows(2).skip(1) {
            self.add_triangle([corners[0], pair[0], pair[1]])?;
        }
        Ok(())
    }

    /// Returns the mesh, its closed shells turned outwards.
    pub(super) fn finish(mut self) -> Result<Mesh, MeshFault> {
        self.slots = Vec::new();
        if self.triangles.is_empty() && self.dropped == 0 {
            return Err(MeshFault::Empty);
        }
        self.drop_stray_facets()?;
        self.drop_unused_vertices();
        let origin = self.find_origin();
        let mut mesh = Mesh {
            positions: self
                .positions
                .iter()
                .map(|p| [0, 1, 2].map(|k| (p[k] - origin[k]) as f32))
                .collect(),
            triangles: self.triangles,
            origin,
            ..Mesh::default()
        };
        drop(self.positions);
        mesh.findings.dropped_facets = self.dropped;
        shells::orient(&mut mesh);
        Ok(mesh)
    }

    /// Drops facets without area that have a corner used by no facet with area. The other facets without area
    /// close the gaps where a corner lies on another facet's edge.
    fn drop_stray_facets(&mut self) -> Result<(), MeshFault> {
        // The first threshold is flatter than any visible facet; the second is exactly flat, for a mesh that
        // is nearly flat as a whole.
        for least_height in [1e-6, 0.0] {
            let mut is_corner = vec![false; self.positions.len()];
            let mut has_area = false;
            for t in &self.triangles {
                if self.has_area(t, least_height) {
                    has_area = true;
                    t.iter().for_each(|&i| is_corner[i as usize] = true);
                }
            }
            if has_area {
                let before = self.triangles.len();
                self.triangles.retain(|t| t.iter().all(|&i| is_corner[i as usize]));
                self.dropped += before - self.triangles.len();
                return Ok(());
            }
        }
        Err(MeshFault::NoArea)
    }

    /// Returns `true` if a triangle's height over its longest edge is more than `least_height` times that
    /// edge.
    fn has_area(&self, triangle: &[VertexIndex; 3], least_height: f64) -> bool {
        let corners = triangle.map(|i| self.positions[i as usize]);
        let [a, b, c] = corners;
        let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let f = [0, 1, 2].map(|k| e[k] - d[k]);
        let square = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        let longest = square(d).max(square(e)).max(square(f));
        let [x, y, z] = area_vector(&corners).map(f64::abs);
        x.max(y).max(z) > least_height * longest
    }

    /// Removes vertices that no triangle uses.
    fn drop_unused_vertices(&mut self) {
        let mut names = vec![FREE; self.positions.len()];
        self.triangles.as_flattened().iter().for_each(|&i| names[i as usize] = 0);
        for (kept, name) in (0..).zip(names.iter_mut().filter(|name| **name == 0)) {
            *name = kept;
        }
        self.triangles.as_flattened_mut().iter_mut().for_each(|i| *i = names[*i as usize]);
        let mut names = names.into_iter();
        self.positions.retain(|_| names.next() != Some(FREE));
    }

    /// Returns the middle of a mesh so far from the origin of its coordinates that single precision would
    /// lose details, as in geodesy; the origin itself for other meshes.
    fn find_origin(&self) -> [f64; 3] {
        /// The distance from which single precision is coarser than 1/1000 voxel of 256, in extents.
        const FAR: f64 = 64.0;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in &self.positions {
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let farthest = low.iter().chain(&high).fold(0.0, |far: f64, c| far.max(c.abs()));
        if farthest <= FAR * extent {
            return [0.0; 3];
        }
        [0, 1, 2].map(|k| low[k] + 0.5 * (high[k] - low[k]))
    }
}

/// Mixes the bits of a position by two wide multiplications, as wyhash does.
fn hash([a, b, c]: [u64; 3]) -> u64 {
    let mix = |x: u64, y: u64| {
        let wide = u128::from(x) * u128::from(y);
        wide as u64 ^ (wide >> 64) as u64
    };
    mix(mix(a ^ 0xa076_1d64_78bd_642f, b ^ 0xe703_7ed1_a0b4_28db) ^ c, 0x8ebc_6af0_9c88_c6e3)
}
