//! Plans of sessions, which can be shrunk: each phase is some ticks in which each hand does one thing.

use std::ops::RangeInclusive;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::BENCH_ITEMS;
use paros_core::limits::FULL_TRIGGER;
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionMode, SessionState, buttons, commands,
};
use paros_core::visit::VisitInput;
use paros_core::volume::{BitSet, Grid, Size};
use paros_core::{HandInput, TickInput, World};
use proptest::prelude::*;

use crate::dense::MaskedVolume;
use crate::random_visitor::{RandomSource, arbitrary_input};
use crate::step::stool;

/// The plan of a session.
#[derive(Clone, Debug)]
pub struct SessionPlan {
    /// The volume and mask that it starts from.
    pub start: MaskedVolume,
    /// Its phases.
    pub phases: Vec<Phase>,
}

/// Some ticks of a plan.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Number of ticks, at least one.
    pub ticks: u8,
    /// The plan of each hand.
    pub hands: [HandPlan; 2],
    /// The additional event.
    pub event: PhaseEvent,
}

/// The plan of a hand in a phase.
#[derive(Clone, Copy, Debug)]
pub enum HandPlan {
    /// The hand doesn't move.
    Stay {
        /// `true` if it pulls the trigger.
        pulls: bool,
    },
    /// The hand moves at constant speed.
    Glide {
        /// The place that its bit would reach without obstacles.
        to: Place,
        /// `true` if it pulls the trigger.
        pulls: bool,
    },
    /// The hand moves at constant speed to a voxel at an end of a row of the present volume, with an offset
    /// in eighths of a voxel.
    Touch {
        /// The row: the first row with voxels from this number on.
        row: u16,
        /// `true` for the last voxel of the row, `false` for the first.
        is_last: bool,
        /// The offset in eighths of a voxel.
        aside: [i8; 3],
        /// `true` if it pulls the trigger.
        pulls: bool,
    },
    /// The hand jumps to a place and stays there.
    Jump {
        /// The place where its bit would be without obstacles.
        to: Place,
        /// `true` if it pulls the trigger.
        pulls: bool,
    },
    /// The hand isn't tracked, so its trigger is ignored.
    Lost,
    /// The hand pulls and releases alternately.
    Flutter,
    /// The hand is tracked with invalid poses, and pulls the trigger.
    Invalid,
}

/// A place in the grid: eighths of a voxel, and an unnormalised rotation.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// x, y, z.
    pub eighths: [i16; 3],
    /// x, y, z, w; all zeros stand for no rotation.
    pub turn: [i8; 4],
}

/// An event of a phase besides the hands' work.
#[derive(Clone, Debug)]
pub enum PhaseEvent {
    /// No event.
    Nothing,
    /// A pointer command in the first tick.
    Pointer(PointerCommand),
    /// Commands in the first tick.
    Commands(u8),
    /// Undo and redo, a tick each: two bits a tick, of [`commands::UNDO`] and [`commands::REDO`].
    Storm(u32),
    /// A hand presses buttons during the whole phase.
    Buttons(usize, u8),
    /// A hand squeezes at an item's home in the first tick.
    Squeeze(usize, u8),
    /// A squeezed hand moves round the stool's rim: 65,536ths of a turn a tick, and the height above it in
    /// centimetres.
    HoldStool(usize, i16, i8),
    /// A hand's stick turns the stool and resizes the bit during the whole phase.
    Stick(usize, [i8; 2]),
    /// A session starts.
    Start(SessionMode),
    /// The world is saved before the phase and loaded into another world, which continues.
    Reload,
    /// Arbitrary input.
    Wild(u64),
}

/// A strategy for sessions from these volumes in a grid of `side`^3 voxels, with a number of phases. Five
/// more phases before them start a session and put tools into both hands.
pub fn session_plans(
    start: impl Strategy<Value = MaskedVolume>,
    side: usize,
    phases: RangeInclusive<usize>,
) -> impl Strategy<Value = SessionPlan> {
    let modes = prop_oneof![
        2 => Just(SessionMode::FreeForm),
        3 => Just(SessionMode::Constrained { figure: 0 }),
        1 => Just(SessionMode::Own),
    ];
    let openings = (modes, 0..BENCH_ITEMS as u8, 0..BENCH_ITEMS as u8);
    let rest = proptest::collection::vec(any_phases(side), phases);
    (start, openings, rest).prop_map(|(start, (mode, left, right), rest)| {
        let mut phases = vec![Phase::of_event(PhaseEvent::Start(mode))];
        for (hand, item) in [(0, left), (1, right)] {
            phases.extend(take_with_its_tool(hand, item).map(Phase::of_event));
        }
        phases.extend(rest);
        SessionPlan { start, phases }
    })
}

/// A strategy for a phase.
pub fn any_phases(side: usize) -> impl Strategy<Value = Phase> {
    (1..14u8, [any_hand_plans(side), any_hand_plans(side)], any_events())
        .prop_map(|(ticks, hands, event)| Phase { ticks, hands, event })
}

fn any_hand_plans(side: usize) -> impl Strategy<Value = HandPlan> {
    let pulls = || prop_oneof![1 => Just(false), 3 => Just(true)];
    let aside = [-6..7i8, -6..7i8, -6..7i8];
    prop_oneof![
        1 => pulls().prop_map(|pulls| HandPlan::Stay { pulls }),
        9 => (any::<u16>(), any::<bool>(), aside, pulls()).prop_map(|(row, is_last, aside, pulls)| {
            HandPlan::Touch { row, is_last, aside, pulls }
        }),
        3 => (any_places(side), pulls()).prop_map(|(to, pulls)| HandPlan::Glide { to, pulls }),
        1 => (any_places(side), pulls()).prop_map(|(to, pulls)| HandPlan::Jump { to, pulls }),
        1 => Just(HandPlan::Lost),
        1 => Just(HandPlan::Flutter),
        1 => Just(HandPlan::Invalid),
    ]
}

/// A strategy for places in and around the grid, some far from it.
fn any_places(side: usize) -> impl Strategy<Value = Place> {
    let end = 8 * side as i16;
    let near = -16..end + 16;
    let eighths = prop_oneof![
        12 => [near.clone(), near.clone(), near],
        1 => [-4 * end..4 * end, -4 * end..4 * end, -4 * end..4 * end],
    ];
    let turn = prop_oneof![
        3 => Just([0; 4]),
        2 => [any::<i8>(), any::<i8>(), any::<i8>(), any::<i8>()],
    ];
    (eighths, turn).prop_map(|(eighths, turn)| Place { eighths, turn })
}

fn any_events() -> impl Strategy<Value = PhaseEvent> {
    let hand = || 0..2usize;
    let item = || 0..BENCH_ITEMS as u8 + 1;
    prop_oneof![
        30 => Just(PhaseEvent::Nothing),
        4 => (hand(), item()).prop_map(|(hand, item)| {
            PhaseEvent::Pointer(PointerCommand::Take { hand: hand as u8, item })
        }),
        1 => hand().prop_map(|hand| PhaseEvent::Pointer(PointerCommand::Return { hand: hand as u8 })),
        2 => any::<i16>().prop_map(|by| PhaseEvent::Pointer(PointerCommand::Turn { by })),
        2 => prop_oneof![Just(0u8), 1..30u8, any::<u8>()].prop_map(|string_mm| {
            PhaseEvent::Pointer(PointerCommand::Steady { string_mm })
        }),
        5 => prop_oneof![Just(commands::UNDO), Just(commands::REDO), Just(commands::SYMMETRY)]
            .prop_map(PhaseEvent::Commands),
        3 => Just(PhaseEvent::Commands(commands::SWAP_HANDS)),
        1 => any::<u8>().prop_map(|all| PhaseEvent::Commands(all & !commands::FINISH)),
        2 => (hand(), -400..400i16, -16..16i8)
            .prop_map(|(hand, by, above)| PhaseEvent::HoldStool(hand, by, above)),
        3 => any::<u32>().prop_map(PhaseEvent::Storm),
        2 => (hand(), prop_oneof![Just(buttons::LOWER), Just(buttons::UPPER), Just(buttons::STICK)])
            .prop_map(|(hand, pressed)| PhaseEvent::Buttons(hand, pressed)),
        2 => (hand(), item()).prop_map(|(hand, item)| PhaseEvent::Squeeze(hand, item)),
        2 => (hand(), any::<[i8; 2]>()).prop_map(|(hand, push)| PhaseEvent::Stick(hand, push)),
        3 => (hand(), any_resizes()).prop_map(|(hand, by)| {
            PhaseEvent::Pointer(PointerCommand::Resize { hand: hand as u8, by })
        }),
        3 => Just(PhaseEvent::Reload),
        1 => any::<u64>().prop_map(PhaseEvent::Wild),
        1 => prop_oneof![
            Just(PhaseEvent::Commands(commands::FINISH)),
            Just(PhaseEvent::Start(SessionMode::Constrained { figure: 0 })),
            Just(PhaseEvent::Start(SessionMode::Creative)),
            Just(PhaseEvent::Start(SessionMode::Constrained { figure: 9 })),
        ],
    ]
}

/// A strategy for steps of a bit's size: one, all, or any number.
fn any_resizes() -> impl Strategy<Value = i8> {
    prop_oneof![2 => Just(1i8), 2 => Just(-1), 2 => Just(8), 2 => Just(-8), 1 => any::<i8>()]
}

/// Returns the pointer's commands that put an item into a hand, with the tool that it belongs to.
fn take_with_its_tool(hand: u8, item: u8) -> [PhaseEvent; 2] {
    let tool = match BenchItem::from_number(item.into()) {
        Some(BenchItem::Bit(bit)) => BenchItem::Tool(bit.spec().tool).number() as u8,
        _ => item,
    };
    [tool, item].map(|item| PhaseEvent::Pointer(PointerCommand::Take { hand, item }))
}

impl Phase {
    /// Returns a phase of one tick in which the hands rest.
    pub fn of_event(event: PhaseEvent) -> Self {
        Phase { ticks: 1, hands: [HandPlan::Stay { pulls: false }; 2], event }
    }
}

impl Place {
    fn to_pose(self) -> Pose {
        let [x, y, z, w] = self.turn.map(f32::from);
        let turn = Quat::from_xyzw(x, y, z, w);
        Pose {
            position: Vec3::from_array(self.eighths.map(|part| f32::from(part) / 8.0)),
            rotation: if self.turn == [0; 4] { Quat::IDENTITY } else { turn.normalize() },
        }
    }
}

/// Turns phases into inputs.
#[derive(Clone, Debug)]
pub struct InputWriter {
    /// The poses that the hands' bits would have without obstacles.
    poses: [Pose; 2],
    /// The goals in this phase of hands that touch the stone.
    goals: [Vec3; 2],
    /// Number of phases so far.
    phases: u32,
}

impl InputWriter {
    /// Creates a writer with both hands above a grid of `side`^3 voxels.
    pub fn above(side: usize) -> Self {
        let at = |x: f32| Pose {
            position: Vec3::new(x, 1.3, 0.5) * side as f32,
            rotation: Quat::IDENTITY,
        };
        let poses = [at(0.3), at(0.7)];
        InputWriter { poses, goals: poses.map(|pose| pose.position), phases: 0 }
    }

    /// Returns the input of tick `i` of a phase, given the world before it.
    pub fn input<const N: usize, const K: usize>(
        &mut self,
        phase: &Phase,
        i: u8,
        world: &World<N, K>,
    ) -> TickInput
    where
        Grid<N>: Size,
    {
        if let PhaseEvent::Wild(seed) = phase.event {
            let mut input = arbitrary_input(&mut RandomSource::new(seed ^ u64::from(i) << 32));
            // Visits have a separate model.
            input.visit = VisitInput::default();
            // Traces can't store the highest button.
            input.hands.iter_mut().for_each(|hand| hand.buttons &= 0x7f);
            return input;
        }
        if i == 0 {
            self.begin_phase(phase, world);
        }
        let mut input = TickInput {
            hands: [0, 1].map(|hand| self.hand_input(hand, phase, i, world)),
            ..TickInput::default()
        };
        phase.event.add_to(&mut input, i);
        if i == 0 && matches!(phase.event, PhaseEvent::Nothing) {
            self.equip(&mut input, world);
        }
        input
    }

    /// Finds the voxels that hands move to.
    fn begin_phase<const N: usize, const K: usize>(&mut self, phase: &Phase, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        self.phases += 1;
        for (goal, plan) in self.goals.iter_mut().zip(&phase.hands) {
            let HandPlan::Touch { row, is_last, aside, .. } = plan else { continue };
            let rows = (0..N * N).map(|i| (i + usize::from(*row)) % (N * N));
            let mut rows = rows.map(|i| (i / N, i % N));
            let held = rows.find_map(|(y, z)| {
                let row = world.volume().rows().row(y, z);
                let x = if *is_last { row.last() } else { row.first() };
                x.map(|x| Vec3::new(x as f32, y as f32, z as f32))
            });
            let aside = Vec3::from_array(aside.map(|part| f32::from(part) / 8.0));
            *goal = held.unwrap_or(Vec3::ZERO) + aside + 0.5;
        }
    }

    /// Gives a tool to an empty hand, and begins a session if the last one is over.
    fn equip<const N: usize, const K: usize>(&self, input: &mut TickInput, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        if world.session_state() == SessionState::Finished {
            input.start = SessionMode::Constrained { figure: 0 };
        }
        if let Some(hand) = [0, 1].into_iter().find(|&hand| world.held_tool(hand).is_none()) {
            let item = (self.phases % 4) as u8;
            input.pointer = PointerCommand::Take { hand: hand as u8, item };
        }
    }

    fn hand_input<const N: usize, const K: usize>(
        &mut self,
        hand: usize,
        phase: &Phase,
        i: u8,
        world: &World<N, K>,
    ) -> HandInput
    where
        Grid<N>: Size,
    {
        let last = self.poses[hand];
        let (pose, pulls) = match phase.hands[hand] {
            HandPlan::Stay { pulls } => (last, pulls),
            HandPlan::Glide { to, pulls } => {
                (last.interpolate(&to.to_pose(), 1.0 / f32::from(phase.ticks - i)), pulls)
            }
            HandPlan::Touch { pulls, .. } => {
                let goal = Pose { position: self.goals[hand], ..last };
                (last.interpolate(&goal, 1.0 / f32::from(phase.ticks - i)), pulls)
            }
            HandPlan::Jump { to, pulls } => (to.to_pose(), pulls),
            HandPlan::Flutter => (last, i.is_multiple_of(2)),
            HandPlan::Lost | HandPlan::Invalid => (last, true),
        };
        self.poses[hand] = pose;
        let mut input = world.hand_with_bit_at(hand, &pose);
        let pulled = if phase.ticks.is_multiple_of(3) { FULL_TRIGGER - 1 } else { 255 };
        input.trigger = if pulls { pulled } else { 0 };
        match phase.hands[hand] {
            HandPlan::Lost => input.tracked = false,
            HandPlan::Invalid => input.grip.rotation = [0, 1, 0, -1],
            _ => {}
        }
        input
    }
}

impl PhaseEvent {
    /// Adds the event in tick `i` of the phase.
    fn add_to(&self, input: &mut TickInput, i: u8) {
        match *self {
            PhaseEvent::Storm(pattern) => {
                input.commands =
                    (pattern >> (2 * (i % 16))) as u8 & (commands::UNDO | commands::REDO);
            }
            PhaseEvent::Buttons(hand, pressed) => input.hands[hand].buttons = pressed,
            PhaseEvent::Stick(hand, push) => input.hands[hand].stick = push,
            PhaseEvent::HoldStool(hand, by, above) => stool::add_hold(input, hand, by, above, i),
            _ if i > 0 => {}
            PhaseEvent::Pointer(pointer) => input.pointer = pointer,
            PhaseEvent::Commands(all) => input.commands = all,
            PhaseEvent::Start(mode) => input.start = mode,
            PhaseEvent::Squeeze(hand, item) => {
                input.hands[hand].squeeze = 255;
                if let Some(item) = BenchItem::from_number(item.into()) {
                    let grip = RawPose::quantise(item.home_position(), Quat::IDENTITY);
                    (input.hands[hand].grip, input.hands[hand].aim) = (grip, grip);
                }
            }
            PhaseEvent::Nothing | PhaseEvent::Reload | PhaseEvent::Wild(_) => {}
        }
    }
}
