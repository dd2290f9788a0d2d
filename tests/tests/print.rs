//! Prints made beside the ticks: the same ticks, the same bytes, never more work than agreed.
//!
//! Planted faults, and what catches each (tried by hand):
//! - a second finish drops the print under way, or is not heard -> `no_finished_sculpture_is_lost`.
//! - twice the budget in a step, or the mask left out -> `each_step_stays_in_its_budget`.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::events::Event;
use paros_core::export::{Exporter, Stage};
use paros_core::input::{Input, Mode, commands};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::world::World;
use paros_shell::print::{BUDGET, HEIGHT_MM, Press, Print, Printer, ROOM};
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::Visitor;

/// The file, made in one call.
fn drained(exporter: &mut Exporter<64>, rows: &Plane<64>, mask: &Maps<64>) -> Vec<u8> {
    let mut file = vec![0; 1 << 24];
    exporter.start(HEIGHT_MM).unwrap();
    let progress = exporter.advance(rows, mask, u32::MAX, &mut file);
    assert_eq!(progress.stage, Stage::Done);
    file.truncate(progress.written);
    file
}

struct Shop {
    studio: Studio<64>,
    press: Press<64>,
    exporter: Exporter<64>,
}

fn shop() -> MutexGuard<'static, Shop> {
    static SHOP: Mutex<Shop> =
        Mutex::new(Shop { studio: Studio::new(), press: Press::new(), exporter: Exporter::new() });
    SHOP.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the ticks of a session are given: it starts, is sculpted, is finished after 150 ticks, and
/// `pause` ticks later the next one starts.
fn sessions(pause: usize) -> Vec<Input> {
    let start = |mode| Input { start: mode, ..Input::default() };
    let finish = Input { commands: commands::FINISH, ..Input::default() };
    let mut visitor = Visitor::new(7);
    visitor.restless = false;
    let mut inputs = vec![start(Mode::Constrained { figure: 0 })];
    inputs.extend((0..150).map(|_| visitor.act()));
    inputs.push(finish);
    inputs.extend((0..pause).map(|_| visitor.act()));
    inputs.push(start(Mode::Creative));
    inputs.extend((0..60).map(|_| visitor.act()));
    inputs.push(finish);
    inputs.extend((0..60).map(|_| visitor.act()));
    inputs
}

/// Steps an empty world through inputs; its digests, and what `each` made of the ticks.
fn run<T>(
    studio: &mut Studio<64>,
    inputs: &[Input],
    mut each: impl FnMut(&World<64>) -> Option<T>,
) -> (Vec<u64>, Vec<T>) {
    studio.open();
    let (mut digests, mut made) = (vec![], vec![]);
    for input in inputs {
        studio.step(input);
        made.extend(each(&studio.world));
        digests.push(studio.world.digest());
    }
    (digests, made)
}

/// Without a printer: digests, and the files of what was finished, drained at once.
fn without(shop: &mut Shop, inputs: &[Input]) -> (Vec<u64>, Vec<Vec<u8>>) {
    let Shop { studio, exporter, .. } = shop;
    run(studio, inputs, |world| {
        let finished = world.events().contains(&Event::Finished);
        finished.then(|| drained(exporter, world.volume().rows(), world.mask()))
    })
}

/// With one: digests, prints, and the most ticks that one took.
fn beside(shop: &mut Shop, inputs: &[Input]) -> (Vec<u64>, Vec<Print>, u32) {
    let mut printer = Printer::new(&mut shop.press, HEIGHT_MM).unwrap();
    let (mut busy, mut most) = (0, 0);
    let (digests, prints) = run(&mut shop.studio, inputs, |world| {
        let print = printer.tick(world);
        busy = if printer.is_busy() { busy + 1 } else { 0 };
        most = most.max(busy);
        print
    });
    assert!(!printer.is_busy() && printer.complete().is_none());
    (digests, prints, most)
}

fn files(prints: &[Print]) -> Vec<&[u8]> {
    prints.iter().map(|print| &print.stl[..]).collect()
}

#[test]
fn ticks_and_bytes_are_those_of_a_print_made_at_once() {
    let mut shop = shop();
    let inputs = sessions(40);
    let (digests, expected) = without(&mut shop, &inputs);
    let (same, prints, ticks) = beside(&mut shop, &inputs);
    assert!(digests == same);
    assert_eq!(expected.len(), 2);
    assert!(files(&prints) == expected);
    assert!(ticks >= 3, "it was spread over {ticks} ticks");
    for print in prints {
        assert!(print.triangles > 1000);
        assert_eq!(print.stl.len(), 84 + 50 * print.triangles as usize);
    }
}

#[test]
fn a_new_session_leaves_the_print_alone() {
    let mut shop = shop();
    let inputs = sessions(0);
    let (digests, expected) = without(&mut shop, &inputs);
    let (same, prints, _) = beside(&mut shop, &inputs);
    assert!(digests == same && files(&prints) == expected);
}

#[test]
fn no_finished_sculpture_is_lost() {
    let mut shop = shop();
    let mut inputs = sessions(0);
    // The second session is finished in the tick after its start.
    let finish = inputs.remove(inputs.len() - 61);
    inputs.insert(153, finish);
    assert_eq!((inputs[152].start, inputs[153].commands), (Mode::Creative, commands::FINISH));
    let (digests, expected) = without(&mut shop, &inputs);
    assert!(expected.len() == 2 && expected[0] != expected[1]);
    let (same, prints, _) = beside(&mut shop, &inputs);
    assert!(digests == same && files(&prints) == expected);
}

#[test]
fn each_step_stays_in_its_budget() {
    let shop = &mut *shop();
    let Shop { studio, press, exporter } = shop;
    studio.start(Mode::Constrained { figure: 0 });
    let (rows, mask) = (studio.world.volume().rows(), studio.world.mask());
    // Bytes that there are after each unit of work.
    let mut units = vec![0];
    let mut buffer = vec![0; Exporter::<64>::MIN_BUFFER];
    exporter.start(HEIGHT_MM).unwrap();
    loop {
        let progress = exporter.advance(rows, mask, 1, &mut buffer);
        units.push(units.last().unwrap() + progress.written);
        if progress.stage == Stage::Done {
            break;
        }
    }
    let mut printer = Printer::new(press, HEIGHT_MM).unwrap();
    printer.begin(rows, mask);
    let (mut steps, mut before) = (0, 0);
    let print = loop {
        steps += 1;
        let print = printer.advance();
        let made = print.as_ref().map_or(printer.made(), |print| print.stl.len());
        let most = units[units.len().min(steps * BUDGET as usize + 1) - 1];
        assert!(made <= most, "step {steps}: {made} bytes, the budget is for {most}");
        assert!(made - before <= ROOM);
        before = made;
        if let Some(print) = print {
            break print;
        }
    };
    assert_eq!(print.stl.len(), *units.last().unwrap());
    assert!(steps * BUDGET as usize >= units.len() - 1, "{steps} steps for {}", units.len() - 1);
}

#[test]
fn nothing_is_printed_of_nothing() {
    let shop = &mut *shop();
    for height in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(Printer::new(&mut shop.press, height).is_err());
    }
    let mut printer = Printer::new(&mut shop.press, HEIGHT_MM).unwrap();
    shop.studio.start_from(|_| false);
    assert_eq!((printer.tick(&shop.studio.world), printer.is_busy()), (None, false));
    shop.studio.step(&Input { commands: commands::FINISH, ..Input::default() });
    assert_eq!((printer.tick(&shop.studio.world), printer.is_busy()), (None, true));
    assert_eq!(printer.complete().map(|print| print.triangles), Some(0));
}
