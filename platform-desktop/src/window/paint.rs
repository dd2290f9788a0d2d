//! `egui`'s output as the overlay's vertex buffers and texture atlas.

use egui::epaint::{ClippedPrimitive, ImageData, ImageDelta, Primitive};
use egui::{ColorImage, TextureId, TexturesDelta};
use paros_shaders::gpu::overlay::{ATLAS_SIDE, ClippedRun, MAX_FRAME_TEXELS, Overlay, PanelVertex};

/// Atlas rows that a frame can upload.
const ROWS: usize = MAX_FRAME_TEXELS / SIDE;

/// Texels along a side of the atlas.
const SIDE: usize = ATLAS_SIDE as usize;

/// A frame's triangles, and the font atlas with the rows that are not uploaded yet.
#[derive(Debug)]
pub(super) struct EguiBuffers {
    vertices: Vec<PanelVertex>,
    indices: Vec<u32>,
    runs: Vec<ClippedRun>,
    texels: Vec<[u8; 4]>,
    /// Size of `egui`'s atlas in texels. It is stored in the upper left of our atlas.
    size: [usize; 2],
    /// The other texture and its size in texels. It is stored in the lower left, which `egui`'s atlas never
    /// reaches.
    picture: Option<(TextureId, [usize; 2])>,
    /// Atlas rows that changed since their last upload.
    changed: core::ops::Range<usize>,
}

/// Lengths of a frame's buffers.
#[cfg(test)]
pub(super) struct BufferLengths {
    pub(super) vertices: usize,
    pub(super) indices: usize,
    pub(super) runs: usize,
}

impl EguiBuffers {
    /// Creates empty buffers and a transparent atlas.
    #[must_use]
    #[allow(clippy::new_without_default)] // megabytes: to be made on purpose
    pub(super) fn new() -> Self {
        EguiBuffers {
            vertices: Vec::new(),
            indices: Vec::new(),
            runs: Vec::new(),
            texels: vec![[0; 4]; SIDE * SIDE],
            size: [1, 1],
            picture: None,
            changed: 0..0,
        }
    }

    /// Applies changes of the font atlas, and stores one other texture. Further textures are ignored.
    pub(super) fn apply_atlas_changes(&mut self, delta: &TexturesDelta) {
        for (id, delta) in &delta.set {
            if *id == TextureId::default() {
                self.patch_atlas(delta);
            } else if self.picture.is_none_or(|(known, _)| known == *id) {
                self.set_picture(*id, delta);
            }
        }
    }

    /// Converts a frame's primitives to the overlay's triangles.
    pub(super) fn set_triangles_of_frame(
        &mut self,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) {
        self.vertices.clear();
        self.indices.clear();
        self.runs.clear();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let first = self.indices.len() as u32;
            let base = self.vertices.len() as u32;
            self.indices.extend(mesh.indices.iter().map(|index| base + index));
            let picture = self.picture.filter(|(id, _)| *id == mesh.texture_id);
            let ([width, height], top) =
                picture.map_or((self.size, 0), |(_, size)| (size, SIDE - size[1]));
            let [width, height, top] = [width, height, top].map(|texels| texels as f32);
            self.vertices.extend(mesh.vertices.iter().map(|vertex| PanelVertex {
                position: [vertex.pos.x * pixels_per_point, vertex.pos.y * pixels_per_point],
                texel: [vertex.uv.x * width, top + vertex.uv.y * height],
                color: vertex.color.to_array(),
            }));
            let pixel = |points: f32| (points * pixels_per_point).round().max(0.0) as u32;
            let (min, max) = (clip_rect.min, clip_rect.max);
            let clip = [pixel(min.x), pixel(min.y), pixel(max.x), pixel(max.y)];
            self.runs.push(ClippedRun { clip, indices: first..self.indices.len() as u32 });
        }
    }

    /// Uploads the triangles and the next changed rows of the atlas, in a frame that has begun.
    pub(super) fn upload_into_begun_frame(&mut self, overlay: &mut Overlay, extent: [u32; 2]) {
        let rows = self.changed.start..self.changed.end.min(self.changed.start + ROWS);
        let texels = &self.texels[rows.start * SIDE..rows.end * SIDE];
        let size = [ATLAS_SIDE, rows.len() as u32];
        if !rows.is_empty() && overlay.try_stage_atlas_patch([0, rows.start as u32], size, texels) {
            self.changed.start = rows.end;
        }
        // Triangles that exceed the overlay's capacity are not drawn.
        let _ = overlay.try_set_triangles(&self.vertices, &self.indices, &self.runs, extent);
    }

    /// Marks the whole atlas as changed, for a new device.
    pub(super) fn mark_atlas_changed(&mut self) {
        self.changed = 0..SIDE;
    }

    /// Returns the lengths of the frame's buffers.
    #[cfg(test)]
    pub(super) fn buffer_lengths(&self) -> BufferLengths {
        let (vertices, indices) = (self.vertices.len(), self.indices.len());
        BufferLengths { vertices, indices, runs: self.runs.len() }
    }

    fn patch_atlas(&mut self, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        let [left, top] = delta.pos.unwrap_or([0, 0]);
        if delta.pos.is_none() {
            self.size = [width, height];
        }
        // `egui` keeps within the atlas's size; the limits only guard the index.
        let bottom = SIDE - self.picture.map_or(0, |(_, size)| size[1]);
        let (width, height) =
            (width.min(SIDE - left.min(SIDE)), height.min(bottom - top.min(bottom)));
        self.write_texels(image, [left, top], [width, height]);
    }

    /// Places a texture at the bottom of the atlas.
    fn set_picture(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        if delta.pos.is_none() && image.size[0] <= SIDE && image.size[1] <= ROWS {
            self.picture = Some((id, image.size));
            self.write_texels(image, [0, SIDE - image.size[1]], image.size);
        }
    }

    /// Writes the upper left part of an image into the atlas, and marks its rows as changed.
    fn write_texels(
        &mut self,
        image: &ColorImage,
        [left, top]: [usize; 2],
        [width, height]: [usize; 2],
    ) {
        for y in 0..height {
            for x in 0..width {
                let pixel = image.pixels[y * image.size[0] + x];
                self.texels[(top + y) * SIDE + left + x] = pixel.to_array();
            }
        }
        self.changed = if self.changed.is_empty() {
            top..top + height
        } else {
            self.changed.start.min(top)..self.changed.end.max(top + height)
        };
    }
}
