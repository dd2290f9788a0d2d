//! Islands as the definition has them: the volume becomes the closure of what is supported.

use super::dense::{Dense, neighbours};

/// What a pass over a volume at rest must come to.
#[derive(Clone, Debug)]
pub struct Cleared {
    /// The volume afterwards.
    pub after: Dense,
    /// Voxels removed.
    pub removed: u32,
    /// Unsupported voxels that closure keeps.
    pub kept: u32,
    /// Neither ground nor mask.
    pub unsupported: bool,
}

/// Clears a closed volume of its islands.
pub fn cleared(volume: &Dense, mask: &Dense) -> Cleared {
    let grounded = volume.occupied().any(|[_, y, _]| y == 0);
    if !grounded && mask.is_empty() {
        return Cleared { after: volume.clone(), removed: 0, kept: 0, unsupported: true };
    }
    let supported = volume.supported(mask);
    let after = supported.closure();
    let removed = volume.without(&after).count();
    let kept = after.without(&supported).count();
    Cleared { after, removed, kept, unsupported: false }
}

/// The islands of a volume that neither hold nor touch a voxel of `added`, all voxels together.
pub fn untouched_islands(volume: &Dense, mask: &Dense, added: &Dense) -> Dense {
    let loose = volume.without(&volume.supported(mask));
    let seeds = loose.occupied().filter(|&voxel| {
        added.contains(voxel) || neighbours(voxel).iter().any(|&at| added.contains(at))
    });
    loose.without(&loose.connected_to(seeds.collect()))
}
