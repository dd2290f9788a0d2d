//! Counts allocations: no frame of the fast path's textures allocates.

use std::sync::{Mutex, PoisonError};

use paros_core::session::SessionMode;
use paros_core::volume::DirtyRects;
use paros_models::allocations::without_allocating;
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;
use paros_shaders::field::{Budget, DensityField};

static STUDIO: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());

#[test]
fn no_frame_of_the_field_allocates() {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let mut field = DensityField::<128>::new();
    let mut dirty = DirtyRects::new();
    studio.start_session(SessionMode::Constrained { figure: 0 });
    let mut visitor = RandomVisitor::new(22);
    let mut bytes = 0;
    dirty.mark_all(128);
    for _ in 0..300 {
        let budget = Budget::per_frame(128);
        without_allocating("a frame of the field", || {
            field.note_dirty_columns(studio.world.volume().maps(), &dirty);
            field.update_textures(budget, &mut |_, region| bytes += region.len());
        });
        dirty.clear();
        studio.step(&visitor.next_input());
        for axis in paros_core::volume::Axis::ALL {
            for rect in studio.world.dirty_rects().rects(axis) {
                for line in rect.first.0..=rect.last.0 {
                    dirty.mark_column(axis, (line.into(), rect.first.1.into()));
                    dirty.mark_column(axis, (line.into(), rect.last.1.into()));
                }
            }
        }
        dirty.end_edit();
    }
    assert!(bytes > 1_000_000, "{bytes} bytes");
}
