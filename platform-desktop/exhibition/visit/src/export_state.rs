//! The state of an export, as it is reported to a host.

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use paros_upload::courier::{BoothState, Courier};

/// The state of a finished sculpture's files.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct ExportState {
    /// `true` if the files are being made or written.
    pub is_busy: bool,
    /// `true` if this session's print is written.
    pub is_kept: bool,
    /// The progress, 0 to 1.
    pub part: f32,
    /// Number of sculptures whose files aren't stored yet: being made, being written, or to be written again.
    pub pending: u32,
    /// The state of the upload to the booth; `None` if the device isn't enrolled.
    pub booth: Option<BoothState>,
}

impl ExportState {
    /// Returns the state of a studio's last sculpture, and of its upload if the device is enrolled.
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
