//! Loss of the booth, and its restore from a backup.

use std::collections::BTreeSet;

use paros_booth_rules::Deletion;
use paros_protocol::{SculptureId, UploadFacts, UploadStatus};
use paros_upload::CONFIRM_MS;

use crate::exhibition::Exhibition;
use crate::network::Weather;
use crate::truth::number_of_facts;

/// Seconds within which a headset that reaches the booth has asked about everything that it sent.
/// Confirmations are sent at [`CONFIRM_MS`], and heartbeats may have been far between.
const SECONDS_UNTIL_ASKED: u64 = CONFIRM_MS / 1000 + 40;

impl Exhibition {
    /// Backs the booth up, or restores it. Does nothing once a thief has taken an id: a restored booth that
    /// forgot the thief may accept both sculptures, which only the simulation could detect.
    pub(crate) fn back_up_or_restore(&mut self) {
        if self.truth.stolen > 0 {
            return;
        }
        let now = self.booth_time();
        match self.backup.take().filter(|_| self.dice.one_in(2)) {
            None => self.backup = Some(self.booth.back_up(now)),
            Some(backup) => {
                let all_hear = self.dice.one_in(2);
                if all_hear {
                    self.let_all_hear();
                }
                self.note(&format!("the booth comes back from a backup: {all_hear}"));
                // Drops the messages of the lost booth's connections.
                self.on_its_way.clear();
                let deletions = self.booth.restore(backup, now);
                self.take_back_what_is_lost(&deletions, all_hear);
                if all_hear {
                    (0..SECONDS_UNTIL_ASKED).for_each(|_| self.turn(1000));
                }
            }
        }
    }

    /// Powers all headsets up and gives them a perfect network.
    fn let_all_hear(&mut self) {
        self.weather = Weather::FINE;
        for h in 0..self.headsets.len() {
            self.headsets[h].disk.borrow_mut().mend();
            self.headsets[h].see_whether_it_is_dead();
            self.power_up(h);
        }
        // Headsets finish freeing disk space before the expected results are computed.
        self.turn(1000);
        for h in 0..self.headsets.len() {
            self.step(h);
        }
    }

    /// Updates the ground truth after a restore: sculptures accepted since the backup are lost, unless a
    /// headset still has them and reaches the booth within the grace period.
    fn take_back_what_is_lost(&mut self, deletions: &[Deletion], all_hear: bool) {
        self.truth.restores += 1;
        let (sculptures, tombstones) = self.booth.list_all();
        let numbers: BTreeSet<usize> = sculptures
            .iter()
            .filter_map(|kept| UploadFacts::from_json(&kept.facts).ok())
            .map(|facts| number_of_facts(&facts))
            .collect();
        for number in 0..self.truth.made.len() {
            let made = &mut self.truth.made[number];
            let headset = &self.headsets[made.headset];
            made.was_deleted |= deletions
                .iter()
                .any(|deletion| deletion.id == made.id && deletion.headset == headset.number);
            let is_known = made.was_deleted || numbers.contains(&number);
            if is_known || !(made.was_signed || made.was_kept_here) {
                continue;
            }
            // Only the running program knows about changes that it made before its power failed.
            let entry = headset.sender.as_ref().and_then(|sender| sender.spool().find(made.id));
            if !made.was_signed && entry.is_some_and(|entry| entry.status != UploadStatus::Sent) {
                continue;
            }
            made.was_signed = false;
            let grace_seconds = u64::from(self.grace_seconds);
            let sent = headset.sender.as_ref().and_then(|sender| sender.sent_seconds(made.id));
            let is_here = |seconds: u64| seconds + SECONDS_UNTIL_ASKED < grace_seconds;
            let is_to_return = all_hear && sent.is_some_and(is_here);
            if is_to_return && !made.is_excused {
                self.truth.to_return += 1;
            } else {
                made.is_excused = true;
            }
        }
        let settled = sculptures.iter().map(|kept| (kept.headset, kept.id));
        let settled = settled.chain(tombstones.iter().map(|gone| (gone.headset, gone.id)));
        let known: BTreeSet<(u32, SculptureId)> = settled
            .chain(self.booth.list_missing())
            .map(|(headset, id)| (headset, SculptureId(id)))
            .collect();
        self.truth.noted.retain(|noted| known.contains(noted));
    }
}
