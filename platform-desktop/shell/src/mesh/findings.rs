//! What a reader found in a file beside its mesh.

use super::Outlier;

/// Faults of a file that were mended or passed over, and its closed shells.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MeshFindings {
    /// Facets that were left out: without area, or with fewer than three different corners.
    pub dropped_facets: usize,
    /// Edges that an odd number of facets use: the rims of holes.
    pub open_edges: usize,
    /// Directed edges that more than one facet of the file uses: 0 if its winding is consistent.
    pub winding_faults: usize,
    /// Connected surfaces without a rim.
    pub closed_shells: usize,
    /// Facets that were turned over, as most of their surface is wound the other way.
    pub turned_facets: usize,
    /// Shells that were wound inwards and turned outwards, where others are not.
    pub turned_shells: usize,
    /// Closed shells wound inwards that lie inside an outward one: they stay, and are hollow.
    pub cavities: usize,
    /// `true` if all outermost shells were wound inwards: all shells were turned.
    pub is_inside_out: bool,
    /// A small part so far away that it decides the size of the rest.
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
