//! Shared parts of the tests of pictures: views of a volume by an exact voxel traversal and by the fast path,
//! and the profile of an outline. Everything is rendered on the CPU.
pub mod fidelity;
pub mod outline;
pub mod screens;
pub mod view;

use paros_models::cases::scaled_cases;

/// Returns the number of pixels along a picture's side: fewer in the check than in the nightly run, where
/// cases are scaled.
#[must_use]
pub fn picture_side(in_check: usize, at_night: usize) -> usize {
    if scaled_cases(1) > 1 { at_night } else { in_check }
}
