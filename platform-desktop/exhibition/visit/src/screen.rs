//! The screen of a visit: its panels, their buttons, and the actions of the buttons.

mod draw;
mod guide;
mod rays;

use paros_core::badge::BadgeNumber;
use paros_core::session::{SessionMode, TICK_RATE};
use paros_core::visit::{GuideStep, PanelAction, PlanSetting, StaffCommand, Visit, VisitPhase};
use paros_protocol::UploadStatus;
use paros_shaders::panel::layout::PinEntry;
use paros_shaders::panel::{Language, Message, Panel};
use paros_upload::courier::BoothState;

use crate::export_state::ExportState;
use crate::options::{Controls, VisitOptions};
use crate::pointing::ShownButton;
use crate::standing::PanelSpot;
pub(crate) use guide::GuideEnd;
pub(crate) use rays::point_in_room;

/// Largest number of panels shown at once: one in front of the visitor, one at the side.
pub(crate) const MAX_PANELS: usize = 2;

/// Largest number of panels with the rays of both hands: a beam and a dot each.
const MAX_DRAWN: usize = MAX_PANELS + 2 * rays::RAYS;

/// Ticks before the end of a visit at which an idle visitor at a window is warned. Headsets need no warning.
const REST_TOLD_TICKS: u32 = 20 * TICK_RATE;

/// The question that is shown instead of the visit's phase.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum Question {
    /// No question.
    #[default]
    None,
    /// Asks the visitor if the sculpture is finished.
    Finish,
    /// Asks for the staff's PIN.
    Pin,
    /// Shows the staff's panel.
    Staff,
}

/// The action of a button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ButtonAction {
    /// Sends the action to the visit.
    Press(PanelAction),
    /// Chooses a start, and confirms the choice.
    Choose(SessionMode),
    /// Sends the command to the visit, and closes the staff's panel.
    Staff(StaffCommand),
    /// Turns the room to the headset's wearer.
    Recentre,
    /// Opens a question, or closes the open one.
    Ask(Question),
    /// Enters a digit of the PIN.
    Digit(u8),
    /// Removes the last digit of the PIN.
    Erase,
    /// Undoes the last stroke.
    Undo,
    /// Turns the stone by an eighth of a turn.
    Turn,
    /// Confirms that the headset is cleaned: the next visitor can start.
    Cleaned,
    /// Starts the visit of a window's next visitor.
    NewVisit,
}

/// Returns `true` if a visitor works on the stone in this phase, with a clock and tools.
#[must_use]
pub const fn is_at_work(phase: VisitPhase) -> bool {
    matches!(phase, VisitPhase::Guided | VisitPhase::Sculpting)
}

/// The state that panels show. They are laid out again when it changes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ScreenState {
    pub(crate) phase: VisitPhase,
    pub(crate) question: Question,
    pub(crate) step: GuideStep,
    /// The end of the guided first cut, while its message is shown.
    pub(crate) guide_end: Option<GuideEnd>,
    pub(crate) language: Language,
    pub(crate) language_number: u8,
    pub(crate) working_hand: u8,
    pub(crate) is_seated: bool,
    /// The remaining seconds, and the seconds of the whole visit.
    pub(crate) seconds: Option<[u32; 2]>,
    pub(crate) warning: Option<Message>,
    /// The seconds until a window's idle visitor counts as gone, while the visitor is warned.
    pub(crate) seconds_to_gone: Option<u32>,
    /// `true` if there is a sculpture, which the warning mentions.
    pub(crate) is_sculpted: bool,
    /// The progress of an export, 0 to 100.
    pub(crate) percent: u32,
    pub(crate) badge: Option<u32>,
    /// `true` if the visit's time has run out.
    pub(crate) is_time_up: bool,
    /// `true` if the badge has been shown for long enough.
    pub(crate) may_leave_badge: bool,
    /// Number of sculptures whose files aren't stored yet.
    pub(crate) pending: u32,
    /// The state of the booth; `None` if there is no booth.
    pub(crate) booth: Option<BoothTold>,
    /// `true` while the device identifies itself to the staff.
    pub(crate) is_glowing: bool,
    pub(crate) pin: PinEntry,
    pub(crate) controls: Controls,
}

/// The state of uploads that panels show.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct BoothTold {
    /// The upload status of the visitor's sculpture.
    pub(crate) status: Option<UploadStatus>,
    /// Sculptures that the booth doesn't have.
    pub(crate) owed: u32,
    /// `true` if the outbox is nearly full with these sculptures.
    pub(crate) is_nearly_full: bool,
}

impl BoothTold {
    pub(crate) fn of_export(export: &ExportState) -> Option<Self> {
        let BoothState { status, outbox, .. } = export.booth?;
        let is_nearly_full = outbox.is_nearly_full;
        Some(BoothTold { status, owed: outbox.owed, is_nearly_full })
    }
}

/// The shown panels and their buttons.
#[derive(Debug)]
pub(crate) struct Screen {
    /// The panels of the visit, followed by those of the rays.
    panels: [Panel; MAX_DRAWN],
    spots: [PanelSpot; MAX_PANELS],
    count: usize,
    ray_panels: usize,
    buttons: Vec<ShownButton>,
    actions: Vec<ButtonAction>,
    drawn: Option<(ScreenState, [Option<u16>; crate::pointing::POINTERS])>,
}

impl ScreenState {
    /// Makes the state of a visit. The host fills in the rest.
    pub(crate) fn of_visit(visit: &Visit, options: &VisitOptions) -> Self {
        let length = u32::from(visit.plan().value(PlanSetting::Length));
        let left = visit.seconds_left().filter(|_| is_at_work(visit.phase()));
        let least = visit.plan().ticks(PlanSetting::BadgeLeast);
        ScreenState {
            phase: visit.phase(),
            question: Question::None,
            step: visit.guide_step(),
            guide_end: None,
            language: options.language(visit.language()),
            language_number: visit.language(),
            working_hand: visit.working_hand(),
            is_seated: visit.is_seated(),
            // An extension may make the remaining time longer than the plan's.
            seconds: left.map(|left| [left, length.max(left)]),
            warning: None,
            seconds_to_gone: seconds_to_gone(visit, options.controls),
            is_sculpted: visit.is_sculpted(),
            percent: 0,
            badge: visit.badge().filter(|number| BadgeNumber::new(*number).is_some()),
            is_time_up: visit.seconds_left() == Some(0),
            may_leave_badge: visit.phase_ticks() >= least,
            pending: 0,
            booth: None,
            is_glowing: false,
            pin: PinEntry::Entered(0),
            controls: options.controls,
        }
    }

    /// Returns `true` if an idle visitor is asked to stay, instead of the phase's panel. In the thanks phase,
    /// its panel shows the seconds itself.
    pub(crate) fn is_asked_to_stay(&self) -> bool {
        self.seconds_to_gone.is_some() && self.phase != VisitPhase::Thanks
    }
}

/// Returns the seconds until a window's idle visitor counts as gone, once that is near. Only windows need
/// this, as the mouse is their only sign of a visitor.
fn seconds_to_gone(visit: &Visit, controls: Controls) -> Option<u32> {
    let is_told = controls == Controls::Mouse && visit.idle_ticks() > 0;
    let ticks = visit.ticks_until_gone().filter(|ticks| is_told && *ticks <= REST_TOLD_TICKS)?;
    Some(ticks.div_ceil(TICK_RATE))
}

impl Screen {
    /// Makes an empty screen.
    pub(crate) fn new() -> Self {
        Screen {
            panels: core::array::from_fn(|_| Panel::new([0.0; 2])),
            spots: [PanelSpot::Main; MAX_PANELS],
            count: 0,
            ray_panels: 0,
            buttons: Vec::new(),
            actions: Vec::new(),
            drawn: None,
        }
    }

    /// Returns the panels of the visit.
    pub(crate) fn panels(&self) -> &[Panel] {
        &self.panels[..self.count]
    }

    /// Returns all panels to draw, including the rays of hands.
    pub(crate) fn drawn_panels(&self) -> &[Panel] {
        &self.panels[..self.count + self.ray_panels]
    }

    /// Returns the buttons of the panels.
    pub(crate) fn buttons(&self) -> &[ShownButton] {
        &self.buttons
    }

    /// Returns the action of a button.
    pub(crate) fn action(&self, id: u16) -> Option<ButtonAction> {
        self.actions.get(usize::from(id)).copied()
    }

    /// Places the panels with a function from spot and size to pose.
    pub(crate) fn place_panels(
        &mut self,
        pose: impl Fn(PanelSpot, [f32; 2]) -> paros_shaders::panel::PanelPose,
    ) {
        for (panel, spot) in self.panels.iter_mut().zip(self.spots).take(self.count) {
            panel.pose = pose(spot, panel.size_mm());
        }
    }

    /// Returns the seconds of the shown warning.
    #[cfg(test)]
    pub(crate) fn told_rest(&self) -> Option<u32> {
        self.drawn.and_then(|(drawn, _)| drawn.seconds_to_gone)
    }

    /// Returns the shown end of the first cut.
    #[cfg(test)]
    pub(crate) fn told_guide_end(&self) -> Option<GuideEnd> {
        self.drawn.and_then(|(drawn, _)| drawn.guide_end)
    }

    /// Returns the shown state of the booth.
    #[cfg(test)]
    pub(crate) fn told_booth(&self) -> Option<BoothTold> {
        self.drawn.and_then(|(drawn, _)| drawn.booth)
    }

    /// Returns `true` if a panel stands beside the sculpture. A window then moves the sculpture aside.
    pub(crate) fn is_beside_sculpture(&self) -> bool {
        self.spots[..self.count].contains(&PanelSpot::Beside)
    }

    /// Returns `true` if a state has another screen than the shown one, with buttons that weren't aimed at.
    pub(crate) fn is_another(&self, state: &ScreenState) -> bool {
        let screen = |state: &ScreenState| {
            (state.phase, state.question, state.is_asked_to_stay(), state.is_glowing)
        };
        self.drawn.is_none_or(|(drawn, _)| screen(&drawn) != screen(state))
    }
}
