//! Connections of facets over their edges: a union-find structure that also stores the turn of each facet
//! relative to the first one of its surface.

/// A use of an edge by a facet: the edge's other vertex, and the facet with a bit for the direction.
type EdgeUse = [u32; 2];

/// The most edge uses that are sorted at once: 64 MiB.
const USES_AT_ONCE: usize = 1 << 23;

/// The connected surfaces of facets.
pub(super) struct Connections {
    /// For each facet, its shell, and a bit that is 1 if the facet is wound against the shell's first facet.
    shells: Vec<u32>,
    shell_count: usize,
    /// For each facet, `true` if it has an edge that an odd number of facets use.
    at_rim: Vec<bool>,
    /// For each facet, `true` if two paths to it disagree about its turn.
    one_sided: Vec<bool>,
    /// Directed edges that several facets use.
    pub(super) repeated_edges: usize,
    /// Edges that an odd number of facets use.
    pub(super) open_edges: usize,
}

impl Connections {
    pub(super) fn find(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        let mut found = Connections {
            shells: (0..triangles.len() as u32).map(|facet| facet << 1).collect(),
            shell_count: 0,
            at_rim: vec![false; triangles.len()],
            one_sided: vec![false; triangles.len()],
            repeated_edges: 0,
            open_edges: 0,
        };
        visit_edges(triangles, vertex_count, |uses| found.add_edge(uses));
        found.number_shells();
        found
    }

    pub(super) fn shell_count(&self) -> usize {
        self.shell_count
    }

    pub(super) fn shell_of(&self, facet: usize) -> usize {
        (self.shells[facet] >> 1) as usize
    }

    pub(super) fn is_turned(&self, facet: usize) -> bool {
        self.shells[facet] & 1 == 1
    }

    pub(super) fn is_at_rim(&self, facet: usize) -> bool {
        self.at_rim[facet]
    }

    pub(super) fn is_one_sided(&self, facet: usize) -> bool {
        self.one_sided[facet]
    }

    /// Adds an edge with all its uses.
    fn add_edge(&mut self, uses: &[EdgeUse]) {
        let forward = uses.iter().filter(|[_, facet]| facet & 1 == 1).count();
        self.repeated_edges += usize::from(forward > 1) + usize::from(uses.len() - forward > 1);
        if !uses.len().is_multiple_of(2) {
            self.open_edges += 1;
            uses.iter().for_each(|[_, facet]| self.at_rim[(facet >> 1) as usize] = true);
        }
        if let [[_, a], [_, b]] = *uses {
            // Two facets that are wound alike use their edge in opposite directions.
            self.join(a >> 1, b >> 1, (a ^ b) & 1 ^ 1);
        }
    }

    /// Returns a facet's root, and the facet's turn relative to the root. Halves the path.
    fn find_root(&mut self, facet: u32) -> (u32, u32) {
        let (mut at, mut turn) = (facet, 0);
        loop {
            let parent = self.shells[at as usize];
            if parent >> 1 == at {
                return (at, turn);
            }
            let grandparent = self.shells[(parent >> 1) as usize];
            self.shells[at as usize] = grandparent ^ (parent & 1);
            turn ^= self.shells[at as usize] & 1;
            at = grandparent >> 1;
        }
    }

    fn join(&mut self, a: u32, b: u32, turn: u32) {
        let ((a_root, a_turn), (b_root, b_turn)) = (self.find_root(a), self.find_root(b));
        let turn = a_turn ^ b_turn ^ turn;
        if a_root == b_root {
            self.one_sided[a as usize] |= turn == 1;
        } else {
            // The first facet of a surface is its root.
            let (low, high) = (a_root.min(b_root), a_root.max(b_root));
            self.shells[high as usize] = low << 1 | turn;
        }
    }

    /// Replaces roots by numbers of shells in the order of their first facets.
    fn number_shells(&mut self) {
        let count = self.shells.len() as u32;
        let mut numbers = Vec::new();
        for facet in 0..count {
            let (root, turn) = self.find_root(facet);
            if root == facet {
                numbers.push(facet);
            }
            self.shells[facet as usize] = root << 1 | turn;
        }
        self.shell_count = numbers.len();
        let mut number_of_root = vec![0; self.shells.len()];
        (0..).zip(&numbers).for_each(|(number, &root)| number_of_root[root as usize] = number);
        for shell in &mut self.shells {
            *shell = number_of_root[(*shell >> 1) as usize] << 1 | (*shell & 1);
        }
    }
}

/// Calls `visit` for each undirected edge with all its uses. Edges are grouped by their lower vertex, a range of
/// vertices at a time, which bounds the memory.
fn visit_edges(triangles: &[[u32; 3]], vertex_count: usize, mut visit: impl FnMut(&[EdgeUse])) {
    // For each vertex, first the number of its uses, then the end of its uses among those of its range.
    let mut ends = vec![0u32; vertex_count];
    for [a, b, c] in triangles {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            ends[*a.min(b) as usize] += 1;
        }
    }
    let mut uses: Vec<EdgeUse> = Vec::new();
    let mut first = 0;
    while first < vertex_count {
        let (mut last, mut total) = (first, 0);
        while last < vertex_count && (last == first || total + ends[last] as usize <= USES_AT_ONCE)
        {
            let count = ends[last];
            ends[last] = total as u32;
            total += count as usize;
            last += 1;
        }
        uses.clear();
        uses.resize(total, [0; 2]);
        let range = first as u32..last as u32;
        for (facet, [a, b, c]) in (0u32..).zip(triangles) {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let low = a.min(b);
                if range.contains(low) {
                    let end = &mut ends[*low as usize];
                    uses[*end as usize] = [*a.max(b), facet << 1 | u32::from(a < b)];
                    *end += 1;
                }
            }
        }
        let mut start = 0;
        for end in &ends[first..last] {
            let of_vertex = &mut uses[start..*end as usize];
            of_vertex.sort_unstable();
            of_vertex.chunk_by(|[a, _], [b, _]| a == b).for_each(&mut visit);
            start = *end as usize;
        }
        first = last;
    }
}
