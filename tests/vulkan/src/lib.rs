//! Support for the renderer's tests: a device with validation, and an offscreen target.
//! It takes volumes and eyes and gives pixels.
//! It knows no window, and no OpenXR: the shells' own tests have them.
pub mod test_renderer;
