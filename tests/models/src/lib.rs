//! Reference models: the naive definition of each algorithm of the core, for differential tests. A model
//! takes the core's inputs and returns what the core must return, voxel by voxel. The crate also has
//! harnesses, which hold the core's state under test and check its invariants, and generators of inputs.
//! Nothing here depends on rendering, files or devices.

pub mod allocations;
pub mod badge;
pub mod badge_pictures;
pub mod bake;
pub mod bake_harness;
pub mod bit_voxels;
pub mod brush;
pub mod cases;
pub mod contact;
pub mod dense;
pub mod edit;
pub mod export;
pub mod field;
pub mod flattening;
pub mod hard_work;
pub mod island_harness;
pub mod islands;
pub mod layers;
pub mod path;
pub mod random_visitor;
pub mod save_layout;
pub mod scripted_hand;
pub mod smoothing;
pub mod solid;
pub mod step;
pub mod twin;
pub mod undo;
pub mod undo_harness;
pub mod visit;
pub mod voxel_traversal;
pub mod world_harness;

use paros_core::internals::ByteWriter;

/// Runs `save` twice, first to measure the length, and returns the bytes written.
///
/// # Panics
/// The second run writes more than the first.
pub fn save_to_bytes(save: impl Fn(&mut ByteWriter<'_>)) -> Vec<u8> {
    let mut sizing = ByteWriter::new(&mut []);
    save(&mut sizing);
    let mut bytes = vec![0; sizing.len()];
    let mut writer = ByteWriter::new(&mut bytes);
    save(&mut writer);
    assert!(writer.fits());
    bytes
}
