//! A pair of scripted hands: each movement becomes one input a tick, at the speed of a person.

use std::ops::ControlFlow;

use glam::{Quat, Vec3};
use paros_core::input::{Input, Mode, RawPose, commands};
use paros_core::maps::Maps;
use paros_core::pose::Pose;
use paros_core::size::{Grid, Size};
use paros_core::tools::Tool;
use paros_core::workbench::Item;
use paros_core::world::World;
use paros_shell::stage::Stage;

/// Metres that a hand moves in a tick: 1.6 m/s.
const HAND_SPEED: f32 = 1.6 / 72.0;

/// How far the hand pushes ahead of a bit that the stone holds back, in voxels.
const PUSH: f32 = 3.0;

/// The hands' pose between strokes, in metres: before the chest.
const REST: [Vec3; 2] = [Vec3::new(-0.25, 1.0, -0.1), Vec3::new(0.25, 1.0, -0.1)];

/// Hears of every tick; may end the session early.
pub type Watcher<'a, const N: usize> = dyn FnMut(&World<N>) -> ControlFlow<()> + 'a;

/// Two hands over a stage.
pub struct Sculptor<'a, 's, const N: usize>
where
    Grid<N>: Size,
{
    stage: &'a mut Stage<'s, N>,
    watcher: &'a mut Watcher<'a, N>,
    input: Input,
    grips: [(Vec3, Quat); 2],
    ended: bool,
}

impl<'a, 's, const N: usize> Sculptor<'a, 's, N>
where
    Grid<N>: Size,
{
    /// Hands at rest.
    pub fn new(stage: &'a mut Stage<'s, N>, watcher: &'a mut Watcher<'a, N>) -> Self {
        let grips = REST.map(|position| (position, Quat::IDENTITY));
        Sculptor { stage, watcher, input: Input::default(), grips, ended: false }
    }

    /// The world as the hands feel it.
    pub fn world(&self) -> &World<N> {
        self.stage.world()
    }

    /// Whether the watcher has had enough; nothing happens any more.
    pub fn ended(&self) -> bool {
        self.ended
    }

    /// Starts a session.
    pub fn start(&mut self, mode: Mode) {
        self.input.start = mode;
        self.tick();
        self.input.start = Mode::None;
    }

    /// Gives one of [`commands`].
    pub fn command(&mut self, command: u8) {
        self.input.commands = command;
        self.tick();
        self.input.commands = 0;
    }

    /// Switches the mirror if it isn't as asked.
    pub fn mirror(&mut self, on: bool) {
        if self.world().symmetry() != on {
            self.command(commands::SYMMETRY);
        }
    }

    /// Waits.
    pub fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Fetches a tool, or a bit for the tool that the hand holds, from the bench.
    pub fn fetch(&mut self, hand: usize, item: Item) {
        let mut over = item.home() + Vec3::Y * 0.15;
        self.glide(hand, over, Quat::IDENTITY);
        if let (Item::Bit(_), Some((tool, _))) = (item, self.world().held(hand)) {
            over -= self.grips[hand].1 * Vec3::new(0.0, 0.0, -length(tool));
        }
        self.glide(hand, over - Vec3::Y * 0.13, Quat::IDENTITY);
        self.input.hands[hand].squeeze = 255;
        self.tick();
        self.input.hands[hand].squeeze = 0;
        self.tick();
        self.rest(hand);
    }

    /// Takes a hand back to the chest.
    pub fn rest(&mut self, hand: usize) {
        self.glide(hand, REST[hand], Quat::IDENTITY);
    }

    /// Turns the stool with the left stick until `degrees` (of the grid, counter-clockwise from +z
    /// to +x) face the visitor.
    pub fn face(&mut self, degrees: f32) {
        let target = (degrees * (-65_536.0 / 360.0)).round() as i32 as u16;
        loop {
            let (_, turn) =
                self.world().frame().to_room(&Pose { rotation: Quat::IDENTITY, ..Pose::ZERO });
            let now =
                (2.0 * libm::atan2f(turn.y, turn.w) * (65_536.0 / core::f32::consts::TAU)).round();
            let left = i32::from(target.wrapping_sub(now as i32 as u16) as i16);
            // A full push of the stick turns by 227 in a tick, a third of it still by 72.
            let push = match left.abs() {
                0..72 => break,
                n if n < 227 => 40,
                _ => 127,
            };
            self.input.hands[0].stick[0] = (push * left.signum()) as i8;
            self.tick();
            if self.ended {
                break;
            }
        }
        self.input.hands[0].stick[0] = 0;
    }

    /// Moves the bit through the air to a point of the grid, so that it points along
    /// `way`.
    pub fn approach(&mut self, hand: usize, point: Vec3, way: Vec3) {
        let (position, rotation) = self.grip_for(hand, point, way);
        self.glide(hand, position, rotation);
    }

    /// Runs the tool along `way` from where it is, pushing through what it meets, until it has come
    /// `distance` voxels, is held by what can't be removed, or is stuck. The trigger stays down.
    pub fn drive(&mut self, hand: usize, from: Vec3, way: Vec3, distance: f32) {
        self.input.hands[hand].trigger = 255;
        let (mut best, mut stuck) = (0.0, 0);
        while stuck < 5 && !self.ended {
            let reached = (self.world().hand(hand).frozen.position - from).dot(way);
            let (grip, rotation) = self.grip_for(hand, from + way * (reached.max(0.0) + PUSH), way);
            self.grips[hand] = (grip, rotation);
            self.tick();
            let reached = (self.world().hand(hand).frozen.position - from).dot(way);
            let on_mask = self.world().contact(hand).is_some_and(|contact| contact.on_mask);
            if reached >= distance || (on_mask && reached < best + 0.2) {
                break;
            }
            stuck = if reached > best + 0.05 { 0 } else { stuck + 1 };
            best = reached.max(best);
        }
    }

    /// Runs the tool through a row of points of the grid, pointing along `way`. It stays at each for
    /// up to `patience` ticks more, as long as it still sinks in.
    pub fn stroke(
        &mut self,
        hand: usize,
        points: impl IntoIterator<Item = Vec3>,
        way: Vec3,
        patience: u32,
    ) {
        self.input.hands[hand].trigger = 255;
        for point in points {
            self.grips[hand] = self.grip_for(hand, point, way);
            self.tick();
            for _ in 0..patience {
                let before = self.world().hand(hand).frozen.position;
                self.tick();
                if (self.world().hand(hand).frozen.position - before).dot(way) < 0.15 {
                    break;
                }
            }
        }
    }

    /// Lets go of the trigger.
    pub fn lift(&mut self, hand: usize) {
        self.input.hands[hand].trigger = 0;
        self.tick();
    }

    /// How far along a ray the stone begins, and how far the mask does, in voxels.
    pub fn probe(&self, from: Vec3, way: Vec3) -> (Option<f32>, Option<f32>) {
        let first = |maps: &Maps<N>| {
            (0..2 * N).map(|i| i as f32).find(|&distance| {
                let voxel = (from + way * distance).floor();
                let inside =
                    voxel.cmpge(Vec3::ZERO).all() && voxel.cmplt(Vec3::splat(N as f32)).all();
                inside && maps.contains(voxel.to_array().map(|v| v as usize))
            })
        };
        (first(self.world().volume().maps()), first(self.world().mask()))
    }

    /// One tick with the hands where they are.
    fn tick(&mut self) {
        if self.ended {
            return;
        }
        for (hand, (position, rotation)) in self.input.hands.iter_mut().zip(self.grips) {
            hand.grip = RawPose::new(position, rotation);
            (hand.aim, hand.tracked) = (hand.grip, true);
        }
        self.input.head = RawPose::new(Vec3::new(0.0, 1.5, 0.1), Quat::IDENTITY);
        self.stage.tick(&self.input);
        self.ended = (self.watcher)(self.stage.world()).is_break();
    }

    /// Moves a hand, at the speed of hands, to a grip pose in the room.
    fn glide(&mut self, hand: usize, position: Vec3, rotation: Quat) {
        let (start, turned) = self.grips[hand];
        let steps = ((position - start).length() / HAND_SPEED).ceil().max(1.0);
        for i in 1..=steps as usize {
            let t = i as f32 / steps;
            self.grips[hand] = (start + (position - start) * t, turned.slerp(rotation, t));
            self.tick();
        }
        self.grips[hand] = (position, rotation);
    }

    /// The grip, in the room, that brings the bit to a point of the grid, pointing along `way`.
    fn grip_for(&self, hand: usize, point: Vec3, way: Vec3) -> (Vec3, Quat) {
        let pose = Pose { position: point, rotation: Quat::from_rotation_arc(Vec3::NEG_Z, way) };
        let (tip, rotation) = self.world().frame().to_room(&pose);
        let reach = self.world().held(hand).map_or(0.0, |(tool, _)| length(tool));
        (tip + rotation * Vec3::new(0.0, 0.0, reach), rotation)
    }
}

fn length(tool: Tool) -> f32 {
    tool.length() as f32 * 1e-6
}
