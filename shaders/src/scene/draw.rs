//! The draw list of a frame: instances batched by mesh.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};

use super::meshes::{DrawGroup, MESHES, MeshId};
use crate::limits::INSTANCES;

/// Per-instance vertex data of a mesh: 64 bytes.
#[derive(Clone, Copy, PartialEq, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MeshInstance {
    /// Affine transform from the mesh to the room (metres): three rows of four.
    pub transform: [f32; 12],
    /// Colour factors, and as the fourth the emissive part; for a particle the opacity.
    pub tint: [f32; 4],
}

/// Consecutive instances of one mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Batch {
    /// The mesh.
    pub mesh: MeshId,
    /// The group that the mesh is drawn in: its own, or another that it was added to.
    pub group: DrawGroup,
    /// The batch's first instance.
    pub first: u32,
    /// Number of instances, not 0.
    pub count: u32,
}

/// Capacity of a draw list, allocated when the list is created.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DrawListCapacity {
    /// Instances.
    pub instances: usize,
    /// Batches.
    pub batches: usize,
}

/// The instances of a frame. Allocates only when created.
#[derive(Debug)]
pub struct DrawList {
    pending: Vec<(MeshId, DrawGroup, MeshInstance)>,
    instances: Vec<MeshInstance>,
    batches: Vec<Batch>,
}

impl DrawList {
    /// Creates an empty list with capacity for all instances.
    #[must_use]
    pub(crate) fn new() -> Self {
        DrawList {
            pending: Vec::with_capacity(INSTANCES),
            instances: Vec::with_capacity(INSTANCES),
            batches: Vec::with_capacity(MESHES * DrawGroup::COUNT),
        }
    }

    /// Returns all instances, ordered by mesh.
    #[must_use]
    pub fn instances(&self) -> &[MeshInstance] {
        &self.instances
    }

    /// Returns one batch for each mesh drawn and each group that it is drawn in.
    #[must_use]
    pub fn batches(&self) -> &[Batch] {
        &self.batches
    }

    /// Returns the instances of one mesh in its own group.
    #[must_use]
    pub fn instances_of(&self, mesh: MeshId) -> &[MeshInstance] {
        self.instances_in_group(mesh, mesh.draw_group())
    }

    /// Returns the instances of one mesh in a group.
    #[must_use]
    pub fn instances_in_group(&self, mesh: MeshId, group: DrawGroup) -> &[MeshInstance] {
        let is_it = |batch: &&Batch| batch.mesh == mesh && batch.group == group;
        self.batches
            .iter()
            .find(is_it)
            .map_or(&[], |b| &self.instances[b.first as usize..][..b.count as usize])
    }

    /// Returns the capacity, which never grows.
    #[must_use]
    pub fn capacity(&self) -> DrawListCapacity {
        let instances = self.instances.capacity().max(self.pending.capacity());
        DrawListCapacity { instances, batches: self.batches.capacity() }
    }

    pub(crate) fn clear(&mut self) {
        self.pending.clear();
    }

    /// Adds an instance; beyond the capacity it is dropped.
    pub(crate) fn add(&mut self, mesh: MeshId, room_from_mesh: Affine3A, tint: [f32; 4]) {
        self.add_to_group(mesh.draw_group(), mesh, room_from_mesh, tint);
    }

    /// Adds an instance to a group that isn't its mesh's own.
    pub(crate) fn add_to_group(
        &mut self,
        group: DrawGroup,
        mesh: MeshId,
        room_from_mesh: Affine3A,
        tint: [f32; 4],
    ) {
        if self.pending.len() < INSTANCES {
            let instance = MeshInstance { transform: matrix_rows(room_from_mesh), tint };
            self.pending.push((mesh, group, instance));
        }
    }

    /// Sorts the added instances by group and mesh: a stable counting sort.
    pub(crate) fn batch_by_mesh(&mut self) {
        self.instances.clear();
        self.batches.clear();
        let key = |mesh: MeshId, group: DrawGroup| group as usize * MESHES + mesh as usize;
        let mut counts = [0u32; MESHES * DrawGroup::COUNT];
        let mut ids = [None; MESHES * DrawGroup::COUNT];
        for (mesh, group, _) in &self.pending {
            counts[key(*mesh, *group)] += 1;
            ids[key(*mesh, *group)] = Some((*mesh, *group));
        }
        let mut next = [0u32; MESHES * DrawGroup::COUNT];
        let mut first = 0;
        for (i, id) in ids.into_iter().enumerate() {
            next[i] = first;
            if let Some((mesh, group)) = id {
                self.batches.push(Batch { mesh, group, first, count: counts[i] });
            }
            first += counts[i];
        }
        self.instances.resize(self.pending.len(), MeshInstance::zeroed());
        for (mesh, group, instance) in &self.pending {
            let at = &mut next[key(*mesh, *group)];
            self.instances[*at as usize] = *instance;
            *at += 1;
        }
    }
}

impl Batch {
    /// Returns `true` if the batch is drawn into the shadow map.
    #[must_use]
    pub fn casts_shadow(&self) -> bool {
        self.mesh.casts_shadow() && self.group == self.mesh.draw_group()
    }
}

impl MeshInstance {
    /// Transforms a point of the mesh to the room.
    #[must_use]
    pub fn transform_point(&self, point: Vec3) -> Vec3 {
        let row = |i: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.transform[4 * i + k]);
            a * point.x + b * point.y + c * point.z + d
        };
        Vec3::new(row(0), row(1), row(2))
    }
}

/// Returns the three rows of four of an affine transform.
fn matrix_rows(transform: Affine3A) -> [f32; 12] {
    let (m, t) = (transform.matrix3, transform.translation);
    let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
    let [a, b, c] = [row(0), row(1), row(2)];
    core::array::from_fn(|i| [a, b, c][i / 4][i % 4])
}
