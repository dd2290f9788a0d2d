//! Depth below the surface to which the mouse's hand presses each bit.

use std::ops::RangeInclusive;

use paros_core::internals::{BitAction, BitShape, ToolBitSpec};
use paros_core::session::ToolBit;

/// Depths that the wheel can set, in millimetres. A bit with a negative depth hovers above the surface.
pub(in crate::window) const DEPTHS_MM: RangeInclusive<f32> = -20.0..=40.0;

/// The chosen depth of each bit, in millimetres; `None` for the default.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitDepths([Option<f32>; ToolBit::ALL.len()]);

impl BitDepths {
    /// No chosen depths: each bit has its default.
    pub(super) const UNCHOSEN: Self = BitDepths([None; ToolBit::ALL.len()]);

    /// Returns the depth of a bit with this table entry, in millimetres.
    pub(super) fn depth_mm(&self, bit: ToolBit, spec: &ToolBitSpec) -> f32 {
        self.0[bit as usize].unwrap_or(default_depth_mm(spec))
    }

    pub(super) fn change_by(&mut self, bit: ToolBit, spec: &ToolBitSpec, delta_mm: f32) {
        let depth = self.depth_mm(bit, spec) + delta_mm;
        self.0[bit as usize] = Some(depth.clamp(*DEPTHS_MM.start(), *DEPTHS_MM.end()));
    }
}

/// Returns the default depth in millimetres: half of the bit, a third of a nozzle, only the thickness that
/// levels the surface for a file, and a quarter of a blade, as far as a hand can guide it.
fn default_depth_mm(spec: &ToolBitSpec) -> f32 {
    let half_um = match spec.shape {
        BitShape::Ball { radius_um } => radius_um,
        BitShape::Box { half_extents_um: [x, y, z] } => x.min(y).min(z),
        BitShape::Disc { radius_um } => radius_um / 2,
    };
    let half_mm = half_um as f32 * 1e-3;
    match spec.action {
        BitAction::Carve => half_mm.min(*DEPTHS_MM.end()).round(),
        BitAction::Fill => (half_mm * 2.0 / 3.0).round(),
        BitAction::Smooth | BitAction::Flatten => 2.0,
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::{BitSize, ToolBit};

    use super::BitDepths;

    #[test]
    fn a_bit_goes_half_into_the_stone_until_another_depth_is_chosen() {
        let (ball, mut depths) = (ToolBit::MediumBall, BitDepths::UNCHOSEN);
        let depth = |depths: &BitDepths, bit: ToolBit| depths.depth_mm(bit, bit.spec());
        assert_eq!(depth(&depths, ball), 15.0);
        let small = ball.spec_at(BitSize::of_bit(ball, -4).expect("it comes in this size"));
        assert_eq!(depths.depth_mm(ball, &small), 8.0, "7.5 mm, rounded");
        let all = ToolBit::ALL.map(|bit| depth(&depths, bit));
        assert_eq!(all, [9.0, 15.0, 24.0, 9.0, 7.0, 7.0, 7.0, 40.0, 35.0, 8.0, 2.0, 2.0, 7.0]);
        depths.change_by(ball, ball.spec(), 3.0);
        assert_eq!((depth(&depths, ball), depths.depth_mm(ball, &small)), (18.0, 18.0));
        assert_eq!(depth(&depths, ToolBit::LargeBall), 24.0);
        depths.change_by(ball, ball.spec(), -90.0);
        assert_eq!(depth(&depths, ball), -20.0);
    }
}
