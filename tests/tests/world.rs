//! A session as a visitor lives it: bench, hands, stool, strokes, modes, the end.

use std::mem::size_of;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::contact::Obstacle;
use paros_core::events::Event;
use paros_core::frame::{BOX, STOOL};
use paros_core::input::{HandInput, Input, Mode, Pointer, RawPose, TICK_RATE, buttons, commands};
use paros_core::maps::{Axis, Maps};
use paros_core::pose::Pose;
use paros_core::tools::{Action, Bit, Tool};
use paros_core::volume::maps_digest;
use paros_core::workbench::{BENCH_TOP, Item, Place};
use paros_core::world::{Session, World};
use paros_tests::models::dense::Dense;
use paros_tests::models::studio::{Studio, same};
use paros_tests::models::visitor::{Dice, Visitor, at};

const LEFT: usize = 0;
const RIGHT: usize = 1;

static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());

fn studio() -> MutexGuard<'static, Studio<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

fn hand_at(position: Vec3) -> HandInput {
    let pose = RawPose::new(position, Quat::IDENTITY);
    HandInput { aim: pose, grip: pose, tracked: true, ..HandInput::default() }
}

/// An input with one hand, the other out of sight.
fn with(hand: usize, input: HandInput) -> Input {
    let mut all = Input::default();
    all.hands[hand] = input;
    all
}

/// A squeeze, and the hand open again.
fn squeeze(studio: &mut Studio<64>, hand: usize, position: Vec3) -> Vec<Event> {
    studio.step(&with(hand, HandInput { squeeze: 255, ..hand_at(position) }));
    let events = studio.world.events().to_vec();
    studio.step(&with(hand, hand_at(position)));
    events
}

fn take(studio: &mut Studio<64>, hand: usize, item: Item) {
    let pointer = Pointer::Take { hand: hand as u8, item: item.number() as u8 };
    studio.step(&Input { pointer, ..Input::default() });
}

/// A tick with the held bit at a place of the grid.
fn reach(studio: &mut Studio<64>, hand: usize, position: Vec3, trigger: bool) {
    let pose = Pose { position, rotation: Quat::IDENTITY };
    let input =
        HandInput { trigger: if trigger { 255 } else { 0 }, ..at(&studio.world, hand, &pose) };
    studio.step(&with(hand, input));
}

/// A stroke from one place to another, trigger pulled; then the bit is out of the way.
fn stroke(studio: &mut Studio<64>, hand: usize, from: Vec3, to: Vec3, ticks: u32) {
    reach(studio, hand, from, false);
    for i in 1..=ticks {
        reach(studio, hand, from.lerp(to, i as f32 / ticks as f32), true);
    }
    reach(studio, hand, to, false);
    reach(studio, hand, to + Vec3::Y * 40.0, false);
}

/// A floor of stone up to `height`.
fn floor(studio: &mut Studio<64>, height: usize) {
    studio.start_from(|[_, y, _]| y < height);
}

fn voxels(studio: &Studio<64>) -> Dense {
    Dense::from_plane(studio.world.volume().rows())
}

fn edits(events: &[Event]) -> usize {
    events.iter().filter(|event| matches!(event, Event::Edited { .. })).count()
}

#[test]
fn each_hand_takes_exchanges_and_returns_tools() {
    let mut studio = studio();
    for (hand, other) in [(LEFT, RIGHT), (RIGHT, LEFT)] {
        studio.start(Mode::FreeForm);
        let (rotary, gun) = (Item::Tool(Tool::Rotary), Item::Tool(Tool::FillGun));
        let events = squeeze(&mut studio, hand, rotary.home());
        assert_eq!(events, [Event::Took { hand: hand as u8, item: rotary }]);
        assert_eq!(studio.world.held(hand), Some((Tool::Rotary, Bit::MediumBall)));
        assert_eq!(studio.world.bench().pose(rotary), None);
        // Another tool in reach: the first goes home.
        squeeze(&mut studio, hand, gun.home());
        assert_eq!(studio.world.held(hand), Some((Tool::FillGun, Bit::Nozzle)));
        assert_eq!(studio.world.bench().place(rotary), Place::Home);
        // What one hand holds, the other can't find on the bench.
        assert_eq!(squeeze(&mut studio, other, gun.home()), []);
        // By the pointer it changes hands.
        take(&mut studio, other, gun);
        assert_eq!(
            (studio.world.held(hand), studio.world.held(other)),
            (None, Some((Tool::FillGun, Bit::Nozzle)))
        );
        // Let go at its own place.
        let events = squeeze(&mut studio, other, gun.home());
        assert_eq!(events, [Event::Released { hand: other as u8, tool: Tool::FillGun }]);
        assert_eq!(studio.world.bench().place(gun), Place::Home);
        // Out of reach of everything, nothing is taken.
        assert_eq!(squeeze(&mut studio, hand, STOOL), []);
    }
}

#[test]
fn bits_are_mounted_on_their_own_tool() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let grinder = Item::Bit(Bit::Grinder);
    assert_eq!(squeeze(&mut studio, LEFT, grinder.home()), [], "no tool to put it on");
    take(&mut studio, LEFT, Item::Tool(Tool::Impact));
    take(&mut studio, LEFT, grinder);
    assert_eq!(studio.world.held(LEFT), Some((Tool::Impact, Bit::PointChisel)));
    squeeze(&mut studio, RIGHT, Item::Tool(Tool::Rotary).home());
    let events = squeeze(&mut studio, RIGHT, grinder.home());
    assert_eq!(events, [Event::Took { hand: 1, item: grinder }]);
    assert_eq!(studio.world.held(RIGHT), Some((Tool::Rotary, Bit::Grinder)));
    assert_eq!(studio.world.bench().place(Item::Bit(Bit::MediumBall)), Place::Home);
    assert_eq!(studio.world.bench().place(grinder), Place::Mounted);
    // It stays mounted on the bench.
    studio.step(&Input { pointer: Pointer::Return { hand: 1 }, ..Input::default() });
    assert_eq!(studio.world.events(), [Event::Returned { hand: 1, tool: Tool::Rotary }]);
    assert_eq!(studio.world.held(RIGHT), None);
    take(&mut studio, LEFT, Item::Tool(Tool::Rotary));
    assert_eq!(studio.world.held(LEFT), Some((Tool::Rotary, Bit::Grinder)));
    for item in 0..=255 {
        studio.step(&Input { pointer: Pointer::Take { hand: 7, item }, ..Input::default() });
    }
}

#[test]
fn what_is_dropped_falls_lies_and_is_back_within_ten_seconds() {
    let mut studio = studio();
    let item = Item::Tool(Tool::Rasp);
    for (place, rest) in [(Vec3::new(0.0, 1.2, 0.3), 0.03), (Vec3::new(0.5, 1.3, 0.15), BENCH_TOP)]
    {
        studio.start(Mode::FreeForm);
        take(&mut studio, RIGHT, item);
        let events = squeeze(&mut studio, RIGHT, place);
        assert_eq!(events, [Event::Released { hand: 1, tool: Tool::Rasp }]);
        let mut height = place.y;
        let mut fell = 0;
        while matches!(studio.world.bench().place(item), Place::Falling(_)) {
            let (position, _) = studio.world.bench().pose(item).expect("it is in the room");
            assert!(position.y < height);
            height = position.y;
            studio.step(&Input::default());
            fell += 1;
        }
        let metres = place.y - rest;
        let seconds = (2.0 * metres / 9.81).sqrt();
        assert!((fell as f32 / TICK_RATE as f32 - seconds).abs() < 0.05, "fell for {fell} ticks");
        let (position, _) = studio.world.bench().pose(item).expect("it lies there");
        assert!(position.distance(Vec3::new(place.x, rest, place.z)) < 1e-4, "{position}");
        // It can be picked up from there, and dropped again.
        let events = squeeze(&mut studio, LEFT, position);
        assert_eq!(events, [Event::Took { hand: 0, item }]);
        squeeze(&mut studio, LEFT, place);
        for _ in 0..10 * TICK_RATE + 60 {
            studio.step(&Input::default());
        }
        assert_eq!(studio.world.bench().place(item), Place::Home);
    }
}

#[test]
fn the_stool_turns_and_takes_contact_and_edits_along() {
    let mut studio = studio();
    for turn in [0i16, 16_384, -16_384, 5000, i16::MIN] {
        floor(&mut studio, 30);
        studio.step(&Input { pointer: Pointer::Turn { by: turn }, ..Input::default() });
        take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
        let before = voxels(&studio);
        // A place in the room, the same for every turn.
        let tip = STOOL + Vec3::new(0.1, 31.0 / 64.0 * BOX, -0.05);
        let grip = tip + Vec3::Z * Tool::Rotary.length() as f32 * 1e-6;
        // From above: the push-out is in the room, up.
        studio.step(&with(RIGHT, hand_at(grip + Vec3::Y * 0.1)));
        studio.step(&with(RIGHT, hand_at(grip)));
        let out = studio.world.push_out(RIGHT);
        assert!(out.y > 0.001 && out.x.abs() < 1e-4 && out.z.abs() < 1e-4, "{turn}: {out}");
        for _ in 0..3 {
            studio.step(&with(RIGHT, HandInput { trigger: 255, ..hand_at(grip) }));
        }
        let angle = f32::from(turn) / 65_536.0 * std::f32::consts::TAU;
        let expected = Quat::from_rotation_y(-angle) * Vec3::new(0.1, 0.0, -0.05) / BOX * 64.0
            + Vec3::new(32.0, 31.0, 32.0);
        let raw = studio.world.hand(RIGHT).raw.position;
        assert!(raw.distance(expected) < 0.05, "{turn}: {raw}, not {expected}");
        let gone = before.without(&voxels(&studio));
        assert!(gone.count() > 5, "{turn}: {} voxels", gone.count());
        for voxel in gone.occupied() {
            let centre = Vec3::from_array(voxel.map(|i| i as f32 + 0.5));
            assert!(centre.distance(expected) < 4.0, "{turn}: {voxel:?} is far from {expected}");
        }
    }
}

#[test]
fn a_stick_turns_the_stool_a_quarter_turn_a_second() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let zero = studio.world.frame();
    for _ in 0..TICK_RATE {
        studio.step(&with(LEFT, HandInput { stick: [127, 0], ..hand_at(STOOL) }));
    }
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let (_, turned) = studio.world.frame().to_room(&Pose::ZERO);
    assert!(turned.angle_between(quarter) < 0.02, "{turned}");
    // Not by a hand that is out of sight, nor by a stick at rest.
    let still = studio.world.frame();
    studio.step(&with(LEFT, HandInput { stick: [127, 0], tracked: false, ..hand_at(STOOL) }));
    studio.step(&with(LEFT, HandInput { stick: [20, 127], ..hand_at(STOOL) }));
    assert_eq!(studio.world.frame(), still);
    assert_ne!(still, zero);
}

/// A stone held against a turning stool is turned as on a lathe: the tool stands, the edit sweeps.
#[test]
fn a_tool_at_rest_carves_the_turning_stone() {
    let mut studio = studio();
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let tip = STOOL + Vec3::new(0.15, 31.0 / 64.0 * BOX, 0.0);
    let grip = tip + Vec3::Z * Tool::Rotary.length() as f32 * 1e-6;
    let full = studio.world.volume().count();
    for _ in 0..5 * TICK_RATE {
        let hand = HandInput { trigger: 255, stick: [127, 0], ..hand_at(grip) };
        studio.step(&with(RIGHT, hand));
        studio.check();
    }
    let ring = voxels(&studio);
    let radius = 0.15 / BOX * 64.0;
    for i in 0..64 {
        let angle = i as f32 / 64.0 * std::f32::consts::TAU;
        let place = [32.0 + radius * angle.cos(), 29.5, 32.0 + radius * angle.sin()];
        assert!(!ring.contains(place.map(|v| v as i32)), "nothing carved at {place:?}");
    }
    assert!(studio.world.volume().count() < full);
}

/// What a tick removes lies within the bit as it is now, not on the way there.
fn assert_no_sweep(studio: &Studio<64>, hand: usize, bit: Bit, before: &Dense, what: &str) {
    let grid = bit.on_grid(studio.world.frame().voxel() * 1e6);
    let brush = grid.brush(&studio.world.hand(hand).frozen);
    let gone = before.without(&voxels(studio));
    assert!(!gone.is_empty(), "{what}: nothing carved");
    for voxel in gone.occupied() {
        let [x, y, z] = voxel.map(|i| i as usize);
        use paros_core::row::Bits;
        assert!(brush.row::<64>(y, z).contains(x), "{what}: {voxel:?} was swept");
    }
}

#[test]
fn a_grab_a_tool_change_and_a_gap_never_sweep() {
    let mut studio = studio();
    let (a, b) = (Vec3::new(12.0, 30.2, 20.0), Vec3::new(52.0, 30.2, 44.0));
    let start = |studio: &mut Studio<64>| {
        floor(studio, 30);
        take(studio, RIGHT, Item::Tool(Tool::Rotary));
        (0..3).for_each(|_| reach(studio, RIGHT, a, true));
    };
    // The other way round: a plain stroke does sweep.
    start(&mut studio);
    let just_touching = |place: Vec3| Vec3::new(place.x, 31.4, place.z);
    reach(&mut studio, RIGHT, just_touching(a), true);
    reach(&mut studio, RIGHT, just_touching(b), true);
    let middle = [32, 29, 32];
    assert!(!voxels(&studio).contains(middle), "a fast stroke leaves no dots");
    // Tracking is lost for a tick; trigger held all the while.
    start(&mut studio);
    reach(&mut studio, RIGHT, just_touching(a), true);
    studio.step(&with(RIGHT, HandInput { trigger: 255, tracked: false, ..HandInput::default() }));
    let before = voxels(&studio);
    reach(&mut studio, RIGHT, just_touching(b), true);
    assert_no_sweep(&studio, RIGHT, Bit::MediumBall, &before, "gap");
    // Another bit, another tool, put back and taken again: in the tick of the jump.
    let jumps: [(&str, Item, Bit); 3] = [
        ("bit", Item::Bit(Bit::LargeBall), Bit::LargeBall),
        ("tool", Item::Tool(Tool::Impact), Bit::PointChisel),
        ("grab", Item::Tool(Tool::Rotary), Bit::MediumBall),
    ];
    for (what, item, bit) in jumps {
        start(&mut studio);
        if what == "grab" {
            studio.step(&Input { pointer: Pointer::Return { hand: 1 }, ..Input::default() });
        }
        let before = voxels(&studio);
        let pose = Pose { position: b, rotation: Quat::IDENTITY };
        let mut input = with(RIGHT, HandInput { trigger: 255, ..at(&studio.world, RIGHT, &pose) });
        // Where the new tool's length has the bit.
        let tool = match item {
            Item::Tool(tool) => tool,
            Item::Bit(bit) => bit.data().tool,
        };
        let (tip, rotation) = studio.world.frame().to_room(&pose);
        let grip = RawPose::new(tip + rotation * Vec3::Z * tool.length() as f32 * 1e-6, rotation);
        (input.hands[RIGHT].grip, input.hands[RIGHT].aim) = (grip, grip);
        input.pointer = Pointer::Take { hand: 1, item: item.number() as u8 };
        studio.step(&input);
        assert_eq!(studio.world.held(RIGHT).map(|held| held.1), Some(bit));
        assert_no_sweep(&studio, RIGHT, bit, &before, what);
    }
}

#[test]
fn modes_start_from_their_volumes() {
    let mut studio = studio();
    for (mode, masked) in
        [(Mode::FreeForm, false), (Mode::Constrained { figure: 0 }, true), (Mode::Creative, false)]
    {
        // Whatever went on before.
        let mut visitor = Visitor::new(3);
        (0..60).for_each(|_| studio.step(&visitor.next()));
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
    press(&mut studio, buttons::UPPER);
    assert_eq!(studio.world.undo_counts(), (3, 0));
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
        assert_eq!(changes, tool != Tool::Rasp || changes, "{tool:?}");
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
        studio.step(&visitor.next());
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
            let mut input = visitor.next();
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
                assert_eq!(obstacle.freeze(&grid, &frozen, &frozen).pose, frozen);
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
        (0..150).for_each(|_| studio.step(&visitor.next()));
        assert_ne!(studio.world.digest(), empty);
        studio.world.clear();
        assert_eq!(studio.world.digest(), empty);
        assert_eq!(studio.world.recompute_digest(), empty);
        assert_eq!((studio.world.tick(), studio.world.session()), (0, Session::Waiting));
    }
}

#[test]
fn a_world_fits_its_memory() {
    let sizes = (size_of::<World<128>>(), size_of::<World<256>>());
    println!("World<128> is {} bytes, World<256> {}", sizes.0, sizes.1);
    assert!(sizes.0 <= 1 << 20 && sizes.1 <= 6 << 20, "{sizes:?}");
    assert_eq!(size_of::<Maps<128>>(), 3 * 2 * 128 * 128);
}
