//! All that is made of the runtime and the device for one session, and unmade together.

use std::sync::Arc;

use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::gpu::{self, Gpu, Show};
use paros_shell::durable;
use paros_shell::keeper::{Keeper, What};
use paros_shell::places::Places;

use crate::error::Error;
use crate::host::Host;
use crate::options::Options;
use crate::xr::{Eyes, Runtime, Session};

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
    /// A session that shows a world.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn new(
        host: &mut dyn Host,
        options: &Options,
        world: &World<N>,
        places: &Places,
    ) -> Result<Self, Error> {
        let runtime = Runtime::new(host)?;
        let wanted = gpu::Options { validation: options.validation, ..gpu::Options::default() };
        let gpu = runtime.gpu(&wanted)?;
        let session = Session::new(&runtime, &gpu)?;
        session.ask(&runtime, options.rate);
        let with_depth = options.depth && runtime.extensions.khr_composition_layer_depth;
        let format = Eyes::format(&session.raw, &gpu, with_depth)?;
        // Without it the start takes longer, that is all.
        let kept = durable::read(&places.pipelines()).unwrap_or_default();
        let show = Show::new(&gpu, format, world, &kept)?;
        let eyes = Eyes::new(&runtime, &session.raw, &gpu, &show.renderer, options.script)?;
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
