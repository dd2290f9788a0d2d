//! Tests that need the meshes beside the checkout.

mod bake;
mod fidelity;
