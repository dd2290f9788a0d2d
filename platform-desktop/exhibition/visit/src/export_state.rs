//! How far an export is, as a host is told of it.

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use paros_upload::courier::{BoothState, Courier};

/// How far a finished sculpture's files are.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct ExportState {
    /// Whether they are being made or written.
    pub is_busy: bool,
    /// Whether this session's print is written.
    pub is_kept: bool,
    /// How much of it is made, 0 to 1.
    pub part: f32,
    /// Sculptures whose files are not yet where they are to be kept: being made, being written, or to be written again.
    pub pending: u32,
    /// Where it stands on its way to the booth; `None` where the device isn't enrolled at one.
    pub booth: Option<BoothState>,
}

impl ExportState {
    /// Returns the state of a studio's last sculpture, and of its upload where the device is enrolled at a booth.
    #[must_use]
    pub fn of_studio<const N: usize>(studio: &Studio<'_, N>, courier: Option<&Courier>) -> Self
    where
        Grid<N>: Size + Resident<N, INTERVALS>,
    {
        ExportState {
            is_busy: studio.is_exporting(),
            is_kept: studio.session_stl_path().is_some(),
            part: studio.export_part(),
            pending: studio.count_unkept_sculptures(),
            booth: courier.map(Courier::booth_state),
        }
    }
}
