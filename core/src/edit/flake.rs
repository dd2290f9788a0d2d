//! Flakes: the piece of stone that a blow on a chisel splits off near an edge.

use glam::{I64Vec3, IVec3};

use crate::edit::brush::{BrushPiece, HalfBall};
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};
use crate::volume::bit_grid::BitGrid;
use crate::volume::size::{Grid, Size};

/// Sampling step along the path of a blow.
const STEP: i64 = SUBUNITS_PER_VOXEL as i64 / 2;

/// Maximum number of steps from the tip to the stone for a struck chisel.
const STRUCK_WITHIN: i64 = 4;

/// Returns the half-ball chip that a blow along a bit's -z splits off. The chip is half the ball of `reach`
/// about the struck point, cut by the plane that contains the blow and the tip's edge (along x), on the side
/// where the stone is thinner. Returns `None` unless the stone ends within `reach` on that side and along the
/// blow.
pub(crate) fn find_flake<const N: usize>(
    rows: &BitGrid<N>,
    pose: &Pose,
    tip_subunits: i32,
    reach_subunits: i32,
) -> Option<BrushPiece>
where
    Grid<N>: Size,
{
    let [_, up, back] = pose.unit_axes_q14();
    let centre = pose.clamped_position_subunits().as_i64vec3();
    let tip = point_along(centre, -back, i64::from(tip_subunits));
    let on_blow = |step: i64| point_along(tip, -back, step * STEP);
    let struck = (0..STRUCK_WITHIN + 1).map(on_blow).find(|&point| is_stone(rows, point))?;
    let steps_to_end = |way: IVec3| {
        let steps = 1..i64::from(reach_subunits) / STEP + 1;
        steps.into_iter().find(|step| {
            let point = point_along(struck, way, step * STEP);
            point.y >= 0 && !is_stone(rows, point)
        })
    };
    steps_to_end(-back)?;
    let sides = [up, -up].map(|side| (steps_to_end(side), side));
    let normal = match sides {
        [(Some(over), side), (Some(under), _)] if over <= under => side,
        [_, (Some(_), side)] | [(Some(_), side), _] => side,
        _ => return None,
    };
    Some(HalfBall::about(struck.as_ivec3(), reach_subunits, normal))
}

/// Returns the point at a distance from another along a unit direction in fixed point.
fn point_along(from: I64Vec3, way_q14: IVec3, distance: i64) -> I64Vec3 {
    let gone = way_q14.as_i64vec3() * distance;
    from + gone.div_euclid(I64Vec3::splat(i64::from(FIXED_ONE)))
}

/// Returns `true` if a point is in an occupied voxel.
fn is_stone<const N: usize>(rows: &BitGrid<N>, point: I64Vec3) -> bool
where
    Grid<N>: Size,
{
    let voxel = point.to_array().map(|part| part.div_euclid(i64::from(SUBUNITS_PER_VOXEL)));
    let is_inside = voxel.iter().all(|i| (0..N as i64).contains(i));
    is_inside && rows.contains(voxel.map(|i| i as usize))
}
