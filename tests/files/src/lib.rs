//! What the tests of mesh files share: meshes of the project's own, and what must hold of one that is baked.
//! They take and give meshes.
//! They know no file outside the project: `tests/real-meshes` has the tests that need one.
pub mod baked;
pub mod mesh_samples;
pub mod shapes;

/// Multiplies the cases of a property test in the check by `PAROS_STEP_CASES`, which is 1 by default.
///
/// # Panics
/// It is no number.
#[must_use]
pub fn scaled_cases(in_check: u32) -> u32 {
    let times =
        std::env::var("PAROS_STEP_CASES").map_or(1, |times| times.parse().expect("a number"));
    in_check * times
}
