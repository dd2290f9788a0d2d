//! The visit's part of a tick: passes it the facts of the tick, and carries out its decisions.

use crate::edit::operation::EditReport;
use crate::session::events::WorldEvent;
use crate::session::input::SessionMode;
use crate::session::start_volumes::StartVolumes;
use crate::session::state::SessionState;
use crate::session::tools::BitAction;
use crate::session::world::World;
use crate::visit::{VisitDecision, VisitFacts, VisitInput, VisitPhase};
use crate::volume::size::{Grid, Size};

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Advances the visit by the facts of this tick, and starts or ends the session as it decides.
    pub(crate) fn advance_visit(
        &mut self,
        input: &VisitInput,
        last_stool: u16,
        starts: &StartVolumes<'_, N, K>,
    ) {
        // Most worlds have no visits, so the common case is kept fast.
        let is_held = self.state.visit.phase() != VisitPhase::Closed;
        let facts = if is_held { self.tell_visit(last_stool) } else { VisitFacts::default() };
        let VisitDecision { start, finishes, puts_back, enters, warns } =
            self.state.visit.step(input, &facts);
        if let Some(seconds) = warns {
            self.push_event(WorldEvent::TimeLeft { seconds });
        }
        if let Some(phase) = enters {
            self.push_event(WorldEvent::Visit(phase));
        }
        if puts_back {
            (0..2).for_each(|hand| self.return_tool(hand));
        }
        if finishes && self.state.session == SessionState::Sculpting {
            self.finish_session();
        }
        if start != SessionMode::None {
            self.start_session(start, starts);
        }
    }

    /// Returns the facts of this tick that matter to a visit.
    fn tell_visit(&self, last_stool: u16) -> VisitFacts {
        let edits = |action: fn(BitAction) -> bool| {
            self.events.iter().any(|event| match event {
                WorldEvent::Edited { bit, report, .. } => {
                    report.changed_volume() && action(bit.spec().action)
                }
                _ => false,
            })
        };
        let touches = |hand: usize| self.has_contact[hand] && self.contacts[hand].overlap > 0;
        let removes = |report: &EditReport| report.removed > 0;
        VisitFacts {
            holds_tool: (0..2).any(|hand| self.held_tool(hand).is_some()),
            touches: (0..2).any(touches),
            cuts: edits(|action| action == BitAction::Carve)
                && (0..2).any(|hand| removes(&self.edit_report(hand))),
            edits: edits(|_| true),
            smooths: edits(|action| matches!(action, BitAction::Smooth | BitAction::Flatten)),
            undoes: self.events.contains(&WorldEvent::Undone),
            turns_stool: self.state.stool != last_stool,
            is_settled: self.is_settled(),
        }
    }
}
