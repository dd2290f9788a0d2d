//! A half-space: the region above a plane.

use glam::IVec3;

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::edit::brush::voxel_centre_subunits;
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range::Range;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The points `p`, in subunits, with `normal . p > offset`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HalfSpace {
    /// Its outward normal, with [`FIXED_ONE`] as 1.
    pub normal: IVec3,
    /// The position of its plane along the normal.
    pub offset: i64,
}

/// Greater than the offset of any plane through a point that a pose can have.
const MOST_OFFSET: i64 = 1 << 40;

impl HalfSpace {
    /// The empty half-space; all zero bytes.
    pub const NOTHING: HalfSpace = HalfSpace { normal: IVec3::ZERO, offset: 0 };

    /// Creates the half-space beyond a plane that is perpendicular to an axis of a bit, `distance_subunits`
    /// from its centre, in the direction of that axis or against it if `is_backward`.
    #[must_use]
    pub(crate) fn beyond_plane_of_bit(
        pose: &Pose,
        axis: usize,
        is_backward: bool,
        distance_subunits: i32,
    ) -> Self {
        let axis = pose.unit_axes_q14()[axis];
        let normal = if is_backward { -axis } else { axis };
        let centre = pose.clamped_position_subunits().as_i64vec3().dot(normal.as_i64vec3());
        let distance = i64::from(distance_subunits) * i64::from(FIXED_ONE);
        HalfSpace { normal, offset: centre + distance }
    }

    /// Returns its mirror image along x in a grid of `grid_side` voxels a side.
    #[must_use]
    pub fn mirrored(self, grid_side: usize) -> Self {
        let IVec3 { x, y, z } = self.normal;
        let far = i64::from(x) * grid_side as i64 * i64::from(SUBUNITS_PER_VOXEL);
        HalfSpace { normal: IVec3::new(-x, y, z), offset: self.offset - far }
    }

    /// Returns the voxels of a row whose middles are inside, given the fixed-point y and z of the middles.
    #[must_use]
    #[inline]
    pub(crate) fn x_range(&self, y: i64, z: i64, grid_side: usize) -> Option<Range> {
        let [nx, ny, nz] = self.normal.to_array().map(i64::from);
        let rest = self.offset - ny * y - nz * z;
        // Voxel i is inside if nx * (256 i + 128) > rest.
        let voxel = i64::from(SUBUNITS_PER_VOXEL);
        let (half, whole) = (nx * voxel / 2, nx.abs() * voxel);
        let end = grid_side as i64 - 1;
        let (first, last) = match nx.signum() {
            0 if rest < 0 => (0, end),
            0 => return None,
            1 => ((rest - half).div_euclid(whole) + 1, end),
            _ => (0, -(rest - half).div_euclid(whole) - 1),
        };
        let (first, last) = (first.max(0), last.min(end));
        (first <= last).then(|| Range::new(first as usize, last as usize))
    }

    /// Returns the voxels of row (y, z) whose middles are inside.
    #[must_use]
    pub(crate) fn row<const N: usize>(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row
    where
        Grid<N>: Size,
    {
        let [y, z] = [y, z].map(voxel_centre_subunits);
        self.x_range(y, z, N).map_or(BitSet::EMPTY, BitSet::from_range)
    }

    /// Returns the axis nearest to its normal, the first of equals, and `true` if the normal points along it,
    /// not against it.
    #[must_use]
    pub(crate) fn dominant_axis(&self) -> (usize, bool) {
        let parts = self.normal.to_array();
        let axis =
            (1..3).fold(0, |most, i| if parts[i].abs() > parts[most].abs() { i } else { most });
        (axis, parts[axis] > 0)
    }

    /// Length of a serialised half-space in bytes.
    pub(crate) const BYTES: usize = 3 * 2 + 8;

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        self.normal.to_array().into_iter().for_each(|part| to.u16(part as i16 as u16));
        to.u64(self.offset as u64);
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a plane within reach");
        let mut part = || Ok(i32::from(from.u16()? as i16));
        let normal = IVec3::new(part()?, part()?, part()?);
        let offset = from.u64()? as i64;
        let is_unit = normal.abs().max_element() <= FIXED_ONE;
        let is_near = (-MOST_OFFSET..=MOST_OFFSET).contains(&offset);
        if is_unit && is_near { Ok(HalfSpace { normal, offset }) } else { Err(bad) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::digest::mix_bits;

    /// A row agrees with the definition, and so does its mirror image.
    #[test]
    fn a_row_is_what_is_beyond_the_plane() {
        for case in 0..4000u64 {
            let any =
                |i: u64, most: i32| (mix_bits(case * 9 + i) % (2 * most as u64 + 1)) as i32 - most;
            let normal = IVec3::new(any(0, 3) * 5000, any(1, FIXED_ONE), any(2, FIXED_ONE));
            let through = IVec3::new(any(3, 9000), any(4, 9000), any(5, 9000)) + 8192;
            let offset = normal.as_i64vec3().dot(through.as_i64vec3());
            let half = HalfSpace { normal, offset };
            let (y, z) = ((any(6, 31) + 32) as usize, (any(7, 31) + 32) as usize);
            let [row, mirrored] = [half, half.mirrored(64)].map(|half| half.row::<64>(y, z));
            for x in 0..64 {
                let middle = IVec3::new(x, y as i32, z as i32) * 256 + 128;
                let is_beyond = normal.as_i64vec3().dot(middle.as_i64vec3()) > offset;
                assert_eq!(row.contains(x as usize), is_beyond, "{half:?}, x = {x}");
                assert_eq!(mirrored.contains(63 - x as usize), is_beyond, "{half:?}, x = {x}");
            }
        }
    }
}
