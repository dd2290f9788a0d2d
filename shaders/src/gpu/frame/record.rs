//! Command recording of a frame: shadow map, march starts, then the frame's pass.
//!
//! Order within that pass: tools and hands, which occlude much and cost little; the sculpture, which
//! costs the most; stool, bench and room, mostly occluded by then; and last particles and panels, blended,
//! with depth test and without depth writes. `paros-bench render` and the test `gpu_order` measure
//! other orders.

use ash::vk;

use super::renderer::Renderer;
use super::request::{FrameRequest, RenderStyle, SculptureOrder};
use crate::gpu::passes::fragments::PassPart;
use crate::gpu::passes::shadow_map;
use crate::gpu::passes::target::RenderTarget;
use crate::gpu::passes::timers::Timestamp;
use crate::gpu::pipelines::paths::RenderPath;
use crate::scene::{Batch, DrawGroup, DrawList};

const GRAPHICS: vk::PipelineBindPoint = vk::PipelineBindPoint::GRAPHICS;

/// A render pass and the framebuffer that it draws to.
struct PassFramebuffer {
    pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    /// Pixels across and down.
    extent: [u32; 2],
}

impl Renderer {
    fn bind_graphics_set(&self, commands: vk::CommandBuffer, set: vk::DescriptorSet) {
        // SAFETY: the set has the layout's bindings, and what it names is alive.
        unsafe {
            self.gpu.device.cmd_bind_descriptor_sets(
                commands,
                GRAPHICS,
                self.pipelines.layout,
                0,
                &[set],
                &[],
            );
        }
    }

    /// Records the shadow map. Without a scene it is cleared once, so that it can be sampled.
    pub(crate) fn record_shadow_map(
        &mut self,
        commands: vk::CommandBuffer,
        scene: Option<&DrawList>,
        set: vk::DescriptorSet,
    ) {
        if scene.is_none() && self.shadow.is_drawn {
            return;
        }
        self.shadow.is_drawn = true;
        let far = vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 };
        let clear = [vk::ClearValue { depth_stencil: far }];
        let drawn = PassFramebuffer {
            pass: self.shadow.pass.raw,
            framebuffer: self.shadow.framebuffer.raw,
            extent: [shadow_map::MAP_SIDE; 2],
        };
        self.record_pass(commands, drawn, &clear, |device| {
            let Some(scene) = scene else { return };
            self.bind_graphics_set(commands, set);
            let [meshes, sculpture] = self.pipelines.shadow_casters;
            self.bind_meshes(commands);
            // SAFETY: the pass is the pipelines'; the box's vertices are made from their numbers.
            unsafe {
                device.cmd_bind_pipeline(commands, GRAPHICS, sculpture);
                device.cmd_draw(commands, BOX_STRIP_VERTICES, 1, 0, 0);
                device.cmd_bind_pipeline(commands, GRAPHICS, meshes);
            }
            for batch in scene.batches().iter().filter(|batch| batch.casts_shadow()) {
                self.draw_bound_batch(commands, batch);
            }
        });
    }

    /// Records the march starts: of the tiles, then of the beams in non-empty tiles.
    pub(crate) fn record_march_starts(&self, commands: vk::CommandBuffer, target: &RenderTarget) {
        let [tiles, beams] = &target.march_starts;
        let draws = [(tiles, 3, 1), (beams, 4, tiles.extent[0] * tiles.extent[1])];
        let none = vk::ClearColorValue { float32: [-1.0; 4] };
        for (((march_starts, vertices, instances), pipeline), pass) in
            draws.into_iter().zip(self.pipelines.march_starts).zip(&self.march_starts)
        {
            let drawn = PassFramebuffer {
                pass: pass.raw,
                framebuffer: march_starts.framebuffer.raw,
                extent: march_starts.extent,
            };
            let clear = [vk::ClearValue { color: none }];
            self.record_pass(commands, drawn, &clear, |device| {
                self.bind_graphics_set(commands, target.sets[self.slot_index]);
                // SAFETY: the pass is the pipeline's, and vertices are made from their numbers.
                unsafe {
                    device.cmd_bind_pipeline(commands, GRAPHICS, pipeline);
                    device.cmd_draw(commands, vertices, instances, 0, 0);
                }
            });
        }
    }

    pub(crate) fn record_frame_pass(
        &self,
        commands: vk::CommandBuffer,
        request: &FrameRequest<'_>,
        target: &RenderTarget,
        image_index: usize,
    ) {
        let [r, g, b] = request.backdrop;
        let color = vk::ClearColorValue { float32: [r, g, b, 1.0] };
        let depth = vk::ClearDepthStencilValue { depth: 0.0, stencil: 0 };
        let clears = [
            vk::ClearValue { color },
            vk::ClearValue { depth_stencil: depth },
            vk::ClearValue { color },
        ];
        let drawn = PassFramebuffer {
            pass: self.frame.raw,
            framebuffer: target.framebuffers[if target.scaled.is_some() { 0 } else { image_index }]
                .raw,
            extent: target.drawn_extent(),
        };
        self.record_pass(commands, drawn, &clears, |_| {
            self.bind_graphics_set(commands, target.sets[self.slot_index]);
            if request.scene.is_some() {
                self.bind_meshes(commands);
            }
            let parts = match self.order {
                SculptureOrder::Between => {
                    [PassPart::Handheld, PassPart::Sculpture, PassPart::Surroundings]
                }
                SculptureOrder::First => {
                    [PassPart::Sculpture, PassPart::Handheld, PassPart::Surroundings]
                }
                SculptureOrder::Last => {
                    [PassPart::Handheld, PassPart::Surroundings, PassPart::Sculpture]
                }
            };
            for part in parts {
                let counters = &self.ring[self.slot_index].counters;
                counters.count_during(commands, part, || {
                    self.record_part(commands, part, request, target);
                });
            }
            if let Some(scene) = request.scene {
                self.record_group_of_bound_meshes(commands, scene, DrawGroup::Hidden);
                self.record_group_of_bound_meshes(commands, scene, DrawGroup::Particles);
            }
            if target.scaled.is_none() {
                self.record_overlay(commands, target, target.drawn_extent());
            }
        });
        if let Some(scaled) = &target.scaled {
            scaled.record_scaling(commands, image_index, target.drawn_extent());
            let drawn = PassFramebuffer {
                pass: scaled.overlay_pass,
                framebuffer: scaled.overlay_framebuffers[image_index].raw,
                extent: target.extent,
            };
            self.record_pass(commands, drawn, &[], |_| {
                self.record_overlay(commands, target, target.extent);
            });
        }
    }

    /// Records the overlay, and the panels in the room.
    fn record_overlay(&self, commands: vk::CommandBuffer, target: &RenderTarget, pixels: [u32; 2]) {
        self.overlay.record_draws(commands, pixels);
        self.record_panels(commands, target, pixels);
    }

    /// Records the panels. Binds all state again, since the overlay has bound its own.
    fn record_panels(
        &self,
        commands: vk::CommandBuffer,
        target: &RenderTarget,
        [width, height]: [u32; 2],
    ) {
        let slot = &self.ring[self.slot_index];
        if slot.panel_quad_count == 0 {
            return;
        }
        self.bind_graphics_set(commands, target.sets[self.slot_index]);
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..vk::Rect2D::default() };
        let device = &self.gpu.device;
        // SAFETY: the pass is the pipeline's; a strip's four vertices are made from their numbers, and the slot's
        // buffer has as many quads.
        unsafe {
            device.cmd_set_scissor(commands, 0, &[area]);
            device.cmd_bind_pipeline(commands, GRAPHICS, self.pipelines.panels);
            device.cmd_bind_vertex_buffers(commands, 1, &[slot.panel_quads()], &[0]);
            device.cmd_draw(commands, 4, slot.panel_quad_count, 0, 0);
        }
    }

    fn record_part(
        &self,
        commands: vk::CommandBuffer,
        part: PassPart,
        request: &FrameRequest<'_>,
        target: &RenderTarget,
    ) {
        let timers = &self.ring[self.slot_index].timers;
        match (part, request.scene) {
            (PassPart::Sculpture, _) => {
                let write = |mark| {
                    if self.times_sculpture {
                        timers.write_timestamp(commands, mark);
                    }
                };
                write(Timestamp::SculptureBegins);
                if request.shows_sculpture() {
                    self.record_sculpture(commands, &request.style, target);
                }
                write(Timestamp::SculptureEnds);
            }
            (PassPart::Handheld, Some(scene)) => {
                self.record_group_of_bound_meshes(commands, scene, DrawGroup::Handheld);
            }
            (PassPart::Surroundings, Some(scene)) => {
                self.record_group_of_bound_meshes(commands, scene, DrawGroup::Surroundings);
            }
            (PassPart::Handheld | PassPart::Surroundings, None) => {}
        }
    }

    fn record_sculpture(
        &self,
        commands: vk::CommandBuffer,
        style: &RenderStyle,
        target: &RenderTarget,
    ) {
        let across = target.march_starts[0].extent;
        // A strip for the box's faces, or one for each tile.
        let (vertices, instances) = match style.path {
            RenderPath::Paper(_) => (BOX_STRIP_VERTICES, 1),
            RenderPath::Fast => (4, across[0] * across[1]),
        };
        let device = &self.gpu.device;
        // SAFETY: the pass is the pipeline's, and the vertices are made from their numbers.
        unsafe {
            let pipeline = self.pipelines.sculpture_pipeline(style.path, style.drawn);
            device.cmd_bind_pipeline(commands, GRAPHICS, pipeline);
            device.cmd_draw(commands, vertices, instances, 0, 0);
        }
    }

    fn record_group_of_bound_meshes(
        &self,
        commands: vk::CommandBuffer,
        scene: &DrawList,
        group: DrawGroup,
    ) {
        let pipeline = match group {
            DrawGroup::Particles => self.pipelines.particles,
            DrawGroup::Hidden => self.pipelines.hidden,
            DrawGroup::Handheld | DrawGroup::Surroundings => self.pipelines.meshes,
        };
        // SAFETY: the pass is the pipeline's.
        unsafe { self.gpu.device.cmd_bind_pipeline(commands, GRAPHICS, pipeline) };
        // The room is the first of the list and behind all else.
        for batch in scene.batches().iter().rev().filter(|batch| batch.group == group) {
            self.draw_bound_batch(commands, batch);
        }
    }

    fn bind_meshes(&self, commands: vk::CommandBuffer) {
        let device = &self.gpu.device;
        let buffers = [self.meshes.vertices.raw, self.ring[self.slot_index].instances.raw];
        // SAFETY: the buffers are alive and made for this.
        unsafe {
            device.cmd_bind_vertex_buffers(commands, 0, &buffers, &[0, 0]);
            let indices = self.meshes.indices.raw;
            device.cmd_bind_index_buffer(commands, indices, 0, vk::IndexType::UINT16);
        }
    }

    fn draw_bound_batch(&self, commands: vk::CommandBuffer, batch: &Batch) {
        let mesh = batch.mesh.range();
        // SAFETY: the mesh lies within the tables that are bound, the instances within the slot's.
        unsafe {
            self.gpu.device.cmd_draw_indexed(
                commands,
                mesh.index_count,
                batch.count,
                mesh.first_index,
                mesh.base_vertex as i32,
                batch.first,
            );
        }
    }

    /// Records a render pass over a framebuffer, or over the part of it that is drawn; `inside` records the
    /// contents. A multiview pass makes bound state undefined, so each pass binds what it needs.
    fn record_pass(
        &self,
        commands: vk::CommandBuffer,
        PassFramebuffer { pass, framebuffer, extent: [width, height] }: PassFramebuffer,
        clears: &[vk::ClearValue],
        inside: impl FnOnce(&ash::Device),
    ) {
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..vk::Rect2D::default() };
        let viewport = vk::Viewport {
            width: width as f32,
            height: height as f32,
            max_depth: 1.0,
            ..vk::Viewport::default()
        };
        let info = vk::RenderPassBeginInfo::default()
            .render_pass(pass)
            .framebuffer(framebuffer)
            .render_area(area)
            .clear_values(clears);
        let device = &self.gpu.device;
        // SAFETY: the commands are being recorded outside of a pass, and the framebuffer is the
        // pass's.
        unsafe {
            device.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE);
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[area]);
        }
        inside(device);
        // SAFETY: the pass was begun above.
        unsafe { device.cmd_end_render_pass(commands) };
    }
}

/// Vertices of the triangle strip over the sculpture's box.
const BOX_STRIP_VERTICES: u32 = 14;
