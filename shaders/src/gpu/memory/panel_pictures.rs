//! The shell's pictures for panels on the device: a layer for each cell. A frame writes at most one layer.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::image::{GpuImage, ImageSpec};
use super::panel_atlas::create_filled_image;
use crate::Image;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::limits::{PANEL_CELL_TEXELS, PANEL_CELLS};
use crate::panel::is_cell_picture;

/// Bytes of a cell: a texel has sRGB and alpha, which is 0 until a picture is set.
const CELL_BYTES: usize = 4 * PANEL_CELL_TEXELS * PANEL_CELL_TEXELS;

/// The layers, and the pictures that wait to be uploaded.
pub(crate) struct PanelPictureLayers {
    pub(crate) image: GpuImage,
    /// The texels of each cell; empty until a picture is set.
    texels: Vec<Vec<u8>>,
    waits: [bool; PANEL_CELLS],
    /// The cell that comes next if it waits: round robin, so that a cell that is set often can't starve
    /// another.
    next: usize,
    /// Staging buffers: one cell for each frame of the ring.
    staged: Vec<Buffer>,
}

impl PanelPictureLayers {
    /// Creates the layers, all transparent. Waits for the queue.
    pub(crate) fn new(gpu: &Arc<Gpu>, frames_in_flight: usize) -> Result<Self, Error> {
        let side = PANEL_CELL_TEXELS as u32;
        let spec = ImageSpec::new_2d(vk::Format::R8G8B8A8_SRGB, [side; 2], PANEL_CELLS as u32);
        let image = create_filled_image(gpu, spec, &vec![0; PANEL_CELLS * CELL_BYTES])?;
        let buffer = |_| Buffer::new(gpu, CELL_BYTES, vk::BufferUsageFlags::TRANSFER_SRC);
        Ok(PanelPictureLayers {
            image,
            texels: vec![Vec::new(); PANEL_CELLS],
            waits: [false; PANEL_CELLS],
            next: 0,
            staged: (0..frames_in_flight).map(buffer).collect::<Result<_, _>>()?,
        })
    }

    /// Queues a picture to be uploaded by one of the next frames, replacing a picture of the same cell that
    /// waits. Returns `false`, without effect, if it doesn't fit.
    pub(crate) fn set(&mut self, cell: u8, picture: &Image) -> bool {
        let fits = is_cell_picture(cell, picture);
        if fits {
            let cell = usize::from(cell);
            let texels = &mut self.texels[cell];
            texels.clear();
            let pixels = picture.pixels.as_chunks::<3>().0;
            texels.extend(pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]));
            self.waits[cell] = true;
        }
        fits
    }

    /// Records the upload of one waiting picture, if there is any, outside of a render pass. The last use
    /// of the ring's frame `slot_index` must be over.
    pub(crate) fn record_upload(
        &mut self,
        device: &ash::Device,
        commands: vk::CommandBuffer,
        slot_index: usize,
    ) {
        let turns = (0..PANEL_CELLS).map(|k| (self.next + k) % PANEL_CELLS);
        let Some(cell) = turns.into_iter().find(|cell| self.waits[*cell]) else { return };
        self.waits[cell] = false;
        self.next = (cell + 1) % PANEL_CELLS;
        let staged = &mut self.staged[slot_index];
        staged.write(0, &self.texels[cell]);
        let [width, height, depth] = self.image.spec.extent;
        let copy = vk::BufferImageCopy {
            image_subresource: vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                base_array_layer: cell as u32,
                layer_count: 1,
                ..vk::ImageSubresourceLayers::default()
            },
            image_extent: vk::Extent3D { width, height, depth },
            ..vk::BufferImageCopy::default()
        };
        let (read, write) =
            (vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        self.image.record_transition(commands, read, write);
        // SAFETY: the image is in this layout, and its layer is as large as the buffer; both outlive the frame.
        unsafe {
            device.cmd_copy_buffer_to_image(commands, staged.raw, self.image.raw, write, &[copy]);
        }
        self.image.record_transition(commands, write, read);
    }
}
