//! All that is made of the runtime and the device for one session, and unmade together.

use std::sync::Arc;

use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::gpu::{self, Format, Gpu, Show};
use paros_shell::durable;
use paros_shell::keeper::{Keeper, What};
use paros_shell::places::Places;

use crate::error::Error;
use crate::foveation::{self, Foveation};
use crate::host::Host;
use crate::options::Options;
use crate::xr::{Eyes, Images, Runtime, Session};

/// A session and what draws for it. The order of the fields is that of their end.
pub(crate) struct Rig<const N: usize>
where
    Grid<N>: Size,
{
    pub(crate) eyes: Eyes,
    pub(crate) show: Show<N>,
    pub(crate) session: Session,
    pub(crate) gpu: Arc<Gpu>,
    pub(crate) runtime: Runtime,
    /// The driver's compiled programs, as they are on the disk or on their way there.
    kept: Vec<u8>,
}

impl<const N: usize> Rig<N>
where
    Grid<N>: Size,
{
    /// A session that shows a world. What looks on at Vulkan is left in `vulkan`, even if the rest
    /// fails.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn new(
        host: &mut dyn Host,
        options: &Options,
        world: &World<N>,
        places: &Places,
        vulkan: &mut Option<Arc<gpu::Instance>>,
    ) -> Result<Self, Error> {
        let runtime = Runtime::new(host, options)?;
        let missing = runtime.lacks(&foveation::EXTENSIONS);
        let wanted = gpu::Options {
            validation: options.validation,
            density_map: missing.is_empty(),
            around_device: host.around_device(),
            ..gpu::Options::default()
        };
        let instance = vulkan.insert(runtime.vulkan(&wanted)?);
        let gpu = runtime.gpu(instance.clone(), &wanted)?;
        let session = Session::new(&runtime, &gpu)?;
        host.log(format_args!("{}", session.ask_rate(&runtime, options.rate)));
        session.ask_pace(&runtime);
        if let Some(floor) = session.floor() {
            host.log(format_args!("{} {floor}", runtime.name));
        }
        let with_depth = options.depth && runtime.extensions.khr_composition_layer_depth;
        let mut format = Eyes::format(&session.raw, &gpu, with_depth)?;
        let images = Images::new(&runtime, &session.raw, &gpu, &format, options.script)?;
        format.density_map = images.are_mapped();
        tell_what_is_missing(host, options, (&runtime, &gpu), &format);
        // Without it the start takes longer, that is all.
        let kept = durable::read(&places.pipelines()).unwrap_or_default();
        let show = Show::new(&gpu, format, world, &kept)?;
        let eyes = Eyes::new(images, &show.renderer)?;
        Ok(Rig { eyes, show, session, gpu, runtime, kept })
    }

    /// Has what makes the next start faster written, where that is new. The driver may take longer
    /// to tell than a frame lasts: it is for when none is due.
    pub(crate) fn keep_cache(&mut self, places: &Places, keeper: &mut Keeper) {
        if let Ok(bytes) = self.show.renderer.cache()
            && bytes != self.kept
        {
            keeper.keep(What::Cache, places.pipelines(), bytes.clone());
            self.kept = bytes;
        }
    }
}

/// What was asked for and can't be had is told, each in a line; the sculpting goes on without.
fn tell_what_is_missing(
    host: &mut dyn Host,
    options: &Options,
    (runtime, gpu): (&Runtime, &Gpu),
    format: &Format,
) {
    let name = &runtime.name;
    if options.depth && !format.keep_depth {
        let what = match runtime.extensions.khr_composition_layer_depth {
            true => format!("{name} takes no {:?}", Format::depth(gpu)),
            false => format!("{name} has no XR_KHR_composition_layer_depth"),
        };
        host.log(format_args!("no depth for the compositor, though it is asked for: {what}"));
    }
    if format.density_map {
        return;
    }
    let extensions = runtime.lacks(&foveation::EXTENSIONS);
    let what = match (&extensions[..], &gpu.lacks[..]) {
        ([], []) => format!("{name} gives no density maps with its pictures"),
        ([], lacks) => format!("{} has no {}", gpu.name, lacks.join(", ")),
        (extensions, _) => format!("{name} has no {}", extensions.join(", ")),
    };
    if let Some(line) = Foveation::missing(options.foveation, &what) {
        host.log(format_args!("{line}"));
    }
}
