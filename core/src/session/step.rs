//! The parts of a tick, in the order in which [`World::step`] calls them.

use crate::limits::{MAX_STRING_MM, bared_count_work};
use crate::session::bared::{BaredEnds, BaringJournal, ToldPart};
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, HandState};
use crate::session::input::{PointerCommand, SessionMode, TICK_RATE, TickInput, buttons, commands};
use crate::session::journals::RemovalJournal;
use crate::session::start_volumes::StartVolumes;
use crate::session::state::{SessionState, WorldState};
use crate::session::workbench::BenchItem;
use crate::session::world::World;
use crate::volume::column_digest::copy_and_digest_maps;
use crate::volume::range_maps::Axis;
use crate::volume::size::{Grid, Size};

/// Maximum speed at which a stick or a hand turns the stool, in 65,536ths of a turn a second: a quarter turn.
const STOOL_SPEED: i32 = 65_536 / 4;

/// The effects of a tick's commands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct CommandEffects {
    /// The number of columns that undo or redo swapped.
    pub(crate) rewound_columns: u32,
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Starts a session in this mode and resets everything except tick, head and visit. Without a start
    /// volume for the mode, only reports [`WorldEvent::NoSuchStart`]. Returns `true` if the session started.
    pub(crate) fn start_session(
        &mut self,
        mode: SessionMode,
        starts: &StartVolumes<'_, N, K>,
    ) -> bool {
        let volume = match mode {
            SessionMode::None => None,
            SessionMode::FreeForm => Some(starts.lump),
            SessionMode::Constrained { figure } => {
                starts.figures.get(usize::from(figure)).map(|hidden| hidden.stone)
            }
            SessionMode::Creative => Some(starts.creative),
            SessionMode::Own => starts.own,
        };
        let Some(volume) = volume else {
            self.push_event(WorldEvent::NoSuchStart);
            return false;
        };
        self.volume.set_maps(volume);
        let WorldState { tick, head, visit, .. } = self.state;
        let session = SessionState::Sculpting;
        self.state = WorldState { tick, head, visit, mode, session, ..WorldState::new() };
        if let SessionMode::Constrained { figure } = mode {
            let hidden = starts.figures[usize::from(figure)].figure;
            self.state.mask_digest = copy_and_digest_maps(hidden, &mut self.mask);
            self.state.masked = !self.mask.is_empty();
        } else {
            self.mask.clear();
        }
        self.bared = BaredEnds::NONE;
        self.state.bench.reset_items();
        self.undo.clear();
        self.islands.reset();
        self.dirty.mark_all(N);
        self.push_event(WorldEvent::Started(mode));
        true
    }

    /// Turns the stool: by the sticks, up to a quarter turn a second each; by hands that hold its rim, with
    /// the same limit for both together; and by the pointer.
    pub(crate) fn turn_stool(&mut self, input: &TickInput, presses: [HandPresses; 2]) {
        let mut turn = 0i32;
        for (hand, state) in input.hands.iter().zip(&self.state.hands) {
            let push = i32::from(hand.stick[0]);
            if state.tracked && push.abs() > 30 {
                turn += push * STOOL_SPEED / (127 * TICK_RATE as i32);
            }
        }
        // Two hands on one rim turn it by the mean of their movements.
        let holding = self.state.hands.iter().filter(|hand| hand.holds_stool).count() as i32;
        let by_rim: i32 = presses.iter().map(|presses| presses.rim_turn).sum();
        let most = STOOL_SPEED / TICK_RATE as i32;
        turn += (by_rim / holding.max(1)).clamp(-most, most);
        if let PointerCommand::Turn { by } = input.pointer {
            turn += i32::from(by);
        }
        self.state.stool = self.state.stool.wrapping_add(turn as u16);
    }

    /// Runs the commands of shells and buttons: undo, redo, symmetry, swapped hands and finish. Undo and redo
    /// together cancel out.
    pub(crate) fn apply_commands(
        &mut self,
        input: &TickInput,
        presses: &mut [HandPresses; 2],
    ) -> CommandEffects {
        let pressed = presses[0].buttons | presses[1].buttons;
        let asked =
            |command: u8, button: u8| input.commands & command != 0 || pressed & button != 0;
        let undo = asked(commands::UNDO, buttons::LOWER);
        let redo = asked(commands::REDO, buttons::UPPER);
        if undo || redo || input.commands & commands::FINISH != 0 {
            self.state.hands.iter_mut().for_each(HandState::drop_trail);
        }
        let rewound = match (undo, redo) {
            (true, false) => self.try_undo_or_redo(WorldEvent::Undone),
            (false, true) => self.try_undo_or_redo(WorldEvent::Redone),
            _ => 0,
        };
        if asked(commands::SYMMETRY, buttons::STICK) {
            self.state.symmetry = !self.state.symmetry;
            self.push_event(WorldEvent::Symmetry(self.state.symmetry));
        }
        if input.commands & commands::SWAP_HANDS != 0 {
            self.swap_hands(presses);
        }
        if input.commands & commands::FINISH != 0 {
            self.finish_session();
        }
        CommandEffects { rewound_columns: rewound }
    }

    /// Makes the sculpture final.
    pub(crate) fn finish_session(&mut self) {
        self.state.session = SessionState::Finished;
        self.islands.cancel_passes();
        self.push_event(WorldEvent::Finished);
    }

    /// Undoes or redoes one stroke, which ends a running island pass and requests another. Returns the number
    /// of its columns, or 0 if there is no such stroke.
    fn try_undo_or_redo(&mut self, event: WorldEvent) -> u32 {
        let before = self.undo.undo_counts().undoable;
        let mut journal = BaringJournal {
            journal: &mut self.dirty,
            figure: &self.mask,
            counted_axes: self.state.counted_axes,
            ends: &mut self.bared,
        };
        let is_done = match event {
            WorldEvent::Undone => self.undo.try_undo(&mut self.volume, &mut journal),
            _ => self.undo.try_redo(&mut self.volume, &mut journal),
        };
        if !is_done {
            return 0;
        }
        self.islands.restart_pass();
        self.push_event(event);
        self.undo.count_columns_of(before.min(self.undo.undo_counts().undoable))
    }

    /// Takes or returns an item for a pointer, or steadies hands. [`World::turn_stool`] handles the pointer's
    /// turns, [`World::resize_bits`] its sizes.
    pub(crate) fn apply_pointer_command(&mut self, pointer: PointerCommand) {
        match pointer {
            PointerCommand::Take { hand, item } => {
                if let Some(item) = BenchItem::from_number(item.into()) {
                    self.take_item(usize::from(hand & 1), item);
                }
            }
            PointerCommand::Return { hand } => self.return_tool(usize::from(hand & 1)),
            PointerCommand::Steady { string_mm } => {
                self.state.string_mm = string_mm.min(MAX_STRING_MM);
            }
            PointerCommand::None | PointerCommand::Turn { .. } | PointerCommand::Resize { .. } => {}
        }
    }

    /// Puts the tool that a hand holds back on the bench.
    pub(crate) fn return_tool(&mut self, hand: usize) {
        if let Some(tool) = self.state.bench.return_tool_home(hand) {
            self.state.hands[hand].invalidate_bit_pose();
            self.push_event(WorldEvent::Returned { hand: hand as u8, tool });
        }
    }

    /// Resizes the bits in hands: by the sticks, and by the pointer. A bit isn't moved: a bit that grew into
    /// the stone cuts itself free, or is pulled out.
    pub(crate) fn resize_bits(&mut self, pointer: PointerCommand, presses: [HandPresses; 2]) {
        for (hand, presses) in presses.into_iter().enumerate() {
            let by_pointer = match pointer {
                PointerCommand::Resize { hand: of, by } if usize::from(of & 1) == hand => by,
                _ => 0,
            };
            let steps = i32::from(presses.resized_by) + i32::from(by_pointer);
            if let Some((_, bit)) = self.held_tool(hand) {
                self.state.bench.resize_bit(bit, steps);
            }
        }
    }

    /// Spends `row_visits` on the island search and reports a pass that removed or kept voxels.
    ///
    /// No pass begins while something can be redone, as a removal would drop it. A pass begins once nothing
    /// is left to redo, hands may no longer work, or after the next edit.
    pub(crate) fn advance_island_search(&mut self, row_visits: u32) {
        let may_redo = self.state.visit.phase().lets_hands_work();
        if self.islands.is_idle() && may_redo && self.undo.undo_counts().redoable > 0 {
            return;
        }
        let journal = RemovalJournal { undo: &mut self.undo, dirty: &mut self.dirty };
        let (figure, ends) = (&self.mask, &mut self.bared);
        let counted_axes = self.state.counted_axes;
        let mut journal = BaringJournal { journal, figure, counted_axes, ends };
        let report =
            self.islands.advance_pass(&mut self.volume, &self.mask, row_visits, &mut journal);
        self.dirty.end_edit();
        if let Some(report) = report
            && (report.removed != 0 || report.kept != 0 || report.unsupported)
        {
            self.push_event(WorldEvent::Islands(report));
        }
    }

    /// Counts the ends of the hidden figure along the next axis that isn't counted yet: counting all axes at
    /// once would exceed a tick's work. Returns the work done. Reports no events for the part that is bared
    /// at the start.
    pub(crate) fn count_next_axis(&mut self) -> u32 {
        let next = Axis::ALL.get(usize::from(self.state.counted_axes));
        let Some(axis) = next.filter(|_| self.state.masked) else {
            return 0;
        };
        self.bared.add_axis(*axis, &self.mask, self.volume.maps());
        self.state.counted_axes += 1;
        if self.is_figure_counted() {
            self.state.told = ToldPart::of(self.bared);
        }
        bared_count_work(N)
    }

    /// Counts the ends again along the axes that were counted.
    pub(crate) fn recount_bared_ends(&mut self) {
        self.bared = BaredEnds::NONE;
        for axis in Axis::ALL.into_iter().take(usize::from(self.state.counted_axes)) {
            self.bared.add_axis(axis, &self.mask, self.volume.maps());
        }
    }

    /// Returns `true` if the ends of all axes are counted.
    pub(crate) const fn is_figure_counted(&self) -> bool {
        self.state.counted_axes as usize == Axis::ALL.len()
    }

    /// Reports each newly bared tenth of the figure, and that it is found, once each.
    pub(crate) fn tell_bared_part(&mut self) {
        let (told, now) = (self.state.told, ToldPart::of(self.bared));
        if now <= told || !self.is_figure_counted() {
            return;
        }
        self.state.told = now;
        if now.tenths() > told.tenths() {
            self.push_event(WorldEvent::Bared { tenths: now.tenths() });
        }
        if now.is_found() && !told.is_found() {
            self.push_event(WorldEvent::Found);
        }
    }

    /// Reports an event. It is dropped if the list is full: events only inform, the state is complete without
    /// them.
    pub(super) fn push_event(&mut self, event: WorldEvent) {
        let _ = self.events.push(event);
    }
}

pub(super) fn metres_from_um(micrometres: i32) -> f32 {
    micrometres as f32 * 1e-6
}
