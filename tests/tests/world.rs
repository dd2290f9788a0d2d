//! A session as a visitor lives it: starts, strokes, mirror, islands, the end.

use std::mem::size_of;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::contact::Obstacle;
use paros_core::events::Event;
use paros_core::frame::STOOL;
use paros_core::input::{HandInput, Input, Mode, Pointer, buttons, commands};
use paros_core::limits::LONG_WAY;
use paros_core::maps::{Axis, Maps};
use paros_core::pose::{Pose, SUB};
use paros_core::tools::{Action, Bit, Tool};
use paros_core::volume::maps_digest;
use paros_core::workbench::{Item, Place};
use paros_core::world::{Session, World};
use paros_tests::models::puppet::{LEFT, RIGHT, floor, hand_at, reach, stroke, take, voxels, with};
use paros_tests::models::studio::{Studio, same};
use paros_tests::models::visitor::{Dice, Visitor, at};

static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());

fn studio() -> MutexGuard<'static, Studio<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
fn modes_start_from_their_volumes() {
    let mut studio = studio();
    for (mode, masked) in
        [(Mode::FreeForm, false), (Mode::Constrained { figure: 0 }, true), (Mode::Creative, false)]
    {
        // Whatever went on before.
        let mut visitor = Visitor::new(3);
        (0..60).for_each(|_| studio.step(&visitor.act()));
        studio.start(mode);
        assert_eq!(studio.world.events(), [Event::Started(mode)]);
        assert_eq!((studio.world.session(), studio.world.mode()), (Session::Sculpting, mode));
        assert_eq!((studio.world.undo_counts(), studio.world.symmetry()), ((0, 0), false));
        assert!(
            Axis::ALL.iter().all(|axis| studio.world.dirty().rects(*axis)[0].area() == 64 * 64)
        );
        let (world, lump, figure, creative) = studio.parts();
        let from = if mode == Mode::Creative { creative } else { lump };
        assert!(same(world.volume().maps(), from), "{mode:?}");
        assert_eq!(same(world.mask(), figure), masked, "{mode:?}");
        assert_eq!(world.mask().is_empty(), !masked);
        for tool in Tool::ALL {
            assert_eq!(world.bench().place(Item::Tool(tool)), Place::Home);
            assert_eq!(world.bench().mounted(tool), tool.first_bit());
        }
        studio.check();
    }
    floor(&mut studio, 9);
    assert!(same(studio.world.volume().maps(), &studio.own));
}

#[test]
fn a_start_that_is_not_there_changes_nothing() {
    let mut studio = studio();
    for mode in [Mode::Constrained { figure: 1 }, Mode::Constrained { figure: 255 }, Mode::Own] {
        studio.start(Mode::Constrained { figure: 0 });
        let mut parts = studio.world.part_digests();
        studio.step(&Input::default());
        let still = studio.world.part_digests();
        studio.start(Mode::Constrained { figure: 0 });
        studio.step(&Input { start: mode, ..Input::default() });
        assert_eq!(studio.world.events(), [Event::NoSuchStart], "{mode:?}");
        assert_eq!(studio.world.part_digests(), still, "{mode:?}");
        // The clock goes on.
        assert_ne!(parts[0], still[0]);
        parts[0] = still[0];
        assert_eq!(parts, still);
    }
    // Before any session, there is nothing to take.
    studio.open();
    take(&mut studio, LEFT, Item::Tool(Tool::Rotary));
    assert_eq!((studio.world.session(), studio.world.held(LEFT)), (Session::Waiting, None));
}

#[test]
fn a_stroke_is_one_entry_with_the_islands_it_cut_off() {
    let mut studio = studio();
    // A mushroom: its cap is an island once the stem is cut.
    studio.start_from(|[x, y, z]| {
        y < 10
            || y < 20 && (30..34).contains(&x) && (30..34).contains(&z)
            || (20..24).contains(&y) && (24..40).contains(&x) && (24..40).contains(&z)
    });
    let start = maps_digest(studio.world.volume().maps());
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    stroke(&mut studio, RIGHT, Vec3::new(10.0, 11.0, 50.0), Vec3::new(50.0, 11.0, 50.0), 20);
    let first = maps_digest(studio.world.volume().maps());
    assert_eq!(studio.world.undo_counts(), (1, 0));
    let mut removed = 0;
    reach(&mut studio, RIGHT, Vec3::new(32.0, 15.0, 50.0), false);
    for i in 0..60 {
        reach(&mut studio, RIGHT, Vec3::new(32.0, 15.0, 50.0 - 0.6 * i as f32), true);
        for event in studio.world.events() {
            if let Event::Islands(report) = event {
                removed += report.removed;
            }
        }
    }
    assert!(removed > 500, "the cap is gone: {removed}");
    let second = maps_digest(studio.world.volume().maps());
    assert_eq!(studio.world.undo_counts(), (2, 0));
    for (command, expected, event) in [
        (commands::UNDO, first, Event::Undone),
        (commands::UNDO, start, Event::Undone),
        (commands::REDO, first, Event::Redone),
        (commands::REDO, second, Event::Redone),
    ] {
        studio.step(&Input { commands: command, ..Input::default() });
        assert_eq!(studio.world.events(), [event]);
        assert_eq!(maps_digest(studio.world.volume().maps()), expected);
        // No pass comes after it.
        (0..5).for_each(|_| studio.step(&Input::default()));
        assert_eq!(maps_digest(studio.world.volume().maps()), expected);
        studio.check();
    }
    studio.step(&Input { commands: commands::REDO, ..Input::default() });
    assert_eq!(studio.world.events(), []);
}

/// An island that hangs in the air at 64: a floor, and a block high above it.
fn hovering([x, y, z]: [usize; 3]) -> bool {
    y < 10 || (30..36).contains(&y) && (28..36).contains(&x) && (50..58).contains(&z)
}

/// The left hand's nozzle goes along the floor, so many steps from its corner, while the right hand
/// bites so deep. Whether an island fell in that tick.
fn falls(studio: &mut Studio<64>, steps: u32, depth: f32, commands: u8) -> bool {
    let nozzle = Bit::Nozzle.on_grid(studio.world.frame().voxel() * 1e6);
    let rest = 9.53 + (nozzle.inner_radius() - nozzle.bite) as f32 / SUB as f32;
    let aim = |hand: usize, x: f32, y: f32| {
        let pose = Pose { position: Vec3::new(x, y, 40.5), rotation: Quat::IDENTITY };
        at(&studio.world, hand, &pose)
    };
    let right = HandInput { trigger: 255, ..aim(RIGHT, 50.0, 12.0 - depth) };
    let hands = [aim(LEFT, 10.0 + steps as f32 / 4.0, rest), right];
    studio.step(&Input { hands, commands, ..Input::default() });
    studio.world.events().iter().any(|event| matches!(event, Event::Islands(_)))
}

fn with_an_island_in_the_air(studio: &mut Studio<64>) {
    studio.start_from(hovering);
    take(studio, LEFT, Item::Tool(Tool::FillGun));
    take(studio, RIGHT, Item::Tool(Tool::Rotary));
    assert!(!falls(studio, 0, -5.0, 0), "nothing is edited yet");
}

#[test]
fn islands_wait_for_a_hand_on_a_long_way() {
    let mut studio = studio();
    for (steps, waits) in [(LONG_WAY / 4, false), (LONG_WAY + 8, true)] {
        with_an_island_in_the_air(&mut studio);
        assert_eq!(falls(&mut studio, steps, 1.0, 0), !waits, "{steps} steps");
        assert_eq!(falls(&mut studio, steps, 1.0, 0), waits, "at rest after {steps} steps");
    }
}

#[test]
fn islands_wait_for_an_undo() {
    let mut studio = studio();
    with_an_island_in_the_air(&mut studio);
    assert!(falls(&mut studio, 0, 1.0, 0));
    assert!(!falls(&mut studio, 0, 2.0, commands::UNDO), "it is back");
    assert!(falls(&mut studio, 0, 2.0, 0));
}

/// A tool that is taken while the trigger is pulled begins a stroke of its own.
#[test]
fn another_bit_begins_another_stroke() {
    let mut studio = studio();
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    (0..4).for_each(|_| reach(&mut studio, RIGHT, Vec3::new(20.0, 31.0, 20.0), true));
    let first = maps_digest(studio.world.volume().maps());
    let place = Pose { position: Vec3::new(44.0, 31.0, 44.0), rotation: Quat::IDENTITY };
    let hand = HandInput { trigger: 255, ..at(&studio.world, RIGHT, &place) };
    let pointer = Pointer::Take { hand: 1, item: Item::Bit(Bit::LargeBall).number() as u8 };
    studio.step(&Input { pointer, ..with(RIGHT, hand) });
    (0..4).for_each(|_| reach(&mut studio, RIGHT, Vec3::new(44.0, 31.0, 44.0), true));
    assert_eq!(studio.world.undo_counts(), (2, 0));
    studio.step(&Input { commands: commands::UNDO, ..Input::default() });
    assert_eq!(maps_digest(studio.world.volume().maps()), first);
}

#[test]
fn buttons_act_once_a_press() {
    let mut studio = studio();
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    for x in [12.0, 32.0, 52.0] {
        stroke(&mut studio, RIGHT, Vec3::new(x, 31.0, 12.0), Vec3::new(x, 31.0, 50.0), 12);
    }
    assert_eq!(studio.world.undo_counts(), (3, 0));
    let press = |studio: &mut Studio<64>, buttons| {
        (0..5).for_each(|_| studio.step(&with(LEFT, HandInput { buttons, ..hand_at(STOOL) })));
        studio.step(&with(LEFT, hand_at(STOOL)));
    };
    press(&mut studio, buttons::LOWER);
    assert_eq!(studio.world.undo_counts(), (2, 1));
    // Both at once are neither.
    press(&mut studio, buttons::LOWER | buttons::UPPER);
    assert_eq!((studio.world.undo_counts(), studio.world.events()), ((2, 1), &[][..]));
    press(&mut studio, buttons::UPPER);
    assert_eq!(studio.world.undo_counts(), (3, 0));
    press(&mut studio, buttons::UPPER);
    press(&mut studio, buttons::LOWER | buttons::UPPER);
    assert_eq!(studio.world.undo_counts(), (3, 0), "as where nothing is to be done again");
    press(&mut studio, buttons::STICK);
    assert!(studio.world.symmetry());
    studio.step(&Input { commands: commands::SYMMETRY, ..Input::default() });
    assert!(!studio.world.symmetry());
}

#[test]
fn symmetry_is_the_exact_mirror() {
    let mut studio = studio();
    for tool in Tool::ALL {
        floor(&mut studio, 30);
        studio.step(&Input { commands: commands::SYMMETRY, ..Input::default() });
        assert_eq!(studio.world.events(), [Event::Symmetry(true)]);
        take(&mut studio, LEFT, Item::Tool(tool));
        let before = voxels(&studio);
        stroke(&mut studio, LEFT, Vec3::new(50.3, 31.2, 20.9), Vec3::new(28.1, 28.7, 40.2), 25);
        let after = voxels(&studio);
        assert!(after == after.mirrored(), "{tool:?}");
        let changes = before != after;
        assert!(tool == Tool::Rasp || changes, "{tool:?} did nothing");
    }
}

#[test]
fn the_end_takes_no_more_edits() {
    let mut studio = studio();
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    stroke(&mut studio, RIGHT, Vec3::new(10.0, 31.0, 20.0), Vec3::new(50.0, 31.0, 20.0), 12);
    studio.step(&Input { commands: commands::FINISH, ..Input::default() });
    assert_eq!(studio.world.events(), [Event::Finished]);
    assert_eq!(studio.world.session(), Session::Finished);
    let done = maps_digest(studio.world.volume().maps());
    let mut visitor = Visitor::new(8);
    for _ in 0..200 {
        studio.step(&visitor.act());
        assert_eq!(studio.world.events(), []);
    }
    assert_eq!(maps_digest(studio.world.volume().maps()), done);
    // In the very tick of the end, nothing is carved either.
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let pose = Pose { position: Vec3::new(30.0, 31.0, 30.0), rotation: Quat::IDENTITY };
    let hand = HandInput { trigger: 255, ..at(&studio.world, RIGHT, &pose) };
    studio.step(&Input { commands: commands::FINISH, ..with(RIGHT, hand) });
    assert_eq!(edits(studio.world.events()), 0);
    studio.start(Mode::Creative);
    assert_eq!(studio.world.session(), Session::Sculpting);
}

/// Whatever a carving visitor does, a bit is never deeper than its bite, nor in the figure, and each
/// tick takes only from the bit's way.
#[test]
fn the_hidden_figure_outlasts_any_carving() {
    let mut studio = studio();
    let (mut on_mask, mut carved) = (0, 0);
    for seed in 0..6 {
        studio.start(Mode::Constrained { figure: 0 });
        let mut dice = Dice::new(seed);
        let bit = Bit::from_number(dice.roll(7) as u8).expect("a carving bit");
        take(&mut studio, RIGHT, Item::Tool(bit.data().tool));
        take(&mut studio, RIGHT, Item::Bit(bit));
        assert_eq!(bit.data().action, Action::Carve);
        let mut visitor = Visitor::new(seed + 70);
        visitor.restless = false;
        // From outside: the bit has a place that isn't too deep.
        reach(&mut studio, RIGHT, Vec3::new(32.0, 90.0, 32.0), false);
        let mask = maps_digest(studio.world.mask());
        let grid = bit.on_grid(studio.world.frame().voxel() * 1e6);
        for _ in 0..900 {
            let mut input = visitor.act();
            input.hands[LEFT] = HandInput::default();
            input.hands[RIGHT].squeeze = 0;
            if !matches!(input.pointer, Pointer::Turn { .. }) {
                input.pointer = Pointer::None;
            }
            let full = studio.world.volume().count();
            studio.step(&input);
            studio.check();
            carved += full - studio.world.volume().count();
            if let Some(contact) = studio.world.contact(RIGHT) {
                assert!(contact.depth <= grid.bite, "{contact:?}");
                let mask = Some(studio.world.mask());
                let frozen = studio.world.hand(RIGHT).frozen;
                let obstacle = Obstacle { rows: studio.world.volume().rows(), mask };
                assert_eq!(obstacle.freeze(&grid, &frozen, &frozen, 1).pose, frozen);
                on_mask += u32::from(contact.on_mask);
                let touches = contact.overlap > 0 || contact.on_mask;
                assert!(touches || studio.world.hand(RIGHT).haptic == 0);
            }
        }
        assert_eq!(maps_digest(studio.world.mask()), mask);
    }
    assert!(on_mask > 50 && carved > 1000, "{on_mask} ticks on the figure, {carved} voxels carved");
}

#[test]
fn a_new_world_is_a_cleared_one() {
    let mut studio = studio();
    studio.open();
    let empty = studio.world.digest();
    static NEW: Mutex<World<64>> = Mutex::new(World::new());
    let new = NEW.lock().unwrap_or_else(PoisonError::into_inner);
    assert_eq!(new.digest(), empty);
    assert_eq!(new.recompute_digest(), empty);
    for seed in 0..4 {
        studio.start_from(|[x, y, z]| y < 4 || x % 9 < 2 && (z % 7 < 2 || y % 16 == 15));
        let mut visitor = Visitor::new(seed);
        (0..150).for_each(|_| studio.step(&visitor.act()));
        assert_ne!(studio.world.digest(), empty);
        studio.world.clear();
        assert_eq!(studio.world.digest(), empty);
        assert_eq!(studio.world.recompute_digest(), empty);
        assert_eq!((studio.world.tick(), studio.world.session()), (0, Session::Waiting));
    }
}

/// One voxel afloat between the ends of six rods, which closure can't leave out.
fn afloat([x, y, z]: [usize; 3]) -> bool {
    let along_x = y == 20 && z == 32 && ((14..=30).contains(&x) || (34..=50).contains(&x));
    let along_z = y == 20 && x == 32 && ((14..=30).contains(&z) || (34..=50).contains(&z));
    let aside = y == 20 && (32..=40).contains(&x) && (z == 14 || z == 50);
    let along_y = x == 32 && z == 32 && (y <= 18 || (22..=40).contains(&y));
    let above = y == 40 && z == 32 && (32..=55).contains(&x);
    let legs = y <= 20 && (z == 32 && (x == 14 || x == 50) || x == 40 && (z == 14 || z == 50));
    let long_leg = y <= 40 && x == 55 && z == 32;
    let stage = y < 3 && x < 12 && z < 12;
    [x, y, z] == [32, 20, 32]
        || [along_x, along_z, aside, along_y, above, legs, long_leg, stage].contains(&true)
}

#[test]
fn what_closure_kept_is_told_once_and_forgotten_at_a_start() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let fresh = studio.world.part_digests();
    studio.start_from(afloat);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut kept = Vec::new();
    for i in 0..40 {
        reach(&mut studio, RIGHT, Vec3::new(2.0 + 0.2 * i as f32, 4.5, 6.0), true);
        let islands = studio.world.events().iter().filter_map(|event| match event {
            Event::Islands(report) => Some(report.kept),
            _ => None,
        });
        kept.extend(islands);
    }
    assert_eq!(kept, [1], "told once, though many passes found it");
    studio.step(&Input { start: Mode::FreeForm, ..Input::default() });
    assert_eq!(studio.world.part_digests()[1..], fresh[1..]);
}

#[test]
fn a_world_fits_its_memory() {
    let sizes = (size_of::<World<128>>(), size_of::<World<256>>());
    println!("World<128> is {} bytes, World<256> {}", sizes.0, sizes.1);
    assert!(sizes.0 <= 1 << 20 && sizes.1 <= 6 << 20, "{sizes:?}");
    assert_eq!(size_of::<Maps<128>>(), 3 * 2 * 128 * 128);
}

fn edits(events: &[Event]) -> usize {
    events.iter().filter(|event| matches!(event, Event::Edited { .. })).count()
}
