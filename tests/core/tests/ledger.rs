//! The ledger of a tick's work, tested through the world: islands fall in time whatever the hands do, and
//! after an undo only when they may.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL, UndoCounts};
use paros_core::internals::GridShape;
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionMode, Tool, ToolBit, commands,
};
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_core::{HandInput, HiddenFigure, RangeMaps, StartVolumes, TickInput, World};
use paros_models::cases::sample_cases;
use paros_models::hard_work::HardWork;
use paros_models::scripted_hand::{LEFT, RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shell::tick_runner::TickRunner;

/// A world with its start volumes.
struct Scene<const N: usize>
where
    Grid<N>: Size,
{
    world: World<N, 2>,
    lump: RangeMaps<N, 2>,
    figure: RangeMaps<N, 2>,
    grid: BitGrid<N>,
    is_made: bool,
}

impl<const N: usize> Scene<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Scene {
            world: World::new(),
            lump: RangeMaps::new(),
            figure: RangeMaps::new(),
            grid: BitGrid::new(),
            is_made: false,
        }
    }

    fn write(
        grid: &mut BitGrid<N>,
        maps: &mut RangeMaps<N, 2>,
        is_in: impl Fn([usize; 3]) -> bool,
    ) {
        grid.clear();
        for y in 0..N {
            for z in 0..N {
                (0..N).filter(|x| is_in([*x, y, z])).for_each(|x| grid.row_mut(y, z).insert(x));
            }
        }
        grid.write_closure(maps);
    }

    /// Writes the start volumes once: a floor whose rows need a whole tick's visits, and a block on a thin
    /// stem. The figure is the floor's middle.
    fn make(&mut self) {
        if std::mem::replace(&mut self.is_made, true) {
            return;
        }
        let floor = if N > 128 { N / 4 } else { N / 2 };
        let within = |x: usize, middle: usize, reach: usize| x.abs_diff(middle) < reach;
        let is_block = |[x, y, z]: [usize; 3]| {
            within(x, N / 2, N / 20) && within(z, N / 2, N / 20) && within(y, floor + N / 5, N / 20)
        };
        let is_stem = |[x, y, z]: [usize; 3]| x == N / 2 && z == N / 2 && y < floor + N / 5;
        let lump = |at: [usize; 3]| at[1] < floor || is_block(at) || is_stem(at);
        Self::write(&mut self.grid, &mut self.lump, lump);
        let figure =
            |[x, y, z]: [usize; 3]| y < floor - N / 16 && within(x, N / 2, N / 4) && z > N / 4;
        Self::write(&mut self.grid, &mut self.figure, figure);
    }
}

fn take(hand: usize, item: BenchItem) -> PointerCommand {
    PointerCommand::Take { hand: hand as u8, item: item.number() as u8 }
}

/// Puts both tools with their bits into the hands, and returns the right hand's tool. It is taken again in
/// the tick of the cut, when its bit is at the stem.
fn take_tools<const N: usize>(runner: &mut TickRunner<'_, N, 2>, works: [(ToolBit, HardWork); 2])
where
    Grid<N>: Size,
{
    let mut run_pointer = |pointer| runner.run_tick(&TickInput { pointer, ..TickInput::default() });
    for (hand, (bit, _)) in works.into_iter().enumerate() {
        run_pointer(take(hand, BenchItem::Tool(bit.spec().tool)));
        run_pointer(take(hand, BenchItem::Bit(bit)));
    }
    run_pointer(PointerCommand::Return { hand: RIGHT as u8 });
}

/// Cuts the block's stem in tick `cut_at` while both hands work, and returns the number of ticks until the
/// block falls.
fn count_ticks_until_fall<const N: usize>(
    scene: &'static Mutex<Scene<N>>,
    is_masked: bool,
    works: [(ToolBit, HardWork); 2],
    cut_at: u32,
) -> u32
where
    Grid<N>: Size,
{
    let mut scene = scene.lock().unwrap_or_else(PoisonError::into_inner);
    scene.make();
    let Scene { world, lump, figure, .. } = &mut *scene;
    world.clear();
    let figures = [HiddenFigure { figure, stone: lump }];
    let starts = StartVolumes { lump, figures: &figures, creative: lump, own: None };
    let mut runner = TickRunner::new(world, starts);
    let figure = SessionMode::Constrained { figure: 0 };
    let start = if is_masked { figure } else { SessionMode::FreeForm };
    runner.run_tick(&TickInput { start, ..TickInput::default() });
    take_tools(&mut runner, works);
    let floor = if N > 128 { N / 4 } else { N / 2 };
    let (side, top) = (N as f32, floor as f32);
    let block = [N / 2, floor + N / 5, N / 2];
    let at_stem = Vec3::new(side / 2.0 + 0.5, top + side * 0.08, side / 2.0 + 0.5);
    for tick in 0..cut_at + 60 {
        let mut input = TickInput::default();
        for (hand, (bit, work)) in works.into_iter().enumerate() {
            let mut pose = work.pose_at(hand, side, top, tick);
            if hand == RIGHT && tick == cut_at {
                pose = Pose { position: at_stem, rotation: Quat::IDENTITY };
                let length = bit.spec().tool.length_um() as f32 * 1e-6;
                let (tip, rotation) = runner.world().stool_frame().to_room(&pose);
                let grip = RawPose::quantise(tip - rotation * Vec3::NEG_Z * length, rotation);
                let at = HandInput { aim: grip, grip, tracked: true, ..HandInput::default() };
                input.hands[hand] = HandInput { trigger: 255, ..at };
                input.pointer = take(RIGHT, BenchItem::Tool(bit.spec().tool));
                continue;
            }
            let at = runner.world().hand_with_bit_at(hand, &pose);
            input.hands[hand] = HandInput { trigger: 255, ..at };
        }
        runner.run_tick(&input);
        let rows = runner.world().volume().rows();
        if tick == cut_at {
            assert!(!rows.contains([N / 2, at_stem.y as usize, N / 2]), "the stem is cut");
        }
        if !rows.contains(block) {
            assert!(tick >= cut_at, "it fell before it was cut loose");
            return tick - cut_at;
        }
    }
    panic!("it hangs for ever: {works:?}");
}

/// Asserts a fall within twelve ticks of the edit, or 24 with a mask. At 256 a third of the works is tested;
/// the nightly run tests all.
fn check_falls<const N: usize>(scene: &'static Mutex<Scene<N>>)
where
    Grid<N>: Size,
{
    let mut worst = [0; 2];
    let all_works = [
        [(ToolBit::Nozzle, HardWork::Storm), (ToolBit::LargeBall, HardWork::Storm)],
        [(ToolBit::File, HardWork::Turns), (ToolBit::Grinder, HardWork::Turns)],
        [(ToolBit::Nozzle, HardWork::Deep), (ToolBit::LargeBall, HardWork::Deep)],
        [(ToolBit::File, HardWork::Storm), (ToolBit::Grinder, HardWork::Deep)],
        [(ToolBit::Nozzle, HardWork::Storm), (ToolBit::RoughingBall, HardWork::Rough)],
        [(ToolBit::FlatChisel, HardWork::Rough), (ToolBit::DiscSaw, HardWork::Rough)],
        [(ToolBit::File, HardWork::Storm), (ToolBit::DiscSaw, HardWork::Turns)],
    ];
    for works in sample_cases(all_works, if N > 128 { 3 } else { 1 }) {
        for (is_masked, most) in [(false, 12), (true, 24)] {
            for cut_at in [0, 3] {
                let ticks = count_ticks_until_fall(scene, is_masked, works, cut_at);
                worst[usize::from(is_masked)] = worst[usize::from(is_masked)].max(ticks);
                assert!(ticks <= most, "{works:?}, masked {is_masked}: {ticks} ticks");
            }
        }
    }
    println!("at {N}: {} ticks, {} with a mask", worst[0], worst[1]);
}

#[test]
fn islands_fall_in_time_at_128() {
    static SCENE: Mutex<Scene<128>> = Mutex::new(Scene::new());
    check_falls(&SCENE);
}

#[test]
fn islands_fall_in_time_at_256() {
    static SCENE: Mutex<Scene<256>> = Mutex::new(Scene::new());
    check_falls(&SCENE);
}

static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

/// Returns `true` inside a floor between two combs of sheets, over which a pass takes several ticks, with a
/// block on a stem.
fn is_stone([x, y, z]: [usize; 3]) -> bool {
    let near = |reach: usize| x.abs_diff(33) < reach && z.abs_diff(32) < reach;
    match x {
        22..44 => y < 10 || y < 38 && near(2) || (38..42).contains(&y) && near(5),
        0..22 => y % 2 == 0 || z == if y % 4 == 1 { 0 } else { 63 },
        _ => y % 2 == 0 || z == if y % 4 == 1 { 63 } else { 0 },
    }
}

fn has_block(harness: &WorldHarness<64>) -> bool {
    harness.world.volume().rows().contains([33, 40, 32])
}

/// Runs a tick in which the left hand's tool is on the floor; it cuts if `cuts`.
fn cut_floor(harness: &mut WorldHarness<64>, cuts: bool) {
    step_with_bit_at(harness, LEFT, Vec3::new(33.0, 10.3, 10.5), cuts);
}

/// Cuts through the stem with the right hand's tool. The block stays for now, because the current pass began
/// before the cut.
fn start_and_cut_stem(harness: &mut WorldHarness<64>) {
    harness.start_from_voxels(is_stone);
    take_item(harness, LEFT, BenchItem::Tool(Tool::Impact));
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    cut_floor(harness, false);
    for i in 0..200 {
        step_with_bit_at(harness, RIGHT, Vec3::new(25.0 + 0.25 * i as f32, 24.5, 32.5), true);
        let is_there = |[x, z]: [usize; 2]| harness.world.volume().rows().contains([x, 24, z]);
        if !(31..36).any(|x| (30..36).any(|z| is_there([x, z]))) {
            break;
        }
        assert!(i < 199, "the stem isn't cut");
    }
    assert!(has_block(harness), "it hangs");
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 1, redoable: 0 });
}

fn run_command(harness: &mut WorldHarness<64>, command: u8) {
    harness.step(&TickInput { commands: command, ..TickInput::default() });
}

fn wait(harness: &mut WorldHarness<64>, ticks: u32) {
    (0..ticks).for_each(|_| harness.step(&TickInput::default()));
}

/// A redo restores the cut and requests the pass that the cut had requested.
#[test]
fn what_a_redo_cuts_loose_falls() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    start_and_cut_stem(&mut harness);
    run_command(&mut harness, commands::UNDO);
    wait(&mut harness, 20);
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 0, redoable: 1 });
    run_command(&mut harness, commands::REDO);
    assert!(has_block(&harness));
    wait(&mut harness, 12);
    assert!(!has_block(&harness), "it hangs for ever");
    // The fallen voxels belong to the stroke's undo entry.
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 1, redoable: 0 });
    run_command(&mut harness, commands::UNDO);
    assert!(has_block(&harness));
}

/// After an undo, the block cut loose by the stroke before still hangs. Removing it would drop the redo
/// history, so it hangs until the redo, or until the next edit drops that history anyway.
#[test]
fn what_hangs_after_an_undo_waits_while_something_can_be_redone() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    for is_redone in [true, false] {
        start_and_cut_stem(&mut harness);
        run_command(&mut harness, commands::UNDO);
        run_command(&mut harness, commands::REDO);
        cut_floor(&mut harness, true);
        assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 2, redoable: 0 });
        run_command(&mut harness, commands::UNDO);
        assert!(has_block(&harness), "it hangs still");
        wait(&mut harness, 30);
        assert!(has_block(&harness), "it fell, and dropped what could be redone");
        assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 1, redoable: 1 });
        match is_redone {
            true => run_command(&mut harness, commands::REDO),
            false => cut_floor(&mut harness, true),
        }
        wait(&mut harness, 12);
        assert!(!has_block(&harness), "it hangs for ever");
        assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 2, redoable: 0 });
    }
}

static HARNESS_128: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());

/// The bits with the most expensive paths, of two tools.
const CRAWLERS: [ToolBit; 2] = [ToolBit::Grinder, ToolBit::FlatChisel];

/// Starts with a floor 60 voxels thick, a block above it that no edit has touched, and each hand's bit on the
/// floor.
fn start_crawl(harness: &mut WorldHarness<128>) {
    harness.start_from_voxels(|[x, y, z]| y < 60 || [x, y, z].map(|i| i / 8) == [8, 12, 8]);
    for (hand, bit) in CRAWLERS.into_iter().enumerate() {
        take_item(harness, hand, BenchItem::Tool(bit.spec().tool));
        take_item(harness, hand, BenchItem::Bit(bit));
    }
    step_to(harness, 15.0, 0);
}

/// Runs a tick in which both hands move their bits toward `x`, as deep in the floor as their bites allow, so
/// that the bits advance a step at a time. Returns the bits' x coordinates.
fn step_to(harness: &mut WorldHarness<128>, x: f32, trigger: u8) -> [f32; 2] {
    let voxel_um = harness.world.stool_frame().voxel_metres() * 1e6;
    let hands = [LEFT, RIGHT].map(|hand| {
        let bit = CRAWLERS[hand].to_grid_bit(voxel_um);
        let GridShape::Box(half) = bit.shape else { unreachable!("two boxes") };
        let depth = (half.y - bit.bite) as f32 / SUBUNITS_PER_VOXEL as f32;
        let position = Vec3::new(x, 59.52 + depth, 35.5 + 60.0 * hand as f32);
        let pose = Pose { position, rotation: Quat::IDENTITY };
        HandInput { trigger, ..harness.world.hand_with_bit_at(hand, &pose) }
    });
    harness.step(&TickInput { hands, ..TickInput::default() });
    [LEFT, RIGHT].map(|hand| harness.world.hand_state(hand).frozen_pose.position.x)
}

/// A bit whose path and edit could use up a tick's work leaves the other hand its half: both bits advance in
/// every tick, whichever hand begins.
#[test]
fn each_hand_has_its_half_of_a_tick() {
    let harness = &mut *HARNESS_128.lock().unwrap_or_else(PoisonError::into_inner);
    start_crawl(harness);
    let mut before = [15.0; 2];
    for tick in 0..4 {
        let now = step_to(harness, 200.0, 255);
        for hand in [LEFT, RIGHT] {
            let way = now[hand] - before[hand];
            assert!((1.0..30.0).contains(&way), "tick {tick}: {:?} went {way}", CRAWLERS[hand]);
        }
        before = now;
    }
}

/// The island search gets its reserve while both hands spend all of their work.
#[test]
fn islands_have_their_share_of_each_tick() {
    let harness = &mut *HARNESS_128.lock().unwrap_or_else(PoisonError::into_inner);
    start_crawl(harness);
    let mut ticks = 0;
    while harness.world.volume().rows().contains([66, 98, 66]) {
        step_to(harness, 200.0, 255);
        ticks += 1;
        assert!(ticks < 40, "it hangs for ever");
    }
    assert!((2..5).contains(&ticks), "{ticks} ticks");
}
