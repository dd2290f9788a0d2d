//! What the device holds of a sculpture, read back: after a thousand edits among which strokes are
//! taken back and sessions loaded, and after an island's fall, the range maps are the world's, and
//! all that is derived from them is what a rebuild from nothing gives.
//!
//! Uploads go the way that the shells' do: a tick is noted, a frame takes what its budget allows
//! through the ring's staging memory, and frames are drawn until nothing is left.
//!
//! Faults that were planted: every 997th region is lost on its way; copies that overlap are not
//! ordered (validation tells); what a load made dirty is not noted.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::events::Event;
use paros_core::input::Mode;
use paros_core::size::{Grid, Size};
use paros_core::tools::{Action, Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::World;
use paros_shaders::field::{Budget, Field};
use paros_shaders::gpu::{
    Context, Eye, Fov, Gpu, Look, Offscreen, Options, Picture, Renderer, Stand, Sync,
};
use paros_shell::require::require;
use paros_tests::models::puppet::{RIGHT, reach, take};
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::Visitor;

/// A renderer, and the textures that it is to hold.
struct Desk<const N: usize> {
    gpu: Context,
    // Goes before the renderer that it was made with.
    screen: Offscreen,
    renderer: Renderer,
    field: Box<Field<N>>,
    rebuilt: Box<Field<N>>,
    frames: u32,
}

impl<const N: usize> Desk<N>
where
    Grid<N>: Size,
{
    fn new() -> Option<Self> {
        let options = Options { validation: true, ..Options::default() };
        let gpu = require(Gpu::headless(&options)).expect("a Vulkan device and its validation")?;
        let format = Offscreen::format(1, 1, false);
        let renderer = Renderer::new(&gpu, format, N, &[]).expect("a renderer");
        let screen = Offscreen::new(&gpu, &renderer, [32, 32]).expect("an image");
        let (field, rebuilt) = (Box::new(Field::new()), Box::new(Field::new()));
        let mut desk = Desk { gpu, screen, renderer, field, rebuilt, frames: 0 };
        desk.field.whole(|region, bytes| desk.renderer.load(region, bytes).expect("a device"));
        Some(desk)
    }

    /// A tick's changes, and a frame.
    fn follow(&mut self, world: &World<N>) {
        self.field.note(world.volume().maps(), world.dirty());
        self.draw();
    }

    fn draw(&mut self) {
        self.renderer.begin().expect("a device");
        let renderer = &mut self.renderer;
        let mut bytes = 0;
        self.field.advance(Budget::frame(N), &mut |region, texels| {
            bytes += texels.len();
            assert!(renderer.upload(region, texels), "a frame's budget is more than it takes");
        });
        assert!(bytes <= Budget::frame(N).bytes, "{bytes} bytes in a frame");
        let fov = Fov { left: -0.5, right: 0.5, up: 0.5, down: -0.5 };
        let position = Vec3::new(0.0, 0.5, 2.0);
        let picture = Picture {
            eyes: &[Eye { position, rotation: Quat::IDENTITY, fov }],
            stand: Stand { foot: Vec3::ZERO, side: 1.0, turn: 0.0 },
            look: Look::default(),
            backdrop: [0.0; 3],
            scene: None,
        };
        let image = &self.screen.surface;
        self.renderer.draw(&picture, image, 0, Sync::default()).expect("a device");
        self.frames += 1;
    }

    /// Draws until nothing is left to upload; then the device holds what it should.
    fn check(&mut self, world: &World<N>, when: &str) {
        while self.field.pending() {
            self.draw();
        }
        let Desk { screen, renderer, rebuilt, .. } = self;
        rebuilt.rebuild(world.volume().maps());
        rebuilt.whole(|region, bytes| {
            let held = screen.texels(renderer, region).expect("a device");
            let texture = region.texture;
            assert_eq!(held.len(), bytes.len());
            let wrong = held.iter().zip(bytes).filter(|(held, right)| held != right).count();
            assert_eq!(wrong, 0, "{when}: of {} bytes of {texture:?}", bytes.len());
        });
    }
}

/// A session of random edits, with all that a visitor does besides; a load from time to time.
fn thousand_edits<const N: usize>(studio: &mut Studio<N>, desk: &mut Desk<N>, edits: u32)
where
    Grid<N>: Size,
{
    let mut visitor = Visitor::new(21 + N as u64);
    let (mut done, mut undone, mut redone, mut loads) = (0, 0, 0, 0);
    let (mut actions, mut bits) = (Vec::<Action>::new(), Vec::<Bit>::new());
    let mut saved = Vec::new();
    studio.start(Mode::FreeForm);
    desk.follow(&studio.world);
    desk.check(&studio.world, "the start");
    let mut checked = 0;
    while done < edits {
        studio.step(&visitor.act());
        desk.follow(&studio.world);
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
            desk.check(&studio.world, &format!("after {done} edits and {undone} undos"));
            checked = done;
        }
        if saved.is_empty() && done > edits / 8 * (loads + 1) {
            saved = vec![0; studio.world.save(&mut [])];
            assert_eq!(studio.world.save(&mut saved), saved.len());
        } else if !saved.is_empty() && done > edits / 8 * (loads + 1) + edits / 16 {
            studio.world.load(&core::mem::take(&mut saved)).expect("what was saved");
            loads += 1;
            // The next tick forgets that everything is dirty.
            desk.follow(&studio.world);
            desk.check(&studio.world, &format!("after load {loads}"));
        }
    }
    desk.check(&studio.world, "the end");
    let of = |action: Action| actions.iter().filter(|one| **one == action).count();
    let (carved, filled) = (of(Action::Carve), of(Action::Fill));
    bits.dedup();
    bits.sort_by_key(|bit| *bit as u8);
    bits.dedup();
    println!(
        "{N}: {done} edits ({carved} carve, {filled} fill) by {bits:?}, {undone} undos, \
         {redone} redos, {loads} loads, {} frames",
        desk.frames
    );
    assert!(carved > done as usize / 10 && filled > done as usize / 20, "both ways");
    assert!(bits.len() >= 3 && undone >= 3 && redone >= 1 && loads >= 3);
}

/// The upper half on a thin stalk that is sawn through.
fn fall<const N: usize>(studio: &mut Studio<N>, desk: &mut Desk<N>)
where
    Grid<N>: Size,
{
    let (half, stalk) = (N / 2, N / 32);
    let in_stalk = |c: usize| c.abs_diff(half) < stalk;
    studio.start_from(|[x, y, z]| y >= half || y < N / 4 || in_stalk(x) && in_stalk(z));
    desk.follow(&studio.world);
    desk.check(&studio.world, "the stalk");
    take(studio, RIGHT, Item::Tool(Tool::Rotary));
    desk.follow(&studio.world);
    let height = 3.0 * N as f32 / 8.0;
    let mut removed = 0;
    for tick in 0..400 {
        let along = half as f32 - N as f32 / 8.0 + tick as f32 * N as f32 / 128.0 * 0.25;
        reach(studio, RIGHT, Vec3::new(along, height, half as f32), true);
        desk.follow(&studio.world);
        removed += studio.world.events().iter().map(removed_by).sum::<u32>();
        if removed > 0 {
            break;
        }
    }
    println!("{N}: {removed} voxels fell");
    assert!(removed as usize >= N * N * half * 9 / 10, "{removed} voxels fell");
    desk.check(&studio.world, "the fall");
}

const fn removed_by(event: &Event) -> u32 {
    match event {
        Event::Islands(report) => report.removed,
        _ => 0,
    }
}

fn check<const N: usize>(studio: &Mutex<Studio<N>>, edits: u32)
where
    Grid<N>: Size,
{
    let Some(mut desk) = Desk::new() else { return };
    let mut studio = studio.lock().unwrap_or_else(PoisonError::into_inner);
    thousand_edits(&mut studio, &mut desk, edits);
    fall(&mut studio, &mut desk);
    assert_eq!(desk.gpu.instance.messages(), Vec::<String>::new());
}

#[test]
fn the_device_holds_the_sculpture_at_128() {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    check(&STUDIO, 1000);
}

#[test]
fn the_device_holds_the_sculpture_at_256() {
    static STUDIO: Mutex<Studio<256>> = Mutex::new(Studio::new());
    check(&STUDIO, 120);
}
