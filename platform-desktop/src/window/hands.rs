//! Mouse and keys as a pair of hands: combines input events, the eye and the volume under the cursor into the
//! core's [`TickInput`] of each tick.
//!
//! The right hand holds the tool; its bit follows the surface under the cursor. While the left button is down
//! the bit is lowered by the wheel's depth below the surface *at the start of the stroke*. So a stroke is a
//! groove of one depth, and the next stroke goes deeper.

pub(super) mod bench_pick;
mod bit_guide;
mod depths;
mod events;
mod mounted_bit;

use std::collections::VecDeque;

use glam::{Quat, Vec3};
use paros_core::internals::RoomPose;
use paros_core::limits::INTERVALS;
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionMode, SessionState, TICK_RATE, Tool, commands,
};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, World};
use paros_shaders::Ray;

use super::camera::OrbitCamera;
use bit_guide::BitGuide;
use depths::BitDepths;
pub(super) use depths::DEPTHS_MM;
pub(super) use events::{HandAction, HandButton, InputEvent};
pub(super) use mounted_bit::tool_bits_of;

/// The hand that the mouse moves.
pub(super) const RIGHT: usize = 1;

/// Rest positions of the hands in the room, in metres.
const REST: [Vec3; 2] = [Vec3::new(-0.25, 1.0, -0.1), Vec3::new(0.25, 1.0, -0.1)];

/// Rotation of the stool by A and D in a tick, in 65,536ths of a turn: a quarter turn a second.
const KEY_TURN: i32 = 65_536 / 4 / TICK_RATE as i32;

/// Depth change of a wheel notch, in millimetres.
const NOTCH_MM: f32 = 1.0;

/// Speed at which a running tool follows the cursor, in micrometres a tick: 1 m/s, the speed up to which the
/// core's bits follow the hands.
const TRAIL_SPEED_UM: f32 = 1e6 / TICK_RATE as f32;

/// Trigger value with Shift, of 255.
const LIGHT_TRIGGER: u8 = 150;

/// Length of the string that steadies a hand, in millimetres. It reduces an excited hand's tremor to a fifth
/// at ordinary speed.
const STRING_MM: u8 = 20;

/// Capacity of the cursor's trail, in points.
const TRAIL: usize = 1024;

/// State of the hands: the eye, the cursor, and pending input for the next tick.
#[derive(Debug)]
pub(super) struct MouseHands<const N: usize>
where
    Grid<N>: Size,
{
    /// The camera.
    pub(super) orbit: OrbitCamera,
    /// Size of the picture in pixels.
    pub(super) size: [u32; 2],
    cursor: Option<[f32; 2]>,
    /// `true` while the left button is down, on or beside the sculpture, and until the tool has followed the
    /// cursor's trail to its end.
    running: bool,
    /// `true` if the button is up and the tool still runs to the end of the trail.
    is_released: bool,
    /// `true` if a new stroke began before the end of the last one: the trigger is released for a tick
    /// between them.
    lifts_trigger: bool,
    /// `true` if the trigger is pulled half way, so that a rasp works lightly.
    pulls_lightly: bool,
    orbiting: bool,
    /// `true` while a button other than the right one orbits: on a finished sculpture no button has another
    /// function.
    orbiting_unasked: bool,
    dragging_stool: bool,
    turning: [bool; 2],
    /// Pending rotation of the stool, in 65,536ths of a turn.
    turn: f32,
    command_bits: u8,
    start: SessionMode,
    pointers: VecDeque<PointerCommand>,
    depths: BitDepths,
    bit_guide: BitGuide<N>,
    /// Cursor positions that the running tool has not passed yet, in pixels.
    trail: VecDeque<[f32; 2]>,
}

impl<const N: usize> MouseHands<N>
where
    Grid<N>: Size,
{
    /// Creates hands at rest.
    #[must_use]
    #[allow(clippy::new_without_default)] // it takes memory for a volume
    pub(super) fn new() -> Self {
        MouseHands {
            orbit: OrbitCamera::default(),
            size: [1, 1],
            cursor: None,
            running: false,
            is_released: false,
            lifts_trigger: false,
            pulls_lightly: false,
            orbiting: false,
            orbiting_unasked: false,
            dragging_stool: false,
            turning: [false; 2],
            turn: 0.0,
            command_bits: 0,
            start: SessionMode::None,
            pointers: VecDeque::new(),
            depths: BitDepths::UNCHOSEN,
            bit_guide: BitGuide::new(),
            trail: VecDeque::new(),
        }
    }

    /// Returns the displacement by which the trigger would move the bit, in metres of the room; `None` while
    /// the tool runs.
    pub(super) fn next_bite(&self) -> Option<Vec3> {
        self.bit_guide.next_bite().filter(|_| !self.running)
    }

    /// Returns the ray in the room through the cursor.
    pub(super) fn cursor_ray(&self) -> Option<Ray> {
        self.cursor.map(|cursor| self.orbit.room_ray_through_pixel(cursor, self.size))
    }

    /// Handles an input event.
    pub(super) fn handle_event(&mut self, event: InputEvent, world: &World<N, INTERVALS>) {
        let is_finished = world.session_state() == SessionState::Finished;
        match event {
            InputEvent::Moved(to) => self.move_cursor(to),
            InputEvent::Gone => self.cursor = None,
            // A finished sculpture can only be viewed: no tool works, and the stool doesn't turn.
            InputEvent::Pressed(HandButton::Left | HandButton::Middle) if is_finished => {
                self.orbiting_unasked = true;
            }
            InputEvent::Wheel(notches) if is_finished => self.orbit.zoom_in(notches),
            InputEvent::Pressed(HandButton::Left) => self.press_left(world),
            InputEvent::Pressed(HandButton::Middle) => self.dragging_stool = true,
            InputEvent::Pressed(HandButton::Right) => self.orbiting = true,
            InputEvent::Released(HandButton::Left) => self.release_left(),
            InputEvent::Released(HandButton::Middle) => {
                (self.dragging_stool, self.orbiting_unasked) = (false, false);
            }
            InputEvent::Released(HandButton::Right) => self.orbiting = false,
            InputEvent::Wheel(notches) => self.change_depth_by(notches * NOTCH_MM, world),
            InputEvent::Zoom(notches) => self.orbit.zoom_in(notches),
            InputEvent::Key(key, down) => self.handle_key(key, down, world),
            InputEvent::Lightly(down) => self.pulls_lightly = down,
            InputEvent::LetGo => {
                self.pulls_lightly = false;
                (self.running, self.orbiting, self.dragging_stool) = (false, false, false);
                self.orbiting_unasked = false;
                self.is_released = false;
                self.turning = [false; 2];
            }
        }
    }

    /// Starts a session at the next tick, with the first tool in hand.
    pub(super) fn start_session(&mut self, mode: SessionMode) {
        self.drop_input();
        self.start = mode;
        self.take_item(BenchItem::Tool(Tool::Rotary));
    }

    /// Resets the camera to the initial view, and the depths of all bits to their defaults.
    pub(super) fn reset_eye_and_depths(&mut self) {
        self.orbit.reset_pose();
        self.depths = BitDepths::UNCHOSEN;
    }

    /// Drops pending input and the present stroke.
    pub(super) fn drop_input(&mut self) {
        self.start = SessionMode::None;
        self.pointers.clear();
        (self.command_bits, self.turn, self.running) = (0, 0.0, false);
        self.is_released = false;
    }

    /// Queues commands, as bits of [`commands`], for the next tick.
    pub(super) fn queue_commands(&mut self, command_bits: u8) {
        self.command_bits |= command_bits;
    }

    /// Queues taking an item off the bench.
    pub(super) fn take_item(&mut self, item: BenchItem) {
        let item = item.number() as u8;
        self.pointers.push_back(PointerCommand::Take { hand: RIGHT as u8, item });
    }

    /// Queues enlarging the held bit by `by` steps.
    pub(super) fn resize_bit(&mut self, by: i8) {
        self.pointers.push_back(PointerCommand::Resize { hand: RIGHT as u8, by });
    }

    /// Returns the depth of the held bit, in millimetres; 0 without a bit.
    #[must_use]
    pub(super) fn depth_mm(&self, world: &World<N, INTERVALS>) -> f32 {
        let held = world.held_tool(RIGHT).zip(world.held_bit_spec(RIGHT));
        held.map_or(0.0, |((_, bit), spec)| self.depths.depth_mm(bit, &spec))
    }

    /// Builds the input of the next tick from the events since the last one.
    pub(super) fn next_input(&mut self, world: &World<N, INTERVALS>) -> TickInput {
        let mut input =
            TickInput { start: core::mem::take(&mut self.start), ..TickInput::default() };
        let (position, rotation) = self.orbit.pose();
        input.head = RawPose::quantise(position, rotation);
        input.hands = REST.map(|rest| tracked_hand(rest, Quat::IDENTITY));
        if input.start != SessionMode::None {
            return input;
        }
        input.commands = core::mem::take(&mut self.command_bits);
        if let Some((grip, rotation)) = self.next_grip_pose(world) {
            input.hands[RIGHT] = tracked_hand(grip, rotation);
            let lifts_trigger = core::mem::take(&mut self.lifts_trigger);
            let pulled = if self.pulls_lightly { LIGHT_TRIGGER } else { 255 };
            input.hands[RIGHT].trigger = if self.running && !lifts_trigger { pulled } else { 0 };
        } else {
            self.bit_guide.forget_next_bite();
        }
        // A stroke doesn't continue if its tool was put back and taken again. A stuck tool is about to be
        // taken again.
        let has_tool = world.held_tool(RIGHT).is_some() || !self.pointers.is_empty();
        if self.is_released && (self.trail.len() < 2 || self.cursor.is_none() || !has_tool) {
            (self.running, self.is_released) = (false, false);
        }
        input.pointer = self.take_pointer_command();
        input
    }

    /// Returns the right hand's grip pose in the room, with its bit on the surface under the cursor. A stuck
    /// tool is put down and taken again.
    fn next_grip_pose(&mut self, world: &World<N, INTERVALS>) -> Option<RoomPose> {
        let (tool, bit) = (world.held_tool(RIGHT)?.0, world.held_bit_spec(RIGHT)?);
        let cursor = self.cursor?;
        let at = if self.running { self.advance_along_trail(cursor) } else { cursor };
        let room_ray = self.orbit.room_ray_through_pixel(at, self.size);
        let depth_m = self.depth_mm(world) * 1e-3;
        let up = self.orbit.pose().1 * Vec3::Y;
        let aim = bit_guide::BitTarget { room_ray, up, bit, depth_m, running: self.running };
        let (tip, rotation) = self.bit_guide.next_bit_centre_pose(&aim, world);
        if self.bit_guide.take_is_stuck() {
            // Returning and taking the tool frees its bit.
            self.pointers.push_back(PointerCommand::Return { hand: RIGHT as u8 });
            self.take_item(BenchItem::Tool(tool));
        }
        Some((tip + rotation * Vec3::Z * (tool.length_um() as f32 * 1e-6), rotation))
    }

    /// Advances a running tool along the cursor's trail. Returns its pixel. Its speed is limited to the bit's
    /// speed, so that a stroke is one groove at any speed of the mouse.
    fn advance_along_trail(&mut self, cursor_pixel: [f32; 2]) -> [f32; 2] {
        let eye = self.orbit.pose().0;
        let far = eye + (self.orbit.pose().1 * Vec3::NEG_Z) * self.bit_guide.last_hit_distance_m();
        let projected = self.orbit.project_point(far, self.size);
        let pixels_per_metre = projected.map_or(1.0, |point| point.pixels_per_metre);
        let mut left = TRAIL_SPEED_UM * 1e-6 * pixels_per_metre;
        while let Some(&from) = self.trail.front() {
            let end = if self.is_released { from } else { cursor_pixel };
            let to = self.trail.get(1).copied().unwrap_or(end);
            let way = [to[0] - from[0], to[1] - from[1]];
            let length = way[0].hypot(way[1]);
            if length > left {
                let part = left / length;
                let at = [from[0] + way[0] * part, from[1] + way[1] * part];
                self.trail[0] = at;
                return at;
            }
            left -= length;
            if self.trail.len() == 1 {
                self.trail[0] = to;
                return to;
            }
            self.trail.pop_front();
        }
        cursor_pixel
    }

    /// Returns the tick's pointer command. A tick has only one; turns of the stool wait until the queue is
    /// empty.
    fn take_pointer_command(&mut self) -> PointerCommand {
        if let Some(pointer) = self.pointers.pop_front() {
            return pointer;
        }
        let keys = i32::from(self.turning[1]) - i32::from(self.turning[0]);
        self.turn += (keys * KEY_TURN) as f32;
        let by = self.turn.clamp(-8192.0, 8192.0).trunc();
        self.turn -= by;
        if by == 0.0 { PointerCommand::None } else { PointerCommand::Turn { by: by as i16 } }
    }

    fn move_cursor(&mut self, to: [f32; 2]) {
        if let Some(from) = self.cursor {
            let by = [to[0] - from[0], to[1] - from[1]];
            if self.orbiting || self.orbiting_unasked {
                self.orbit.rotate_by_drag(by, self.size[1]);
            }
            if self.dragging_stool {
                self.turn += by[0] / self.size[0].max(1) as f32 * 65_536.0;
            }
        }
        self.cursor = Some(to);
        if self.running && !self.is_released && self.trail.len() < TRAIL {
            self.trail.push_back(to);
        }
    }

    /// Takes the item on the workbench under the cursor, or starts a stroke.
    fn press_left(&mut self, world: &World<N, INTERVALS>) {
        let Some(cursor) = self.cursor else { return };
        match self.pointed_item(world) {
            Some(item) => self.take_item_with_its_tool(item, world),
            // An empty hand starts no stroke: a tool that is taken later must not continue it.
            None if world.held_tool(RIGHT).is_none() => {}
            None => {
                self.lifts_trigger = self.is_released;
                (self.running, self.is_released) = (true, false);
                self.trail.clear();
                self.trail.push_back(cursor);
                self.bit_guide.begin_stroke(world.volume().maps());
            }
        }
    }

    /// Ends a stroke at the cursor's present position, which the tool may not have reached yet.
    fn release_left(&mut self) {
        self.orbiting_unasked = false;
        self.is_released = self.running;
        if self.running
            && let Some(cursor) = self.cursor
        {
            self.trail.push_back(cursor);
        }
    }

    fn change_depth_by(&mut self, delta_mm: f32, world: &World<N, INTERVALS>) {
        let held = world.held_tool(RIGHT).zip(world.held_bit_spec(RIGHT));
        if let Some(((_, bit), spec)) = held {
            self.depths.change_by(bit, &spec, delta_mm);
        }
    }

    fn handle_key(&mut self, key: HandAction, down: bool, world: &World<N, INTERVALS>) {
        if let HandAction::Turn { left } = key {
            self.turning[usize::from(!left)] = down;
        }
        if !down {
            return;
        }
        match key {
            HandAction::Tool(number) => {
                if let Some(tool) = Tool::ALL.get(usize::from(number)) {
                    self.take_item(BenchItem::Tool(*tool));
                }
            }
            HandAction::Bit(number) => {
                self.mount_bit(world, |bits| usize::from(number).min(bits.count));
            }
            HandAction::PreviousBit => {
                self.mount_bit(world, |bits| (bits.mounted + bits.count - 1) % bits.count);
            }
            HandAction::NextBit => self.mount_bit(world, |bits| (bits.mounted + 1) % bits.count),
            HandAction::Smaller => self.resize_bit(-1),
            HandAction::Larger => self.resize_bit(1),
            HandAction::Undo => self.queue_commands(commands::UNDO),
            HandAction::Redo => self.queue_commands(commands::REDO),
            HandAction::Mirror => self.queue_commands(commands::SYMMETRY),
            HandAction::Steady => {
                let string_mm = if world.string_mm() > 0 { 0 } else { STRING_MM };
                self.pointers.push_back(PointerCommand::Steady { string_mm });
            }
            HandAction::Nearer => self.orbit.zoom_in(1.0),
            HandAction::Farther => self.orbit.zoom_in(-1.0),
            HandAction::Turn { .. } => {}
        }
    }
}

fn tracked_hand(position: Vec3, rotation: Quat) -> HandInput {
    let grip = RawPose::quantise(position, rotation);
    HandInput { aim: grip, grip, tracked: true, ..HandInput::default() }
}

#[cfg(test)]
mod tests;
