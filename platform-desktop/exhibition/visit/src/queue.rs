//! The queue of commands for the core, which takes one in each tick.

use std::collections::VecDeque;

use paros_core::visit::{VisitCommand, VisitPlan};
use paros_shell::settings::plan_changes;

/// Largest number of waiting commands: a plan, and what a visitor can press in as many ticks.
const LIMIT: usize = 64;

/// Commands that wait to be sent, one in each tick.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub(crate) struct VisitQueue {
    waiting: VecDeque<VisitCommand>,
}

impl VisitQueue {
    /// Adds a command. Drops it if too many are waiting.
    pub(crate) fn push(&mut self, command: VisitCommand) {
        if self.waiting.len() < LIMIT {
            self.waiting.push_back(command);
        }
    }

    /// Starts visits with a plan. Drops waiting commands of earlier visits.
    pub(crate) fn open(&mut self, plan: &VisitPlan) {
        self.waiting.clear();
        self.push(VisitCommand::Open);
        plan_changes(&VisitPlan::new(), plan).for_each(|command| self.push(command));
    }

    /// Returns `true` if this command is waiting.
    pub(crate) fn contains(&self, command: &VisitCommand) -> bool {
        self.waiting.contains(command)
    }

    /// Takes the command of the next tick.
    pub(crate) fn take(&mut self) -> VisitCommand {
        self.waiting.pop_front().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use paros_core::visit::{PanelAction, PlanSetting, StaffCommand, VisitCommand, VisitPlan};

    use super::{LIMIT, VisitQueue};

    #[test]
    fn commands_come_one_by_one_in_their_order() {
        let mut queue = VisitQueue::default();
        queue.push(VisitCommand::Press(PanelAction::Confirm));
        let set = VisitCommand::Set { setting: PlanSetting::Length, value: 7 };
        let mut plan = VisitPlan::new();
        plan.set_value(PlanSetting::Length, 7);
        queue.open(&plan);
        queue.push(VisitCommand::Exported);
        assert!(queue.contains(&VisitCommand::Exported));
        let taken = [0; 4].map(|_| queue.take());
        assert_eq!(taken, [VisitCommand::Open, set, VisitCommand::Exported, VisitCommand::None]);
    }

    #[test]
    fn who_presses_everything_fills_no_memory() {
        let mut queue = VisitQueue::default();
        (0..10 * LIMIT).for_each(|_| queue.push(VisitCommand::Staff(StaffCommand::Extend)));
        let count = std::iter::repeat_with(|| queue.take());
        assert_eq!(count.take_while(|command| *command != VisitCommand::None).count(), LIMIT);
    }
}
