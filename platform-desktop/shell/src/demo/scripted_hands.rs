//! Scripted hands: movements as a sequence of tick inputs, at the speed of a person's hands.

use std::ops::ControlFlow;

use crate::tick_runner::TickRunner;
use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::RoomPose;
use paros_core::session::{BenchItem, PointerCommand, RawPose, SessionMode, TICK_RATE, Tool};
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, TickInput, World};

/// The distance in metres that a hand moves in a tick, clear of the stone: 1.6 m/s.
const HAND_SPEED: f32 = 1.6 / TICK_RATE as f32;

/// The distance by which the hand leads a bit that the stone holds back, in voxels.
const PUSH: f32 = 3.0;

/// The hands' rest positions between strokes, in metres: in front of the chest.
const REST: [Vec3; 2] = [Vec3::new(-0.25, 1.0, -0.1), Vec3::new(0.25, 1.0, -0.1)];

/// A function that is called after every tick and may end the session early.
pub type TickWatcher<'a, const N: usize, const K: usize> =
    dyn FnMut(&World<N, K>) -> ControlFlow<()> + 'a;

/// The distances in voxels from a ray's origin to the first stone and the first mask voxel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StoneAndMaskDistances {
    /// The distance to stone; `None` if the ray meets none.
    pub stone: Option<f32>,
    /// The distance to the mask; `None` if the ray doesn't meet it.
    pub mask: Option<f32>,
}

/// Two hands that produce the inputs of a [`TickRunner`].
pub struct ScriptedHands<'a, 's, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    runner: &'a mut TickRunner<'s, N, K>,
    watcher: &'a mut TickWatcher<'a, N, K>,
    input: TickInput,
    grips: [RoomPose; 2],
    ended: bool,
}

impl<'a, 's, const N: usize, const K: usize> ScriptedHands<'a, 's, N, K>
where
    Grid<N>: Size,
{
    /// Creates hands at rest in front of the chest.
    pub fn new(
        runner: &'a mut TickRunner<'s, N, K>,
        watcher: &'a mut TickWatcher<'a, N, K>,
    ) -> Self {
        let grips = REST.map(|position| (position, Quat::IDENTITY));
        ScriptedHands { runner, watcher, input: TickInput::default(), grips, ended: false }
    }

    /// Returns the world after the last tick.
    pub fn world(&self) -> &World<N, K> {
        self.runner.world()
    }

    /// Returns `true` once the watcher has ended the session; then no tick is run any more.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Starts a session, in one tick.
    pub fn start_session(&mut self, mode: SessionMode) {
        self.input.start = mode;
        self.run_tick();
        self.input.start = SessionMode::None;
    }

    /// Sends some of the core's [`commands`](paros_core::session::commands), as bits, in one tick.
    pub fn send_commands(&mut self, command_bits: u8) {
        self.input.commands = command_bits;
        self.run_tick();
        self.input.commands = 0;
    }

    /// Makes the bit that a hand holds larger by `by` steps, or smaller if negative.
    pub fn resize_bit(&mut self, hand: usize, by: i8) {
        self.input.pointer = PointerCommand::Resize { hand: hand as u8, by };
        self.run_tick();
        self.input.pointer = PointerCommand::None;
    }

    /// Runs ticks with the hands where they are.
    pub fn wait_ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.run_tick();
        }
    }

    /// Takes a tool, or a bit for the tool that the hand holds, from the bench and returns to rest.
    pub fn fetch_item(&mut self, hand: usize, item: BenchItem) {
        let mut over = item.home_position() + Vec3::Y * 0.15;
        self.move_hand_to(hand, over, Quat::IDENTITY);
        if let (BenchItem::Bit(_), Some((tool, _))) = (item, self.world().held_tool(hand)) {
            over -= self.grips[hand].1 * Vec3::new(0.0, 0.0, -tool_length_m(tool));
        }
        self.move_hand_to(hand, over - Vec3::Y * 0.13, Quat::IDENTITY);
        self.input.hands[hand].squeeze = 255;
        self.run_tick();
        self.input.hands[hand].squeeze = 0;
        self.run_tick();
        self.move_hand_to_rest(hand);
    }

    /// Moves a hand to its rest pose in front of the chest.
    pub fn move_hand_to_rest(&mut self, hand: usize) {
        self.move_hand_to(hand, REST[hand], Quat::IDENTITY);
    }

    /// Turns the stool with the left stick until the side at an azimuth of the grid (counter-clockwise from
    /// +z to +x) faces the visitor.
    pub fn turn_azimuth_to_visitor(&mut self, degrees_from_z_to_x: f32) {
        let target = (degrees_from_z_to_x * (-65_536.0 / 360.0)).round() as i32 as u16;
        loop {
            let now = (self.stool_radians() * (65_536.0 / core::f32::consts::TAU)).round();
            let left = i32::from(target.wrapping_sub(now as i32 as u16) as i16);
            // A full push of the stick turns by 227 in a tick, a third of a push by 72.
            let push = match left.abs() {
                0..72 => break,
                n if n < 227 => 40,
                _ => 127,
            };
            self.input.hands[0].stick[0] = (push * left.signum()) as i8;
            self.run_tick();
            if self.ended {
                break;
            }
        }
        self.input.hands[0].stick[0] = 0;
    }

    /// Moves the bit to a point of the grid, pointing along `grid_direction`. The trigger is unchanged.
    pub fn move_bit_to(&mut self, hand: usize, point_voxels: Vec3, grid_direction: Vec3) {
        self.move_bit_to_pose(hand, &pose_pointing(point_voxels, grid_direction));
    }

    /// Moves the bit to a pose in the grid. The trigger is unchanged.
    pub fn move_bit_to_pose(&mut self, hand: usize, pose: &Pose) {
        let (position, rotation) = self.grip_for_bit(hand, pose);
        self.move_hand_to(hand, position, rotation);
    }

    /// Presses the trigger and pushes the bit along `grid_direction` until it is `distance_voxels` from
    /// `start_voxels`, is held by the mask, or makes no progress for five ticks. The trigger stays down.
    pub fn drive_bit(
        &mut self,
        hand: usize,
        start_voxels: Vec3,
        grid_direction: Vec3,
        distance_voxels: f32,
    ) {
        self.input.hands[hand].trigger = 255;
        let (mut best, mut stuck) = (0.0, 0);
        while stuck < 5 && !self.ended {
            let reached = (self.world().hand_state(hand).frozen_pose.position - start_voxels)
                .dot(grid_direction);
            let ahead = start_voxels + grid_direction * (reached.max(0.0) + PUSH);
            self.grips[hand] = self.grip_for_bit(hand, &pose_pointing(ahead, grid_direction));
            self.run_tick();
            let reached = (self.world().hand_state(hand).frozen_pose.position - start_voxels)
                .dot(grid_direction);
            let on_mask = self.world().hand_contact(hand).is_some_and(|contact| contact.on_mask);
            if reached >= distance_voxels || (on_mask && reached < best + 0.2) {
                break;
            }
            stuck = if reached > best + 0.05 { 0 } else { stuck + 1 };
            best = reached.max(best);
        }
    }

    /// Presses the trigger and moves the bit through poses in the grid, no faster than `voxels_per_tick`. The trigger
    /// stays down.
    pub fn stroke_through(
        &mut self,
        hand: usize,
        poses: impl IntoIterator<Item = Pose>,
        voxels_per_tick: f32,
    ) {
        self.input.hands[hand].trigger = 255;
        let metres_per_tick = voxels_per_tick * self.world().stool_frame().voxel_metres();
        for pose in poses {
            let (position, rotation) = self.grip_for_bit(hand, &pose);
            self.move_hand_at_speed(hand, position, rotation, metres_per_tick);
        }
    }

    /// Turns the stool by one turn with the left stick, while the other hand holds its running tool at the
    /// pose that `pose_at_azimuth` returns for the grid's azimuth, in degrees, that faces the visitor. The
    /// trigger stays down.
    pub fn turn_once_under_tool(
        &mut self,
        hand: usize,
        trigger: u8,
        mut pose_at_azimuth: impl FnMut(&Self, f32) -> Option<Pose>,
    ) {
        self.input.hands[0].stick[0] = 127;
        let mut turned = 0.0;
        while turned < 365.0 && !self.ended {
            let before = self.azimuth_before_visitor();
            if let Some(pose) = pose_at_azimuth(self, before) {
                self.grips[hand] = self.grip_for_bit(hand, &pose);
                self.input.hands[hand].trigger = trigger;
            }
            self.run_tick();
            let way = self.azimuth_before_visitor() - before;
            turned += ((way + 540.0).rem_euclid(360.0) - 180.0).abs();
        }
        self.input.hands[0].stick[0] = 0;
    }

    /// Returns the azimuth of the grid, from +z to +x in degrees, that faces the visitor.
    fn azimuth_before_visitor(&self) -> f32 {
        -self.stool_radians() * (180.0 / core::f32::consts::PI)
    }

    /// Returns the rotation of the stool, in radians.
    fn stool_radians(&self) -> f32 {
        let (_, turn) =
            self.world().stool_frame().to_room(&Pose { rotation: Quat::IDENTITY, ..Pose::ZERO });
        2.0 * libm::atan2f(turn.y, turn.w)
    }

    /// Releases the trigger.
    pub fn release_trigger(&mut self, hand: usize) {
        self.input.hands[hand].trigger = 0;
        self.run_tick();
    }

    /// Casts a ray to the first voxel of stone and of the mask, in steps of a voxel.
    pub fn cast_ray_to_stone_and_mask(
        &self,
        origin_voxels: Vec3,
        grid_direction: Vec3,
    ) -> StoneAndMaskDistances {
        let first = |maps: &RangeMaps<N, K>| {
            (0..2 * N).map(|i| i as f32).find(|&distance| {
                let voxel = (origin_voxels + grid_direction * distance).floor();
                let inside =
                    voxel.cmpge(Vec3::ZERO).all() && voxel.cmplt(Vec3::splat(N as f32)).all();
                inside && maps.contains(voxel.to_array().map(|v| v as usize))
            })
        };
        StoneAndMaskDistances {
            stone: first(self.world().volume().maps()),
            mask: first(self.world().mask()),
        }
    }

    /// Runs one tick with the hands where they are, unless the session has ended.
    fn run_tick(&mut self) {
        if self.ended {
            return;
        }
        for (hand, (position, rotation)) in self.input.hands.iter_mut().zip(self.grips) {
            hand.grip = RawPose::quantise(position, rotation);
            (hand.aim, hand.tracked) = (hand.grip, true);
        }
        self.input.head = RawPose::quantise(Vec3::new(0.0, 1.5, 0.1), Quat::IDENTITY);
        self.runner.run_tick(&self.input);
        self.ended = (self.watcher)(self.runner.world()).is_break();
    }

    /// Moves a hand's grip to a pose in the room, in metres, at [`HAND_SPEED`].
    fn move_hand_to(&mut self, hand: usize, position: Vec3, rotation: Quat) {
        self.move_hand_at_speed(hand, position, rotation, HAND_SPEED);
    }

    fn move_hand_at_speed(
        &mut self,
        hand: usize,
        position: Vec3,
        rotation: Quat,
        metres_per_tick: f32,
    ) {
        let (start, turned) = self.grips[hand];
        let steps = ((position - start).length() / metres_per_tick).ceil().max(1.0);
        for i in 1..=steps as usize {
            let t = i as f32 / steps;
            self.grips[hand] = (start + (position - start) * t, turned.slerp(rotation, t));
            self.run_tick();
        }
        self.grips[hand] = (position, rotation);
    }

    /// Returns the grip pose in the room, in metres, at which the bit has a pose in the grid.
    fn grip_for_bit(&self, hand: usize, pose: &Pose) -> RoomPose {
        let (tip, rotation) = self.world().stool_frame().to_room(pose);
        let reach = self.world().held_tool(hand).map_or(0.0, |(tool, _)| tool_length_m(tool));
        (tip + rotation * Vec3::new(0.0, 0.0, reach), rotation)
    }
}

/// Returns the pose at a point in the grid, pointing along a direction.
pub fn pose_pointing(position: Vec3, grid_direction: Vec3) -> Pose {
    Pose { position, rotation: Quat::from_rotation_arc(Vec3::NEG_Z, grid_direction) }
}

fn tool_length_m(tool: Tool) -> f32 {
    tool.length_um() as f32 * 1e-6
}
