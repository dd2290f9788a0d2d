//! What the device holds of a sculpture, read back: after a thousand edits among which strokes are
//! taken back and sessions loaded, and after an island's fall, the range maps are the world's, and
//! all that is derived from them is what a rebuild from nothing gives.
//!
//! Uploads go the way that the shells' do: a tick is noted, a frame takes what its budget allows
//! through the ring's staging memory, and frames are drawn until nothing is left; by a program that
//! writes what it can, and by copies alone.
//!
//! Faults that were planted: every 997th region is lost on its way; copies that overlap are not
//! ordered (validation tells); what a load made dirty is not noted.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use paros_core::events::Event;
use paros_core::input::Mode;
use paros_core::size::{Grid, Size};
use paros_core::tools::{Action, Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::World;
use paros_shaders::field::Field;
use paros_shaders::gpu::Options;
use paros_tests::models::desk::{Desk, device_with};
use paros_tests::models::puppet::{RIGHT, reach, take};
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::Visitor;

/// A sculpture's textures, and the device that is to hold them.
struct Held<const N: usize> {
    desk: Desk,
    field: Box<Field<N>>,
    rebuilt: Box<Field<N>>,
    frames: u32,
}

impl<const N: usize> Held<N>
where
    Grid<N>: Size,
{
    fn new(copies: bool) -> Option<Self> {
        let device = device_with(Options { copies, ..Options::default() })?;
        assert!(device.needs.scatter != copies, "{} has no program write textures", device.name);
        let mut desk = Desk::new(&device, N, [1, 1], [32, 32]);
        let field = Box::new(Field::new());
        desk.load(&field);
        Some(Held { desk, field, rebuilt: Box::new(Field::new()), frames: 0 })
    }

    /// A tick's changes, and a frame.
    fn follow(&mut self, world: &World<N>) {
        self.field.note(world.volume().maps(), world.dirty());
        self.draw();
    }

    fn draw(&mut self) {
        self.desk.follow(&mut self.field);
        self.frames += 1;
    }

    /// Draws until nothing is left to upload; then the device holds what it should.
    fn check(&mut self, world: &World<N>, when: &str) {
        while self.field.pending() {
            self.draw();
        }
        self.desk.check(world, &mut self.rebuilt, when);
    }
}

/// A session of random edits, with all that a visitor does besides; a load from time to time.
fn thousand_edits<const N: usize>(studio: &mut Studio<N>, held: &mut Held<N>, edits: u32)
where
    Grid<N>: Size,
{
    let mut visitor = Visitor::new(21 + N as u64);
    let (mut done, mut undone, mut redone, mut loads) = (0, 0, 0, 0);
    let (mut actions, mut bits) = (Vec::<Action>::new(), Vec::<Bit>::new());
    let mut saved = Vec::new();
    studio.start(Mode::FreeForm);
    held.follow(&studio.world);
    held.check(&studio.world, "the start");
    let mut checked = 0;
    while done < edits {
        studio.step(&visitor.act());
        held.follow(&studio.world);
        let mut look = false;
        for event in studio.world.events() {
            match event {
                Event::Edited { bit, .. } if !studio.world.dirty().is_empty() => {
                    done += 1;
                    actions.push(bit.data().action);
                    bits.push(*bit);
                }
                Event::Undone => (undone, look) = (undone + 1, true),
                Event::Redone => redone += 1,
                _ => {}
            }
        }
        if look || done >= checked + edits / 8 {
            held.check(&studio.world, &format!("after {done} edits and {undone} undos"));
            checked = done;
        }
        if saved.is_empty() && done > edits / 8 * (loads + 1) {
            saved = vec![0; studio.world.save(&mut [])];
            assert_eq!(studio.world.save(&mut saved), saved.len());
        } else if !saved.is_empty() && done > edits / 8 * (loads + 1) + edits / 16 {
            studio.world.load(&core::mem::take(&mut saved)).expect("what was saved");
            loads += 1;
            // The next tick forgets that everything is dirty.
            held.follow(&studio.world);
            held.check(&studio.world, &format!("after load {loads}"));
        }
    }
    held.check(&studio.world, "the end");
    let of = |action: Action| actions.iter().filter(|one| **one == action).count();
    let (carved, filled) = (of(Action::Carve), of(Action::Fill));
    bits.dedup();
    bits.sort_by_key(|bit| *bit as u8);
    bits.dedup();
    println!(
        "{N}: {done} edits ({carved} carve, {filled} fill) by {bits:?}, {undone} undos, \
         {redone} redos, {loads} loads, {} frames",
        held.frames
    );
    assert!(carved > done as usize / 10 && filled > done as usize / 20, "both ways");
    assert!(bits.len() >= 3 && undone >= 3 && redone >= 1 && loads >= 3);
}

/// The upper half on a thin stalk that is sawn through.
fn fall<const N: usize>(studio: &mut Studio<N>, held: &mut Held<N>)
where
    Grid<N>: Size,
{
    let (half, stalk) = (N / 2, N / 32);
    let in_stalk = |c: usize| c.abs_diff(half) < stalk;
    studio.start_from(|[x, y, z]| y >= half || y < N / 4 || in_stalk(x) && in_stalk(z));
    held.follow(&studio.world);
    held.check(&studio.world, "the stalk");
    take(studio, RIGHT, Item::Tool(Tool::Rotary));
    held.follow(&studio.world);
    let height = 3.0 * N as f32 / 8.0;
    let mut removed = 0;
    for tick in 0..400 {
        let along = half as f32 - N as f32 / 8.0 + tick as f32 * N as f32 / 128.0 * 0.25;
        reach(studio, RIGHT, Vec3::new(along, height, half as f32), true);
        held.follow(&studio.world);
        removed += studio.world.events().iter().map(removed_by).sum::<u32>();
        if removed > 0 {
            break;
        }
    }
    println!("{N}: {removed} voxels fell");
    assert!(removed as usize >= N * N * half * 9 / 10, "{removed} voxels fell");
    held.check(&studio.world, "the fall");
}

const fn removed_by(event: &Event) -> u32 {
    match event {
        Event::Islands(report) => report.removed,
        _ => 0,
    }
}

fn check<const N: usize>(studio: &Mutex<Studio<N>>, copies: bool, edits: u32)
where
    Grid<N>: Size,
{
    let Some(mut held) = Held::new(copies) else { return };
    let mut studio = studio.lock().unwrap_or_else(PoisonError::into_inner);
    thousand_edits(&mut studio, &mut held, edits);
    fall(&mut studio, &mut held);
}

#[test]
fn the_device_holds_the_sculpture_at_128() {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    check(&STUDIO, false, 1000);
}

#[test]
fn the_device_holds_the_sculpture_by_copies_at_128() {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    check(&STUDIO, true, 1000);
}

#[test]
fn the_device_holds_the_sculpture_at_256() {
    static STUDIO: Mutex<Studio<256>> = Mutex::new(Studio::new());
    check(&STUDIO, false, 120);
}

#[test]
fn the_device_holds_the_sculpture_by_copies_at_256() {
    static STUDIO: Mutex<Studio<256>> = Mutex::new(Studio::new());
    check(&STUDIO, true, 120);
}
