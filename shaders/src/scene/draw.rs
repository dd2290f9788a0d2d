//! What a frame draws: instances grouped by mesh.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};

use super::meshes::{MESHES, MeshId};
use crate::limits::INSTANCES;

/// A mesh's place in the room: 64 bytes.
#[derive(Clone, Copy, PartialEq, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// Three rows of four: the mesh's point (x, y, z, 1) times them is the room's, in metres.
    pub transform: [f32; 12],
    /// Red, green and blue that its colours are multiplied by, and how much of them shines by
    /// itself.
    pub tint: [f32; 4],
}

/// Instances of one mesh, that lie side by side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Batch {
    /// The mesh.
    pub mesh: MeshId,
    /// Its first instance.
    pub first: u32,
    /// How many there are; not 0.
    pub count: u32,
}

/// The instances of a frame. Its memory is taken once.
#[derive(Debug)]
pub struct DrawList {
    noted: Vec<(MeshId, Instance)>,
    instances: Vec<Instance>,
    batches: Vec<Batch>,
}

impl DrawList {
    /// An empty list with room for all.
    #[must_use]
    pub(crate) fn new() -> Self {
        DrawList {
            noted: Vec::with_capacity(INSTANCES),
            instances: Vec::with_capacity(INSTANCES),
            batches: Vec::with_capacity(MESHES),
        }
    }

    /// All instances, those of a mesh side by side.
    #[must_use]
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The meshes that are drawn, each once.
    #[must_use]
    pub fn batches(&self) -> &[Batch] {
        &self.batches
    }

    /// The instances of one mesh.
    #[must_use]
    pub fn of(&self, mesh: MeshId) -> &[Instance] {
        let batch = self.batches.iter().find(|batch| batch.mesh == mesh);
        batch.map_or(&[], |b| &self.instances[b.first as usize..][..b.count as usize])
    }

    /// Room for instances and batches, which never grows.
    #[must_use]
    pub fn capacity(&self) -> (usize, usize) {
        (self.instances.capacity().max(self.noted.capacity()), self.batches.capacity())
    }

    pub(crate) fn clear(&mut self) {
        self.noted.clear();
    }

    /// Adds an instance. What there is no room for is left out.
    pub(crate) fn add(&mut self, mesh: MeshId, at: Affine3A, tint: [f32; 4]) {
        if self.noted.len() < INSTANCES {
            self.noted.push((mesh, Instance { transform: rows(at), tint }));
        }
    }

    /// Groups what was added by mesh, in the order in which it was added.
    pub(crate) fn group(&mut self) {
        self.instances.clear();
        self.batches.clear();
        let mut counts = [0u32; MESHES];
        let mut ids = [None; MESHES];
        for (mesh, _) in &self.noted {
            counts[*mesh as usize] += 1;
            ids[*mesh as usize] = Some(*mesh);
        }
        let mut next = [0u32; MESHES];
        let mut first = 0;
        for (i, mesh) in ids.into_iter().enumerate() {
            next[i] = first;
            if let Some(mesh) = mesh {
                self.batches.push(Batch { mesh, first, count: counts[i] });
            }
            first += counts[i];
        }
        self.instances.resize(self.noted.len(), Instance::zeroed());
        for (mesh, instance) in &self.noted {
            let at = &mut next[*mesh as usize];
            self.instances[*at as usize] = *instance;
            *at += 1;
        }
    }
}

impl Instance {
    /// A point of the mesh, in the room.
    #[must_use]
    pub fn place(&self, point: Vec3) -> Vec3 {
        let row = |i: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.transform[4 * i + k]);
            a * point.x + b * point.y + c * point.z + d
        };
        Vec3::new(row(0), row(1), row(2))
    }
}

fn rows(at: Affine3A) -> [f32; 12] {
    let (m, t) = (at.matrix3, at.translation);
    let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
    let [a, b, c] = [row(0), row(1), row(2)];
    core::array::from_fn(|i| [a, b, c][i / 4][i % 4])
}
