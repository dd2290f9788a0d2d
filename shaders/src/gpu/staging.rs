//! Bytes on their way to the sculpture's textures, within one frame of the ring.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::Error;
use crate::upload::Region;

/// What one frame can upload; a load is spread over frames.
pub(super) const CAPACITY: usize = 1 << 20;
/// Boxes of texels that one frame can upload.
pub(super) const REGIONS: usize = 1024;
/// Copies begin at multiples of this.
const ALIGNMENT: usize = 4;
/// With what lies between them.
const ROOM: usize = CAPACITY + ALIGNMENT * REGIONS;

/// Regions that wait for this frame's commands, and their bytes.
pub(super) struct Staging {
    pub(super) buffer: Buffer,
    pub(super) regions: Vec<(Region, u64)>,
    used: usize,
}

impl Staging {
    pub(super) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::STORAGE_BUFFER;
        let buffer = Buffer::new(gpu, ROOM, usage)?;
        Ok(Staging { buffer, regions: Vec::with_capacity(REGIONS), used: 0 })
    }

    /// Forgets what the frame before uploaded, once it is done.
    pub(super) fn clear(&mut self) {
        self.regions.clear();
        self.used = 0;
    }

    /// Whether a texel is in two regions.
    pub(super) fn overlaps(&self) -> bool {
        let regions = &self.regions;
        let overlaps_earlier =
            |i: usize| regions[..i].iter().any(|(earlier, _)| earlier.overlaps(&regions[i].0));
        (1..regions.len()).any(overlaps_earlier)
    }

    /// Takes a region's bytes, or says that there is no room for them in this frame.
    #[must_use]
    pub(super) fn push(&mut self, region: Region, bytes: &[u8]) -> bool {
        let at = self.used.next_multiple_of(ALIGNMENT);
        let fits = at + bytes.len() <= ROOM && self.regions.len() < REGIONS;
        if fits {
            self.buffer.write(at, bytes);
            self.regions.push((region, at as u64));
            self.used = at + bytes.len();
        }
        fits
    }
}
