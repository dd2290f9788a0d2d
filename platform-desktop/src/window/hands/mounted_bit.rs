//! The bits of the held tool, and the mounted bit among them.

use paros_core::World;
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, Tool, ToolBit};
use paros_core::volume::{Grid, Size};

use super::{MouseHands, RIGHT};

/// Returns the bits that a tool takes.
pub(in crate::window) fn tool_bits_of(tool: Tool) -> impl Iterator<Item = ToolBit> {
    ToolBit::ALL.into_iter().filter(move |bit| bit.spec().tool == tool)
}

/// The mounted bit's place among the bits of its tool.
#[derive(Clone, Copy)]
pub(super) struct MountedBit {
    /// The index of the mounted bit.
    pub(super) mounted: usize,
    /// The number of bits of the tool.
    pub(super) count: usize,
}

impl<const N: usize> MouseHands<N>
where
    Grid<N>: Size,
{
    /// Mounts one of the held tool's bits, by its index among them.
    pub(super) fn mount_bit(
        &mut self,
        world: &World<N, INTERVALS>,
        choose_index: impl Fn(MountedBit) -> usize,
    ) {
        let Some((tool, mounted)) = world.held_tool(RIGHT) else { return };
        let bits: Vec<ToolBit> = tool_bits_of(tool).collect();
        let mounted = bits.iter().position(|bit| *bit == mounted).unwrap_or(0);
        if let Some(bit) = bits.get(choose_index(MountedBit { mounted, count: bits.len() })) {
            self.take_item(BenchItem::Bit(*bit));
        }
    }
}
