//! Shared by the tests of pictures: views of a volume by an exact voxel traversal and by the fast
//! path, and the profile of an outline. Takes dense volumes, gives pictures and asserts that they agree.
//! Knows no device: all is drawn by the CPU.
pub mod fidelity;
pub mod outline;
pub mod screens;
pub mod view;
