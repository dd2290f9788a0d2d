//! Mouse and keys as a pair of hands: what happened since the last tick, the eye and the volume
//! under the cursor become an [`Input`].
//!
//! The right hand holds the tool; its bit rides on the surface under the cursor. While the left
//! button is down the bit is let in by the depth that the wheel chose, below the surface *as it was
//! when the button went down*, so a stroke is a groove of one depth, and the next goes deeper.

mod reach;

use std::collections::VecDeque;

use glam::{Quat, Vec3};
use paros_core::input::{HandInput, Input, Mode, Pointer, RawPose, commands};
use paros_core::size::{Grid, Size};
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::World;

use super::camera::Orbit;
use reach::Reach;

/// The hand that the mouse moves.
pub(super) const RIGHT: usize = 1;

/// Where hands rest, in metres: before the chest.
const REST: [Vec3; 2] = [Vec3::new(-0.25, 1.0, -0.1), Vec3::new(0.25, 1.0, -0.1)];

/// What A and D turn the stool by in a tick, in 65,536ths: a quarter turn a second.
const KEY_TURN: i32 = 65_536 / 4 / 72;

/// Millimetres of depth in a notch of the wheel.
const NOTCH: f32 = 1.0;

/// The depths that the wheel chooses from, in millimetres; negative stays clear of the surface.
const DEPTHS: core::ops::RangeInclusive<f32> = -20.0..=40.0;

/// Micrometres that a running tool goes in a tick at least, where there is a way to go.
const SLOWEST: f32 = 1_500.0;

/// Points of the cursor's way that are remembered.
const TRAIL: usize = 1024;

/// Buttons of the mouse.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Button {
    /// Runs the tool.
    Left,
    /// Turns the stool.
    Middle,
    /// Orbits.
    Right,
}

/// Keys that the hands listen to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Key {
    /// Takes a tool, by number.
    Tool(u8),
    /// Mounts the held tool's bit of a number, from 0.
    Bit(u8),
    /// Mounts the bit before the mounted one.
    PreviousBit,
    /// Mounts the bit after it.
    NextBit,
    /// Takes a stroke back.
    Undo,
    /// Brings it back again.
    Redo,
    /// Switches the mirror.
    Mirror,
    /// Turns the stool while it is down: to the left, or to the right.
    Turn {
        /// Clockwise as seen from above.
        left: bool,
    },
    /// Goes nearer.
    Nearer,
    /// Goes farther.
    Farther,
}

/// What a device did.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Event {
    /// The cursor is at a pixel, counted from the upper left.
    Moved([f32; 2]),
    /// The cursor is nowhere in the picture.
    Gone,
    /// A button went down over the picture.
    Pressed(Button),
    /// A button went up.
    Released(Button),
    /// The wheel turned by notches; away from the visitor is positive.
    Wheel(f32),
    /// The wheel turned with Ctrl down.
    Zoom(f32),
    /// A key went down, or up.
    Key(Key, bool),
    /// Nothing is down any more: the window lost its keyboard.
    LetGo,
}

/// The hands between two ticks.
#[derive(Debug)]
pub(super) struct Hands<const N: usize>
where
    Grid<N>: Size,
{
    /// The eye.
    pub(super) orbit: Orbit,
    /// Pixels of the picture.
    pub(super) size: [u32; 2],
    cursor: Option<[f32; 2]>,
    /// The left button is down, over the sculpture or beside it.
    running: bool,
    orbiting: bool,
    dragging_stool: bool,
    turning: [bool; 2],
    /// What a drag has turned the stool by that no tick has taken yet.
    turn: f32,
    commands: u8,
    start: Mode,
    pointers: VecDeque<Pointer>,
    /// Depth of each tool, in millimetres.
    depths: [f32; 4],
    reach: Reach<N>,
    /// Where the cursor went while the tool runs, and the tool has not been yet.
    trail: VecDeque<[f32; 2]>,
}

impl<const N: usize> Hands<N>
where
    Grid<N>: Size,
{
    /// Hands at rest.
    #[must_use]
    #[allow(clippy::new_without_default)] // it takes memory for a volume
    pub(super) fn new() -> Self {
        Hands {
            orbit: Orbit::default(),
            size: [1, 1],
            cursor: None,
            running: false,
            orbiting: false,
            dragging_stool: false,
            turning: [false; 2],
            turn: 0.0,
            commands: 0,
            start: Mode::None,
            pointers: VecDeque::new(),
            depths: [9.0, 9.0, 8.0, 2.0],
            reach: Reach::new(),
            trail: VecDeque::new(),
        }
    }

    /// Takes in what a device did.
    pub(super) fn event(&mut self, event: Event, world: &World<N>) {
        match event {
            Event::Moved(to) => self.moved(to),
            Event::Gone => self.cursor = None,
            Event::Pressed(Button::Left) => self.press(world),
            Event::Pressed(Button::Middle) => self.dragging_stool = true,
            Event::Pressed(Button::Right) => self.orbiting = true,
            Event::Released(Button::Left) => self.running = false,
            Event::Released(Button::Middle) => self.dragging_stool = false,
            Event::Released(Button::Right) => self.orbiting = false,
            Event::Wheel(notches) => self.deepen(-notches * NOTCH, world),
            Event::Zoom(notches) => self.orbit.zoom(notches),
            Event::Key(key, down) => self.key(key, down, world),
            Event::LetGo => {
                (self.running, self.orbiting, self.dragging_stool) = (false, false, false);
                self.turning = [false; 2];
            }
        }
    }

    /// Starts a session at the next tick, with the first tool in hand.
    pub(super) fn start(&mut self, mode: Mode) {
        self.start = mode;
        self.pointers.clear();
        (self.commands, self.turn, self.running) = (0, 0.0, false);
        self.take(Item::Tool(Tool::Rotary));
    }

    /// Gives commands, of [`commands`], at the next tick.
    pub(super) fn command(&mut self, commands: u8) {
        self.commands |= commands;
    }

    /// Takes something off the bench, in one of the next ticks.
    pub(super) fn take(&mut self, item: Item) {
        let item = item.number() as u8;
        self.pointers.push_back(Pointer::Take { hand: RIGHT as u8, item });
    }

    /// How deep a tool goes, in millimetres.
    #[must_use]
    pub(super) fn depth(&self, tool: Tool) -> f32 {
        self.depths[tool as usize]
    }

    /// The input of a tick, with what happened since the last one.
    pub(super) fn input(&mut self, world: &World<N>) -> Input {
        let mut input = Input { start: core::mem::take(&mut self.start), ..Input::default() };
        let (position, rotation) = self.orbit.pose();
        input.head = RawPose::new(position, rotation);
        input.hands = REST.map(|rest| at(rest, Quat::IDENTITY));
        if input.start != Mode::None {
            return input;
        }
        input.commands = core::mem::take(&mut self.commands);
        if let Some((grip, rotation)) = self.tool(world) {
            input.hands[RIGHT] = at(grip, rotation);
            input.hands[RIGHT].trigger = if self.running { 255 } else { 0 };
        }
        input.pointer = self.pointer();
        input
    }

    /// The right hand's grip in the room: its bit on the surface under the cursor.
    fn tool(&mut self, world: &World<N>) -> Option<(Vec3, Quat)> {
        let (tool, bit) = world.held(RIGHT)?;
        let cursor = self.cursor?;
        let at = if self.running { self.follow(cursor, bit) } else { cursor };
        let ray = self.orbit.ray(at, self.size);
        let depth = self.depths[tool as usize] * 1e-3;
        let up = self.orbit.pose().1 * Vec3::Y;
        let aim = reach::Aim { ray, up, bit, depth, running: self.running };
        let (tip, rotation) = self.reach.tip(&aim, world);
        if self.reach.is_stuck() {
            // Put down and taken up again, it is free of what held it.
            self.pointers.push_back(Pointer::Return { hand: RIGHT as u8 });
            self.take(Item::Tool(tool));
        }
        Some((tip + rotation * Vec3::Z * (tool.length() as f32 * 1e-6), rotation))
    }

    /// Where a running tool is on the cursor's way: it goes no faster than it can bite, so that a
    /// stroke is one groove however fast the hand was.
    fn follow(&mut self, cursor: [f32; 2], bit: Bit) -> [f32; 2] {
        let (eye, _) = self.orbit.ray(cursor, self.size);
        let far = eye + (self.orbit.pose().1 * Vec3::NEG_Z) * self.reach.metres();
        let metre = self.orbit.pixel(far, self.size).map_or(1.0, |(_, metre)| metre);
        let data = bit.data();
        let bite = (data.bite as f32 / f32::from(data.period)).max(SLOWEST) * 1e-6;
        let mut left = bite * metre;
        while let Some(&from) = self.trail.front() {
            let to = self.trail.get(1).copied().unwrap_or(cursor);
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
        cursor
    }

    /// A tick has one command of the pointer; a turn waits while there is another.
    fn pointer(&mut self) -> Pointer {
        if let Some(pointer) = self.pointers.pop_front() {
            return pointer;
        }
        let keys = i32::from(self.turning[1]) - i32::from(self.turning[0]);
        self.turn += (keys * KEY_TURN) as f32;
        let by = self.turn.clamp(-8192.0, 8192.0).trunc();
        self.turn -= by;
        if by == 0.0 { Pointer::None } else { Pointer::Turn { by: by as i16 } }
    }

    fn moved(&mut self, to: [f32; 2]) {
        if let Some(from) = self.cursor {
            let by = [to[0] - from[0], to[1] - from[1]];
            if self.orbiting {
                self.orbit.drag(by, self.size[1]);
            }
            if self.dragging_stool {
                self.turn += by[0] / self.size[0].max(1) as f32 * 65_536.0;
            }
        }
        self.cursor = Some(to);
        if self.running && self.trail.len() < TRAIL {
            self.trail.push_back(to);
        }
    }

    /// A press on a thing on the bench takes it, any other runs the tool.
    fn press(&mut self, world: &World<N>) {
        let Some(cursor) = self.cursor else { return };
        let ray = self.orbit.ray(cursor, self.size);
        match reach::thing(ray, world) {
            Some(item) => self.take(item),
            None => {
                self.running = true;
                self.trail.clear();
                self.trail.push_back(cursor);
                self.reach.begin_stroke(world.volume().maps());
            }
        }
    }

    fn deepen(&mut self, millimetres: f32, world: &World<N>) {
        if let Some((tool, _)) = world.held(RIGHT) {
            let depth = &mut self.depths[tool as usize];
            *depth = (*depth + millimetres).clamp(*DEPTHS.start(), *DEPTHS.end());
        }
    }

    fn key(&mut self, key: Key, down: bool, world: &World<N>) {
        if let Key::Turn { left } = key {
            self.turning[usize::from(!left)] = down;
        }
        if !down {
            return;
        }
        match key {
            Key::Tool(number) => {
                if let Some(tool) = Tool::ALL.get(usize::from(number)) {
                    self.take(Item::Tool(*tool));
                }
            }
            Key::Bit(number) => self.mount(world, |_, count| usize::from(number).min(count)),
            Key::PreviousBit => self.mount(world, |at, count| (at + count - 1) % count),
            Key::NextBit => self.mount(world, |at, count| (at + 1) % count),
            Key::Undo => self.command(commands::UNDO),
            Key::Redo => self.command(commands::REDO),
            Key::Mirror => self.command(commands::SYMMETRY),
            Key::Nearer => self.orbit.zoom(1.0),
            Key::Farther => self.orbit.zoom(-1.0),
            Key::Turn { .. } => {}
        }
    }

    /// Mounts that of the held tool's bits which `choose` says, given the mounted one's place among
    /// them and their number.
    fn mount(&mut self, world: &World<N>, choose: impl Fn(usize, usize) -> usize) {
        let Some((tool, mounted)) = world.held(RIGHT) else { return };
        let bits: Vec<Bit> = bits_of(tool).collect();
        let at = bits.iter().position(|bit| *bit == mounted).unwrap_or(0);
        if let Some(bit) = bits.get(choose(at, bits.len())) {
            self.take(Item::Bit(*bit));
        }
    }
}

/// The bits that a tool takes.
pub(super) fn bits_of(tool: Tool) -> impl Iterator<Item = Bit> {
    Bit::ALL.into_iter().filter(move |bit| bit.data().tool == tool)
}

fn at(position: Vec3, rotation: Quat) -> HandInput {
    let grip = RawPose::new(position, rotation);
    HandInput { aim: grip, grip, tracked: true, ..HandInput::default() }
}

#[cfg(test)]
mod tests;
