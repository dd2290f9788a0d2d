//! Model of island removal by its naive definition: flood fill from ground and mask. The volume becomes the
//! closure of its supported voxels.

use crate::dense::{DenseVolume, face_neighbours};

/// The result of an island pass over a volume that isn't edited meanwhile.
#[derive(Clone, Debug)]
pub struct ClearedVolume {
    /// The volume afterwards.
    pub after: DenseVolume,
    /// Number of voxels removed.
    pub removed: u32,
    /// Number of unsupported voxels that closure keeps.
    pub kept: u32,
    /// `true` if the volume touches neither ground nor mask; nothing is removed then.
    pub unsupported: bool,
}

/// Removes the islands of a closed volume.
pub fn clear_islands(volume: &DenseVolume, mask: &DenseVolume) -> ClearedVolume {
    let grounded = volume.occupied().any(|[_, y, _]| y == 0);
    if !grounded && mask.is_empty() {
        return ClearedVolume { after: volume.clone(), removed: 0, kept: 0, unsupported: true };
    }
    let supported = volume.supported_by_ground_or(mask);
    let after = supported.closure();
    let removed = volume.difference(&after).count();
    let kept = after.difference(&supported).count();
    ClearedVolume { after, removed, kept, unsupported: false }
}

/// Returns the voxels of all islands that neither contain nor touch a voxel of `added`.
pub fn islands_away_from(
    volume: &DenseVolume,
    mask: &DenseVolume,
    added: &DenseVolume,
) -> DenseVolume {
    let loose = volume.difference(&volume.supported_by_ground_or(mask));
    let seeds = loose.occupied().filter(|&voxel| {
        added.contains(voxel) || face_neighbours(voxel).iter().any(|&at| added.contains(at))
    });
    loose.difference(&loose.connected_to(seeds.collect()))
}
