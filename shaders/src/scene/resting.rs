//! The studio at rest: every tool with its first bit in its place, the stool unturned.

use glam::Affine3A;
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{BenchItem, Tool, ToolBit};

use super::assembly::{PLAIN, SHINING, SculpturePlacement, room_from_pose};
use super::draw::DrawList;
use super::meshes::MeshId;
use super::placing::{bit_pose, display_pose_at_home};

/// Returns the sculpture's placement on the unturned stool.
#[must_use]
pub const fn resting_placement() -> SculpturePlacement {
    SculpturePlacement { turn_radians: 0.0, side: BOX_SIDE, foot: STOOL_TOP }
}

/// Returns the draw list of the studio at rest, for pictures without a world.
#[must_use]
pub fn resting_studio() -> DrawList {
    let mut list = DrawList::new();
    for (mesh, tint) in [
        (MeshId::Room, PLAIN),
        (MeshId::Outside, SHINING),
        (MeshId::Workbench, PLAIN),
        (MeshId::StoolBase, PLAIN),
    ] {
        list.add(mesh, Affine3A::IDENTITY, tint);
    }
    list.add(MeshId::StoolTop, Affine3A::from_translation(STOOL_TOP), PLAIN);
    for tool in Tool::ALL {
        let grip = display_pose_at_home(BenchItem::Tool(tool));
        list.add(MeshId::of_tool(tool), room_from_pose(grip), PLAIN);
        let bit = MeshId::of_bit(tool.default_bit());
        list.add(bit, room_from_pose(bit_pose(grip, tool)), PLAIN);
    }
    let is_mounted = |bit: &ToolBit| Tool::ALL.iter().any(|tool| tool.default_bit() == *bit);
    for bit in ToolBit::ALL.into_iter().filter(|bit| !is_mounted(bit)) {
        let at = display_pose_at_home(BenchItem::Bit(bit));
        list.add(MeshId::of_bit(bit), room_from_pose(at), PLAIN);
    }
    list.batch_by_mesh();
    list
}
