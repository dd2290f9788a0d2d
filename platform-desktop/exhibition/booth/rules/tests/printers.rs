//! Prints on networked printers.

use super::common::*;
use paros_booth_rules::limits::{LIFE_AT_PRINTER, SENDING_LIFE};
use paros_booth_rules::records::{PrintOrder, PrintState};
use paros_booth_rules::{PrintSize, PrintStep, PrintWish, PrinterTask, PrinterWord, SliceOutcome};

const LEFT: &str = "Left";

/// Makes a booth with two sliced prints: 7 and 8.
fn with_prints() -> (Rig, SculptureId) {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, leased(5));
    rig.upload(&device, &parcel, START).unwrap();
    for order in [7, 8] {
        let size = PrintSize::Height(800);
        let wish = PrintWish { size, filament: String::new(), note: String::new() };
        rig.booth.ask_print(&parcel.id, &wish, (order, true), "bob", START).unwrap();
        let known = SliceOutcome::Known { height: 800, minutes: 95, tenths_gram: 123 };
        rig.booth.note_slice(order, &known, START).unwrap();
    }
    (rig, parcel.id)
}

impl Rig {
    fn order(&self, order: u64) -> PrintOrder {
        self.booth.find_print(order).unwrap().order
    }

    fn task(&self, now: u64) -> Option<PrinterTask> {
        self.booth.next_printer_task(LEFT, seconds(now)).unwrap()
    }

    fn step_print(&self, order: u64, step: PrintStep) {
        self.booth.step_print(order, (step, true), "bob", seconds(50)).unwrap();
    }

    /// Sends a print, until the printer has it.
    fn send(&self, order: u64) {
        self.booth.send_print(order, LEFT, "bob", START).unwrap();
        assert!(self.booth.begin_print(order, "a.gcode", START).unwrap());
    }
}

#[test]
fn a_print_is_sent_watched_and_done() {
    let (rig, _) = with_prints();
    let booth = &rig.booth;
    assert_eq!(rig.task(0), None);
    booth.send_print(7, LEFT, "bob", START).unwrap();
    assert_eq!(booth.next_printer_task("Right", START).unwrap(), None);
    assert!(matches!(rig.task(1), Some(PrinterTask::Send(job)) if job.order.order == 7));
    assert!(booth.begin_print(7, "a.gcode", seconds(1)).unwrap());
    assert!(!booth.begin_print(7, "b.gcode", seconds(1)).unwrap(), "it is sent once");
    assert_eq!(rig.order(7).state, PrintState::Printing);
    assert!(
        matches!(rig.task(2), Some(PrinterTask::Watch(order)) if order.job.as_deref() == Some("a.gcode"))
    );
    booth.note_printer_word(7, PrinterWord::Prints, seconds(3)).unwrap();
    booth.note_printer_word(7, PrinterWord::Finished, seconds(4)).unwrap();
    let order = rig.order(7);
    assert_eq!((order.state, order.printer, order.job), (PrintState::Done, None, None));
    assert_eq!(rig.task(5), None);
    booth.note_printer_word(7, PrinterWord::Broke, seconds(6)).unwrap();
    assert_eq!(rig.order(7).state, PrintState::Done);
}

/// The bed may still be full: a person sends each print, after the previous one has ended.
#[test]
fn a_printer_has_one_print() {
    let (rig, _) = with_prints();
    let send = |order| rig.booth.send_print(order, LEFT, "bob", seconds(60));
    rig.booth.send_print(7, LEFT, "bob", START).unwrap();
    assert_eq!(status(send(8)), 409, "one waits for it");
    rig.booth.begin_print(7, "a.gcode", START).unwrap();
    assert_eq!(status(send(8)), 409, "it prints one");
    rig.step_print(7, PrintStep::Cancel);
    assert_eq!(status(send(8)), 409, "it is yet to be stopped");
    assert!(matches!(rig.task(60), Some(PrinterTask::Stop(order)) if order.order == 7));
    rig.booth.release_printer(7).unwrap();
    send(8).unwrap();
    assert_eq!(status(rig.booth.send_print(7, "Right", "bob", START)), 409, "it is cancelled");
    assert_eq!(status(rig.booth.send_print(99, LEFT, "bob", START)), 404);
}

#[test]
fn a_printer_that_does_not_answer_is_not_waited_for() {
    let (rig, _) = with_prints();
    rig.booth.send_print(7, LEFT, "bob", START).unwrap();
    let life = SENDING_LIFE.as_secs();
    assert!(matches!(rig.task(life), Some(PrinterTask::Send(_))));
    assert_eq!(rig.task(life + 1), None);
    let order = rig.order(7);
    assert_eq!((order.state, order.printer), (PrintState::Sliced, None));
    assert_eq!(order.why, "the printer didn't answer");
    assert!(
        !rig.booth.begin_print(7, "a.gcode", seconds(life + 2)).unwrap(),
        "nor is it sent late"
    );
}

#[test]
fn what_a_printer_says_ends_a_print() {
    for (word, state) in [
        (PrinterWord::Prints, PrintState::Printing),
        (PrinterWord::Finished, PrintState::Done),
        (PrinterWord::Stopped, PrintState::Cancelled),
        (PrinterWord::Broke, PrintState::Failed),
    ] {
        let (rig, _) = with_prints();
        rig.send(7);
        rig.booth.note_printer_word(7, word, seconds(1)).unwrap();
        assert_eq!(rig.order(7).state, state, "{word:?}");
    }
    let (rig, _) = with_prints();
    rig.send(7);
    let life = LIFE_AT_PRINTER.as_secs();
    rig.booth.note_printer_word(7, PrinterWord::Other, seconds(life)).unwrap();
    assert_eq!(rig.order(7).state, PrintState::Printing, "it takes the file in");
    rig.booth.note_printer_word(7, PrinterWord::Other, seconds(life + 1)).unwrap();
    assert_eq!(rig.order(7).state, PrintState::Failed);
    rig.step_print(7, PrintStep::Retry);
    assert_eq!(rig.task(99), None, "it isn't sent again by itself");
}

#[test]
fn people_and_withdrawals_go_before_the_printer() {
    let (rig, _) = with_prints();
    rig.send(7);
    rig.step_print(7, PrintStep::Finish);
    assert_eq!((rig.order(7).state, rig.task(60)), (PrintState::Done, None));
    rig.booth.send_print(8, LEFT, "bob", START).unwrap();
    rig.step_print(8, PrintStep::Start);
    assert_eq!((rig.order(8).printer, rig.task(60)), (None, None), "it is printed by hand");
    let (rig, id) = with_prints();
    rig.booth.send_print(7, LEFT, "bob", START).unwrap();
    rig.booth.withdraw(&id, "bob", seconds(1)).unwrap();
    assert_eq!((rig.order(7).state, rig.task(2)), (PrintState::Cancelled, None));
    assert!(!rig.booth.begin_print(7, "a.gcode", seconds(2)).unwrap());
}
