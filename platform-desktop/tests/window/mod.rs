//! The window on a display of its own (Xvfb, or Weston without a screen) and a software device
//! (lavapipe): a visitor carves, takes it back and finishes, and the screen shows it; and whatever
//! goes wrong around the window loses no sculpture. Validation looks on.
//!
//! The screens are left in the test's folder, to be looked at.

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
