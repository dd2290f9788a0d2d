//! Tests that need the meshes beside the checkout.

mod bake;
mod cases;
mod fidelity;
