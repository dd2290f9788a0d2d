//! The volumes that a session can start from, lent by the shell.

use crate::volume::range_maps::RangeMaps;

/// A hidden figure and the stone that it is carved from. The figure is a subset of the stone.
#[derive(Clone, Copy, Debug)]
pub struct HiddenFigure<'a, const N: usize, const K: usize = 1> {
    /// The mask of the session.
    pub figure: &'a RangeMaps<N, K>,
    /// Its start volume.
    pub stone: &'a RangeMaps<N, K>,
}

/// Start volumes by session mode. All maps must be tight.
///
/// With a single volume, pass it as both `lump` and `creative`. To continue from an edited [`Volume`], pass
/// its maps as `own` and start a session of [`SessionMode::Own`].
///
/// [`Volume`]: crate::Volume
/// [`SessionMode::Own`]: crate::session::SessionMode::Own
#[derive(Debug)]
pub struct StartVolumes<'a, const N: usize, const K: usize = 1> {
    /// The rough stone of the free-form mode.
    pub lump: &'a RangeMaps<N, K>,
    /// The hidden figures of the constrained mode.
    pub figures: &'a [HiddenFigure<'a, N, K>],
    /// The shape of the creative mode.
    pub creative: &'a RangeMaps<N, K>,
    /// A volume loaded by the user.
    pub own: Option<&'a RangeMaps<N, K>>,
}
