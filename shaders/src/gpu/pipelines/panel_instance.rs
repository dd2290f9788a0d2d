//! The instance of a panel's quad: the quad, and its panel's transform.

use bytemuck::{Pod, Zeroable};

use crate::panel::{Panel, PanelQuad};

/// A quad with its panel's transform, as `wgsl/panel.wgsl` reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PanelInstance {
    /// Rows of the affine transform from the panel, in millimetres, y down, to the room, in metres.
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) quad: PanelQuad,
}

impl PanelInstance {
    /// Returns the instances of a panel, from the back to the front.
    pub(crate) fn of_panel(panel: &Panel) -> impl Iterator<Item = PanelInstance> {
        let [corner, right, down] = panel.pose.frame(panel.size_mm());
        let rows = [0, 1, 2].map(|k| [right[k], down[k], 0.0, corner[k]]);
        panel.quads().iter().map(move |&quad| PanelInstance { rows, quad })
    }
}
