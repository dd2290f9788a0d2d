//! Prints exported during ticks: they don't change the ticks, their bytes equal those of one export, and no
//! call exceeds its budget.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::convert::ExportPhase;
use paros_core::session::{SessionMode, commands};
use paros_core::volume::BitGrid;
use paros_core::{Exporter, RangeMaps, TickInput, World, WorldEvent};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;
use paros_shell::stl_export::{
    DEFAULT_HEIGHT_MM, FinishedStl, MAX_BYTES_PER_STEP, StlBuffers, StlExporter, UNITS_PER_STEP,
};

/// Exports the file in one call.
fn export_at_once(
    exporter: &mut Exporter<64>,
    rows: &BitGrid<64>,
    mask: &RangeMaps<64>,
) -> Vec<u8> {
    let mut file = vec![0; 1 << 24];
    exporter.start_export(DEFAULT_HEIGHT_MM).unwrap();
    let progress = exporter.advance_export(rows, mask, u32::MAX, &mut file);
    assert_eq!(progress.phase, ExportPhase::Done);
    file.truncate(progress.written);
    file
}

struct Shop {
    studio: WorldHarness<64>,
    press: StlBuffers<64, 1>,
    exporter: Exporter<64>,
}

fn lock_shop() -> MutexGuard<'static, Shop> {
    static SHOP: Mutex<Shop> = Mutex::new(Shop {
        studio: WorldHarness::new(),
        press: StlBuffers::new(),
        exporter: Exporter::new(),
    });
    SHOP.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the inputs of two sessions: the first is sculpted, finished after 150 ticks, and followed `pause`
/// ticks later by the second.
fn two_sessions(pause: usize) -> Vec<TickInput> {
    let start = |mode| TickInput { start: mode, ..TickInput::default() };
    let finish = TickInput { commands: commands::FINISH, ..TickInput::default() };
    let mut visitor = RandomVisitor::new(7);
    visitor.restless = false;
    let mut inputs = vec![start(SessionMode::Constrained { figure: 0 })];
    inputs.extend((0..150).map(|_| visitor.next_input()));
    inputs.push(finish);
    inputs.extend((0..pause).map(|_| visitor.next_input()));
    inputs.push(start(SessionMode::Creative));
    inputs.extend((0..60).map(|_| visitor.next_input()));
    inputs.push(finish);
    inputs.extend((0..60).map(|_| visitor.next_input()));
    inputs
}

/// Steps an empty world through inputs. Returns the digests, and the results of `each`.
fn run_inputs<T>(
    studio: &mut WorldHarness<64>,
    inputs: &[TickInput],
    mut each: impl FnMut(&World<64>) -> Option<T>,
) -> (Vec<u64>, Vec<T>) {
    studio.reset();
    let (mut digests, mut made) = (vec![], vec![]);
    for input in inputs {
        studio.step(input);
        made.extend(each(&studio.world));
        digests.push(studio.world.digest());
    }
    (digests, made)
}

/// Runs inputs without an exporter. Returns the digests, and the files of finished sculptures, each exported
/// at once.
fn run_without_printer(shop: &mut Shop, inputs: &[TickInput]) -> (Vec<u64>, Vec<Vec<u8>>) {
    let Shop { studio, exporter, .. } = shop;
    run_inputs(studio, inputs, |world| {
        let finished = world.events().contains(&WorldEvent::Finished);
        finished.then(|| export_at_once(exporter, world.volume().rows(), world.mask()))
    })
}

/// Runs inputs with an exporter. Returns the digests, the prints, and the most ticks that a print took.
fn run_with_printer(shop: &mut Shop, inputs: &[TickInput]) -> (Vec<u64>, Vec<FinishedStl>, u32) {
    let mut stl_exporter = StlExporter::new(&mut shop.press, DEFAULT_HEIGHT_MM).unwrap();
    let (mut busy, mut most) = (0, 0);
    let (digests, prints) = run_inputs(&mut shop.studio, inputs, |world| {
        let print = stl_exporter.begin_if_finished_or_advance(world);
        busy = if stl_exporter.is_busy() { busy + 1 } else { 0 };
        most = most.max(busy);
        print
    });
    assert!(!stl_exporter.is_busy() && stl_exporter.run_export_to_end().is_none());
    (digests, prints, most)
}

fn stl_files(prints: &[FinishedStl]) -> Vec<&[u8]> {
    prints.iter().map(|print| &print.bytes[..]).collect()
}

#[test]
fn ticks_and_bytes_are_those_of_a_print_made_at_once() {
    let mut shop = lock_shop();
    let inputs = two_sessions(40);
    let (digests, expected) = run_without_printer(&mut shop, &inputs);
    let (same, prints, ticks) = run_with_printer(&mut shop, &inputs);
    assert!(digests == same);
    assert_eq!(expected.len(), 2);
    assert!(stl_files(&prints) == expected);
    assert!(ticks >= 3, "it was spread over {ticks} ticks");
    for print in prints {
        assert!(print.triangle_count > 1000);
        assert_eq!(print.bytes.len(), 84 + 50 * print.triangle_count as usize);
    }
}

#[test]
fn a_new_session_leaves_the_print_alone() {
    let mut shop = lock_shop();
    let inputs = two_sessions(0);
    let (digests, expected) = run_without_printer(&mut shop, &inputs);
    let (same, prints, _) = run_with_printer(&mut shop, &inputs);
    assert!(digests == same && stl_files(&prints) == expected);
}

#[test]
fn no_finished_sculpture_is_lost() {
    let mut shop = lock_shop();
    let mut inputs = two_sessions(0);
    // Finishes the second session in the tick after its start.
    let finish = inputs.remove(inputs.len() - 61);
    inputs.insert(153, finish);
    assert_eq!(
        (inputs[152].start, inputs[153].commands),
        (SessionMode::Creative, commands::FINISH)
    );
    let (digests, expected) = run_without_printer(&mut shop, &inputs);
    assert!(expected.len() == 2 && expected[0] != expected[1]);
    let (same, prints, _) = run_with_printer(&mut shop, &inputs);
    assert!(digests == same && stl_files(&prints) == expected);
}

#[test]
fn each_step_stays_in_its_budget() {
    let shop = &mut *lock_shop();
    let Shop { studio, press, exporter } = shop;
    studio.start_session(SessionMode::Constrained { figure: 0 });
    let (rows, mask) = (studio.world.volume().rows(), studio.world.mask());
    // Number of bytes available after each unit of work.
    let mut units = vec![0];
    let mut buffer = vec![0; Exporter::<64>::MIN_BUFFER];
    exporter.start_export(DEFAULT_HEIGHT_MM).unwrap();
    loop {
        let progress = exporter.advance_export(rows, mask, 1, &mut buffer);
        units.push(units.last().unwrap() + progress.written);
        if progress.phase == ExportPhase::Done {
            break;
        }
    }
    let mut stl_exporter = StlExporter::new(press, DEFAULT_HEIGHT_MM).unwrap();
    stl_exporter.begin_export(rows, mask);
    let (mut steps, mut before) = (0, 0);
    let print = loop {
        steps += 1;
        let print = stl_exporter.advance_export_step();
        let made = print.as_ref().map_or(stl_exporter.bytes_made(), |print| print.bytes.len());
        let most = units[units.len().min(steps * UNITS_PER_STEP as usize + 1) - 1];
        assert!(made <= most, "step {steps}: {made} bytes, the budget is for {most}");
        assert!(made - before <= MAX_BYTES_PER_STEP);
        before = made;
        if let Some(print) = print {
            break print;
        }
    };
    assert_eq!(print.bytes.len(), *units.last().unwrap());
    assert!(
        steps * UNITS_PER_STEP as usize >= units.len() - 1,
        "{steps} steps for {}",
        units.len() - 1
    );
}

#[test]
fn nothing_is_printed_of_nothing() {
    let shop = &mut *lock_shop();
    for height in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(StlExporter::new(&mut shop.press, height).is_err());
    }
    let mut stl_exporter = StlExporter::new(&mut shop.press, DEFAULT_HEIGHT_MM).unwrap();
    shop.studio.start_from_voxels(|_| false);
    assert_eq!(
        (stl_exporter.begin_if_finished_or_advance(&shop.studio.world), stl_exporter.is_busy()),
        (None, false)
    );
    shop.studio.step(&TickInput { commands: commands::FINISH, ..TickInput::default() });
    assert_eq!(
        (stl_exporter.begin_if_finished_or_advance(&shop.studio.world), stl_exporter.is_busy()),
        (None, true)
    );
    assert_eq!(stl_exporter.run_export_to_end().map(|print| print.triangle_count), Some(0));
}
