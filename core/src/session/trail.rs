//! The trail of a hand: the poses that its running bit has yet to follow.
//!
//! A bit cuts no faster than its bites allow, so a quick hand is ahead of it. The bit cuts along the hand's
//! own path, pose by pose, not along the chord from its position to the hand's.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::vectors::{QUAT_BYTES, VEC3_BYTES, write_quat, write_vec3};
use crate::edit::pose::Pose;
use crate::limits::MAX_TRAIL_POSES;
use crate::session::hand::read_pose;

/// A queue of poses in the grid, one for each tick of the hand, the oldest first.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandTrail {
    /// All zero from `count` on.
    poses: [Pose; MAX_TRAIL_POSES],
    count: u8,
}

/// The value of unused elements.
const NO_POSE: Pose = Pose { position: Vec3::ZERO, rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0) };

impl HandTrail {
    /// The empty trail; all zero bytes.
    pub const EMPTY: HandTrail = HandTrail { poses: [NO_POSE; MAX_TRAIL_POSES], count: 0 };

    /// Returns the poses that the bit has yet to reach, the oldest first.
    #[must_use]
    pub fn poses(&self) -> &[Pose] {
        &self.poses[..usize::from(self.count)]
    }

    /// Returns `true` if the bit has caught up with its hand.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Appends the newest pose of the hand. Drops the oldest poses beyond `most`, which is clamped to
    /// [`MAX_TRAIL_POSES`]. Returns the number of dropped poses.
    pub fn push_and_drop_beyond(&mut self, pose: Pose, most: usize) -> u32 {
        let most = most.clamp(1, MAX_TRAIL_POSES);
        let dropped = (usize::from(self.count) + 1).saturating_sub(most);
        self.drop_oldest(dropped);
        self.poses[usize::from(self.count)] = pose;
        self.count += 1;
        dropped as u32
    }

    /// Removes the oldest pose, if there is one.
    pub fn pop_oldest(&mut self) {
        self.drop_oldest(1);
    }

    fn drop_oldest(&mut self, dropped: usize) {
        let dropped = dropped.min(usize::from(self.count));
        self.poses.copy_within(dropped.., 0);
        self.poses[MAX_TRAIL_POSES - dropped..].fill(NO_POSE);
        self.count -= dropped as u8;
    }

    /// Length of a serialised trail.
    pub(crate) const BYTES: usize = 1 + MAX_TRAIL_POSES * (VEC3_BYTES + QUAT_BYTES);

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u8(self.count);
        for pose in &self.poses {
            write_vec3(to, pose.position);
            write_quat(to, pose.rotation);
        }
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a trail of poses, and zeros after them");
        let mut trail = HandTrail { count: from.u8()?, ..HandTrail::EMPTY };
        if usize::from(trail.count) > MAX_TRAIL_POSES {
            return Err(bad);
        }
        for (i, pose) in trail.poses.iter_mut().enumerate() {
            let (position, rotation) = read_pose(from)?;
            *pose = Pose { position, rotation };
            let is_used = i < usize::from(trail.count);
            let is_zero = pose.position.to_array().map(f32::to_bits) == [0; 3]
                && pose.rotation.to_array().map(f32::to_bits) == [0; 4];
            let is_valid = if is_used { pose.rotation.length_squared() > 0.0 } else { is_zero };
            if !is_valid {
                return Err(bad);
            }
        }
        Ok(trail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x: f32) -> Pose {
        Pose { position: Vec3::X * x, rotation: Quat::IDENTITY }
    }

    fn first_and_last(trail: &HandTrail) -> [f32; 2] {
        let poses = trail.poses();
        [0, poses.len() - 1].map(|i| poses[i].position.x)
    }

    #[test]
    fn the_oldest_poses_go_where_there_are_too_many() {
        let mut trail = HandTrail::EMPTY;
        let dropped = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| trail.push_and_drop_beyond(pose(x), 3));
        assert_eq!((dropped, first_and_last(&trail)), ([0, 0, 0, 1, 1], [2.0, 4.0]));
        // A chisel that is exchanged for a burr may leave a longer trail than the burr's maximum.
        let mut trail = HandTrail::EMPTY;
        (0..9).for_each(|x| _ = trail.push_and_drop_beyond(pose(x as f32), 12));
        assert_eq!(trail.push_and_drop_beyond(pose(9.0), 6), 4);
        assert_eq!((trail.poses().len(), first_and_last(&trail)), (6, [4.0, 9.0]));
    }

    #[test]
    fn what_was_followed_leaves_nothing_behind() {
        let mut trail = HandTrail::EMPTY;
        (0..12).for_each(|x| _ = trail.push_and_drop_beyond(pose(x as f32), 12));
        (0..13).for_each(|_| trail.pop_oldest());
        assert_eq!(trail, HandTrail::EMPTY);
    }

    #[test]
    fn a_trail_comes_back_from_its_bytes_and_a_forged_one_does_not() {
        let mut trail = HandTrail::EMPTY;
        (0..4).for_each(|x| _ = trail.push_and_drop_beyond(pose(x as f32), 12));
        let mut bytes = [0; HandTrail::BYTES];
        let mut to = ByteWriter::new(&mut bytes);
        trail.write(&mut to);
        assert_eq!(to.len(), HandTrail::BYTES);
        let read = |bytes: &[u8]| HandTrail::read(&mut ByteReader::new(bytes));
        assert_eq!(read(&bytes), Ok(trail));
        // Fewer or more poses than the trail has, and more than its capacity.
        for count in [3, 5, 13, 255] {
            bytes[0] = count;
            assert!(read(&bytes).is_err(), "{count} poses");
        }
    }
}
