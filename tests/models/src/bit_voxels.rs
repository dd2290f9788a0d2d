//! The voxels in a bit or a brush, which the model of contact tests one by one.

use glam::I64Vec3;
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{BrushBounds, BrushPiece, FIXED_ONE, GridBit, GridShape};

use crate::dense::DenseVolume;

/// Returns the occupied voxels that may be within half a voxel of a bit, by the bit's outer radius.
pub(crate) fn voxels_around<'a>(
    voxels: &'a DenseVolume,
    bit: &GridBit,
    pose: &Pose,
) -> impl Iterator<Item = [i32; 3]> + use<'a> {
    let n = voxels.side();
    let reach = bit.circumscribed_radius_subunits() as f32 / SUBUNITS_PER_VOXEL as f32 + 2.0;
    let [x, y, z] = pose.position.to_array().map(|centre| {
        let [lo, hi] = [centre - reach, centre + reach].map(|end| end.clamp(0.0, n as f32));
        lo.floor() as usize..hi.ceil() as usize
    });
    let rows = y.flat_map(move |y| z.clone().map(move |z| (y, z)));
    let rows = rows.map(move |at| (at, &voxels.row(at.0, at.1)[x.clone()], x.start));
    rows.filter(|(_, row, _)| row.contains(&true)).flat_map(|((y, z), row, first)| {
        let occupied = row.iter().enumerate().filter(|(_, occupied)| **occupied);
        occupied.map(move |(i, _)| [first + i, y, z].map(|i| i as i32))
    })
}

/// Returns `true` if a piece of a brush contains one of the voxels.
pub(crate) fn holds_any(piece: &BrushPiece, voxels: &DenseVolume) -> bool {
    let n = voxels.side();
    let Some(BrushBounds { lo, hi }) = piece.bounds(n) else { return false };
    (lo[1]..=hi[1]).any(|y| {
        (lo[2]..=hi[2]).any(|z| {
            let row = piece.x_range(y, z, n);
            row.is_some_and(|x| voxels.row(y, z)[x.first()..=x.last()].contains(&true))
        })
    })
}

/// Returns the depth of a voxel's centre inside the bit, rounded up to whole fixed-point units; `None`
/// outside.
pub(crate) fn centre_depth_subunits(bit: &GridBit, pose: &Pose, voxel: [i32; 3]) -> Option<i32> {
    let p = centre_offset_subunits(pose, voxel);
    let inner = match bit.shape {
        GridShape::Ball(radius) => depth_in_ball_subunits(radius, p)?,
        GridShape::Box(half) => {
            let unit = i64::from(FIXED_ONE);
            let across = distances_along_bit_axes(pose, p);
            let left = [0, 1, 2].map(|i| i64::from(half[i]) * unit - across[i]);
            let least = *left.iter().min().expect("three axes");
            if least < 0 {
                return None;
            }
            (least + unit - 1) / unit
        }
        GridShape::Disc { radius, half_thickness } => {
            // Across its plane, a disc is as deep as its bite when five eighths of its thickness are left.
            let whole = i64::from(half_thickness) * i64::from(FIXED_ONE);
            let left = whole - distances_along_bit_axes(pose, p)[0];
            if left < 0 {
                return None;
            }
            let (parts, of) = (left * 8 * i64::from(bit.bite.max(1)), 3 * whole);
            depth_in_ball_subunits(radius, p)?.min((parts + of - 1) / of)
        }
    };
    Some(inner as i32)
}

/// Returns the depth of a point in a ball about the origin: the least k for which radius - k is at most the
/// distance. `None` outside.
fn depth_in_ball_subunits(radius: i32, p: I64Vec3) -> Option<i64> {
    let squared = p.length_squared();
    let mut k = i64::from(radius) - squared.isqrt() - 1;
    while (i64::from(radius) - k).max(0).pow(2) > squared {
        k += 1;
    }
    (squared <= i64::from(radius).pow(2)).then_some(k)
}

/// Returns `true` if a voxel's centre lies in the bit, or less than half a voxel outside its radius or faces.
pub(crate) fn is_less_than_half_a_voxel_outside(
    bit: &GridBit,
    pose: &Pose,
    voxel: [i32; 3],
) -> bool {
    let p = centre_offset_subunits(pose, voxel);
    match bit.shape {
        GridShape::Ball(radius) => {
            p.length_squared() < i64::from(radius + SUBUNITS_PER_VOXEL / 2).pow(2)
        }
        GridShape::Box(half) => {
            distances_along_bit_axes(pose, p).iter().enumerate().all(|(i, &across)| {
                across < i64::from(half[i] + SUBUNITS_PER_VOXEL / 2) * i64::from(FIXED_ONE)
            })
        }
        GridShape::Disc { radius, half_thickness } => {
            let wider = half_thickness + SUBUNITS_PER_VOXEL / 2;
            p.length_squared() < i64::from(radius + SUBUNITS_PER_VOXEL / 2).pow(2)
                && distances_along_bit_axes(pose, p)[0] < i64::from(wider) * i64::from(FIXED_ONE)
        }
    }
}

/// Returns a voxel's centre relative to the bit's, along the grid's axes.
pub(crate) fn centre_offset_subunits(bit_pose: &Pose, voxel: [i32; 3]) -> I64Vec3 {
    let centre = voxel.map(|i| i64::from(i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2));
    I64Vec3::from_array(centre) - bit_pose.clamped_position_subunits().as_i64vec3()
}

/// Returns the distances of a point from the bit's centre along the bit's axes, in subunits times
/// [`FIXED_ONE`].
pub(crate) fn distances_along_bit_axes(bit_pose: &Pose, offset_subunits: I64Vec3) -> [i64; 3] {
    bit_pose.unit_axes_q14().map(|axis| offset_subunits.dot(axis.as_i64vec3()).abs())
}
