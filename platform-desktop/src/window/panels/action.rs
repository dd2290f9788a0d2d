//! Actions that a visitor can choose in a panel.

use std::path::PathBuf;

use paros_core::session::{BenchItem, SessionMode};

/// An action that the visitor chose in a panel.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::window) enum PanelAction {
    /// Start a session.
    Start(SessionMode),
    /// Start a session from the sculpture as it is.
    CarveOn,
    /// Go back to the previous sculpture.
    OneBefore,
    /// Start from the file that has been read.
    StartRead,
    /// Open a file to start from.
    Open(PathBuf),
    /// Take an item off the workbench.
    Take(BenchItem),
    /// Make the held bit larger by this number of steps.
    Resize(i8),
    /// Commands of the core, as bits of `paros_core::session::commands`.
    Command(u8),
    /// Finish the session.
    Finish,
    /// Retry writing the files that could not be written.
    WriteAgain,
}
