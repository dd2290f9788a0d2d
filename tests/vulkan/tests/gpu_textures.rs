//! Reads back the device's textures of a sculpture after hundreds of edits (thousands in the nightly run),
//! with undos, loads and an island's fall in between. The range maps must equal the world's, and all derived
//! textures must equal a complete rebuild.
//!
//! Uploads take the same way as in the shells: a tick is recorded, a frame uploads as much as its budget
//! allows through the ring's staging memory, and frames are drawn until nothing is left. Tests both the
//! compute program, where it can write, and copies alone.
//!
//! Planted faults: every 997th region is lost in transit; overlapping copies aren't ordered (validation
//! reports this); regions made dirty by a load aren't recorded.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use paros_core::internals::BitAction;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::volume::{Axis, Grid, Size};
use paros_core::{World, WorldEvent};
use paros_models::cases::scaled_cases;
use paros_models::random_visitor::RandomVisitor;
use paros_models::scripted_hand::{RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::Options;
use paros_shaders::upload::VolumeFormat;
use paros_tests_vulkan::test_renderer::{TestRenderer, test_device_with};

/// A sculpture's textures, and the device that holds copies of them.
struct TextureCheck<const N: usize, const K: usize> {
    test_renderer: TestRenderer,
    field: Box<DensityField<N, K>>,
    rebuilt: Box<DensityField<N, K>>,
    frames: u32,
}

impl<const N: usize, const K: usize> TextureCheck<N, K>
where
    Grid<N>: Size,
{
    fn new(copies: bool) -> Option<Self> {
        let device = test_device_with(Options { copies_only: copies, ..Options::default() })?;
        assert!(
            device.features.storage_writes != copies,
            "{} has no program write textures",
            device.name
        );
        let mut test_renderer =
            TestRenderer::new(&device, VolumeFormat::of::<N, K>(), [1, 1], [32, 32]);
        let field = Box::new(DensityField::new());
        test_renderer.upload_field(&field);
        Some(TextureCheck {
            test_renderer,
            field,
            rebuilt: Box::new(DensityField::new()),
            frames: 0,
        })
    }

    /// Records a tick's changes and draws a frame.
    fn note_and_draw(&mut self, world: &World<N, K>) {
        self.field.note_dirty_columns(world.volume().maps(), world.dirty_rects());
        self.draw_frame();
    }

    fn draw_frame(&mut self) {
        self.test_renderer.draw_with_pending_uploads(&mut self.field);
        self.frames += 1;
    }

    /// Draws until nothing is left to upload, then checks the device's textures.
    fn check_all(&mut self, world: &World<N, K>, when: &str) {
        while self.field.has_pending() {
            self.draw_frame();
        }
        self.test_renderer.assert_textures_match(world, &mut self.rebuilt, when);
    }
}

/// Runs a session of random edits with all other actions of a visitor, and a load from time to time.
fn run_random_edits<const N: usize, const K: usize>(
    studio: &mut WorldHarness<N, K>,
    held: &mut TextureCheck<N, K>,
    edits: u32,
) where
    Grid<N>: Size,
{
    let mut visitor = RandomVisitor::new(27 + N as u64);
    let (mut done, mut undone, mut redone, mut loads) = (0, 0, 0, 0);
    let (mut actions, mut bits) = (Vec::<BitAction>::new(), Vec::<ToolBit>::new());
    let mut saved = Vec::new();
    studio.start_session(SessionMode::FreeForm);
    held.note_and_draw(&studio.world);
    held.check_all(&studio.world, "the start");
    let mut checked = 0;
    while done < edits {
        studio.step(&visitor.next_input());
        held.note_and_draw(&studio.world);
        let mut look = false;
        for event in studio.world.events() {
            match event {
                WorldEvent::Edited { bit, .. } if !studio.world.dirty_rects().is_empty() => {
                    done += 1;
                    actions.push(bit.spec().action);
                    bits.push(*bit);
                }
                WorldEvent::Undone => (undone, look) = (undone + 1, true),
                WorldEvent::Redone => redone += 1,
                _ => {}
            }
        }
        if look || done >= checked + edits / 8 {
            held.check_all(&studio.world, &format!("after {done} edits and {undone} undos"));
            checked = done;
        }
        if saved.is_empty() && done > edits / 8 * (loads + 1) {
            saved = vec![0; studio.world.save(&mut [])];
            assert_eq!(studio.world.save(&mut saved), saved.len());
        } else if !saved.is_empty() && done > edits / 8 * (loads + 1) + edits / 16 {
            studio.world.load(&core::mem::take(&mut saved)).expect("what was saved");
            loads += 1;
            // The next tick clears the state in which everything is dirty.
            held.note_and_draw(&studio.world);
            held.check_all(&studio.world, &format!("after load {loads}"));
        }
    }
    held.check_all(&studio.world, "the end");
    let of = |action: BitAction| actions.iter().filter(|one| **one == action).count();
    let (carved, filled) = (of(BitAction::Carve), of(BitAction::Fill));
    bits.dedup();
    bits.sort_by_key(|bit| *bit as u8);
    bits.dedup();
    println!(
        "{N}: {done} edits ({carved} carve, {filled} fill) by {bits:?}, {undone} undos, \
         {redone} redos, {loads} loads, {} frames",
        held.frames
    );
    // A nozzle in the air lays nothing; undos, files and floats add stone too.
    assert!(carved > done as usize / 10 && filled > 0, "both ways");
    assert!(bits.len() >= 3 && undone >= 3 && redone >= 1 && loads >= 3);
}

/// Saws through a thin stalk that carries the upper half.
fn saw_through_stalk<const N: usize, const K: usize>(
    studio: &mut WorldHarness<N, K>,
    held: &mut TextureCheck<N, K>,
) where
    Grid<N>: Size,
{
    let (half, stalk) = (N / 2, N / 32);
    let in_stalk = |c: usize| c.abs_diff(half) < stalk;
    studio.start_from_voxels(|[x, y, z]| y >= half || y < N / 4 || in_stalk(x) && in_stalk(z));
    held.note_and_draw(&studio.world);
    held.check_all(&studio.world, "the stalk");
    take_item(studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    held.note_and_draw(&studio.world);
    let height = 3.0 * N as f32 / 8.0;
    let mut removed = 0;
    for tick in 0..400 {
        let along = half as f32 - N as f32 / 8.0 + tick as f32 * N as f32 / 128.0 * 0.25;
        step_with_bit_at(studio, RIGHT, Vec3::new(along, height, half as f32), true);
        held.note_and_draw(&studio.world);
        removed += studio.world.events().iter().map(removed_by).sum::<u32>();
        if removed > 0 {
            break;
        }
    }
    println!("{N}: {removed} voxels fell");
    assert!(removed as usize >= N * N * half * 9 / 10, "{removed} voxels fell");
    held.check_all(&studio.world, "the fall");
}

const fn removed_by(event: &WorldEvent) -> u32 {
    match event {
        WorldEvent::Islands(report) => report.removed,
        _ => 0,
    }
}

fn check_device<const N: usize, const K: usize>(
    studio: &Mutex<WorldHarness<N, K>>,
    copies: bool,
    edits: u32,
) where
    Grid<N>: Size,
{
    let edits = scaled_cases(edits);
    let Some(mut held) = TextureCheck::new(copies) else { return };
    let mut studio = studio.lock().unwrap_or_else(PoisonError::into_inner);
    run_random_edits(&mut studio, &mut held, edits);
    let gaps = count_gaps(&studio.world);
    assert!(K == 1 || gaps > 100, "{gaps} gaps");
    saw_through_stalk(&mut studio, &mut held);
}

#[test]
fn the_device_holds_the_sculpture_at_128() {
    static STUDIO: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());
    check_device(&STUDIO, false, 300);
}

#[test]
fn the_device_holds_the_sculpture_by_copies_at_128() {
    static STUDIO: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());
    check_device(&STUDIO, true, 300);
}

#[test]
fn the_device_holds_two_intervals_at_128() {
    static STUDIO: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
    check_device(&STUDIO, false, 300);
}

fn count_gaps<const N: usize, const K: usize>(world: &World<N, K>) -> usize
where
    Grid<N>: Size,
{
    let line = |axis, line| world.volume().maps().line(axis, line).iter();
    let columns = Axis::ALL.into_iter().flat_map(|axis| (0..N).flat_map(move |i| line(axis, i)));
    columns.flat_map(|column| column.intervals().skip(1)).count()
}

#[test]
fn the_device_holds_the_sculpture_at_256() {
    static STUDIO: Mutex<WorldHarness<256>> = Mutex::new(WorldHarness::new());
    check_device(&STUDIO, false, 80);
}

#[test]
fn the_device_holds_the_sculpture_by_copies_at_256() {
    static STUDIO: Mutex<WorldHarness<256>> = Mutex::new(WorldHarness::new());
    check_device(&STUDIO, true, 80);
}
