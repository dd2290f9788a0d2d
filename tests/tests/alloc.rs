//! No tick, no step of an export and no baked triangle allocates: a counting allocator looks on.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::bake::Baker;
use paros_core::dirty::Dirty;
use paros_core::export::{Exporter, Stage};
use paros_core::input::{Input, Mode};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_shaders::field::{Budget, Field};
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::Visitor;

thread_local! {
    /// Allocations of this thread.
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count() {
    // A thread that is ending has no count any more.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call goes to the system's allocator with the arguments it came with.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Runs `act`, which may not allocate.
fn quietly<T>(what: &str, act: impl FnOnce() -> T) -> T {
    let before = COUNT.get();
    let result = act();
    assert_eq!(COUNT.get(), before, "{what} allocated");
    result
}

static SMALL: Mutex<Studio<64>> = Mutex::new(Studio::new());
static LARGE: Mutex<Studio<128>> = Mutex::new(Studio::new());

#[test]
fn the_counter_counts() {
    let before = COUNT.get();
    drop(std::hint::black_box(vec![1u8; 100]));
    assert_eq!(COUNT.get(), before + 2);
}

#[test]
fn no_step_allocates() {
    let mut studio = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut edits = 0;
    for (seed, mode) in
        [Mode::FreeForm, Mode::Constrained { figure: 0 }, Mode::Creative, Mode::None]
            .into_iter()
            .enumerate()
    {
        match mode {
            Mode::None => studio.start_from(|[x, y, z]| y < 4 || x % 9 < 2 && z % 7 < 2),
            mode => studio.start(mode),
        };
        let mut visitor = Visitor::new(seed as u64);
        for _ in 0..700 {
            let input = visitor.act();
            quietly("a step", || studio.step(&input));
            edits += studio.world.events().len();
        }
        // Starting again doesn't either, nor do a save and a load.
        let mut bytes = vec![0; studio.world.save(&mut [])];
        quietly("a save and a load", || {
            let _ = studio.world.save(&mut bytes);
            studio.world.load(&bytes).expect("a saved world");
        });
        quietly("a start", || studio.step(&Input { start: Mode::Creative, ..Input::default() }));
    }
    assert!(edits > 200, "{edits} events");
}

#[test]
fn no_step_at_the_size_that_counts_allocates() {
    let mut studio = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    studio.start(Mode::Constrained { figure: 0 });
    let mut visitor = Visitor::new(21);
    for _ in 0..300 {
        let input = visitor.act();
        quietly("a step", || studio.step(&input));
    }
}

#[test]
fn no_part_of_an_export_allocates() {
    static EXPORTER: Mutex<Exporter<64>> = Mutex::new(Exporter::new());
    let mut studio = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut exporter = EXPORTER.lock().unwrap_or_else(PoisonError::into_inner);
    studio.start(Mode::FreeForm);
    let mut room = vec![0; Exporter::<64>::MIN_BUFFER];
    exporter.start(120.0).expect("a height");
    let mut written = 0;
    loop {
        let world = &studio.world;
        let progress = quietly("an export", || {
            exporter.advance(world.volume().rows(), world.mask(), 2000, &mut room)
        });
        written += progress.written;
        if progress.stage == Stage::Done {
            break;
        }
    }
    assert!(written > 10_000, "{written} bytes");
}

#[test]
fn no_baked_triangle_allocates() {
    struct Bench {
        baker: Baker<64>,
        maps: Maps<64>,
        plane: Plane<64>,
    }
    static BENCH: Mutex<Bench> =
        Mutex::new(Bench { baker: Baker::new(), maps: Maps::new(), plane: Plane::new() });
    let mut bench = BENCH.lock().unwrap_or_else(PoisonError::into_inner);
    let Bench { baker, maps, plane } = &mut *bench;
    quietly("a bake", || {
        baker.begin();
        for corner in [[0, 0, 0], [9000, 0, 0], [0, 9000, 0]] {
            let far = IVec3::splat(9000);
            let near = IVec3::from_array(corner);
            baker.triangle([near, far, near + IVec3::new(0, 30, 700)]).expect("in the box");
        }
        let _ = baker.finish(maps, plane);
    });
    assert!(plane.count() > 10);
}

#[test]
fn no_frame_of_the_field_allocates() {
    let mut studio = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut field = Field::<128>::new();
    let mut dirty = Dirty::new();
    studio.start(Mode::Constrained { figure: 0 });
    let mut visitor = Visitor::new(22);
    let mut bytes = 0;
    dirty.note_all(128);
    for _ in 0..300 {
        let budget = Budget::frame(128);
        quietly("a frame of the field", || {
            field.note(studio.world.volume().maps(), &dirty);
            field.advance(budget, &mut |_, region| bytes += region.len());
        });
        dirty.clear();
        studio.step(&visitor.act());
        for axis in paros_core::maps::Axis::ALL {
            for rect in studio.world.dirty().rects(axis) {
                for line in rect.lo.0..=rect.hi.0 {
                    dirty.note(axis, (line.into(), rect.lo.1.into()));
                    dirty.note(axis, (line.into(), rect.hi.1.into()));
                }
            }
        }
        dirty.close();
    }
    assert!(bytes > 1_000_000, "{bytes} bytes");
}
