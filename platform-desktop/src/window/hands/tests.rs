//! The hands over a real world.

use std::sync::MutexGuard;

use glam::Vec3;
use paros_core::input::{Input, Mode, Pointer, commands};
use paros_core::maps::{Axis, Maps};
use paros_core::size::Grid;
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::{Session, World};
use paros_shell::stage::Stage;
use paros_shell::starts::StartVolumes;
use paros_shell::statics::Resident;

use super::{Button, Event, Hands, Key, RIGHT};

const SIZE: [u32; 2] = [1000, 700];

/// Hands over a world of 128, one test at a time.
struct Rig {
    hands: Hands<128>,
    volumes: MutexGuard<'static, StartVolumes<128>>,
    world: MutexGuard<'static, World<128>>,
}

impl Rig {
    fn new(mode: Mode) -> Self {
        let mut volumes = Grid::<128>::start_volumes();
        volumes.make(&mut Grid::<128>::plane(), |_| {});
        let mut world = Grid::<128>::world();
        world.clear();
        let mut hands = Hands::new();
        hands.size = SIZE;
        hands.start(mode);
        let mut rig = Rig { hands, volumes, world };
        rig.ticks(3);
        assert_eq!(rig.world.session(), Session::Sculpting);
        rig
    }

    fn tick(&mut self) -> Input {
        let input = self.hands.input(&self.world);
        let hidden = self.volumes.hidden();
        Stage::new(&mut self.world, self.volumes.starts(&hidden)).tick(&input);
        input
    }

    fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
        }
    }

    fn does(&mut self, event: Event) {
        self.hands.event(event, &self.world);
    }

    fn taps(&mut self, key: Key) {
        self.does(Event::Key(key, true));
        self.does(Event::Key(key, false));
        self.ticks(2);
    }

    fn held(&self) -> (Tool, Bit) {
        self.world.held(RIGHT).expect("something is held")
    }

    fn count(&self) -> u64 {
        self.world.volume().count()
    }

    fn digest(&self) -> u64 {
        self.world.volume().digest()
    }
}

/// Occupied voxels of `a` that are not in `b`.
fn missing(a: &Maps<128>, b: &Maps<128>) -> Vec<Vec3> {
    let mut voxels = Vec::new();
    for y in 0..128 {
        for z in 0..128 {
            let column = a.column(Axis::X, (y, z));
            for x in (0..128).filter(|x| column.contains(*x)) {
                if a.contains([x, y, z]) && !b.contains([x, y, z]) {
                    voxels.push(Vec3::new(x as f32, y as f32, z as f32) + 0.5);
                }
            }
        }
    }
    voxels
}

#[test]
fn a_press_carves_under_the_cursor_and_undo_brings_it_back() {
    let mut rig = Rig::new(Mode::FreeForm);
    rig.does(Event::Moved([480.0, 330.0]));
    rig.ticks(10);
    let (before, untouched) = (Box::new(copy(&rig)), rig.digest());
    rig.does(Event::Pressed(Button::Left));
    rig.ticks(20);
    rig.does(Event::Released(Button::Left));
    rig.ticks(2);
    let removed = missing(&before, rig.world.volume().maps());
    assert!(removed.len() > 50, "{} voxels", removed.len());
    let (origin, direction) = rig.hands.orbit.ray([480.0, 330.0], SIZE);
    let frame = rig.world.frame();
    for voxel in removed {
        let pose = paros_core::pose::Pose { position: voxel, ..paros_core::pose::Pose::ZERO };
        let (point, _) = frame.to_room(&pose);
        let aside = (point - origin).cross(direction).length();
        assert!(aside < 0.02, "{aside} m beside the cursor");
    }
    rig.taps(Key::Undo);
    assert_eq!(rig.digest(), untouched);
    rig.taps(Key::Redo);
    assert_ne!(rig.digest(), untouched);
}

fn copy(rig: &Rig) -> Maps<128> {
    let mut maps = Maps::new();
    maps.copy_from(rig.world.volume().maps());
    maps
}

#[test]
fn a_stroke_is_one_groove_however_fast_the_hand_is() {
    let groove = |points: u32| {
        let mut rig = Rig::new(Mode::FreeForm);
        rig.does(Event::Moved([440.0, 400.0]));
        rig.ticks(10);
        let before = rig.count();
        rig.does(Event::Pressed(Button::Left));
        rig.ticks(10);
        for i in 1..=points {
            rig.does(Event::Moved([440.0 + 120.0 * i as f32 / points as f32, 400.0]));
            rig.tick();
        }
        rig.ticks(150);
        rig.does(Event::Released(Button::Left));
        rig.ticks(2);
        before - rig.count()
    };
    let (slow, fast) = (groove(100), groove(1));
    assert!(slow > 400, "{slow} voxels");
    assert!(fast * 10 > slow * 9 && slow * 10 > fast * 9, "{slow} slowly, {fast} fast");
}

#[test]
fn the_wheel_chooses_the_depth_of_a_stroke() {
    let removed = |notches: f32| {
        let mut rig = Rig::new(Mode::FreeForm);
        rig.does(Event::Moved([480.0, 330.0]));
        rig.does(Event::Wheel(notches));
        rig.ticks(10);
        let before = rig.count();
        rig.does(Event::Pressed(Button::Left));
        rig.ticks(60);
        before - rig.count()
    };
    let (off, usual, deep) = (removed(12.0), removed(0.0), removed(-8.0));
    assert_eq!(off, 0, "held off the surface it carves nothing");
    assert!(usual > 50 && deep > usual * 3 / 2, "{usual} and {deep}");
}

#[test]
fn a_tool_at_rest_touches_nothing_and_never_stays_behind() {
    let mut rig = Rig::new(Mode::Creative);
    let untouched = rig.digest();
    let mut seed = 11u32;
    let mut random = |below: f32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32 * below
    };
    for round in 0..60 {
        rig.does(Event::Moved([300.0 + random(400.0), 100.0 + random(500.0)]));
        if round % 6 == 0 {
            rig.does(Event::Pressed(Button::Right));
            rig.does(Event::Moved([random(1000.0), 100.0 + random(500.0)]));
            rig.does(Event::Released(Button::Right));
            rig.does(Event::Moved([300.0 + random(400.0), 100.0 + random(500.0)]));
        }
        rig.ticks(45);
        let hand = rig.world.hand(RIGHT);
        let behind = (hand.raw.position - hand.frozen.position).length();
        assert!(behind < 8.0, "{behind} voxels behind in round {round}");
    }
    assert_eq!(rig.digest(), untouched);
}

#[test]
fn keys_choose_tools_and_bits() {
    let mut rig = Rig::new(Mode::FreeForm);
    assert_eq!(rig.held(), (Tool::Rotary, Bit::MediumBall));
    rig.taps(Key::NextBit);
    assert_eq!(rig.held().1, Bit::LargeBall);
    rig.taps(Key::PreviousBit);
    rig.taps(Key::PreviousBit);
    rig.taps(Key::PreviousBit);
    assert_eq!(rig.held().1, Bit::Grinder, "they go round");
    rig.taps(Key::Bit(3));
    assert_eq!(rig.held().1, Bit::Cylinder);
    rig.taps(Key::Bit(8));
    assert_eq!(rig.held().1, Bit::Cylinder, "there is no ninth");
    for (number, tool) in Tool::ALL.into_iter().enumerate().rev() {
        rig.taps(Key::Tool(number as u8));
        assert_eq!(rig.held().0, tool);
    }
    rig.taps(Key::Mirror);
    assert!(rig.world.symmetry());
}

#[test]
fn a_click_on_the_bench_takes_what_lies_there() {
    let mut rig = Rig::new(Mode::FreeForm);
    let untouched = rig.digest();
    rig.hands.orbit.azimuth = 0.6;
    rig.hands.orbit.distance = 2.0;
    let home = Item::Tool(Tool::Impact).home();
    let (pixel, _) = rig.hands.orbit.pixel(home, SIZE).expect("it is before the eye");
    rig.does(Event::Moved(pixel));
    rig.does(Event::Pressed(Button::Left));
    rig.ticks(30);
    assert_eq!(rig.held().0, Tool::Impact);
    assert_eq!(rig.digest(), untouched);
}

#[test]
fn drags_and_keys_turn_the_eye_and_the_stool() {
    let mut rig = Rig::new(Mode::FreeForm);
    let eye = rig.hands.orbit;
    rig.does(Event::Moved([500.0, 300.0]));
    rig.does(Event::Pressed(Button::Right));
    rig.does(Event::Moved([560.0, 330.0]));
    rig.does(Event::Released(Button::Right));
    assert!(rig.hands.orbit.azimuth < eye.azimuth && rig.hands.orbit.elevation > eye.elevation);
    let turned = |input: Input| match input.pointer {
        Pointer::Turn { by } => i32::from(by),
        _ => 0,
    };
    rig.does(Event::Moved([100.0, 300.0]));
    rig.does(Event::Pressed(Button::Middle));
    rig.does(Event::Moved([600.0, 300.0]));
    rig.does(Event::Released(Button::Middle));
    rig.does(Event::Moved([300.0, 300.0]));
    // Half the picture is half a turn, in as many ticks as it takes.
    assert_eq!((0..8).map(|_| turned(rig.tick())).sum::<i32>(), 32_768);
    rig.does(Event::Key(Key::Turn { left: true }, true));
    assert_eq!((0..72).map(|_| turned(rig.tick())).sum::<i32>(), -72 * 227);
    rig.does(Event::LetGo);
    assert_eq!(turned(rig.tick()), 0);
    let near = rig.hands.orbit.distance;
    rig.does(Event::Key(Key::Nearer, true));
    assert!(rig.hands.orbit.distance < near);
}

#[test]
fn a_start_comes_alone_and_commands_act_once() {
    let mut rig = Rig::new(Mode::FreeForm);
    rig.hands.command(commands::SYMMETRY);
    rig.hands.start(Mode::Creative);
    let input = rig.tick();
    assert_eq!((input.start, input.commands), (Mode::Creative, 0));
    rig.hands.command(commands::SYMMETRY);
    assert_eq!(rig.tick().commands, commands::SYMMETRY);
    assert_eq!(rig.tick().commands, 0);
    assert_eq!(rig.held().0, Tool::Rotary);
    // Where there is no cursor the hand rests and the tool does nothing.
    rig.does(Event::Pressed(Button::Left));
    assert_eq!(rig.tick().hands[RIGHT].trigger, 0);
}
