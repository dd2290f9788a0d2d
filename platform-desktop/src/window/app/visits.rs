//! Visits in the window: visitor presence from mouse and touch, and the visit's panels before the eye.

use glam::Quat;
use paros_core::limits::INTERVALS;
use paros_core::visit::{GuideStep, Presence, VisitPhase};
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, WorldEvent};
use paros_shaders::panel::{Language, Panel};
use paros_shell::last_use::{LastUse, UseClock};
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use paros_visit::{
    Controls, ExportState, POINTERS, Pointer, VisitHost, VisitOptions, close_visits, is_at_work,
};

use super::App;

/// Angle of the camera, in radians, after which the guide's "look around" step is done: a drag over a sixth
/// of the window's height.
const LOOKED_AROUND: f32 = 0.4;

/// The cursor's index among the pointers.
const CURSOR: usize = 2;

/// State of the visits in the window.
#[derive(Debug)]
pub(in crate::window) struct WindowVisits {
    pub(in crate::window) host: VisitHost,
    uses: UseClock,
    is_pressed: bool,
    /// `true` if the button was pressed since the last tick; it may have been released again.
    was_pressed: bool,
    look_around: LookAround,
}

/// Rotation of the camera when the guide asked the visitor to look around.
#[derive(Clone, Copy, Default, Debug)]
struct LookAround {
    from: Option<Quat>,
}

impl LookAround {
    /// Compares the camera's rotation after a tick. Returns `true` once it has turned far enough since the
    /// guide asked for it.
    fn is_done(&mut self, step: GuideStep, eye: Quat) -> bool {
        if step != GuideStep::TurnStool {
            self.from = None;
            return false;
        }
        self.from.get_or_insert(eye).angle_between(eye) > LOOKED_AROUND
    }
}

/// Returns `true` in a phase that needs no activity and has its own time limit: hands off, export, or the
/// badge.
const fn is_at_rest(phase: VisitPhase) -> bool {
    matches!(phase, VisitPhase::HandsOff | VisitPhase::Export | VisitPhase::Badge)
}

impl WindowVisits {
    /// Creates the visits of a studio, or resumes the visit that was found. A visit whose idle time is
    /// unknown or over the limit of its phase counts as a former visitor's.
    pub(super) fn new<const N: usize>(options: &VisitOptions, studio: &Studio<'_, N>) -> Self
    where
        Grid<N>: Size + Resident<N, INTERVALS>,
    {
        let options = VisitOptions { controls: Controls::Mouse, ..options.clone() };
        let visit = studio.world().visit();
        let mut host = VisitHost::new(options, visit);
        if visit.phase() != VisitPhase::Closed {
            let (used, now) = (studio.read_last_use().ok(), LastUse::read_now());
            let unused = used.zip(now);
            let unused =
                unused.and_then(|(used, now)| used.time_until(Some(now.boot), now.since_boot));
            host.note_found(visit, unused);
        }
        WindowVisits {
            host,
            uses: UseClock::default(),
            is_pressed: false,
            was_pressed: false,
            look_around: LookAround::default(),
        }
    }

    /// Notes a press or release of the left button or a finger.
    pub(super) const fn note_button(&mut self, is_down: bool) {
        self.is_pressed = is_down;
        self.was_pressed |= is_down;
    }

    /// Returns the panels to draw.
    pub(super) fn panels(&self) -> &[Panel] {
        self.host.panels()
    }
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Returns the phase of the visit; `None` without visits.
    pub(super) fn visit_phase(&self) -> Option<VisitPhase> {
        self.visits.as_ref().map(|_| self.studio.world().visit().phase())
    }

    /// Returns the visitor's language; English without visits.
    pub(super) fn visit_language(&self) -> Language {
        let visit = self.studio.world().visit();
        self.visits.as_ref().map_or(Language::English, |visits| visits.host.language(visit))
    }

    /// Returns `true` if a visit's panel asks a question.
    pub(super) fn is_visit_asking(&self) -> bool {
        self.visits.as_ref().is_some_and(|visits| visits.host.is_asking())
    }

    /// Returns `true` if the visit's guide shows its panel.
    pub(super) fn has_visit_guide(&self) -> bool {
        self.visits.as_ref().is_some_and(|visits| visits.host.has_guide())
    }

    /// Returns `true` if the cursor is over a panel of the visit.
    pub(super) fn is_cursor_on_visit_panel(&self) -> bool {
        let ray = self.hands.cursor_ray();
        let on_panel = |visits: &WindowVisits| {
            ray.is_some_and(|ray| visits.host.covers_ray(ray.origin, ray.direction))
        };
        self.visits.as_ref().is_some_and(on_panel)
    }

    /// Places the visit's panels before the eye, for drawing and for pointer hits.
    pub(super) fn place_visit_panels(&mut self) {
        let view = self.hands.orbit.panel_view(self.hands.size);
        if let Some(visits) = &mut self.visits {
            visits.host.place_panels(|spot, size| view.panel_pose(spot, size));
        }
    }

    /// Adds the visit's input to a tick's input.
    pub(super) fn fill_visit_input(&mut self, input: &mut TickInput) {
        self.place_visit_panels();
        let ray = self.hands.cursor_ray();
        let Some(visits) = &mut self.visits else {
            return close_visits(self.studio.world().visit(), input);
        };
        let is_pressed = visits.is_pressed || core::mem::take(&mut visits.was_pressed);
        let mut pointers = [None; POINTERS];
        // The help hides the visit's panels, so that they can't be pressed.
        let ray = ray.filter(|_| !self.panels.is_help_shown());
        pointers[CURSOR] = ray.map(|ray| Pointer {
            origin: ray.origin,
            direction: ray.direction,
            is_pressed,
            fingertip: None,
        });
        let world = self.studio.world();
        visits.host.follow_pointers(world.visit(), &pointers);
        let is_used = is_at_rest(world.visit().phase()) || self.idle.is_in_use();
        visits.host.fill_input(world, (Presence::Unknown, is_used), input);
        if is_used {
            visits.uses.note_use(self.begun.elapsed());
        }
        if visits.uses.take_due_stamp().is_some()
            && let Some(now) = LastUse::read_now()
        {
            self.studio.keep_last_use(now);
        }
    }

    /// Saves the time of the last use to disk, as the program may end next.
    pub(super) fn keep_last_use_before_end(&mut self) {
        let last_use = self.visits.as_mut().and_then(|visits| visits.uses.take_last_stamp());
        if let (Some(last_use), Some(now)) = (last_use, LastUse::read_now()) {
            let unused = self.begun.elapsed().saturating_sub(last_use);
            let since_boot = now.since_boot.saturating_sub(unused);
            self.studio.keep_last_use(LastUse { since_boot, ..now });
        }
    }

    /// Passes the left button or a finger to the visit, if nothing covers the visit's panels. A press in the
    /// attract phase always begins a new visit: a window can't detect that one visitor has replaced another.
    pub(super) fn press_in_visit(&mut self, is_down: bool) {
        let Some(visits) = &mut self.visits else { return };
        visits.note_button(is_down);
        if is_down && self.studio.world().visit().phase() == VisitPhase::Attract {
            visits.host.begin_anew();
        }
    }

    /// Asks the visitor whether the sculpture is finished. A second request confirms it.
    pub(super) fn ask_visitor_to_finish(&mut self) {
        if let Some(visits) = &mut self.visits {
            visits.host.ask_or_confirm_finish(self.studio.world().visit());
        }
    }

    /// Closes the help, else the visit's question.
    pub(super) fn close_topmost_in_visit(&mut self) {
        if self.panels.close_help() {
            return;
        }
        if let Some(visits) = &mut self.visits {
            visits.host.drop_question();
        }
    }

    /// Shows or hides the staff's PIN panel.
    pub(super) fn ask_staff(&mut self) {
        if let Some(visits) = &mut self.visits {
            visits.host.toggle_staff_panel();
        }
    }

    /// Updates visit, camera, hands and panels after a tick.
    pub(super) fn follow_visit_tick(&mut self) {
        let Some(visits) = &mut self.visits else { return };
        let world = self.studio.world();
        let export = ExportState::of_studio(&self.studio, self.courier.as_deref());
        visits.host.follow_tick(world, &export);
        self.hands.orbit.move_aside(visits.host.is_beside_sculpture());
        let is_new_visit = |event: &WorldEvent| {
            matches!(event, WorldEvent::Visit(VisitPhase::Welcome | VisitPhase::Attract))
        };
        if world.events().contains(&WorldEvent::Found) {
            let language = visits.host.language(world.visit());
            self.panels.show_found(language, world.mode());
        }
        if world.events().iter().any(is_new_visit) {
            self.hands.drop_input();
            self.hands.reset_eye_and_depths();
            self.panels.forget_visitor();
        }
        if world.events().iter().any(ends_work) {
            self.panels.close_help();
        }
        self.follow_guide();
    }

    /// Reports the guide steps that no tick detects: the tool is over the stone, the camera was turned.
    fn follow_guide(&mut self) {
        let is_over_stone = self.hands.next_bite().is_some()
            && !self.panels.wants_pointer()
            && !self.is_cursor_on_visit_panel();
        let eye = self.hands.orbit.pose().1;
        let visit = self.studio.world().visit();
        let Some(visits) = &mut self.visits else { return };
        if is_over_stone {
            visits.host.note_step_done(visit, GuideStep::Touch);
        }
        if visits.look_around.is_done(visit.guide_step(), eye) {
            visits.host.note_step_done(visit, GuideStep::TurnStool);
        }
    }
}

/// Returns `true` if the event ends the visitor's work. The help is closed then: it would hide the badge, and
/// touch has no key to close it.
const fn ends_work(event: &WorldEvent) -> bool {
    matches!(event, WorldEvent::Visit(phase) if !is_at_work(*phase))
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use paros_core::visit::GuideStep::{Cut, TurnStool};

    use super::{LookAround, VisitPhase, WorldEvent, ends_work, is_at_rest};

    #[test]
    fn an_eye_has_looked_around_once_it_went_far_enough_since_it_was_asked_to() {
        let mut look = LookAround::default();
        let mut is_done = |step, [azimuth, elevation]: [f32; 2]| {
            let eye = Quat::from_rotation_y(azimuth) * Quat::from_rotation_x(elevation);
            look.is_done(step, eye)
        };
        assert!(!is_done(Cut, [0.0, 0.0]) && !is_done(Cut, [2.0, 0.0]), "not asked for");
        assert!(!is_done(TurnStool, [2.0, 0.0]), "from there on");
        assert!(!is_done(TurnStool, [2.1, 0.1]), "hardly another side");
        assert!(is_done(TurnStool, [1.5, 0.0]) && is_done(TurnStool, [2.0, 0.5]));
    }

    #[test]
    fn help_is_closed_once_the_tool_bar_with_its_button_goes() {
        use VisitPhase::{Badge, Choice, Guided, HandsOff, Sculpting, Welcome};
        let closes = [Welcome, Choice, Guided, Sculpting, HandsOff, Badge]
            .map(|phase| ends_work(&WorldEvent::Visit(phase)));
        assert_eq!(closes, [true, true, false, false, true, true]);
        assert!(!ends_work(&WorldEvent::Found));
    }

    #[test]
    fn a_mouse_may_rest_while_hands_are_off_and_a_badge_is_looked_at() {
        use VisitPhase::{Badge, Choice, Export, HandsOff, Sculpting, Thanks, Welcome};
        let phases = [Welcome, Choice, Sculpting, HandsOff, Export, Badge, Thanks];
        assert_eq!(phases.map(is_at_rest), [false, false, false, true, true, true, false]);
    }
}
