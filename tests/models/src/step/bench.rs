//! Model of the workbench: the places of all items, how hands take, drop and return them, and the sizes of
//! bits.

use glam::{Quat, Vec3};
use paros_core::internals::{BENCH_ITEMS, BENCH_TOP, RoomPose, ToolPlace};
use paros_core::session::{BenchItem, BitSize, TICK_RATE, Tool, ToolBit};

/// Greatest distance at which a hand takes an item, in metres.
const GRAB_DISTANCE: f32 = 0.12;

/// An item: its place, and its pose if it fell.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Item {
    place: ToolPlace,
    pose: RoomPose,
}

/// The model of the bench.
#[derive(Clone, PartialEq, Debug)]
pub struct BenchModel {
    items: [Item; BENCH_ITEMS],
    /// The size of each bit, in steps from its size in the table.
    sizes: [i8; ToolBit::ALL.len()],
}

impl BenchModel {
    /// Returns the bench before any session: every item at home, no bit mounted.
    pub fn before_sessions() -> Self {
        let nowhere = (Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        BenchModel {
            items: [Item { place: ToolPlace::Home, pose: nowhere }; BENCH_ITEMS],
            sizes: [0; ToolBit::ALL.len()],
        }
    }

    /// Returns the bench at the start of a session: each tool carries its own bit.
    pub fn at_start() -> Self {
        let mut bench = Self::before_sessions();
        for bit in [ToolBit::MediumBall, ToolBit::PointChisel, ToolBit::Nozzle, ToolBit::File] {
            bench.put(BenchItem::Bit(bit), ToolPlace::Mounted);
        }
        bench
    }

    /// Returns the tool in a hand and the bit on it.
    pub fn held(&self, hand: usize) -> Option<(Tool, ToolBit)> {
        let tool = Tool::ALL
            .into_iter()
            .find(|tool| self.place_of(BenchItem::Tool(*tool)) == ToolPlace::Hand(hand as u8))?;
        let mounted = ToolBit::ALL.into_iter().find(|bit| {
            bit.spec().tool == tool && self.place_of(BenchItem::Bit(*bit)) == ToolPlace::Mounted
        });
        Some((tool, mounted.unwrap_or(tool.default_bit())))
    }

    /// Returns an item's place.
    pub fn place_of(&self, item: BenchItem) -> ToolPlace {
        self.items[item.number()].place
    }

    /// Returns an item's pose in the room, unless it is in a hand or on a tool.
    pub fn pose_of(&self, item: BenchItem) -> Option<RoomPose> {
        match self.place_of(item) {
            ToolPlace::Hand(_) | ToolPlace::Mounted => None,
            ToolPlace::Home => Some((item.home_position(), Quat::IDENTITY)),
            ToolPlace::Falling(_) | ToolPlace::Lying(_) => Some(self.items[item.number()].pose),
        }
    }

    /// Returns the nearest tool within reach of a hand's grip, or bit of its tool within reach of grip or
    /// tip.
    pub fn item_in_reach(&self, hand: usize, grip: Vec3, tip: Vec3) -> Option<BenchItem> {
        let held = self.held(hand).map(|(tool, _)| tool);
        let mut nearest: Option<(BenchItem, f32)> = None;
        for item in (0..BENCH_ITEMS).filter_map(BenchItem::from_number) {
            let Some((at, _)) = self.pose_of(item) else { continue };
            let distance = match item {
                BenchItem::Tool(_) => grip.distance(at),
                BenchItem::Bit(bit) if held == Some(bit.spec().tool) => {
                    grip.distance(at).min(tip.distance(at))
                }
                BenchItem::Bit(_) => continue,
            };
            if distance < nearest.map_or(GRAB_DISTANCE, |(_, least)| least) {
                nearest = Some((item, distance));
            }
        }
        nearest.map(|(item, _)| item)
    }

    /// Takes a tool into a hand, or mounts a bit on the tool that the hand holds. The previous tool or bit
    /// goes home. Returns `true` if anything changed.
    pub fn take(&mut self, hand: usize, item: BenchItem) -> bool {
        let held = self.held(hand);
        match item {
            BenchItem::Tool(tool) => {
                if held.is_some_and(|(held, _)| held == tool) {
                    return false;
                }
                if let Some((held, _)) = held {
                    self.put(BenchItem::Tool(held), ToolPlace::Home);
                }
                self.put(item, ToolPlace::Hand(hand as u8));
            }
            BenchItem::Bit(bit) => {
                let Some((tool, mounted)) = held else { return false };
                if bit.spec().tool != tool || mounted == bit {
                    return false;
                }
                self.put(BenchItem::Bit(mounted), ToolPlace::Home);
                self.put(item, ToolPlace::Mounted);
            }
        }
        true
    }

    /// Puts tools into the left and the right hand.
    pub fn put_into_hands(&mut self, tools: [Option<Tool>; 2]) {
        for (hand, tool) in (0..).zip(tools) {
            if let Some(tool) = tool {
                self.put(BenchItem::Tool(tool), ToolPlace::Hand(hand));
            }
        }
    }

    /// Returns the held tool to its home. Returns that tool.
    pub fn return_home(&mut self, hand: usize) -> Option<Tool> {
        let (tool, _) = self.held(hand)?;
        self.put(BenchItem::Tool(tool), ToolPlace::Home);
        Some(tool)
    }

    /// Drops the held tool at the grip: near its home it returns there, elsewhere it falls. Returns that
    /// tool.
    pub fn drop_tool(&mut self, hand: usize, grip: RoomPose) -> Option<Tool> {
        let (tool, _) = self.held(hand)?;
        let item = BenchItem::Tool(tool);
        let is_near = grip.0.distance(item.home_position()) < 2.0 * GRAB_DISTANCE;
        let place = if is_near { ToolPlace::Home } else { ToolPlace::Falling(0) };
        self.items[item.number()] = Item { place, pose: grip };
        Some(tool)
    }

    /// Advances dropped items by a tick: each falls on bench or floor, lies there for ten seconds, and
    /// returns home.
    pub fn step_dropped(&mut self) {
        for Item { place, pose: (at, _) } in &mut self.items {
            *place = match *place {
                ToolPlace::Falling(ticks) => {
                    let on_bench = (0.3..0.9).contains(&at.x)
                        && (-0.68..0.32).contains(&at.z)
                        && at.y >= BENCH_TOP;
                    let rest = if on_bench { BENCH_TOP } else { 0.03 };
                    at.y -= 9.81 / (TICK_RATE * TICK_RATE) as f32 * (f32::from(ticks) + 0.5);
                    if at.y <= rest || ticks > 1000 {
                        at.y = rest;
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

    /// Writes the bench in a save's format: each item's place with its ticks or hand, and its pose.
    pub fn write(&self, to: &mut Vec<u8>) {
        for Item { place, pose } in &self.items {
            let (kind, ticks) = match *place {
                ToolPlace::Home => (0, 0),
                ToolPlace::Hand(hand) => (1, hand.into()),
                ToolPlace::Mounted => (2, 0),
                ToolPlace::Falling(ticks) => (3, ticks),
                ToolPlace::Lying(ticks) => (4, ticks),
            };
            to.push(kind);
            to.extend(u16::to_le_bytes(ticks));
            write_pose(to, *pose);
        }
        to.extend(self.sizes.map(|steps| steps as u8));
    }

    /// Returns the size of a bit, in steps from its size in the table.
    pub const fn size_of(&self, bit: ToolBit) -> i8 {
        self.sizes[bit as usize]
    }

    /// Makes a bit larger or smaller, step by step, within its range of sizes.
    pub fn resize(&mut self, bit: ToolBit, steps: i32) {
        let size = &mut self.sizes[bit as usize];
        for _ in 0..steps.abs() {
            let next = *size + steps.signum() as i8;
            if BitSize::of_bit(bit, next).is_some() {
                *size = next;
            }
        }
    }

    fn put(&mut self, item: BenchItem, place: ToolPlace) {
        if let Some(item) = self.items.get_mut(item.number()) {
            item.place = place;
        }
    }
}

/// Writes a position and a rotation as seven numbers.
pub fn write_pose(to: &mut Vec<u8>, (position, rotation): RoomPose) {
    let parts = position.to_array().into_iter().chain(rotation.to_array());
    parts.for_each(|part| to.extend(f32::to_le_bytes(part)));
}
