//! The workbench: where tools and bits lie, and how they go from hand to hand.

use glam::{Quat, Vec3};

use crate::codec::{BadBytes, Reader, Writer};
use crate::input::TICK_RATE;
use crate::tools::{Bit, Tool};

/// Things to take: the tools by number, then the exchangeable bits by number.
pub const ITEMS: usize = 11;

/// How near a hand must be to a thing to take it, in metres.
pub const REACH: f32 = 0.12;

/// A thing that lies on the bench at the start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Item {
    /// A tool, with the bit that is mounted on it.
    Tool(Tool),
    /// A bit to be mounted.
    Bit(Bit),
}

/// Where a thing is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// At its own place on the bench.
    Home,
    /// In a hand (0 left, 1 right).
    Hand(u8),
    /// On its tool.
    Mounted,
    /// Dropped, on its way down for some ticks.
    Falling(u16),
    /// Where it fell, for some ticks; then it is back home.
    Lying(u16),
}

/// A thing's place and pose; the pose counts only while it falls or lies.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Thing {
    place: Place,
    position: Vec3,
    rotation: Quat,
}

/// All the things, and which bit is mounted on each tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Workbench {
    things: [Thing; ITEMS],
}

impl Item {
    /// The item of a number.
    #[must_use]
    pub fn from_number(number: usize) -> Option<Item> {
        match number {
            0..4 => Some(Item::Tool(Tool::ALL[number])),
            4..ITEMS => Some(Item::Bit(Bit::ALL[number - 4])),
            _ => None,
        }
    }

    /// Its number.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            Item::Tool(tool) => tool as usize,
            Item::Bit(bit) => 4 + bit as usize,
        }
    }

    /// Its own place on the bench, in metres: tools in the front row, bits behind.
    #[must_use]
    pub fn home(self) -> Vec3 {
        match self {
            Item::Tool(tool) => Vec3::new(0.45, BENCH_TOP, -0.65 + 0.18 * (tool as u8) as f32),
            Item::Bit(bit) => Vec3::new(0.7, BENCH_TOP, -0.65 + 0.1 * (bit as u8) as f32),
        }
    }
}

impl Workbench {
    /// Before any session: all zero bytes.
    #[must_use]
    #[allow(clippy::new_without_default)] // `const fn new` is the one way these are made
    pub const fn new() -> Self {
        let rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        Workbench { things: [Thing { place: Place::Home, position: Vec3::ZERO, rotation }; ITEMS] }
    }

    /// Everything at its place, each tool with its first bit.
    pub fn tidy(&mut self) {
        *self = Self::new();
        for tool in Tool::ALL {
            self.set_place(Item::Bit(tool.first_bit()), Place::Mounted);
        }
    }

    /// Where a thing is. The fixed bits of the fill gun and the rasp are always mounted.
    #[must_use]
    pub fn place(&self, item: Item) -> Place {
        self.things.get(item.number()).map_or(Place::Mounted, |thing| thing.place)
    }

    /// The bit on a tool.
    #[must_use]
    pub fn mounted(&self, tool: Tool) -> Bit {
        let on_it = |bit: &Bit| bit.data().tool == tool && self.is_mounted(*bit);
        Bit::ALL.into_iter().find(on_it).unwrap_or(tool.first_bit())
    }

    /// The tool in a hand.
    #[must_use]
    pub fn held(&self, hand: usize) -> Option<Tool> {
        let place = Place::Hand(hand as u8);
        Tool::ALL.into_iter().find(|tool| self.place(Item::Tool(*tool)) == place)
    }

    /// A thing's pose in metres; `None` for what is in a hand or on a tool.
    #[must_use]
    pub fn pose(&self, item: Item) -> Option<(Vec3, Quat)> {
        let thing = self.things.get(item.number())?;
        match thing.place {
            Place::Home => Some((item.home(), Quat::IDENTITY)),
            Place::Falling(_) | Place::Lying(_) => Some((thing.position, thing.rotation)),
            Place::Hand(_) | Place::Mounted => None,
        }
    }

    /// The nearest thing that a hand can take: a tool near its grip, or a bit for the tool it holds
    /// near its grip or that tool's tip.
    #[must_use]
    pub fn within_reach(&self, hand: usize, grip: Vec3, tip: Vec3) -> Option<Item> {
        let held = self.held(hand);
        let mut nearest = None;
        let mut least = REACH;
        for item in (0..ITEMS).filter_map(Item::from_number) {
            let Some((position, _)) = self.pose(item) else { continue };
            let distance = match item {
                Item::Tool(_) => grip.distance(position),
                Item::Bit(bit) if held == Some(bit.data().tool) => {
                    let (a, b) = (grip.distance(position), tip.distance(position));
                    if a < b { a } else { b }
                }
                Item::Bit(_) => continue,
            };
            if distance < least {
                (nearest, least) = (Some(item), distance);
            }
        }
        nearest
    }

    /// Puts a thing into a hand, or a bit onto the tool in that hand; what was there before goes
    /// home. Whether anything changed.
    pub fn take(&mut self, hand: usize, item: Item) -> bool {
        match item {
            Item::Tool(tool) => {
                let held = self.held(hand);
                if held == Some(tool) {
                    return false;
                }
                if let Some(held) = held {
                    self.set_place(Item::Tool(held), Place::Home);
                }
                self.set_place(item, Place::Hand(hand as u8));
            }
            Item::Bit(bit) => {
                let tool = bit.data().tool;
                if self.held(hand) != Some(tool) || self.is_mounted(bit) {
                    return false;
                }
                self.set_place(Item::Bit(self.mounted(tool)), Place::Home);
                self.set_place(item, Place::Mounted);
            }
        }
        true
    }

    /// Lets go of what a hand holds at a pose: near its own place it is put back there, elsewhere
    /// it falls.
    pub fn release(&mut self, hand: usize, position: Vec3, rotation: Quat) -> Option<Tool> {
        let tool = self.held(hand)?;
        let item = Item::Tool(tool);
        let near = position.distance(item.home()) < 2.0 * REACH;
        let place = if near { Place::Home } else { Place::Falling(0) };
        self.things[item.number()] = Thing { place, position, rotation };
        Some(tool)
    }

    /// Puts what a hand holds back on the bench.
    pub fn put_back(&mut self, hand: usize) -> Option<Tool> {
        let tool = self.held(hand)?;
        self.set_place(Item::Tool(tool), Place::Home);
        Some(tool)
    }

    /// A tick: what was dropped falls, lies, and after ten seconds is back home.
    pub fn step(&mut self) {
        for thing in &mut self.things {
            thing.place = match thing.place {
                Place::Falling(ticks) => {
                    let rest = rest_height(thing.position);
                    thing.position.y -= GRAVITY * (f32::from(ticks) + 0.5);
                    if thing.position.y <= rest || ticks > 1000 {
                        thing.position.y = rest;
                        Place::Lying(0)
                    } else {
                        Place::Falling(ticks + 1)
                    }
                }
                Place::Lying(ticks) if u32::from(ticks) >= 10 * TICK_RATE => Place::Home,
                Place::Lying(ticks) => Place::Lying(ticks + 1),
                place => place,
            };
        }
    }

    pub(crate) fn write(&self, to: &mut Writer<'_>) {
        for thing in &self.things {
            let (kind, ticks) = match thing.place {
                Place::Home => (0, 0),
                Place::Hand(hand) => (1, u16::from(hand)),
                Place::Mounted => (2, 0),
                Place::Falling(ticks) => (3, ticks),
                Place::Lying(ticks) => (4, ticks),
            };
            to.u8(kind);
            to.u16(ticks);
            write_vec3(to, thing.position);
            write_quat(to, thing.rotation);
        }
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let mut bench = Self::new();
        for thing in &mut bench.things {
            let bad = from.bad("a place, 0 to 4");
            let (kind, ticks) = (from.u8()?, from.u16()?);
            thing.place = match kind {
                0 if ticks == 0 => Place::Home,
                1 if ticks < 2 => Place::Hand(ticks as u8),
                2 if ticks == 0 => Place::Mounted,
                3 => Place::Falling(ticks),
                4 => Place::Lying(ticks),
                _ => return Err(bad),
            };
            thing.position = read_vec3(from)?;
            thing.rotation = read_quat(from)?;
        }
        Ok(bench)
    }

    fn is_mounted(&self, bit: Bit) -> bool {
        self.place(Item::Bit(bit)) == Place::Mounted
    }

    fn set_place(&mut self, item: Item, place: Place) {
        if let Some(thing) = self.things.get_mut(item.number()) {
            thing.place = place;
        }
    }
}

/// Height of the bench's top, in metres.
pub const BENCH_TOP: f32 = 0.86;

/// Metres that a falling thing gains in speed a tick, a tick.
const GRAVITY: f32 = 9.81 / (TICK_RATE * TICK_RATE) as f32;

/// Where a thing above or beside the bench comes to rest.
fn rest_height(position: Vec3) -> f32 {
    let above = (0.3..0.9).contains(&position.x)
        && (-0.8..0.2).contains(&position.z)
        && position.y >= BENCH_TOP;
    if above { BENCH_TOP } else { 0.03 }
}

/// Writes three floats by their bits.
pub(crate) fn write_vec3(to: &mut Writer<'_>, v: Vec3) {
    v.to_array().iter().for_each(|f| to.f32(*f));
}

/// Writes four floats by their bits.
pub(crate) fn write_quat(to: &mut Writer<'_>, q: Quat) {
    q.to_array().iter().for_each(|f| to.f32(*f));
}

pub(crate) fn read_vec3(from: &mut Reader<'_>) -> Result<Vec3, BadBytes> {
    Ok(Vec3::new(finite(from)?, finite(from)?, finite(from)?))
}

pub(crate) fn read_quat(from: &mut Reader<'_>) -> Result<Quat, BadBytes> {
    Ok(Quat::from_xyzw(finite(from)?, finite(from)?, finite(from)?, finite(from)?))
}

fn finite(from: &mut Reader<'_>) -> Result<f32, BadBytes> {
    let bad = from.bad("a finite number");
    let value = from.f32()?;
    if value.is_finite() { Ok(value) } else { Err(bad) }
}
