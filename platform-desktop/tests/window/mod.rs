//! The window on its own display (Xvfb, or headless Weston) and a software device (lavapipe): a visitor
//! carves, undoes and finishes, and the screen shows it. No fault around the window loses a sculpture.
//! Vulkan's validation layer is enabled.
//!
//! The screenshots are kept in the test's folder, for inspection.

mod booth;
mod desktop;
mod disk;
mod exhibit;
mod exhibition;
mod losses;
mod newcomer;
mod next_visitor;
mod pictures;
mod rig;
mod sound;
mod starts;
mod visit;
mod wayland;
mod xdnd;
