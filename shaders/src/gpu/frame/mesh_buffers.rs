//! Vertex and index buffers of the scene's meshes.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::memory::buffer::Buffer;
use crate::scene::meshes;

/// Vertex and index buffers of all scene meshes.
pub(crate) struct MeshBuffers {
    pub(crate) vertices: Buffer,
    pub(crate) indices: Buffer,
}

impl MeshBuffers {
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let constant = |bytes, usage| Buffer::new_device_local(gpu, bytes, usage);
        let vertices = bytemuck::cast_slice(meshes::all_vertices());
        let indices = bytemuck::cast_slice(meshes::all_indices());
        Ok(MeshBuffers {
            vertices: constant(vertices, vk::BufferUsageFlags::VERTEX_BUFFER)?,
            indices: constant(indices, vk::BufferUsageFlags::INDEX_BUFFER)?,
        })
    }
}
