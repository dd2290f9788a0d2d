//! The workbench: the places of tools and bits, and how hands take, release and return them.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::vectors::{QUAT_BYTES, VEC3_BYTES, write_quat, write_vec3};
use crate::session::bit_size::BitSize;
use crate::session::hand::{RoomPose, read_pose};
use crate::session::input::TICK_RATE;
use crate::session::tools::{Tool, ToolBit};

/// Number of items: the tools, then the exchangeable bits.
pub const BENCH_ITEMS: usize = 17;

/// Maximum distance at which a hand can take an item, in metres.
pub(crate) const GRAB_DISTANCE: f32 = 0.12;

/// An item that can be taken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BenchItem {
    /// A tool, with the bit that is mounted on it.
    Tool(Tool),
    /// A bit that can be mounted.
    Bit(ToolBit),
}

/// The place of an item.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ToolPlace {
    /// At its home position on the bench.
    Home,
    /// In a hand (0 left, 1 right).
    Hand(u8),
    /// Mounted on its tool.
    Mounted,
    /// Falling, for this many ticks so far.
    Falling(u16),
    /// Lying where it fell, for this many ticks so far; after ten seconds it returns home.
    Lying(u16),
}

/// An item's place and pose; the pose is used only while it falls or lies.
#[derive(Clone, Copy, PartialEq, Debug)]
struct PlacedItem {
    place: ToolPlace,
    position: Vec3,
    rotation: Quat,
}

/// The places of all items, and the sizes of all bits.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Workbench {
    items: [PlacedItem; BENCH_ITEMS],
    sizes: [BitSize; ToolBit::ALL.len()],
}

impl BenchItem {
    /// Returns the item with this number.
    #[must_use]
    pub fn from_number(number: usize) -> Option<BenchItem> {
        match number {
            0..4 => Some(BenchItem::Tool(Tool::ALL[number])),
            4..BENCH_ITEMS => Some(BenchItem::Bit(ToolBit::ALL[number - 4])),
            _ => None,
        }
    }

    /// Returns its number.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            BenchItem::Tool(tool) => tool as usize,
            BenchItem::Bit(bit) => 4 + bit as usize,
        }
    }

    /// Returns its home position in the room, in metres: tools in the front row, bits behind, the large ones
    /// last. All are within reach from the room's origin without a step, standing or seated, for small and
    /// tall people.
    #[must_use]
    pub fn home_position(self) -> Vec3 {
        let (x, z) = match self {
            BenchItem::Tool(tool) => (0.45, -0.53 + 0.18 * (tool as u8) as f32),
            BenchItem::Bit(ToolBit::PitchingChisel) => (0.82, -0.4),
            BenchItem::Bit(ToolBit::Float) => (0.82, -0.27),
            BenchItem::Bit(ToolBit::RoughingBall) => (0.82, -0.11),
            BenchItem::Bit(ToolBit::DiscSaw) => (0.82, 0.07),
            BenchItem::Bit(ToolBit::File) => (0.82, 0.19),
            BenchItem::Bit(ToolBit::Nozzle) => (0.7, 0.2),
            BenchItem::Bit(bit) => (0.7, -0.53 + 0.1 * (bit as u8) as f32),
        };
        Vec3::new(x, BENCH_TOP, z)
    }
}

impl Workbench {
    /// Creates the bench before any session; all zero bytes.
    #[must_use]
    pub(crate) const fn new() -> Self {
        let rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        Workbench {
            items: [PlacedItem { place: ToolPlace::Home, position: Vec3::ZERO, rotation };
                BENCH_ITEMS],
            sizes: [BitSize::NATURAL; ToolBit::ALL.len()],
        }
    }

    /// Puts every item at its home in its natural size, and mounts each tool's default bit.
    pub(crate) fn reset_items(&mut self) {
        *self = Self::new();
        for tool in Tool::ALL {
            self.set_place(BenchItem::Bit(tool.default_bit()), ToolPlace::Mounted);
        }
    }

    /// Returns the place of an item.
    #[must_use]
    pub fn place_of(&self, item: BenchItem) -> ToolPlace {
        self.items[item.number()].place
    }

    /// Returns the bit mounted on a tool.
    #[must_use]
    pub fn mounted_bit(&self, tool: Tool) -> ToolBit {
        let on_it = |bit: &ToolBit| bit.spec().tool == tool && self.is_mounted(*bit);
        ToolBit::ALL.into_iter().find(on_it).unwrap_or(tool.default_bit())
    }

    /// Returns the tool in a hand.
    #[must_use]
    pub fn held_tool(&self, hand: usize) -> Option<Tool> {
        let place = ToolPlace::Hand(hand as u8);
        Tool::ALL.into_iter().find(|tool| self.place_of(BenchItem::Tool(*tool)) == place)
    }

    /// Returns the size of a bit, wherever the bit is.
    #[must_use]
    pub const fn size_of(&self, bit: ToolBit) -> BitSize {
        self.sizes[bit as usize]
    }

    /// Enlarges or shrinks a bit by a number of steps, within its range.
    pub(crate) fn resize_bit(&mut self, bit: ToolBit, steps: i32) {
        self.sizes[bit as usize] = self.size_of(bit).resized_by(bit, steps);
    }

    /// Returns an item's pose in the room, in metres, or `None` if it is in a hand or on a tool.
    #[must_use]
    pub fn pose_of(&self, item: BenchItem) -> Option<RoomPose> {
        let thing = &self.items[item.number()];
        match thing.place {
            ToolPlace::Home => Some((item.home_position(), Quat::IDENTITY)),
            ToolPlace::Falling(_) | ToolPlace::Lying(_) => Some((thing.position, thing.rotation)),
            ToolPlace::Hand(_) | ToolPlace::Mounted => None,
        }
    }

    /// Returns the nearest item that a hand can take: a tool within [`GRAB_DISTANCE`] of its grip, or a bit
    /// for its held tool within that distance of its grip or the tool's tip.
    #[must_use]
    pub(crate) fn nearest_in_reach(&self, hand: usize, grip: Vec3, tip: Vec3) -> Option<BenchItem> {
        let held = self.held_tool(hand);
        let mut nearest = None;
        let mut least = GRAB_DISTANCE;
        for item in (0..BENCH_ITEMS).filter_map(BenchItem::from_number) {
            let Some((position, _)) = self.pose_of(item) else { continue };
            let distance = match item {
                BenchItem::Tool(_) => grip.distance(position),
                BenchItem::Bit(bit) if held == Some(bit.spec().tool) => {
                    let (a, b) = (grip.distance(position), tip.distance(position));
                    if a < b { a } else { b }
                }
                BenchItem::Bit(_) => continue,
            };
            if distance < least {
                (nearest, least) = (Some(item), distance);
            }
        }
        nearest
    }

    /// Puts a tool into a hand, or mounts a bit on the tool in that hand. The replaced item returns home.
    /// Returns `true` if anything changed.
    pub(crate) fn try_take_item(&mut self, hand: usize, item: BenchItem) -> bool {
        match item {
            BenchItem::Tool(tool) => {
                let held = self.held_tool(hand);
                if held == Some(tool) {
                    return false;
                }
                if let Some(held) = held {
                    self.set_place(BenchItem::Tool(held), ToolPlace::Home);
                }
                self.set_place(item, ToolPlace::Hand(hand as u8));
            }
            BenchItem::Bit(bit) => {
                let tool = bit.spec().tool;
                if self.held_tool(hand) != Some(tool) || self.is_mounted(bit) {
                    return false;
                }
                self.set_place(BenchItem::Bit(self.mounted_bit(tool)), ToolPlace::Home);
                self.set_place(item, ToolPlace::Mounted);
            }
        }
        true
    }

    /// Swaps the tools `held` by the hands.
    pub(crate) fn swap_held_tools(&mut self, held: [Option<Tool>; 2]) {
        for (hand, tool) in held.into_iter().enumerate() {
            if let Some(tool) = tool {
                self.set_place(BenchItem::Tool(tool), ToolPlace::Hand(1 - hand as u8));
            }
        }
    }

    /// Releases the held tool at the grip's pose in the room: near its home position it returns there,
    /// elsewhere it falls. Returns the tool.
    pub(crate) fn let_tool_fall_or_return_home(
        &mut self,
        hand: usize,
        grip: RoomPose,
    ) -> Option<Tool> {
        let (position, rotation) = grip;
        let tool = self.held_tool(hand)?;
        let item = BenchItem::Tool(tool);
        let near = position.distance(item.home_position()) < 2.0 * GRAB_DISTANCE;
        let place = if near { ToolPlace::Home } else { ToolPlace::Falling(0) };
        self.items[item.number()] = PlacedItem { place, position, rotation };
        Some(tool)
    }

    /// Puts the held tool back home and returns it.
    pub(crate) fn return_tool_home(&mut self, hand: usize) -> Option<Tool> {
        let tool = self.held_tool(hand)?;
        self.set_place(BenchItem::Tool(tool), ToolPlace::Home);
        Some(tool)
    }

    /// Advances dropped items by one tick: they fall, lie for ten seconds, and return home.
    pub(crate) fn step_dropped_items(&mut self) {
        for thing in &mut self.items {
            thing.place = match thing.place {
                ToolPlace::Falling(ticks) => {
                    let rest = rest_height_metres(thing.position);
                    thing.position.y -= GRAVITY * (f32::from(ticks) + 0.5);
                    if thing.position.y <= rest || ticks > 1000 {
                        thing.position.y = rest;
                        ToolPlace::Lying(0)
                    } else {
                        ToolPlace::Falling(ticks + 1)
                    }
                }
                ToolPlace::Lying(ticks) if u32::from(ticks) >= 10 * TICK_RATE => ToolPlace::Home,
                ToolPlace::Lying(ticks) => ToolPlace::Lying(ticks + 1),
                place => place,
            };
        }
    }

    /// Length of a serialised bench: the place, tick count and pose of each item, and the size of each bit.
    pub(crate) const BYTES: usize =
        BENCH_ITEMS * (1 + 2 + VEC3_BYTES + QUAT_BYTES) + ToolBit::ALL.len();

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        for thing in &self.items {
            let (kind, ticks) = match thing.place {
                ToolPlace::Home => (0, 0),
                ToolPlace::Hand(hand) => (1, u16::from(hand)),
                ToolPlace::Mounted => (2, 0),
                ToolPlace::Falling(ticks) => (3, ticks),
                ToolPlace::Lying(ticks) => (4, ticks),
            };
            to.u8(kind);
            to.u16(ticks);
            write_vec3(to, thing.position);
            write_quat(to, thing.rotation);
        }
        self.sizes.iter().for_each(|size| to.u8(size.steps() as u8));
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let mut bench = Self::new();
        for thing in &mut bench.items {
            let bad = from.error_here("a place, 0 to 4");
            let (kind, ticks) = (from.u8()?, from.u16()?);
            thing.place = match kind {
                0 if ticks == 0 => ToolPlace::Home,
                1 if ticks < 2 => ToolPlace::Hand(ticks as u8),
                2 if ticks == 0 => ToolPlace::Mounted,
                3 => ToolPlace::Falling(ticks),
                4 => ToolPlace::Lying(ticks),
                _ => return Err(bad),
            };
            (thing.position, thing.rotation) = read_pose(from)?;
        }
        for (bit, size) in ToolBit::ALL.into_iter().zip(&mut bench.sizes) {
            let bad = from.error_here("a size that the bit comes in");
            *size = BitSize::of_bit(bit, from.u8()? as i8).ok_or(bad)?;
        }
        let bad = from.error_here("a bench with one tool a hand and one bit a tool");
        if bench.is_possible() { Ok(bench) } else { Err(bad) }
    }

    /// Returns `true` if each item is in a place valid for its kind, no hand holds two tools, and no tool has
    /// two bits.
    fn is_possible(&self) -> bool {
        let place =
            |number: usize| BenchItem::from_number(number).map(|item| (item, self.place_of(item)));
        let mut places = (0..BENCH_ITEMS).filter_map(place);
        places.all(|(item, here)| match (item, here) {
            (BenchItem::Tool(tool), ToolPlace::Hand(hand)) => {
                self.held_tool(hand.into()) == Some(tool)
            }
            (BenchItem::Tool(_), here) => here != ToolPlace::Mounted,
            (BenchItem::Bit(bit), ToolPlace::Mounted) => self.mounted_bit(bit.spec().tool) == bit,
            (BenchItem::Bit(_), here) => here == ToolPlace::Home,
        })
    }

    fn is_mounted(&self, bit: ToolBit) -> bool {
        self.place_of(BenchItem::Bit(bit)) == ToolPlace::Mounted
    }

    fn set_place(&mut self, item: BenchItem, place: ToolPlace) {
        if let Some(thing) = self.items.get_mut(item.number()) {
            thing.place = place;
        }
    }
}

/// Height of the bench's top, in metres.
pub const BENCH_TOP: f32 = 0.86;

/// The extent of the bench's top in the room, along x and along z, in metres: at the visitor's right.
pub const BENCH_REACH: [[f32; 2]; 2] = [[0.3, 0.9], [-0.68, 0.32]];

/// Returns `true` if a point is above or below the bench's top.
#[must_use]
pub fn is_over_bench(point: Vec3) -> bool {
    let [x, z] = BENCH_REACH;
    (x[0]..x[1]).contains(&point.x) && (z[0]..z[1]).contains(&point.z)
}

/// Acceleration of gravity, in metres per tick squared.
const GRAVITY: f32 = 9.81 / (TICK_RATE * TICK_RATE) as f32;

/// Returns the height at which an item dropped at this position comes to rest.
fn rest_height_metres(position: Vec3) -> f32 {
    if is_over_bench(position) && position.y >= BENCH_TOP { BENCH_TOP } else { 0.03 }
}
