//! From a checked mesh to the core's bake, and what only the whole mesh can tell.

use super::Mesh;
use paros_core::bake::{BakeReport, Baker, Placement, Up};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use std::collections::HashMap;

impl Mesh {
    /// The lowest and the highest coordinates of the vertices. `None` without any.
    #[must_use]
    pub fn bounds(&self) -> Option<([f32; 3], [f32; 3])> {
        let (&first, rest) = self.positions.split_first()?;
        let (mut low, mut high) = (first, first);
        for p in rest {
            for k in 0..3 {
                low[k] = if p[k] < low[k] { p[k] } else { low[k] };
                high[k] = if p[k] > high[k] { p[k] } else { high[k] };
            }
        }
        Some((low, high))
    }

    /// Bakes the mesh, fitted to the grid as [`Placement::fit`] says, into tight maps and their
    /// voxels. `None`, and nothing changed, when the mesh has no extent; one that was read has.
    #[must_use]
    pub fn bake<const N: usize>(
        &self,
        up: Up,
        baker: &mut Baker<N>,
        maps: &mut Maps<N>,
        plane: &mut Plane<N>,
    ) -> Option<BakeReport>
    where
        Grid<N>: Size,
    {
        let (min, max) = self.bounds()?;
        let placement = Placement::fit(min, max, up, N)?;
        let snapped: Vec<_> = self.positions.iter().map(|&p| placement.snap(p)).collect();
        baker.begin();
        for t in &self.triangles {
            baker
                .triangle(t.map(|i| snapped[i as usize]))
                .expect("the placement keeps every corner inside the box");
        }
        Some(baker.finish(maps, plane))
    }

    /// How many directed edges more than one triangle uses, vertices merged by position: 0 where
    /// the winding is consistent, as on any surface that two triangles at most share an edge of.
    #[must_use]
    pub fn winding_faults(&self) -> usize {
        let mut merged = HashMap::new();
        let vertices: Vec<u32> = self
            .positions
            .iter()
            .enumerate()
            // Adding zero makes one of the two zeros.
            .map(|(i, p)| *merged.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(i as u32))
            .collect();
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(self.triangles.len() * 3);
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| vertices[i as usize]);
            if a != b && b != c && c != a {
                edges.extend([[a, b], [b, c], [c, a]]);
            }
        }
        edges.sort_unstable();
        edges.chunk_by(|e, f| e == f).filter(|uses| uses.len() > 1).count()
    }
}
