//! What is shown of a visit: which panels, with which buttons, and what those do.

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

/// The most panels shown at once: one before the visitor, one at the side.
pub(crate) const MAX_PANELS: usize = 2;

/// The most with the rays of both hands on them: a beam, and where it ends.
const MAX_DRAWN: usize = MAX_PANELS + 2 * rays::RAYS;

/// For how long a visitor who rests is told that another's turn comes, at most. Who has a headset on is seen to be there.
const REST_TOLD_TICKS: u32 = 20 * TICK_RATE;

/// What is asked beside what the visit's phase shows.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum Question {
    /// Nothing.
    #[default]
    None,
    /// Whether the sculpture is ready.
    Finish,
    /// The staff's PIN.
    Pin,
    /// What the staff wants.
    Staff,
}

/// What a button does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ButtonAction {
    /// It is told to the visit.
    Press(PanelAction),
    /// A way to start is taken, and that is all there was to choose.
    Choose(SessionMode),
    /// It is told to the visit, and the staff's panel is shut.
    Staff(StaffCommand),
    /// The room is turned to who wears the headset.
    Recentre,
    /// A question is asked, or none any more.
    Ask(Question),
    /// A digit of the PIN.
    Digit(u8),
    /// The PIN's last digit is taken back.
    Erase,
    /// The last stroke is taken back.
    Undo,
    /// The stone turns by a part.
    Turn,
    /// The headset is cleaned: the next visitor may come.
    Cleaned,
    /// A window's next visitor is there.
    NewVisit,
}

/// Whether a visitor works on the stone in this phase, and has a clock and tools.
#[must_use]
pub const fn is_at_work(phase: VisitPhase) -> bool {
    matches!(phase, VisitPhase::Guided | VisitPhase::Sculpting)
}

/// All that panels show: they are laid out anew where it differs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ScreenState {
    pub(crate) phase: VisitPhase,
    pub(crate) question: Question,
    pub(crate) step: GuideStep,
    /// The first cut has just ended, and the visitor is told so.
    pub(crate) guide_end: Option<GuideEnd>,
    pub(crate) language: Language,
    pub(crate) language_number: u8,
    pub(crate) working_hand: u8,
    pub(crate) is_seated: bool,
    /// Seconds left, and of how many.
    pub(crate) seconds: Option<[u32; 2]>,
    pub(crate) warning: Option<Message>,
    /// Seconds until a window's visitor who rests counts as gone, once they are to be told.
    pub(crate) seconds_to_gone: Option<u32>,
    /// It is a sculpture that they are told of.
    pub(crate) is_sculpted: bool,
    /// Of an export, 0 to 100.
    pub(crate) percent: u32,
    pub(crate) badge: Option<u32>,
    /// The clock has run out.
    pub(crate) is_time_up: bool,
    /// The badge has been shown long enough.
    pub(crate) may_leave_badge: bool,
    /// Sculptures that are not yet where they are kept.
    pub(crate) pending: u32,
    /// What is told of the booth, where there is one.
    pub(crate) booth: Option<BoothTold>,
    /// The staff looks for the device.
    pub(crate) is_glowing: bool,
    pub(crate) pin: PinEntry,
    pub(crate) controls: Controls,
}

/// What panels tell of the way to a booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct BoothTold {
    /// Where the visitor's sculpture stands.
    pub(crate) status: Option<UploadStatus>,
    /// Sculptures that the booth doesn't have.
    pub(crate) owed: u32,
    /// Whether the device is nearly full with them.
    pub(crate) is_nearly_full: bool,
}

impl BoothTold {
    pub(crate) fn of_export(export: &ExportState) -> Option<Self> {
        let BoothState { status, outbox, .. } = export.booth?;
        let is_nearly_full = outbox.is_nearly_full;
        Some(BoothTold { status, owed: outbox.owed, is_nearly_full })
    }
}

/// The panels that are shown, and their buttons.
#[derive(Debug)]
pub(crate) struct Screen {
    /// Those of the visit, then the rays'.
    panels: [Panel; MAX_DRAWN],
    spots: [PanelSpot; MAX_PANELS],
    count: usize,
    ray_panels: usize,
    buttons: Vec<ShownButton>,
    actions: Vec<ButtonAction>,
    drawn: Option<(ScreenState, [Option<u16>; crate::pointing::POINTERS])>,
}

impl ScreenState {
    /// What is shown of a visit; what the host knows beside it is filled in by the host.
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
            // A minute more may make it more than all.
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

    /// Whether a visitor who rests is asked to stay, over what was shown. Thanks go on beside the sculpture that is looked
    /// at, and tell the seconds themselves.
    pub(crate) fn is_asked_to_stay(&self) -> bool {
        self.seconds_to_gone.is_some() && self.phase != VisitPhase::Thanks
    }
}

/// The seconds after which a window's visitor who rests counts as gone, once that is near. A mouse is all that a window
/// knows of its visitor.
fn seconds_to_gone(visit: &Visit, controls: Controls) -> Option<u32> {
    let is_told = controls == Controls::Mouse && visit.idle_ticks() > 0;
    let ticks = visit.ticks_until_gone().filter(|ticks| is_told && *ticks <= REST_TOLD_TICKS)?;
    Some(ticks.div_ceil(TICK_RATE))
}

impl Screen {
    /// Nothing.
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

    /// The panels with what is to be read and pressed.
    pub(crate) fn panels(&self) -> &[Panel] {
        &self.panels[..self.count]
    }

    /// All panels to be drawn: the rays of hands, too.
    pub(crate) fn drawn_panels(&self) -> &[Panel] {
        &self.panels[..self.count + self.ray_panels]
    }

    /// Their buttons.
    pub(crate) fn buttons(&self) -> &[ShownButton] {
        &self.buttons
    }

    /// What a button does.
    pub(crate) fn action(&self, id: u16) -> Option<ButtonAction> {
        self.actions.get(usize::from(id)).copied()
    }

    /// Puts the panels where they stand.
    pub(crate) fn place_panels(
        &mut self,
        pose: impl Fn(PanelSpot, [f32; 2]) -> paros_shaders::panel::PanelPose,
    ) {
        for (panel, spot) in self.panels.iter_mut().zip(self.spots).take(self.count) {
            panel.pose = pose(spot, panel.size_mm());
        }
    }

    /// The seconds that a visitor who rests is told.
    #[cfg(test)]
    pub(crate) fn told_rest(&self) -> Option<u32> {
        self.drawn.and_then(|(drawn, _)| drawn.seconds_to_gone)
    }

    /// What is told of the first cut's end.
    #[cfg(test)]
    pub(crate) fn told_guide_end(&self) -> Option<GuideEnd> {
        self.drawn.and_then(|(drawn, _)| drawn.guide_end)
    }

    /// What is told of the booth.
    #[cfg(test)]
    pub(crate) fn told_booth(&self) -> Option<BoothTold> {
        self.drawn.and_then(|(drawn, _)| drawn.booth)
    }

    /// Whether a panel stands beside the sculpture, and a window moves that aside.
    pub(crate) fn is_beside_sculpture(&self) -> bool {
        self.spots[..self.count].contains(&PanelSpot::Beside)
    }

    /// Whether panels of this state are another screen than what is shown: other buttons, which nobody has aimed at.
    pub(crate) fn is_another(&self, state: &ScreenState) -> bool {
        let screen = |state: &ScreenState| {
            (state.phase, state.question, state.is_asked_to_stay(), state.is_glowing)
        };
        self.drawn.is_none_or(|(drawn, _)| screen(&drawn) != screen(state))
    }
}
