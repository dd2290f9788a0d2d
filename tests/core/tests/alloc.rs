//! Counts allocations: no tick, no step of an export and no baked triangle allocates.

use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::convert::ExportPhase;
use paros_core::session::SessionMode;
use paros_core::volume::BitGrid;
use paros_core::{Baker, Exporter, RangeMaps, TickInput};
use paros_models::allocations::{CountingAllocator, allocation_count, without_allocating};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

static SMALL: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());

#[test]
fn the_counter_counts() {
    let before = allocation_count();
    drop(std::hint::black_box(vec![1u8; 100]));
    assert_eq!(allocation_count(), before + 2);
}

#[test]
fn no_step_allocates() {
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut edits = 0;
    for (seed, mode) in [
        SessionMode::FreeForm,
        SessionMode::Constrained { figure: 0 },
        SessionMode::Creative,
        SessionMode::None,
    ]
    .into_iter()
    .enumerate()
    {
        match mode {
            SessionMode::None => {
                harness.start_from_voxels(|[x, y, z]| y < 4 || x % 9 < 2 && z % 7 < 2)
            }
            mode => harness.start_session(mode),
        };
        let mut visitor = RandomVisitor::new(seed as u64);
        for _ in 0..700 {
            let input = visitor.next_input();
            without_allocating("a step", || harness.step(&input));
            edits += harness.world.events().len();
        }
        // Neither a new session nor a save and a load allocates.
        let mut bytes = vec![0; harness.world.save(&mut [])];
        without_allocating("a save and a load", || {
            let _ = harness.world.save(&mut bytes);
            harness.world.load(&bytes).expect("a saved world");
        });
        without_allocating("a start", || {
            harness.step(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
        });
    }
    assert!(edits > 200, "{edits} events");
}

#[test]
fn no_step_at_the_size_that_counts_allocates() {
    let mut harness = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    harness.start_session(SessionMode::Constrained { figure: 0 });
    let mut visitor = RandomVisitor::new(21);
    for _ in 0..300 {
        let input = visitor.next_input();
        without_allocating("a step", || harness.step(&input));
    }
}

#[test]
fn no_part_of_an_export_allocates() {
    static EXPORTER: Mutex<Exporter<64>> = Mutex::new(Exporter::new());
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut exporter = EXPORTER.lock().unwrap_or_else(PoisonError::into_inner);
    harness.start_session(SessionMode::FreeForm);
    let mut room = vec![0; Exporter::<64>::MIN_BUFFER];
    exporter.start_export(120.0).expect("a height");
    let mut written = 0;
    loop {
        let world = &harness.world;
        let progress = without_allocating("an export", || {
            exporter.advance_export(world.volume().rows(), world.mask(), 2000, &mut room)
        });
        written += progress.written;
        if progress.phase == ExportPhase::Done {
            break;
        }
    }
    assert!(written > 10_000, "{written} bytes");
}

#[test]
fn no_baked_triangle_allocates() {
    struct AllocationHarness {
        baker: Baker<64>,
        maps: RangeMaps<64>,
        plane: BitGrid<64>,
    }
    static BENCH: Mutex<AllocationHarness> = Mutex::new(AllocationHarness {
        baker: Baker::new(),
        maps: RangeMaps::new(),
        plane: BitGrid::new(),
    });
    let mut bench = BENCH.lock().unwrap_or_else(PoisonError::into_inner);
    let AllocationHarness { baker, maps, plane } = &mut *bench;
    without_allocating("a bake", || {
        baker.clear();
        for corner in [[0, 0, 0], [9000, 0, 0], [0, 9000, 0]] {
            let far = IVec3::splat(9000);
            let near = IVec3::from_array(corner);
            baker.add_triangle([near, far, near + IVec3::new(0, 30, 700)]).expect("in the box");
        }
        let _ = baker.write_maps(maps, plane);
    });
    assert!(plane.count_voxels() > 10);
}
