//! What a tick does, part by part, in the order in which [`World::step`] calls it.

use crate::contact::{Frozen, Obstacle};
use crate::dirty::Dirty;
use crate::edit::{Edit, EditReport, Operation, apply};
use crate::events::Event;
use crate::hand::{Did, haptic_level};
use crate::input::{Input, Mode, Pointer, TICK_RATE, buttons, commands};
use crate::islands::Islands;
use crate::limits::row_visits;
use crate::maps::{Axis, Column};
use crate::pose::Pose;
use crate::size::{Grid, Size};
use crate::state::State;
use crate::tools::{Action, Bit};
use crate::undo::Undo;
use crate::volume::{Journal, Volume};
use crate::workbench::Item;
use crate::world::{Session, Starts, World};

impl<const N: usize> World<N>
where
    Grid<N>: Size,
{
    /// Starts a session, if its volume exists.
    pub(crate) fn start(&mut self, mode: Mode, starts: &Starts<'_, N>) {
        let volume = match mode {
            Mode::None => None,
            Mode::FreeForm => Some(starts.lump),
            Mode::Constrained { figure } => {
                starts.figures.get(usize::from(figure)).map(|_| starts.lump)
            }
            Mode::Creative => Some(starts.creative),
            Mode::Own => starts.own,
        };
        let Some(volume) = volume else {
            self.note(Event::NoSuchStart);
            return;
        };
        self.volume.set_maps(volume);
        self.mask.clear();
        let (tick, head) = (self.state.tick, self.state.head);
        self.state = State { tick, head, mode, session: Session::Sculpting, ..State::new() };
        if let Mode::Constrained { figure } = mode {
            self.mask.copy_from(starts.figures[usize::from(figure)]);
            self.state.masked = !self.mask.is_empty();
            self.state.mask_digest = crate::volume::maps_digest(&self.mask);
        }
        self.state.bench.tidy();
        self.undo.clear();
        self.islands.clear();
        self.dirty.note_all(N);
        self.note(Event::Started(mode));
    }

    /// A stick to the side turns the stool by up to a quarter turn a second.
    pub(crate) fn turn_stool(&mut self, input: &Input) {
        let mut turn = 0i32;
        for (hand, state) in input.hands.iter().zip(&self.state.hands) {
            let push = i32::from(hand.stick[0]);
            if state.tracked && push.abs() > 30 {
                turn += push * (65_536 / 4) / (127 * TICK_RATE as i32);
            }
        }
        if let Pointer::Turn { by } = input.pointer {
            turn += i32::from(by);
        }
        self.state.stool = self.state.stool.wrapping_add(turn as u16);
    }

    /// What is asked for; whether the volume was rewound.
    pub(crate) fn command(&mut self, input: &Input, did: [Did; 2]) -> bool {
        let pressed = did[0].pressed | did[1].pressed;
        let asked =
            |command: u8, button: u8| input.commands & command != 0 || pressed & button != 0;
        let undo = asked(commands::UNDO, buttons::LOWER);
        let redo = asked(commands::REDO, buttons::UPPER);
        // Both at once are neither.
        let rewound = match (undo, redo) {
            (true, false) => self.rewind(Event::Undone, Undo::undo),
            (false, true) => self.rewind(Event::Redone, Undo::redo),
            _ => false,
        };
        if asked(commands::SYMMETRY, buttons::STICK) {
            self.state.symmetry = !self.state.symmetry;
            self.note(Event::Symmetry(self.state.symmetry));
        }
        if input.commands & commands::FINISH != 0 {
            self.state.session = Session::Finished;
            self.islands.abort();
            self.note(Event::Finished);
        }
        rewound
    }

    /// Undo and redo abort the pass in flight and start none.
    fn rewind(
        &mut self,
        event: Event,
        go: fn(&mut Undo<N>, &mut Volume<N>, &mut Dirty) -> bool,
    ) -> bool {
        let rewound = go(&mut self.undo, &mut self.volume, &mut self.dirty);
        if rewound {
            self.islands.abort();
            self.note(event);
        }
        rewound
    }

    pub(crate) fn point(&mut self, pointer: Pointer) {
        match pointer {
            Pointer::Take { hand, item } => {
                if let Some(item) = Item::from_number(item.into()) {
                    self.take(usize::from(hand & 1), item);
                }
            }
            Pointer::Return { hand } => {
                let hand = usize::from(hand & 1);
                if let Some(tool) = self.state.bench.put_back(hand) {
                    self.state.hands[hand].forget_bit();
                    self.note(Event::Returned { hand: hand as u8, tool });
                }
            }
            Pointer::None | Pointer::Turn { .. } => {}
        }
    }

    /// A squeeze takes what is in reach, or lets go of what the hand holds.
    pub(crate) fn reach(&mut self, hand: usize, did: Did) {
        if !did.squeezed {
            return;
        }
        let state = self.state.hands[hand];
        let tip = self.state.bench.held(hand).map(|tool| state.tip(metres(tool.length())).0);
        let tip = tip.unwrap_or(state.grip.0);
        if let Some(item) = self.state.bench.within_reach(hand, state.grip.0, tip) {
            self.take(hand, item);
        } else if let Some(tool) = self.state.bench.release(hand, state.grip.0, state.grip.1) {
            self.state.hands[hand].forget_bit();
            self.note(Event::Released { hand: hand as u8, tool });
        }
    }

    fn take(&mut self, hand: usize, item: Item) {
        let other = self.state.bench.held(1 - hand);
        if self.state.bench.take(hand, item) {
            self.state.hands[hand].forget_bit();
            if self.state.bench.held(1 - hand) != other {
                self.state.hands[1 - hand].forget_bit();
            }
            self.note(Event::Took { hand: hand as u8, item });
        }
    }

    /// Contact, and the edit where the tool runs.
    /// Moves the held tool by so many steps of its bit at the most, and edits with it; returns the steps
    /// that it took and the pieces of the brush that it drew, which cost as much.
    pub(crate) fn sculpt(&mut self, hand: usize, did: Did, most: u32) -> u32 {
        let Some((tool, bit)) = self.held(hand) else {
            return 0;
        };
        let mut state = self.state.hands[hand];
        if !state.tracked || self.state.session != Session::Sculpting {
            return 0;
        }
        let frame = self.frame();
        let grid_bit = bit.on_grid(frame.voxel() * 1e6);
        let (position, rotation) = state.tip(metres(tool.length()));
        let raw = frame.to_grid(position, rotation);
        let last = if state.bound { state.frozen } else { raw };
        let mask = self.state.masked.then_some(&self.mask);
        let obstacle = Obstacle { rows: self.volume.rows(), mask };
        let Frozen { pose: frozen, steps, .. } = obstacle.freeze(&grid_bit, &last, &raw, most);
        let contact = obstacle.contact(&grid_bit, &frozen);
        let moved = if state.bound { (raw.position - state.raw.position).length() } else { 0.0 };
        let speed = (moved * frame.voxel() * 1e6).min(1e6) as u32;
        state.haptic = haptic_level(bit.data(), &contact, state.trigger, state.phase, speed);
        let from = if state.sweeps { last } else { frozen };
        let new_bit = !state.bound;
        (state.raw, state.frozen) = (raw, frozen);
        (state.sweeps, state.bound) = (true, true);
        self.state.hands[hand] = state;
        self.contacts[hand] = contact;
        self.felt[hand] = true;
        if did.pulled || state.trigger && new_bit {
            self.undo.begin_stroke();
        }
        if state.trigger && state.phase.is_multiple_of(u16::from(bit.data().period)) {
            return steps + self.edit(hand, bit, &from, &frozen);
        }
        steps
    }

    fn edit(&mut self, hand: usize, bit: Bit, from: &Pose, to: &Pose) -> u32 {
        let grid_bit = bit.on_grid(self.frame().voxel() * 1e6);
        let depth = grid_bit.depth();
        let operation = match bit.data().action {
            Action::Carve => Operation::Carve { depth },
            Action::Fill => Operation::Fill { depth },
            Action::Smooth => Operation::Smooth,
        };
        let mirrored = self.state.symmetry;
        let mut log =
            Log { undo: &mut self.undo, dirty: &mut self.dirty, islands: &mut self.islands };
        let mut go = |brush| {
            let edit = Edit { brush: &brush, operation, mirrored };
            apply(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut log)
        };
        // A rasp that flies farther than the scratch remembers smooths where it lands.
        let brush = grid_bit.swept_brush(from, to);
        let pieces = brush.pieces().len() as u32;
        let report = go(brush).or_else(|_| go(grid_bit.piece(to).into())).unwrap_or_default();
        self.dirty.close();
        if report.changed() {
            self.islands.edited();
        }
        if report != EditReport::default() {
            self.note(Event::Edited { hand: hand as u8, bit, report });
        }
        pieces
    }

    pub(crate) fn clear_islands(&mut self) {
        let mut record = Record { undo: &mut self.undo, dirty: &mut self.dirty };
        let report = self.islands.advance(&mut self.volume, &self.mask, row_visits(N), &mut record);
        self.dirty.close();
        if let Some(report) = report
            && (report.removed != 0 || report.kept != 0 || report.unsupported)
        {
            self.note(Event::Islands(report));
        }
    }

    /// More events than there is room for are dropped: they are for show, the state has it all.
    fn note(&mut self, event: Event) {
        let _ = self.events.push(event);
    }
}

/// Hears of an island's removal.
#[derive(Debug)]
pub struct Record<'a, const N: usize>
where
    Grid<N>: Size,
{
    /// Its newest entry takes the removal in.
    pub undo: &'a mut Undo<N>,
    /// Is told the columns.
    pub dirty: &'a mut Dirty,
}

/// Hears of an edit: the pass in flight must learn what is added.
#[derive(Debug)]
pub struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    /// Records the stroke.
    pub undo: &'a mut Undo<N>,
    /// Is told the columns.
    pub dirty: &'a mut Dirty,
    /// Are told the voxels.
    pub islands: &'a mut Islands<N>,
}

impl<const N: usize> Journal<N> for Record<'_, N>
where
    Grid<N>: Size,
{
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        self.undo.amend(axis, line, places, old);
        self.dirty.note_line(axis, line, places);
    }

    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        self.undo.record(axis, line, places, old);
        self.dirty.note_line(axis, line, places);
    }

    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.islands.added(row, voxels);
    }
}

fn metres(micrometres: i32) -> f32 {
    micrometres as f32 * 1e-6
}
