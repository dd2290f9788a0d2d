//! The project's own meshes for baking.

use paros_shell::mesh::Mesh;
use std::collections::HashMap;

/// Returns a surface of revolution of 120 x 90 quads, closed at the top and open at the bottom.
#[must_use]
pub fn vase() -> Mesh {
    vase_of_quads(120, 90)
}

/// Returns the vase with the given quads around and levels.
#[must_use]
pub fn vase_of_quads(around: u32, levels: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for level in 0..levels {
        let height = level as f32 / levels as f32;
        let radius = 0.3 + 0.15 * (height * 9.0).sin();
        for i in 0..around {
            let angle = i as f32 / around as f32 * std::f32::consts::TAU;
            mesh.positions.push([radius * angle.cos(), height, -radius * angle.sin()]);
        }
    }
    let top = mesh.positions.len() as u32;
    mesh.positions.push([0.0, 1.0, 0.0]);
    for level in 0..levels {
        for i in 0..around {
            let [a, b] = [i, (i + 1) % around].map(|i| level * around + i);
            if level + 1 == levels {
                mesh.triangles.push([a, b, top]);
            } else {
                mesh.triangles.extend([[a, b, b + around], [a, b + around, a + around]]);
            }
        }
    }
    mesh
}

/// Returns the mesh with every hole closed by a fan from the middle of its boundary loop.
#[must_use]
pub fn with_holes_closed(mesh: &Mesh) -> Mesh {
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut uses: HashMap<[u32; 2], i32> = HashMap::new();
    for t in &mesh.triangles {
        for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            *uses.entry([a, b]).or_default() += 1;
            *uses.entry([b, a]).or_default() -= 1;
        }
    }
    for ([a, b], _) in uses.into_iter().filter(|&(_, uses)| uses > 0) {
        next.entry(b).or_default().push(a);
    }
    let mut closed = mesh.clone();
    while let Some(start) = next.iter().find(|(_, ends)| !ends.is_empty()).map(|(&start, _)| start)
    {
        let mut ring = vec![start];
        while let Some(end) = next.get_mut(ring.last().unwrap()).and_then(Vec::pop) {
            if end == start {
                break;
            }
            ring.push(end);
        }
        let middle = [0, 1, 2].map(|k| {
            ring.iter().map(|&i| mesh.positions[i as usize][k]).sum::<f32>() / ring.len() as f32
        });
        let centre = closed.positions.len() as u32;
        closed.positions.push(middle);
        for (i, &a) in ring.iter().enumerate() {
            closed.triangles.push([a, ring[(i + 1) % ring.len()], centre]);
        }
    }
    closed
}
