//! The findings of a reader about a file's mesh.

use super::Outlier;

/// Faults of a file that were repaired or ignored, and statistics of its closed shells.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MeshFindings {
    /// Facets that were dropped: without area, or with fewer than three different corners.
    pub dropped_facets: usize,
    /// Edges that an odd number of facets use: the rims of holes.
    pub open_edges: usize,
    /// Directed edges that more than one facet of the file uses: 0 if its winding is consistent.
    pub winding_faults: usize,
    /// Connected surfaces without a rim.
    pub closed_shells: usize,
    /// Facets that were turned over, because most of their surface's area is wound the other way.
    pub turned_facets: usize,
    /// Shells that were wound inwards, unlike others, and were turned outwards.
    pub turned_shells: usize,
    /// Closed shells wound inwards that lie inside an outward one: they are kept as cavities.
    pub cavities: usize,
    /// `true` if all outermost shells were wound inwards: all shells were turned.
    pub is_inside_out: bool,
    /// A small part so far away that it makes the rest small in the grid.
    pub outlier: Option<Outlier>,
}

impl MeshFindings {
    /// Returns a sentence for each finding that matters.
    #[must_use]
    pub fn describe(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut push = |count: usize, line: String| {
            if count > 0 {
                lines.push(line);
            }
        };
        let count = |count: usize, one: &str, many: &str| {
            format!("{count} {}", if count == 1 { one } else { many })
        };
        let facets = |n| count(n, "facet", "facets");
        push(self.dropped_facets, format!("{} without area dropped", facets(self.dropped_facets)));
        push(
            self.turned_facets,
            format!(
                "{} wound against the rest of their surface turned over",
                facets(self.turned_facets)
            ),
        );
        push(
            self.turned_shells,
            format!("{} wound inwards turned outwards", count(self.turned_shells, "part", "parts")),
        );
        push(
            usize::from(self.is_inside_out),
            "the mesh is inside out; baked as if it were not".into(),
        );
        push(
            self.cavities,
            format!(
                "{} inside another part kept hollow",
                count(self.cavities, "cavity", "cavities")
            ),
        );
        push(
            self.open_edges,
            format!("the mesh has holes: {}", count(self.open_edges, "open edge", "open edges")),
        );
        if let Some(outlier) = &self.outlier {
            lines.push(outlier.to_string());
        }
        lines
    }
}
