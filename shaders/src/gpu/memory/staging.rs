//! Bytes on their way to the sculpture's textures, within one frame of the ring.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use crate::field::Budget;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::upload::Region;

/// Bytes that one frame can upload: the budget at 256 voxels a side after [`Budget::MAX_TICKS`]. Larger
/// uploads are spread over frames.
pub(crate) const FRAME_UPLOAD_BYTES: usize = Budget::of_frame_after(256, Budget::MAX_TICKS).bytes;
/// Regions that one frame can upload.
pub(crate) const MAX_REGIONS: usize = 1024 * Budget::MAX_TICKS as usize;
/// Alignment of a region in the buffer, in bytes.
const ALIGNMENT: usize = 4;
/// Size of the buffer, with the padding between regions.
const STAGING_BYTES: usize = FRAME_UPLOAD_BYTES + ALIGNMENT * MAX_REGIONS;

/// A frame's staging buffer: regions and their bytes, to be uploaded by the frame's commands.
pub(crate) struct Staging {
    pub(crate) buffer: Buffer,
    pub(crate) regions: Vec<(Region, u64)>,
    used: usize,
}

impl Staging {
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::STORAGE_BUFFER;
        let buffer = Buffer::new(gpu, STAGING_BYTES, usage)?;
        Ok(Staging { buffer, regions: Vec::with_capacity(MAX_REGIONS), used: 0 })
    }

    /// Empties the buffer, once the frame that used it is done.
    pub(crate) fn clear(&mut self) {
        self.regions.clear();
        self.used = 0;
    }

    /// Returns `true` if two regions share a texel.
    pub(crate) fn has_overlaps(&self) -> bool {
        let regions = &self.regions;
        let overlaps_earlier =
            |i: usize| regions[..i].iter().any(|(earlier, _)| earlier.overlaps(&regions[i].0));
        (1..regions.len()).any(overlaps_earlier)
    }

    /// Stages a region's bytes. Returns `false`, without effect, if this frame has no room for them.
    #[must_use]
    pub(crate) fn try_push(&mut self, region: Region, bytes: &[u8]) -> bool {
        let at = self.used.next_multiple_of(ALIGNMENT);
        let fits = at + bytes.len() <= STAGING_BYTES && self.regions.len() < MAX_REGIONS;
        if fits {
            self.buffer.write(at, bytes);
            self.regions.push((region, at as u64));
            self.used = at + bytes.len();
        }
        fits
    }
}
