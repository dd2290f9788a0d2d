//! The thread that compiles a renderer's programs, while the shell polls the session's events and makes its
//! frames.

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use paros_shaders::gpu::{self, CompiledRenderer, Gpu, TargetFormat};
use paros_shaders::upload::VolumeFormat;
use paros_shell::durable;

use crate::error::Error;

/// A running compilation of a renderer's programs. Dropping it waits for the thread, as the driver can't be
/// interrupted.
pub(crate) struct Compilation(Option<JoinHandle<Result<Compiled, gpu::Error>>>);

/// A renderer's programs.
pub(crate) struct Compiled {
    pub(crate) renderer: CompiledRenderer,
    /// The pipeline cache as it was read from the disk.
    pub(crate) pipeline_cache: Vec<u8>,
}

impl Compilation {
    /// Starts the thread.
    pub(crate) fn start(
        gpu: &Arc<Gpu>,
        format: TargetFormat,
        volume: VolumeFormat,
        cache_file: PathBuf,
    ) -> Self {
        let gpu = gpu.clone();
        Compilation(Some(thread::spawn(move || {
            // Without the cache the start only takes longer.
            let pipeline_cache = durable::read_regular_file(&cache_file).unwrap_or_default();
            let renderer = CompiledRenderer::compile(&gpu, format, volume, &pipeline_cache)?;
            Ok(Compiled { renderer, pipeline_cache })
        })))
    }

    /// Returns the result once, when the compilation has finished.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn take_result(&mut self) -> Option<Result<Compiled, Error>> {
        let thread = self.0.take_if(|thread| thread.is_finished())?;
        match thread.join() {
            Ok(compiled) => Some(compiled.map_err(Error::Gpu)),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl Drop for Compilation {
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            // The result isn't needed; a panic has been printed.
            let _ = thread.join();
        }
    }
}
