//! Model of the bared share of a hidden figure, recounted in each tick.

use paros_core::WorldEvent;
use paros_core::session::BaredEnds;
use paros_core::volume::{Axis, Column};

use super::StepModel;
use super::volume::StepVolume;

impl<const K: usize> StepModel<K> {
    /// Returns the number of ends of the figure's columns, and how many of them are also ends of the stone:
    /// each column of each axis by its own list of ends.
    pub fn bared_ends(&self) -> BaredEnds {
        let mut ends = BaredEnds { bared: 0, all: 0 };
        if self.counted_axes < 3 {
            return ends;
        }
        let side = self.side();
        for axis in Axis::ALL {
            for at in 0..side * side {
                if self.mask.columns()[axis as usize][at] == Column::EMPTY {
                    continue;
                }
                let ends_of = |volume: &StepVolume<K>| {
                    let column = volume.columns()[axis as usize][at];
                    let ends = column
                        .intervals()
                        .flat_map(|range| [(range.first(), -1), (range.last(), 1)]);
                    ends.filter(|end| (axis, *end) != (Axis::Y, (0, -1))).collect::<Vec<_>>()
                };
                let (figure, stone) = (ends_of(&self.mask), ends_of(&self.volume));
                ends.all += figure.len() as u32;
                ends.bared += figure.iter().filter(|end| stone.contains(end)).count() as u32;
            }
        }
        ends
    }

    /// Counts the next axis of a figure. Returns `true` if there was one. Ends that are already bared when
    /// all axes are counted were bared from the start.
    pub(super) fn count_next_axis(&mut self) -> bool {
        let counts = !self.mask.voxels().is_empty() && self.counted_axes < 3;
        if counts {
            self.counted_axes += 1;
            self.told = self.part_to_tell();
        }
        counts
    }

    /// Returns the bared share in the encoding of a save.
    pub(super) fn part_to_tell(&self) -> u8 {
        let BaredEnds { bared, all } = self.bared_ends();
        match bared * 100 {
            _ if all == 0 => 0,
            times_hundred if times_hundred == all * 100 => 11,
            times_hundred if times_hundred >= all * 95 => 10,
            times_hundred => (times_hundred / (all * 10)) as u8,
        }
    }

    /// Reports a newly bared tenth, and that the figure is found.
    pub(super) fn tell_bared_part(&mut self) {
        let (before, now) = (self.told, self.part_to_tell());
        // A figure counts as found at nine tenths.
        let tenths = |told: u8| if told < 10 { told } else { told - 1 };
        if tenths(now) > tenths(before) {
            self.events.push(WorldEvent::Bared { tenths: tenths(now) });
        }
        if now >= 10 && before < 10 {
            self.events.push(WorldEvent::Found);
        }
        self.told = before.max(now);
    }
}
