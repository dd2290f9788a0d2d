//! What a frame's commands draw: the sun's map, the beams' starts, then the frame's pass.
//!
//! In that pass, in this order: tools and hands, which hide much and cost little; the sculpture,
//! which costs the most; stool, bench and room, of which those hide the most; and last the
//! particles, mixed with what is behind them: they test depth, and leave it. What other orders of
//! the sculpture cost is told by `paros bench render` and, in fragments, by the test `gpu_order`.

use ash::vk;

use super::fragments::Part;
use super::frame::{Order, Path, Picture};
use super::renderer::Renderer;
use super::shadow;
use super::surface::Surface;
use super::timers::Mark;
use crate::scene::{Batch, DrawList, Stage};

const GRAPHICS: vk::PipelineBindPoint = vk::PipelineBindPoint::GRAPHICS;

impl Renderer {
    fn bind_set(&self, commands: vk::CommandBuffer, set: vk::DescriptorSet) {
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

    /// What the sun sees. Without a scene that is nothing, and drawn once, so that there is a map.
    pub(super) fn draw_shadows(
        &mut self,
        commands: vk::CommandBuffer,
        scene: Option<&DrawList>,
        set: vk::DescriptorSet,
    ) {
        if scene.is_none() && self.shadow.drawn {
            return;
        }
        self.shadow.drawn = true;
        let far = vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 };
        let clear = [vk::ClearValue { depth_stencil: far }];
        let target = (self.shadow.pass.raw, self.shadow.framebuffer.raw);
        self.within(commands, target, [shadow::SIDE; 2], &clear, |device| {
            let Some(scene) = scene else { return };
            self.bind_set(commands, set);
            let [meshes, sculpture] = self.pipelines.cast;
            self.bind_meshes(commands);
            // SAFETY: the pass is the pipelines'; the box's vertices are made from their numbers.
            unsafe {
                device.cmd_bind_pipeline(commands, GRAPHICS, sculpture);
                device.cmd_draw(commands, BOX_STRIP, 1, 0, 0);
                device.cmd_bind_pipeline(commands, GRAPHICS, meshes);
            }
            for batch in scene.batches().iter().filter(|batch| batch.mesh.casts_shadow()) {
                self.draw_batch(commands, batch);
            }
        });
    }

    /// The tiles' rays first, then those of the beams in the tiles that aren't empty.
    pub(super) fn find_starts(&self, commands: vk::CommandBuffer, surface: &Surface) {
        let [tiles, beams] = &surface.starts;
        let draws = [(tiles, 3, 1), (beams, 4, tiles.extent[0] * tiles.extent[1])];
        let none = vk::ClearColorValue { float32: [-1.0; 4] };
        for ((starts, vertices, instances), pipeline) in
            draws.into_iter().zip(self.pipelines.starts)
        {
            let pass = (self.starts.raw, starts.framebuffer.raw);
            let clear = [vk::ClearValue { color: none }];
            self.within(commands, pass, starts.extent, &clear, |device| {
                self.bind_set(commands, surface.sets[self.at]);
                // SAFETY: the pass is the pipeline's, and vertices are made from their numbers.
                unsafe {
                    device.cmd_bind_pipeline(commands, GRAPHICS, pipeline);
                    device.cmd_draw(commands, vertices, instances, 0, 0);
                }
            });
        }
    }

    pub(super) fn draw_frame(
        &self,
        commands: vk::CommandBuffer,
        picture: &Picture<'_>,
        surface: &Surface,
        image: usize,
    ) {
        let [r, g, b] = picture.backdrop;
        let color = vk::ClearColorValue { float32: [r, g, b, 1.0] };
        let depth = vk::ClearDepthStencilValue { depth: 0.0, stencil: 0 };
        let clears = [
            vk::ClearValue { color },
            vk::ClearValue { depth_stencil: depth },
            vk::ClearValue { color },
        ];
        let pass = (self.frame.raw, surface.framebuffers[image].raw);
        self.within(commands, pass, surface.extent, &clears, |_| {
            self.bind_set(commands, surface.sets[self.at]);
            if picture.scene.is_some() {
                self.bind_meshes(commands);
            }
            let parts = match self.order {
                Order::Between => [Part::Handled, Part::Sculpture, Part::Standing],
                Order::First => [Part::Sculpture, Part::Handled, Part::Standing],
                Order::Last => [Part::Handled, Part::Standing, Part::Sculpture],
            };
            for part in parts {
                let counters = &self.ring[self.at].counters;
                counters.around(commands, part, || {
                    self.draw_part(commands, part, picture, surface);
                });
            }
            if let Some(scene) = picture.scene {
                self.draw_stage(commands, scene, Stage::Particles);
            }
            self.overlay.record(commands, surface.extent);
        });
    }

    fn draw_part(
        &self,
        commands: vk::CommandBuffer,
        part: Part,
        picture: &Picture<'_>,
        surface: &Surface,
    ) {
        let timers = &self.ring[self.at].timers;
        match (part, picture.scene) {
            (Part::Sculpture, _) => {
                timers.mark(commands, Mark::SculptureBegins);
                if picture.shows_sculpture() {
                    self.draw_sculpture(commands, picture.look.path, surface);
                }
                timers.mark(commands, Mark::SculptureEnds);
            }
            (Part::Handled, Some(scene)) => self.draw_stage(commands, scene, Stage::Handled),
            (Part::Standing, Some(scene)) => self.draw_stage(commands, scene, Stage::Standing),
            (Part::Handled | Part::Standing, None) => {}
        }
    }

    fn draw_sculpture(&self, commands: vk::CommandBuffer, path: Path, surface: &Surface) {
        let across = surface.starts[0].extent;
        // A strip for the box's faces, or one for each tile.
        let (vertices, instances) = match path {
            Path::Paper(_) => (BOX_STRIP, 1),
            Path::Fast => (4, across[0] * across[1]),
        };
        let device = &self.gpu.device;
        // SAFETY: the pass is the pipeline's, and the vertices are made from their numbers.
        unsafe {
            device.cmd_bind_pipeline(commands, GRAPHICS, self.pipelines.sculpture(path));
            device.cmd_draw(commands, vertices, instances, 0, 0);
        }
    }

    fn draw_stage(&self, commands: vk::CommandBuffer, scene: &DrawList, stage: Stage) {
        let pipeline = match stage {
            Stage::Particles => self.pipelines.particles,
            Stage::Handled | Stage::Standing => self.pipelines.meshes,
        };
        // SAFETY: the pass is the pipeline's.
        unsafe { self.gpu.device.cmd_bind_pipeline(commands, GRAPHICS, pipeline) };
        // The room is the first of the list and behind all else.
        for batch in scene.batches().iter().rev().filter(|batch| batch.mesh.stage() == stage) {
            self.draw_batch(commands, batch);
        }
    }

    fn bind_meshes(&self, commands: vk::CommandBuffer) {
        let device = &self.gpu.device;
        let buffers = [self.meshes.vertices.raw, self.ring[self.at].instances.raw];
        // SAFETY: the buffers are alive and made for this.
        unsafe {
            device.cmd_bind_vertex_buffers(commands, 0, &buffers, &[0, 0]);
            let indices = self.meshes.indices.raw;
            device.cmd_bind_index_buffer(commands, indices, 0, vk::IndexType::UINT16);
        }
    }

    fn draw_batch(&self, commands: vk::CommandBuffer, batch: &Batch) {
        let mesh = batch.mesh.mesh();
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

    /// Records what `inside` adds within a pass over all of a framebuffer. A pass of several views
    /// forgets what was bound before it, so each binds what it needs.
    fn within(
        &self,
        commands: vk::CommandBuffer,
        (pass, framebuffer): (vk::RenderPass, vk::Framebuffer),
        [width, height]: [u32; 2],
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

/// Corners of the strip around the sculpture's box.
const BOX_STRIP: u32 = 14;
