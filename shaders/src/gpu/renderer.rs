//! The renderer: a ring of two frames, each with its commands, its bytes and its clock.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::{Doing, Error};
use super::fragments::Fragments;
use super::frame::{self, Order, Path, Picture};
use super::overlay::Overlay;
use super::owned::Owned;
use super::pass::{Format, Pass};
use super::pipelines::{Passes, Pipelines};
use super::scatter::Scatter;
use super::shadow::ShadowMap;
use super::slot::Slot;
use super::staging::CAPACITY;
use super::surface::{Parts, Surface, Views};
use super::textures::Textures;
use super::timers::{Mark, Times};
use crate::constants::NOISE_SIZE;
use crate::scene::meshes;
use crate::upload::{Region, Texture};
use crate::{marble, noise};

/// Frames that may be under way at once.
const RING: usize = 2;

/// What a frame's commands wait for and tell, where the shell has a window.
#[derive(Clone, Copy, Default, Debug)]
pub struct Sync {
    /// The image may be drawn into.
    pub wait: Option<vk::Semaphore>,
    /// The image has been drawn.
    pub signal: Option<vk::Semaphore>,
}

/// Draws sculptures of N voxels a side, for one format of images.
///
/// A call that fails may have lost what was to be uploaded: the renderer is to be dropped, and
/// another one made, of another device if it [is lost].
///
/// [is lost]: Error::is_lost
pub struct Renderer {
    pub(super) gpu: Arc<Gpu>,
    format: Format,
    n: usize,
    /// Panels over the frame that has begun.
    pub overlay: Overlay,
    pub(super) starts: Pass,
    pub(super) shadow: ShadowMap,
    pub(super) frame: Pass,
    pub(super) pipelines: Pipelines,
    pub(super) textures: Textures,
    /// None where programs can't write textures.
    scatter: Option<Scatter>,
    pub(super) meshes: Meshes,
    pub(super) ring: Vec<Slot>,
    /// Of the ring's commands.
    _pool: Owned<vk::CommandPool>,
    pub(super) at: usize,
    times: Times,
    fragments: Fragments,
    pub(super) order: Order,
}

/// The scene's meshes, on the device for good.
pub(super) struct Meshes {
    pub(super) vertices: Buffer,
    pub(super) indices: Buffer,
}

impl core::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Renderer").field("format", &self.format).field("n", &self.n).finish()
    }
}

impl Renderer {
    /// A renderer for volumes of `n` voxels a side. `cache` is what [`Renderer::cache`] gave at an
    /// earlier start, or nothing. Without density maps if the device has none: see [`Gpu::lacks`].
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn new(gpu: &Arc<Gpu>, format: Format, n: usize, cache: &[u8]) -> Result<Self, Error> {
        let density_map = format.density_map && gpu.needs.density_map;
        let format = Format { density_map, ..format };
        let starts = Pass::starts(gpu, &format)?;
        let frame = Pass::frame(gpu, &format)?;
        let shadow = ShadowMap::new(gpu)?;
        let passes = Passes { starts: &starts, shadow: &shadow.pass, frame: &frame };
        let pipelines = Pipelines::new(gpu, &format, &passes, cache)?;
        let textures = Textures::new(gpu, n as u32, marble::SIDE as u32)?;
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(gpu.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the family is the device's.
        let pool = unsafe { gpu.device.create_command_pool(&info, None) }.doing("make a pool")?;
        let pool = Owned::new(gpu, pool);
        let overlay = Overlay::new(gpu, &format, &frame, RING, pipelines.cache)?;
        let ring = (0..RING)
            .map(|_| Slot::new(gpu, pool.raw, format.views))
            .collect::<Result<Vec<_>, _>>()?;
        let staged = ring.iter().map(|slot| &slot.staging);
        let scatter = match gpu.needs.scatter {
            true => Some(Scatter::new(gpu, &textures, staged, pipelines.cache)?),
            false => None,
        };
        let mut renderer = Renderer {
            gpu: gpu.clone(),
            format,
            n,
            overlay,
            starts,
            shadow,
            frame,
            pipelines,
            textures,
            scatter,
            meshes: Meshes::new(gpu)?,
            ring,
            _pool: pool,
            at: 0,
            times: Times::default(),
            fragments: Fragments::default(),
            order: Order::default(),
        };
        let cube = |texture, side: usize| Region { texture, min: [0; 3], size: [side as u32; 3] };
        let bytes: Vec<u8> = noise::texture().iter().map(|noise| noise.cast_unsigned()).collect();
        renderer.load(cube(Texture::Noise, NOISE_SIZE), &bytes)?;
        renderer.load(cube(Texture::Marble, marble::SIDE), marble::texture())?;
        Ok(renderer)
    }

    /// The format it draws: what was asked for, as far as the device has it.
    #[must_use]
    pub const fn format(&self) -> &Format {
        &self.format
    }

    /// How long the device took for the latest frame known to be done.
    #[must_use]
    pub const fn times(&self) -> Times {
        self.times
    }

    /// How many fragments were shaded for that frame.
    #[must_use]
    pub const fn fragments(&self) -> Fragments {
        self.fragments
    }

    /// Draws in another order from now on, for measuring.
    pub const fn draw_in(&mut self, order: Order) {
        self.order = order;
    }

    /// What makes the next start faster, for this device and driver.
    ///
    /// # Errors
    /// A lost device.
    pub fn cache(&self) -> Result<Vec<u8>, Error> {
        self.pipelines.cache()
    }

    /// A surface for views of the shell's images.
    ///
    /// # Errors
    /// A call that failed.
    pub fn surface(
        &self,
        extent: [u32; 2],
        colors: &[vk::ImageView],
        depths: &[vk::ImageView],
    ) -> Result<Surface, Error> {
        self.mapped_surface(extent, colors, depths, &[])
    }

    /// A surface for views of the shell's images and of their density maps, one for each, which are
    /// not looked at where [`Renderer::format`] is without.
    ///
    /// # Errors
    /// [`Error::NoDensityMap`], or a call that failed.
    pub fn mapped_surface(
        &self,
        extent: [u32; 2],
        colors: &[vk::ImageView],
        depths: &[vk::ImageView],
        densities: &[vk::ImageView],
    ) -> Result<Surface, Error> {
        let parts = Parts {
            gpu: &self.gpu,
            format: &self.format,
            starts: &self.starts,
            frame: &self.frame,
            pipelines: &self.pipelines,
            textures: &self.textures,
            shadow: &self.shadow,
        };
        let views = Views { colors, depths, densities };
        Surface::new(&parts, extent, &views, self.ring.iter().map(|slot| &slot.uniform))
    }

    /// Begins a frame: waits until the one before the last is done.
    ///
    /// # Errors
    /// A lost device.
    pub fn begin(&mut self) -> Result<(), Error> {
        let slot = &mut self.ring[self.at];
        if slot.under_way {
            let fences = [slot.done.raw];
            // SAFETY: the fence is this device's.
            unsafe { self.gpu.device.wait_for_fences(&fences, true, u64::MAX) }
                .doing("wait for a frame")?;
            slot.under_way = false;
        }
        if slot.drew {
            (self.times, self.fragments) = (slot.timers.read(), slot.counters.read());
        }
        slot.drew = false;
        slot.staging.clear();
        self.overlay.begin(self.at);
        Ok(())
    }

    /// Takes bytes of a region to be uploaded in the frame that has begun. Whether there was room.
    #[must_use]
    pub fn upload(&mut self, region: Region, bytes: &[u8]) -> bool {
        debug_assert_eq!(region.bytes(), bytes.len(), "a region's bytes");
        self.ring[self.at].staging.push(region, bytes)
    }

    /// Uploads a region of any size at once, in as many frames as it takes, without drawing.
    ///
    /// # Errors
    /// A lost device.
    pub fn load(&mut self, region: Region, bytes: &[u8]) -> Result<(), Error> {
        let layer = bytes.len() / region.size[2] as usize;
        let layers = (CAPACITY / layer).max(1);
        for (i, part) in bytes.chunks(layers * layer).enumerate() {
            let mut piece = region;
            piece.min[2] += (i * layers) as u32;
            piece.size[2] = (part.len() / layer) as u32;
            self.begin()?;
            let fits = self.upload(piece, part);
            assert!(fits, "a layer of a texture is larger than a frame's staging memory");
            self.submit(Sync::default(), |_, _| ())?;
        }
        Ok(())
    }

    /// Draws a picture into an image of a surface, with what was uploaded since [`begin`].
    ///
    /// [`begin`]: Renderer::begin
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(
        &mut self,
        picture: &Picture<'_>,
        surface: &Surface,
        image: usize,
        sync: Sync,
    ) -> Result<(), Error> {
        let bytes = frame::layout(picture, self.n, surface.extent);
        let slot = &mut self.ring[self.at];
        slot.uniform.write(0, bytemuck::bytes_of(&bytes));
        if let Some(scene) = picture.scene {
            slot.instances.write(0, bytemuck::cast_slice(scene.instances()));
        }
        let at = self.at;
        self.submit(sync, |renderer, commands| {
            renderer.draw_shadows(commands, picture.scene, surface.sets[at]);
            renderer.ring[at].timers.mark(commands, Mark::Shadowed);
            if picture.look.path == Path::Fast {
                renderer.find_starts(commands, surface);
            }
            renderer.ring[at].timers.mark(commands, Mark::Tiled);
            renderer.draw_frame(commands, picture, surface, image);
            renderer.ring[at].drew = true;
        })
    }

    /// Waits until the latest frame is done; how long the device took for its parts.
    ///
    /// # Errors
    /// A lost device.
    pub fn finish(&mut self) -> Result<Times, Error> {
        self.gpu.wait()?;
        let slot = &self.ring[(self.at + RING - 1) % RING];
        if slot.drew {
            (self.times, self.fragments) = (slot.timers.read(), slot.counters.read());
        }
        Ok(self.times)
    }

    /// Records the uploads and what `record` adds, and submits it all.
    fn submit(
        &mut self,
        sync: Sync,
        record: impl FnOnce(&mut Self, vk::CommandBuffer),
    ) -> Result<(), Error> {
        let gpu = self.gpu.clone();
        let slot = &mut self.ring[self.at];
        let (commands, done) = (slot.commands, slot.done.raw);
        let info = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the frame's fence has passed, so its commands are free.
        unsafe { gpu.device.begin_command_buffer(commands, &info) }.doing("record")?;
        slot.timers.reset(commands);
        slot.counters.reset(commands);
        slot.timers.mark(commands, Mark::Begin);
        self.textures.record(commands, &slot.staging, self.scatter.as_mut(), self.at);
        self.overlay.record_copies(commands);
        slot.timers.mark(commands, Mark::Uploaded);
        record(self, commands);
        self.ring[self.at].timers.mark(commands, Mark::End);
        // SAFETY: the commands are being recorded.
        unsafe { gpu.device.end_command_buffer(commands) }.doing("record")?;
        let buffers = [commands];
        let (waits, signals) = (sync.wait.as_slice(), sync.signal.as_slice());
        let stages = [vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT];
        let info = vk::SubmitInfo::default()
            .command_buffers(&buffers)
            .wait_semaphores(waits)
            .wait_dst_stage_mask(&stages[..waits.len()])
            .signal_semaphores(signals);
        // SAFETY: the fence has passed, and the queue is used by one thread.
        unsafe {
            gpu.device.reset_fences(&[done]).doing("reset a fence")?;
            gpu.device.queue_submit(gpu.queue, &[info], done).doing("submit a frame")?;
        }
        self.ring[self.at].under_way = true;
        self.at = (self.at + 1) % RING;
        Ok(())
    }
}

impl Meshes {
    fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let constant = |bytes, usage| Buffer::constant(gpu, bytes, usage);
        let vertices = bytemuck::cast_slice(meshes::vertices());
        let indices = bytemuck::cast_slice(meshes::indices());
        Ok(Meshes {
            vertices: constant(vertices, vk::BufferUsageFlags::VERTEX_BUFFER)?,
            indices: constant(indices, vk::BufferUsageFlags::INDEX_BUFFER)?,
        })
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // A lost device has nothing under way.
        let _ = self.gpu.wait();
    }
}
