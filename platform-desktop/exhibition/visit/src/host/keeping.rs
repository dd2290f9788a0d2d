//! The export phase of a visit: the badge of the sculpture, and its storage.

use paros_core::badge::BadgeNumber;
use paros_core::session::TICK_RATE;
use paros_core::visit::{PlanSetting, Visit, VisitCommand};

use super::VisitHost;
use crate::export_state::ExportState;

/// Ticks to wait for a leased badge: more than a disk sync takes.
pub(super) const BADGE_TICKS: u32 = 3 * TICK_RATE;

/// Returns 32 random bits of the system. Without them badges repeat, as provisional badges may.
pub(super) fn random_bits_of_system() -> u32 {
    getrandom::u32().unwrap_or_default()
}

impl VisitHost {
    /// Sends the visit its badge, and reports once the sculpture is stored.
    pub(super) fn follow_export(&mut self, visit: &Visit, export: &ExportState) {
        let gives_badges = visit.plan().value(PlanSetting::Badges) != 0;
        let has_badge = !gives_badges || visit.badge().is_some() || self.has_sent_badge;
        if !has_badge && let Some(number) = self.choose_badge(visit, export) {
            self.has_sent_badge = true;
            self.queue.push(VisitCommand::Badge { number: number.get() });
        }
        // If there was nothing to print, nothing is kept or pending.
        let is_over = !export.is_busy && (export.is_kept || export.pending == 0);
        if is_over && has_badge && !self.has_sent_export {
            self.has_sent_export = true;
            self.queue.push(VisitCommand::Exported);
        }
    }

    /// Returns the leased badge, once it is there. Without a booth, or after a timeout, returns a provisional
    /// badge, which may repeat.
    fn choose_badge(&self, visit: &Visit, export: &ExportState) -> Option<BadgeNumber> {
        let leased = export.booth.map(|booth| booth.badge);
        let provisional = || BadgeNumber::provisional((self.random_bits)());
        match leased {
            None => Some(provisional()),
            Some(Some(number)) => Some(number),
            Some(None) => (visit.phase_ticks() >= BADGE_TICKS).then(provisional),
        }
    }
}
