//! Runs sessions of a world and its model side by side, and records them as traces.

use std::panic::{AssertUnwindSafe, catch_unwind};

use paros_core::internals::IslandSearch;
use paros_core::limits::max_island_row_visits_per_tick;
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, Volume, World, WorldEvent};

use crate::dense::MaskedVolume;
use crate::step::comparison::WorldComparison;
use crate::step::ensure;
use crate::step::islands::{LONGEST_WAIT, LONGEST_WAIT_BESIDE_MASK};
use crate::step::plan::{InputWriter, Phase, PhaseEvent, SessionPlan};
use crate::step::trace::{StepTrace, TraceEvent};
use crate::world_harness::WorldHarness;

/// Two worlds, one of which continues after the other is saved, and the memory for measuring how long a pass
/// takes. Meant for statics.
#[derive(Debug)]
pub struct StepHarness<const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    worlds: [WorldHarness<N, K>; 2],
    spare: Volume<N, K>,
    search: IslandSearch<N>,
}

/// A failed session.
#[derive(Clone, Debug)]
pub struct StepFailure {
    /// The difference.
    pub message: String,
    /// The trace of the session, ending with the failed tick.
    pub trace: StepTrace,
}

/// Counts of what happened in a session, because a session that does little proves nothing.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct SessionTally {
    /// Number of ticks.
    pub ticks: u32,
    /// Edits that changed the volume.
    pub edits: u32,
    /// Edits that only added voxels.
    pub fills: u32,
    /// Edits partly refused by closure or the mask.
    pub refusals: u32,
    /// Passes that removed voxels.
    pub removals: u32,
    /// Passes that were reported.
    pub passes: u32,
    /// Strokes undone or redone.
    pub rewinds: u32,
    /// Loads into another world.
    pub loads: u32,
    /// Ticks in which both hands edited.
    pub both: u32,
    /// Swaps of the hands.
    pub swaps: u32,
    /// Ticks in which the stool turned while a hand held it.
    pub rim_turns: u32,
    /// The longest wait for the end of a pass, in ticks.
    pub longest_wait: u64,
}

/// A session in progress.
struct Session<'a, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    harness: &'a mut StepHarness<N, K>,
    comparison: WorldComparison<N, K>,
    /// The index of the current world.
    current: usize,
    tally: SessionTally,
    trace: StepTrace,
}

impl<const N: usize, const K: usize> StepHarness<N, K>
where
    Grid<N>: Size,
{
    /// Creates the harness; `const` for statics.
    #[allow(clippy::new_without_default)] // a Default would hand the worlds about by value
    pub const fn new() -> Self {
        StepHarness {
            worlds: [const { WorldHarness::new() }; 2],
            spare: Volume::new(),
            search: IslandSearch::new(),
        }
    }

    /// Runs a plan and returns its counts.
    ///
    /// # Errors
    /// World and model differ, or the world panics.
    pub fn run_plan(&mut self, plan: &SessionPlan) -> Result<SessionTally, Box<StepFailure>> {
        self.run_plan_traced(plan).map(|(tally, _)| tally)
    }

    /// Runs a plan. Returns its counts and its trace.
    ///
    /// # Errors
    /// World and model differ, or the world panics.
    pub fn run_plan_traced(
        &mut self,
        plan: &SessionPlan,
    ) -> Result<(SessionTally, StepTrace), Box<StepFailure>> {
        self.run(&plan.start, |session| {
            let mut writer = InputWriter::above(N);
            plan.phases.iter().try_for_each(|phase| session.run_phase(&mut writer, phase))
        })
    }

    /// Replays a trace.
    ///
    /// # Errors
    /// World and model differ, or the world panics.
    pub fn run_trace(&mut self, trace: &StepTrace) -> Result<SessionTally, Box<StepFailure>> {
        let start = MaskedVolume { volume: trace.volume.clone(), mask: trace.mask.clone() };
        let run = |session: &mut Session<'_, N, K>| {
            trace.events.iter().try_for_each(|event| session.run_event(event))
        };
        self.run(&start, run).map(|(tally, _)| tally)
    }

    fn run(
        &mut self,
        start: &MaskedVolume,
        run: impl FnOnce(&mut Session<'_, N, K>) -> Result<(), String>,
    ) -> Result<(SessionTally, StepTrace), Box<StepFailure>> {
        for world in &mut self.worlds {
            world.reset_to_voxels(&start.volume, &start.mask);
        }
        let mut session = Session {
            harness: self,
            comparison: WorldComparison::of_cleared_world(),
            current: 0,
            tally: SessionTally::default(),
            trace: StepTrace::from_start(start, K),
        };
        let message = match catch_unwind(AssertUnwindSafe(|| run(&mut session))) {
            Ok(Ok(())) => return Ok((session.tally, session.trace)),
            Ok(Err(message)) => message,
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or(panic.downcast_ref::<&str>().copied());
                format!("panicked: {}", text.unwrap_or("with no text"))
            }
        };
        Err(Box::new(StepFailure { message, trace: session.trace }))
    }
}

impl<const N: usize, const K: usize> Session<'_, N, K>
where
    Grid<N>: Size,
{
    fn world(&self) -> &World<N, K> {
        &self.harness.worlds[self.current].world
    }

    fn run_phase(&mut self, writer: &mut InputWriter, phase: &Phase) -> Result<(), String> {
        if let PhaseEvent::Reload = phase.event {
            self.run_event(&TraceEvent::Reload)?;
        }
        (0..phase.ticks).try_for_each(|i| {
            let input = writer.input(phase, i, self.world());
            self.run_event(&TraceEvent::Tick(input))
        })
    }

    fn run_event(&mut self, event: &TraceEvent) -> Result<(), String> {
        self.trace.events.push(*event);
        match event {
            TraceEvent::Tick(input) => self.run_tick(input),
            TraceEvent::Reload if self.tally.ticks > 0 => self.reload(),
            TraceEvent::Reload => Ok(()),
        }
    }

    fn run_tick(&mut self, input: &TickInput) -> Result<(), String> {
        let comparison = &mut self.comparison;
        let stool = comparison.model.stool;
        self.harness.worlds[self.current]
            .step_then(input, |world, starts| comparison.follow_tick(world, input, starts))
            .map_err(|message| format!("tick {}: {message}", self.tally.ticks))?;
        let model = &self.comparison.model;
        self.tally.count(&model.events);
        let is_held = model.hands.iter().any(|hand| hand.holds_stool);
        self.tally.rim_turns += u32::from(is_held && model.stool != stool);
        self.check_wait()
    }

    /// Loads the last tick's save into the other world.
    fn reload(&mut self) -> Result<(), String> {
        self.current = 1 - self.current;
        self.tally.loads += 1;
        let world = &mut self.harness.worlds[self.current].world;
        let loaded = world.load(self.comparison.last_save());
        loaded.map_err(|bad| format!("a save isn't loaded: {bad:?}"))?;
        self.comparison.follow_load(world)
    }

    /// Checks that no pass waits longer than allowed: the longest wait of a pass of one tick, times the ticks
    /// that a pass over the present volume needs if nothing else is done.
    fn check_wait(&mut self) -> Result<(), String> {
        let model = &self.comparison.model;
        let is_held = model.history.counts().redoable > 0;
        let Some(waited) = model.islands.waited(model.tick, is_held) else { return Ok(()) };
        self.tally.longest_wait = self.tally.longest_wait.max(waited);
        let is_masked = !model.mask.voxels().is_empty();
        let longest = if is_masked { LONGEST_WAIT_BESIDE_MASK } else { LONGEST_WAIT };
        if waited <= longest {
            return Ok(());
        }
        let StepHarness { worlds, spare, search } = &mut *self.harness;
        let world = &worlds[self.current].world;
        spare.set_maps(world.volume().maps());
        search.reset();
        search.request_pass();
        let visits = max_island_row_visits_per_tick(N);
        let ticks =
            (1..).find(|_| search.advance_pass(spare, world.mask(), visits, &mut ()).is_some());
        let longest = longest * ticks.unwrap_or(1);
        ensure!(waited <= longest, "a pass has waited for {waited} ticks, {longest} at most");
        Ok(())
    }
}

impl SessionTally {
    /// Returns the sums of two sessions' counts.
    pub fn sum_with(self, other: SessionTally) -> SessionTally {
        SessionTally {
            ticks: self.ticks + other.ticks,
            edits: self.edits + other.edits,
            fills: self.fills + other.fills,
            refusals: self.refusals + other.refusals,
            removals: self.removals + other.removals,
            passes: self.passes + other.passes,
            rewinds: self.rewinds + other.rewinds,
            loads: self.loads + other.loads,
            both: self.both + other.both,
            swaps: self.swaps + other.swaps,
            rim_turns: self.rim_turns + other.rim_turns,
            longest_wait: self.longest_wait.max(other.longest_wait),
        }
    }

    fn count(&mut self, events: &[WorldEvent]) {
        self.ticks += 1;
        let mut hands = 0;
        for event in events {
            match event {
                WorldEvent::Edited { report, .. } => {
                    let refused = report.refused_by_closure + report.refused_by_mask > 0;
                    self.refusals += u32::from(refused);
                    self.edits += u32::from(report.changed_volume());
                    self.fills += u32::from(report.added > 0 && report.removed == 0);
                    hands += u32::from(report.changed_volume());
                }
                WorldEvent::Islands(report) => {
                    self.passes += 1;
                    self.removals += u32::from(report.removed > 0);
                }
                WorldEvent::Undone | WorldEvent::Redone => self.rewinds += 1,
                WorldEvent::HandsSwapped => self.swaps += 1,
                _ => {}
            }
        }
        self.both += u32::from(hands == 2);
    }
}
