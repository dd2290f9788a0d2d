//! The Vulkan instance and device: selection, optional features, errors, and owned handles.
//! Takes [`Options`](options::Options) and what an OpenXR runtime adds, gives a
//! [`Gpu`](context::Gpu) or an error; knows nothing of what is drawn.

pub(crate) mod context;
pub(crate) mod error;
pub(crate) mod features;
pub(crate) mod format;
pub(crate) mod options;
pub(crate) mod owned;
pub(crate) mod selection;
pub(crate) mod submit;
