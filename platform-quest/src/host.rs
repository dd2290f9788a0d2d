//! What the shell needs of the system it runs on, beside the runtime.

use std::fmt;
use std::io::{self, Write};

use openxr as xr;

use crate::error::Error;
use crate::strain::Strain;

/// The system: Android, or anything else.
pub trait Host {
    /// The way to the runtime. Asked again after the runtime was lost.
    ///
    /// # Errors
    /// [`Error::Unavailable`] where there is none.
    fn entry(&mut self) -> Result<xr::Entry, Error>;

    /// Makes an instance with these extensions, and those that the system itself needs.
    ///
    /// # Errors
    /// The runtime's.
    fn instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance>;

    /// What the system has told since it was asked last; called in every frame, and often while no
    /// frames are made.
    fn told(&mut self) -> Told {
        Told::default()
    }

    /// Carries out a step of the world; who measures looks at a clock before and after.
    fn step(&mut self, step: &mut dyn FnMut()) {
        step();
    }

    /// What puts a measurer's functions around a device's own, if anything does.
    fn around_device(&self) -> Option<fn(ash::Device) -> ash::Device> {
        None
    }

    /// Writes a line to where those look who look after the headset.
    fn log(&mut self, text: fmt::Arguments<'_>) {
        // Nobody may be listening there.
        let _ = writeln!(io::stderr(), "paros-quest: {text}");
    }
}

/// What a system tells.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Told {
    /// Heat and battery.
    pub strain: Strain,
    /// The application is to be left.
    pub leave: bool,
}

/// A system that has nothing to tell, with a loader where libraries are: Linux.
#[derive(Clone, Copy, Default, Debug)]
pub struct Plain;

impl Host for Plain {
    fn entry(&mut self) -> Result<xr::Entry, Error> {
        // SAFETY: the loader is the system's own; loading it runs its initialisers.
        unsafe { xr::Entry::load(&()) }.map_err(|error| {
            let mut why: &dyn std::error::Error = &error;
            while let Some(deeper) = why.source() {
                why = deeper;
            }
            Error::Unavailable(format!(
                "no OpenXR loader: {why}; install one (Debian: libopenxr-loader1)"
            ))
        })
    }

    fn instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance> {
        entry.create_instance(application, &extensions, &[], &())
    }
}
