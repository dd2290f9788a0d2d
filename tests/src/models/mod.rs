//! Naive, obviously correct models to hold the real algorithms against.

pub mod bake;
pub mod brush;
pub mod contact;
pub mod dense;
pub mod desk;
pub mod edit;
pub mod exact;
pub mod export;
pub mod field;
pub mod island_bench;
pub mod islands;
pub mod puppet;
pub mod shapes;
pub mod solid;
pub mod studio;
pub mod twin;
pub mod undo;
pub mod undo_bench;
pub mod view;
pub mod visitor;

use paros_core::codec::Writer;

/// What `save` writes, as bytes.
///
/// # Panics
/// It writes more the second time than the first.
pub fn saved(save: impl Fn(&mut Writer<'_>)) -> Vec<u8> {
    let mut sizing = Writer::new(&mut []);
    save(&mut sizing);
    let mut bytes = vec![0; sizing.len()];
    let mut writer = Writer::new(&mut bytes);
    save(&mut writer);
    assert!(writer.fits());
    bytes
}
