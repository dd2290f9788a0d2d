//! The OpenXR and Vulkan objects of one session, created and destroyed together: first the ones that need no
//! shader programs, which show a notice, then the ones that draw the world.

use std::sync::Arc;

use paros_core::World;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headset::start_up::StartNotice;
use paros_shaders::gpu::{self, Gpu, TargetFormat, WorldRenderer};
use paros_shaders::upload::VolumeFormat;
use paros_shell::file_writer::{FileKind, FileWriter};
use paros_shell::studio_paths::StudioPaths;

use crate::compilation::{Compilation, Compiled};
use crate::error::Error;
use crate::foveation::{FOVEATION_EXTENSIONS, FoveationLevel};
use crate::options::ShellOptions;
use crate::platform::Platform;
use crate::xr::{EyeImages, EyeTargets, FrameCalls, HeadsetSession, NoticeLayer, Runtime};

/// A session without a renderer yet. Fields are dropped in this order.
pub(crate) struct OpenedSession {
    /// The layer that shows the loading notice; `None` if the runtime refuses it.
    pub(crate) notice: Option<NoticeLayer>,
    images: EyeImages,
    format: TargetFormat,
    pub(crate) session: HeadsetSession,
    pub(crate) gpu: Arc<Gpu>,
    pub(crate) runtime: Runtime,
}

/// A session and its renderer. Fields are dropped in this order.
pub(crate) struct SessionResources<const N: usize>
where
    Grid<N>: Size,
{
    pub(crate) eyes: EyeTargets,
    pub(crate) show: WorldRenderer<N, INTERVALS>,
    pub(crate) session: HeadsetSession,
    pub(crate) gpu: Arc<Gpu>,
    pub(crate) runtime: Runtime,
    /// The pipeline cache as last read from the disk or submitted for writing.
    pipeline_cache: Vec<u8>,
}

impl OpenedSession {
    /// Creates a session. The Vulkan instance, which collects the validation messages, is stored in
    /// `vulkan_out` even if a later step fails.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn create(
        platform: &mut dyn Platform,
        options: &ShellOptions,
        vulkan_out: &mut Option<Arc<gpu::Instance>>,
    ) -> Result<Self, Error> {
        let runtime = Runtime::create(platform, options)?;
        let missing = runtime.find_disabled_extensions(&FOVEATION_EXTENSIONS);
        let wanted = gpu::Options {
            validation: options.validation,
            density_map: missing.is_empty(),
            device_hook: platform.vulkan_device_wrapper(),
            ..gpu::Options::default()
        };
        let instance = vulkan_out.insert(runtime.create_vulkan(&wanted)?);
        let gpu = runtime.create_gpu(instance.clone(), &wanted)?;
        let session = HeadsetSession::create(&runtime, &gpu)?;
        platform.log(format_args!(
            "{}",
            session.request_refresh_rate_and_describe(&runtime, options.refresh_rate)
        ));
        if let Some(floor) = session.describe_missing_local_floor() {
            platform.log(format_args!("{} {floor}", runtime.name));
        }
        let with_depth = options.submit_depth && runtime.extensions.khr_composition_layer_depth;
        let mut format =
            EyeTargets::choose_format(&session.raw, &gpu, with_depth, options.samples)?;
        let images =
            EyeImages::create(&runtime, &session.raw, &gpu, &format, options.test_commands)?;
        format.density_map = images.have_density_maps();
        format.is_subsampled = images.are_subsampled();
        log_missing_features(platform, options, &runtime, &gpu, &format);
        let notice = NoticeLayer::create(&session.raw, &gpu, options.test_commands);
        let notice = notice.map_err(|why| {
            platform.log(format_args!("nothing is seen while the studio is made ready: {why}"));
        });
        Ok(OpenedSession { notice: notice.ok(), images, format, session, gpu, runtime })
    }

    /// Starts to compile the renderer's programs on a thread of their own.
    pub(crate) fn start_compiling(&self, volume: VolumeFormat, paths: &StudioPaths) -> Compilation {
        Compilation::start(&self.gpu, self.format, volume, paths.pipeline_cache_file())
    }

    /// Waits for the next frame, and shows a notice in it.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn wait_and_run_frame(&mut self, notice: &StartNotice) -> Result<(), Error> {
        let HeadsetSession { waiter, stream, .. } = &mut self.session;
        let calls = FrameCalls { waiter, stream, blend_mode: self.runtime.blend_mode };
        match &mut self.notice {
            Some(layer) => layer.wait_and_run_frame(calls, notice),
            None => calls.wait_and_run_empty_frame(),
        }
    }
}

impl<const N: usize> SessionResources<N>
where
    Grid<N>: Size,
{
    /// Creates the renderer of a world from the compiled programs. The notice stays visible until the first
    /// frame.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn create(
        opened: OpenedSession,
        compiled: Compiled,
        world: &World<N, INTERVALS>,
    ) -> Result<Self, Error> {
        let OpenedSession { images, session, gpu, runtime, .. } = opened;
        let Compiled { renderer, pipeline_cache } = compiled;
        let show = WorldRenderer::from_compiled(renderer, world)?;
        let eyes = EyeTargets::from_images(images, &show.renderer)?;
        Ok(SessionResources { eyes, show, session, gpu, runtime, pipeline_cache })
    }

    /// Submits the pipeline cache for writing if it has changed, so that the next start is faster. The driver
    /// may take longer than a frame: call this while no frame is due.
    pub(crate) fn submit_changed_pipeline_cache_between_frames(
        &mut self,
        paths: &StudioPaths,
        writer: &mut FileWriter,
    ) {
        if let Ok(bytes) = self.show.renderer.pipeline_cache_data()
            && bytes != self.pipeline_cache
        {
            writer.submit_file_or_wait(
                FileKind::PipelineCache,
                paths.pipeline_cache_file(),
                bytes.clone(),
            );
            self.pipeline_cache = bytes;
        }
    }
}

/// Logs a line for each requested feature that is missing; the session continues without it.
fn log_missing_features(
    platform: &mut dyn Platform,
    options: &ShellOptions,
    runtime: &Runtime,
    gpu: &Gpu,
    format: &TargetFormat,
) {
    let name = &runtime.name;
    if options.submit_depth && !format.keep_depth {
        let what = match runtime.extensions.khr_composition_layer_depth {
            true => format!("{name} takes no {:?}", TargetFormat::choose_depth(gpu)),
            false => format!("{name} has no XR_KHR_composition_layer_depth"),
        };
        platform.log(format_args!("no depth for the compositor, though it is asked for: {what}"));
    }
    if format.density_map {
        return;
    }
    let extensions = runtime.find_disabled_extensions(&FOVEATION_EXTENSIONS);
    let what = match (&extensions[..], &gpu.missing_features[..]) {
        ([], []) => format!("{name} gives no density maps with its pictures"),
        ([], lacks) => format!("{} has no {}", gpu.name, lacks.join(", ")),
        (extensions, _) => format!("{name} has no {}", extensions.join(", ")),
    };
    if let Some(line) = FoveationLevel::describe_unmet_request(options.foveation, &what) {
        platform.log(format_args!("{line}"));
    }
}
