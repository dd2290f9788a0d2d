//! Scenarios of a session: starts, strokes, symmetry, islands, the end.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, UndoCounts};
use paros_core::internals::{BitAction, Obstacle, STOOL_TOP, ToolPlace, WayBudget, maps_digest};
use paros_core::session::{
    BenchItem, PointerCommand, SessionMode, SessionState, Tool, ToolBit, buttons, commands,
};
use paros_core::volume::Axis;
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::cases::scaled_step;
use paros_models::random_visitor::{RandomSource, RandomVisitor};
use paros_models::scripted_hand::{
    LEFT, RIGHT, hand_input_at, input_with_hand, run_stroke, start_from_floor, step_with_bit_at,
    take_item, volume_of,
};
use paros_models::world_harness::{WorldAndStarts, WorldHarness, maps_are_equal};

paros_models::test_with_one_and_two_intervals!(
    modes_start_from_their_volumes,
    a_start_that_is_not_there_changes_nothing,
    a_stroke_is_one_entry_with_the_islands_it_cut_off,
    another_bit_goes_on_with_the_stroke,
    buttons_act_once_a_press,
    symmetry_is_the_exact_mirror,
    the_end_takes_no_more_edits,
    the_hidden_figure_outlasts_any_carving,
);

fn modes_start_from_their_volumes<const K: usize>(harness: &mut WorldHarness<64, K>) {
    for (mode, masked) in [
        (SessionMode::FreeForm, false),
        (SessionMode::Constrained { figure: 0 }, true),
        (SessionMode::Constrained { figure: 1 }, true),
        (SessionMode::Creative, false),
    ] {
        // The earlier session doesn't matter.
        let mut visitor = RandomVisitor::new(3);
        (0..60).for_each(|_| harness.step(&visitor.next_input()));
        harness.start_session(mode);
        assert_eq!(harness.world.events(), [WorldEvent::Started(mode)]);
        assert_eq!(
            (harness.world.session_state(), harness.world.mode()),
            (SessionState::Sculpting, mode)
        );
        assert_eq!(
            (harness.world.undo_counts(), harness.world.is_mirrored()),
            (UndoCounts { undoable: 0, redoable: 0 }, false)
        );
        assert!(
            Axis::ALL
                .iter()
                .all(|axis| harness.world.dirty_rects().rects(*axis)[0].area() == 64 * 64)
        );
        let WorldAndStarts { world, lump, figure, creative } = harness.world_and_start_volumes();
        let from = match mode {
            SessionMode::Creative => creative,
            SessionMode::Constrained { figure: 1 } => figure,
            _ => lump,
        };
        assert!(maps_are_equal(world.volume().maps(), from), "{mode:?}");
        assert_eq!(maps_are_equal(world.mask(), figure), masked, "{mode:?}");
        assert_eq!(world.mask().is_empty(), !masked);
        for tool in Tool::ALL {
            assert_eq!(world.workbench().place_of(BenchItem::Tool(tool)), ToolPlace::Home);
            assert_eq!(world.workbench().mounted_bit(tool), tool.default_bit());
        }
        harness.check_invariants();
    }
    start_from_floor(harness, 9);
    assert!(maps_are_equal(harness.world.volume().maps(), &harness.own));
}

fn a_start_that_is_not_there_changes_nothing<const K: usize>(harness: &mut WorldHarness<64, K>) {
    for mode in [
        SessionMode::Constrained { figure: 2 },
        SessionMode::Constrained { figure: 255 },
        SessionMode::Own,
    ] {
        harness.start_session(SessionMode::Constrained { figure: 0 });
        let mut parts = harness.world.part_digests();
        harness.step(&TickInput::default());
        let still = harness.world.part_digests();
        harness.start_session(SessionMode::Constrained { figure: 0 });
        harness.step(&TickInput { start: mode, ..TickInput::default() });
        assert_eq!(harness.world.events(), [WorldEvent::NoSuchStart], "{mode:?}");
        assert_eq!(harness.world.part_digests(), still, "{mode:?}");
        // The clock advances.
        assert_ne!(parts[0], still[0]);
        parts[0] = still[0];
        assert_eq!(parts, still);
    }
    // Before the first session, nothing can be taken.
    harness.reset();
    take_item(harness, LEFT, BenchItem::Tool(Tool::Rotary));
    assert_eq!(
        (harness.world.session_state(), harness.world.held_tool(LEFT)),
        (SessionState::Waiting, None)
    );
}

fn a_stroke_is_one_entry_with_the_islands_it_cut_off<const K: usize>(
    harness: &mut WorldHarness<64, K>,
) {
    // A mushroom, whose cap is an island once the stem is cut.
    harness.start_from_voxels(|[x, y, z]| {
        y < 10
            || y < 20 && (30..34).contains(&x) && (30..34).contains(&z)
            || (20..24).contains(&y) && (24..40).contains(&x) && (24..40).contains(&z)
    });
    let start = maps_digest(harness.world.volume().maps());
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    run_stroke(harness, RIGHT, Vec3::new(10.0, 11.0, 50.0), Vec3::new(50.0, 11.0, 50.0), 20);
    let first = maps_digest(harness.world.volume().maps());
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 1, redoable: 0 });
    let mut removed = 0;
    step_with_bit_at(harness, RIGHT, Vec3::new(32.0, 15.0, 50.0), false);
    for i in 0..60 {
        step_with_bit_at(harness, RIGHT, Vec3::new(32.0, 15.0, 50.0 - 0.6 * i as f32), true);
        for event in harness.world.events() {
            if let WorldEvent::Islands(report) = event {
                removed += report.removed;
            }
        }
    }
    assert!(removed > 500, "the cap is gone: {removed}");
    let second = maps_digest(harness.world.volume().maps());
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 2, redoable: 0 });
    for (command, expected, event) in [
        (commands::UNDO, first, WorldEvent::Undone),
        (commands::UNDO, start, WorldEvent::Undone),
        (commands::REDO, first, WorldEvent::Redone),
        (commands::REDO, second, WorldEvent::Redone),
    ] {
        harness.step(&TickInput { commands: command, ..TickInput::default() });
        assert_eq!(harness.world.events(), [event]);
        assert_eq!(maps_digest(harness.world.volume().maps()), expected);
        // No pass follows.
        (0..5).for_each(|_| harness.step(&TickInput::default()));
        assert_eq!(maps_digest(harness.world.volume().maps()), expected);
        harness.check_invariants();
    }
    harness.step(&TickInput { commands: commands::REDO, ..TickInput::default() });
    assert_eq!(harness.world.events(), []);
}

/// Exchanging the bit while the trigger is pulled continues the stroke.
fn another_bit_goes_on_with_the_stroke<const K: usize>(harness: &mut WorldHarness<64, K>) {
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let start = maps_digest(harness.world.volume().maps());
    (0..4).for_each(|_| step_with_bit_at(harness, RIGHT, Vec3::new(20.0, 31.0, 20.0), true));
    let place = Pose { position: Vec3::new(44.0, 31.0, 44.0), rotation: Quat::IDENTITY };
    let hand = HandInput { trigger: 255, ..harness.world.hand_with_bit_at(RIGHT, &place) };
    let pointer =
        PointerCommand::Take { hand: 1, item: BenchItem::Bit(ToolBit::LargeBall).number() as u8 };
    harness.step(&TickInput { pointer, ..input_with_hand(RIGHT, hand) });
    (0..4).for_each(|_| step_with_bit_at(harness, RIGHT, Vec3::new(44.0, 31.0, 44.0), true));
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 1, redoable: 0 });
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    assert_eq!(maps_digest(harness.world.volume().maps()), start);
}

fn buttons_act_once_a_press<const K: usize>(harness: &mut WorldHarness<64, K>) {
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    for x in [12.0, 32.0, 52.0] {
        run_stroke(harness, RIGHT, Vec3::new(x, 31.0, 12.0), Vec3::new(x, 31.0, 50.0), 12);
    }
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 3, redoable: 0 });
    let press = |harness: &mut WorldHarness<64, K>, buttons| {
        (0..5).for_each(|_| {
            harness.step(&input_with_hand(LEFT, HandInput { buttons, ..hand_input_at(STOOL_TOP) }));
        });
        harness.step(&input_with_hand(LEFT, hand_input_at(STOOL_TOP)));
    };
    press(harness, buttons::LOWER);
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 2, redoable: 1 });
    // Both buttons at once have no effect.
    press(harness, buttons::LOWER | buttons::UPPER);
    assert_eq!(
        (harness.world.undo_counts(), harness.world.events()),
        (UndoCounts { undoable: 2, redoable: 1 }, &[][..])
    );
    press(harness, buttons::UPPER);
    assert_eq!(harness.world.undo_counts(), UndoCounts { undoable: 3, redoable: 0 });
    press(harness, buttons::UPPER);
    press(harness, buttons::LOWER | buttons::UPPER);
    assert_eq!(
        harness.world.undo_counts(),
        UndoCounts { undoable: 3, redoable: 0 },
        "as where nothing is to be done again"
    );
    press(harness, buttons::STICK);
    assert!(harness.world.is_mirrored());
    harness.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
    assert!(!harness.world.is_mirrored());
}

fn symmetry_is_the_exact_mirror<const K: usize>(harness: &mut WorldHarness<64, K>) {
    for tool in Tool::ALL {
        start_from_floor(harness, 30);
        harness.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
        assert_eq!(harness.world.events(), [WorldEvent::Symmetry(true)]);
        take_item(harness, LEFT, BenchItem::Tool(tool));
        let before = volume_of(harness);
        run_stroke(harness, LEFT, Vec3::new(50.3, 31.2, 20.9), Vec3::new(28.1, 28.7, 40.2), 25);
        let after = volume_of(harness);
        assert!(after == after.mirrored_in_x(), "{tool:?}");
        let changes = before != after;
        assert!(tool == Tool::Rasp || changes, "{tool:?} did nothing");
        // Both halves belong to one stroke.
        let command = |commands| TickInput { commands, ..TickInput::default() };
        harness.step(&command(commands::UNDO));
        assert!(volume_of(harness) == before, "{tool:?} leaves a half");
        harness.step(&command(commands::REDO));
        assert!(volume_of(harness) == after, "{tool:?} brings back a half");
    }
}

fn the_end_takes_no_more_edits<const K: usize>(harness: &mut WorldHarness<64, K>) {
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    run_stroke(harness, RIGHT, Vec3::new(10.0, 31.0, 20.0), Vec3::new(50.0, 31.0, 20.0), 12);
    harness.step(&TickInput { commands: commands::FINISH, ..TickInput::default() });
    assert_eq!(harness.world.events(), [WorldEvent::Finished]);
    assert_eq!(harness.world.session_state(), SessionState::Finished);
    let done = maps_digest(harness.world.volume().maps());
    let mut visitor = RandomVisitor::new(8);
    for _ in 0..200 {
        harness.step(&visitor.next_input());
        assert_eq!(harness.world.events(), []);
    }
    assert_eq!(maps_digest(harness.world.volume().maps()), done);
    // In the tick of the end itself, nothing is carved.
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let pose = Pose { position: Vec3::new(30.0, 31.0, 30.0), rotation: Quat::IDENTITY };
    let hand = HandInput { trigger: 255, ..harness.world.hand_with_bit_at(RIGHT, &pose) };
    harness.step(&TickInput { commands: commands::FINISH, ..input_with_hand(RIGHT, hand) });
    assert_eq!(count_edits(harness.world.events()), 0);
    harness.start_session(SessionMode::Creative);
    assert_eq!(harness.world.session_state(), SessionState::Sculpting);
}

/// Under random carving, a bit's penetration never exceeds its bite, the hidden figure stays whole, every cut
/// is felt, and each tick removes only voxels of the bit's swept volume.
fn the_hidden_figure_outlasts_any_carving<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let (mut on_mask, mut carved, mut felt_alone) = (0, 0, 0);
    let checked_every = scaled_step(16);
    for seed in 0..6 {
        harness.start_session(SessionMode::Constrained { figure: 0 });
        let mut dice = RandomSource::new(seed);
        let bit = ToolBit::from_number(dice.below(7) as u8).expect("a carving bit");
        take_item(harness, RIGHT, BenchItem::Tool(bit.spec().tool));
        take_item(harness, RIGHT, BenchItem::Bit(bit));
        assert_eq!(bit.spec().action, BitAction::Carve);
        let mut visitor = RandomVisitor::new(seed + 70);
        visitor.restless = false;
        // The bit starts outside, so that it has a last place within its limits.
        step_with_bit_at(harness, RIGHT, Vec3::new(32.0, 90.0, 32.0), false);
        let mask = maps_digest(harness.world.mask());
        let grid = bit.to_grid_bit(harness.world.stool_frame().voxel_metres() * 1e6);
        for tick in 0..900 {
            let mut input = visitor.next_input();
            input.hands[LEFT] = HandInput::default();
            input.hands[RIGHT].squeeze = 0;
            if !matches!(input.pointer, PointerCommand::Turn { .. }) {
                input.pointer = PointerCommand::None;
            }
            let full = harness.world.volume().count_voxels();
            harness.step(&input);
            // `determinism` checks them after every tick.
            if tick % checked_every == 0 {
                harness.check_invariants();
            }
            carved += full - harness.world.volume().count_voxels();
            if let Some(contact) = harness.world.hand_contact(RIGHT) {
                assert!(contact.depth <= grid.bite, "{contact:?}");
                let mask = Some(harness.world.mask());
                let frozen = harness.world.hand_state(RIGHT).frozen_pose;
                let rows = harness.world.volume().rows();
                let obstacle = Obstacle { rows, mask, is_mask_alone: false };
                let one = WayBudget::of_steps(1);
                assert_eq!(obstacle.freeze_bit(&grid, &frozen, &frozen, one).pose, frozen);
                on_mask += u32::from(contact.on_mask);
                let touches = contact.overlap > 0 || contact.on_mask;
                let (cuts, haptic) = (
                    harness.world.edit_report(RIGHT).removed > 0,
                    harness.world.hand_state(RIGHT).haptic,
                );
                assert!(touches || cuts || haptic == 0);
                felt_alone += u32::from(cuts && !touches && haptic > 0);
            }
        }
        assert_eq!(maps_digest(harness.world.mask()), mask);
    }
    assert!(on_mask > 50 && carved > 1000, "{on_mask} ticks on the figure, {carved} voxels carved");
    assert!(
        felt_alone > 0,
        "a bit that has cut its way free when a tick ends is felt by what it cut"
    );
}

/// Returns `true` inside a volume whose rods leave one voxel unsupported between six of their ends; closure
/// adds that voxel again.
fn is_voxel_between_rods([x, y, z]: [usize; 3]) -> bool {
    let along_x = y == 20 && z == 32 && ((14..=30).contains(&x) || (34..=50).contains(&x));
    let along_z = y == 20 && x == 32 && ((14..=30).contains(&z) || (34..=50).contains(&z));
    let aside = y == 20 && (32..=40).contains(&x) && (z == 14 || z == 50);
    let along_y = x == 32 && z == 32 && (y <= 18 || (22..=40).contains(&y));
    let above = y == 40 && z == 32 && (32..=55).contains(&x);
    let legs = y <= 20 && (z == 32 && (x == 14 || x == 50) || x == 40 && (z == 14 || z == 50));
    let long_leg = y <= 40 && x == 55 && z == 32;
    let stage = y < 3 && x < 12 && z < 12;
    [x, y, z] == [32, 20, 32]
        || [along_x, along_z, aside, along_y, above, legs, long_leg, stage].contains(&true)
}

#[test]
fn what_closure_kept_is_told_once_and_forgotten_at_a_start() {
    static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    harness.start_session(SessionMode::FreeForm);
    let fresh = harness.world.part_digests();
    harness.start_from_voxels(is_voxel_between_rods);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut kept = Vec::new();
    for i in 0..40 {
        step_with_bit_at(&mut harness, RIGHT, Vec3::new(2.0 + 0.2 * i as f32, 4.5, 6.0), true);
        let islands = harness.world.events().iter().filter_map(|event| match event {
            WorldEvent::Islands(report) => Some(report.kept),
            _ => None,
        });
        kept.extend(islands);
    }
    assert_eq!(kept, [1], "told once, though many passes found it");
    harness.step(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
    assert_eq!(harness.world.part_digests()[1..], fresh[1..]);
}

fn count_edits(events: &[WorldEvent]) -> usize {
    events.iter().filter(|event| matches!(event, WorldEvent::Edited { .. })).count()
}
