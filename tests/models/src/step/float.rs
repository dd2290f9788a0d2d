//! Model of a float and the plane that it works.

use glam::{IVec3, Vec3};
use paros_core::edit::{EditOperation, HalfSpace, Pose};
use paros_core::internals::{GridBit, GridShape};
use paros_core::limits::flattening_reach;

use crate::step::StepModel;
use crate::step::ledger::work_of_contact;

impl<const K: usize> StepModel<K> {
    /// Stores the plane of a float at its hand's present pose: that of its underside, or of its other face if
    /// the stone is on that side. Returns the work of finding the stone.
    pub(super) fn lay_float(&mut self, hand: usize, bit: &GridBit) -> u32 {
        let pose = self.hands[hand].raw_pose;
        let contact = self.stone().contact_at(bit, &pose);
        let GridShape::Box(half) = bit.shape else { return 0 };
        let up: IVec3 = pose.unit_axes_q14()[1];
        let is_over = contact.normal.dot(pose.rotation * Vec3::Y) < 0.0;
        let normal = if is_over { -up } else { up };
        let middle = pose.clamped_position_subunits();
        let along = normal.as_i64vec3().dot(middle.as_i64vec3());
        let offset = along - i64::from(half.y) * (1 << 14);
        self.hands[hand].above_float = HalfSpace { normal, offset };
        work_of_contact(bit, &contact)
    }

    /// Returns the operation of a float at a pose.
    pub(super) fn flattening(&self, hand: usize, pose: &Pose) -> EditOperation {
        let side = self.side();
        let own = self.hands[hand].above_float;
        let is_upper = pose.position.x > side as f32 / 2.0;
        let above = if self.is_mirrored && is_upper { own.mirrored(side) } else { own };
        EditOperation::Flatten { above, reach: flattening_reach(side) }
    }
}
