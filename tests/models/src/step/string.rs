//! Model of a steadied hand, whose bit follows on a string.

use paros_core::edit::Pose;

use crate::step::StepModel;

impl<const K: usize> StepModel<K> {
    /// Returns the position that a hand at `in_hand` wants for its bit. A running bit follows on a string:
    /// the position wanted a tick ago moves toward the hand by the distance that exceeds the string's length.
    pub(super) fn pull_string(&self, hand: usize, in_hand: Pose, is_new_pull: bool) -> Pose {
        let state = &self.hands[hand];
        let string = f32::from(self.string_mm) * 1e-3 / self.stool_frame().voxel_metres();
        if self.string_mm == 0 || !state.trigger || is_new_pull || !state.has_frozen_pose {
            return in_hand;
        }
        let end = state.raw_pose.position;
        let distance = (end - in_hand.position).length();
        let position = match distance > string {
            true => in_hand.position + (end - in_hand.position) * (string / distance),
            false => end,
        };
        Pose { position, ..in_hand }
    }
}
