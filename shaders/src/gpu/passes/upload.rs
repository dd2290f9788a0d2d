//! Texture uploads from staging memory, by a compute program or by copy commands.

use ash::vk;

use crate::gpu::memory::staging::Staging;
use crate::gpu::memory::textures::SculptureTextures;
use crate::gpu::pipelines::scatter::TexelWriter;
use crate::upload::Region;

/// Records the uploads of all staged regions of the frame in the ring's slot `slot_index`; the first call
/// clears the textures before. The compute program writes the regions that it can, unless some overlap.
pub(crate) fn record_uploads(
    textures: &mut SculptureTextures,
    commands: vk::CommandBuffer,
    staging: &Staging,
    writer: Option<&mut TexelWriter>,
    slot_index: usize,
) {
    textures.record_clear_once(commands);
    let writer = writer.filter(|_| !staging.has_overlaps());
    let is_written = |region: &Region| writer.is_some() && TexelWriter::can_write(region);
    let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
    let copied = textures.with_staged_regions(staging, |region| !is_written(region));
    if copied.contains(&true) {
        let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        textures.record_transition(commands, copied, read, write);
        textures.record_copies(commands, staging, |region| !is_written(region));
        textures.record_transition(commands, copied, write, read);
    }
    let writes = staging.regions.iter().any(|(region, _)| is_written(region));
    if let Some(writer) = writer.filter(|_| writes) {
        // All textures that the program has bound, whether it writes them or not.
        let bound = textures.with_storage_usage();
        textures.record_transition(commands, bound, read, vk::ImageLayout::GENERAL);
        writer.record_non_overlapping_writes(commands, slot_index, staging);
        textures.record_transition(commands, bound, vk::ImageLayout::GENERAL, read);
    }
}
