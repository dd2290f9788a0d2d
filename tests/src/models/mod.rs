//! Naive, obviously correct models to hold the real algorithms against.

pub mod bake;
pub mod brush;
pub mod contact;
pub mod dense;
pub mod edit;
pub mod export;
pub mod islands;
pub mod preview;
pub mod puppet;
pub mod shapes;
pub mod studio;
pub mod twin;
pub mod undo;
pub mod visitor;
