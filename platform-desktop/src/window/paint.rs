//! What `egui` laid out, as the renderer's triangles and texels.

use egui::epaint::{ClippedPrimitive, ImageData, ImageDelta, Primitive};
use egui::{TextureId, TexturesDelta};
use paros_shaders::gpu::overlay::{ATLAS, Overlay, PATCH, Run, Vertex};

/// Rows of the atlas that a frame takes.
const ROWS: usize = PATCH / SIDE;

/// Texels along a side of the atlas.
const SIDE: usize = ATLAS as usize;

/// The panels of a frame, and the atlas with what of it the device hasn't got yet.
#[derive(Debug)]
pub(super) struct Painted {
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
    runs: Vec<Run>,
    texels: Vec<[u8; 4]>,
    /// Texels of the layouter's own atlas, the upper left part of ours.
    size: [usize; 2],
    /// Rows that changed.
    changed: core::ops::Range<usize>,
}

impl Painted {
    /// Nothing.
    #[must_use]
    #[allow(clippy::new_without_default)] // megabytes: to be made on purpose
    pub(super) fn new() -> Self {
        Painted {
            vertices: Vec::new(),
            indices: Vec::new(),
            runs: Vec::new(),
            texels: vec![[0; 4]; SIDE * SIDE],
            size: [1, 1],
            changed: 0..0,
        }
    }

    /// Takes in changes of the atlas. There is one texture, that of the fonts.
    pub(super) fn take_textures(&mut self, delta: &TexturesDelta) {
        for (id, delta) in &delta.set {
            if *id == TextureId::default() {
                self.patch(delta);
            }
        }
    }

    /// Takes over the triangles of a frame, at so many pixels a point.
    pub(super) fn take_triangles(&mut self, primitives: &[ClippedPrimitive], scale: f32) {
        self.vertices.clear();
        self.indices.clear();
        self.runs.clear();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let first = self.indices.len() as u32;
            let base = self.vertices.len() as u32;
            self.indices.extend(mesh.indices.iter().map(|index| base + index));
            let [width, height] = self.size.map(|side| side as f32);
            self.vertices.extend(mesh.vertices.iter().map(|vertex| Vertex {
                position: [vertex.pos.x * scale, vertex.pos.y * scale],
                texel: [vertex.uv.x * width, vertex.uv.y * height],
                color: vertex.color.to_array(),
            }));
            let pixel = |points: f32| (points * scale).round().max(0.0) as u32;
            let (min, max) = (clip_rect.min, clip_rect.max);
            let clip = [pixel(min.x), pixel(min.y), pixel(max.x), pixel(max.y)];
            self.runs.push(Run { clip, indices: first..self.indices.len() as u32 });
        }
    }

    /// Hands all to a frame that has begun: the triangles, and rows of the atlas.
    pub(super) fn hand_over(&mut self, overlay: &mut Overlay, extent: [u32; 2]) {
        let rows = self.changed.start..self.changed.end.min(self.changed.start + ROWS);
        let texels = &self.texels[rows.start * SIDE..rows.end * SIDE];
        let size = [ATLAS, rows.len() as u32];
        if !rows.is_empty() && overlay.patch([0, rows.start as u32], size, texels) {
            self.changed.start = rows.end;
        }
        // Panels that are too much for a frame are left out of it.
        let _ = overlay.draw(&self.vertices, &self.indices, &self.runs, extent);
    }

    /// The device has lost the atlas.
    pub(super) fn forget_device(&mut self) {
        self.changed = 0..self.size[1];
    }

    /// Vertices, indices and runs of the frame.
    #[cfg(test)]
    pub(super) fn lengths(&self) -> (usize, usize, usize) {
        (self.vertices.len(), self.indices.len(), self.runs.len())
    }

    fn patch(&mut self, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        let [left, top] = delta.pos.unwrap_or([0, 0]);
        if delta.pos.is_none() {
            self.size = [width, height];
        }
        // The layouter knows the atlas's size and stays within it.
        let (width, height) = (width.min(SIDE - left.min(SIDE)), height.min(SIDE - top.min(SIDE)));
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
