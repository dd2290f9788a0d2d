//! Actions that the visitor chose in a panel.

use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState, commands};
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use paros_shell::studio::CarvingOn;

use super::App;
use crate::window::opening;
use crate::window::panels::PanelAction;

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Performs an action that the visitor chose in a panel.
    pub(super) fn perform_action(&mut self, action: PanelAction) {
        match action {
            PanelAction::Start(mode) => self.start_anew(mode),
            PanelAction::StartRead => {
                if let Some(session) = self.studio.offer_read_volume() {
                    self.start_anew(session.mode);
                }
            }
            PanelAction::OneBefore => self.bring_back_the_one_before(),
            PanelAction::CarveOn => match self.studio.carve_on() {
                CarvingOn::GoesOn => self.show_another_world(),
                CarvingOn::Starts(session) => self.hands.start_session(session.mode),
            },
            PanelAction::Open(path) => {
                self.studio.open_file(&path, opening::read_into_resident_maps::<N>);
            }
            PanelAction::Take(item) => self.hands.take_item(item),
            PanelAction::Resize(by) => self.hands.resize_bit(by),
            PanelAction::WriteAgain => self.studio.retry_failed_writes(),
            PanelAction::Command(command) => self.hands.queue_commands(command),
            PanelAction::Finish => {
                if self.studio.world().session_state() == SessionState::Sculpting {
                    self.hands.queue_commands(commands::FINISH);
                }
            }
        }
    }

    /// Starts a session with the initial camera and the default tool depths.
    pub(super) fn start_anew(&mut self, mode: SessionMode) {
        self.hands.start_session(mode);
        self.hands.reset_eye_and_depths();
    }

    fn bring_back_the_one_before(&mut self) {
        if self.studio.bring_back_the_one_before() {
            self.show_another_world();
        }
    }

    /// Resets input, renderer and panels after another world was loaded.
    fn show_another_world(&mut self) {
        self.hands.drop_input();
        if let Some(view) = &mut self.view {
            view.note_load(self.studio.world());
        }
        self.panels.close_covering_panels();
    }
}
