//! Print orders of visitors.

use super::common::*;
use paros_booth_rules::limits::MAX_PRINTS_OF_ONE;
use paros_booth_rules::records::{EstimateState, PrintOrder, PrintState};
use paros_booth_rules::{PrintSize, PrintStep, PrintWish, SliceOutcome};

const STATES: [PrintState; 6] = [
    PrintState::Ordered,
    PrintState::Sliced,
    PrintState::Printing,
    PrintState::Done,
    PrintState::Failed,
    PrintState::Cancelled,
];

const STEPS: [PrintStep; 6] = [
    PrintStep::Slice,
    PrintStep::Start,
    PrintStep::Finish,
    PrintStep::Fail,
    PrintStep::Cancel,
    PrintStep::Retry,
];

const KNOWN: SliceOutcome = SliceOutcome::Known { height: 800, minutes: 95, tenths_gram: 123 };

fn with_sculpture() -> (Rig, SculptureId) {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, leased(5));
    rig.upload(&device, &parcel, START).unwrap();
    (rig, parcel.id)
}

fn wish(size: PrintSize) -> PrintWish {
    PrintWish { size, filament: "  white ".into(), note: "by five,\r\nplease".into() }
}

const TALL: PrintSize = PrintSize::Height(1200);

impl Rig {
    fn print(&self, id: &SculptureId) -> PrintOrder {
        self.booth.list_prints(id).unwrap().remove(0)
    }

    fn step(&self, step: PrintStep) {
        self.booth.step_print(7, (step, true), "bob", seconds(9)).unwrap();
    }
}

/// Checks that no print gets stuck: every state can reach every other state.
#[test]
fn every_state_can_be_left_and_every_state_is_reached() {
    for from in STATES {
        let mut reached = vec![from];
        let mut k = 0;
        while let Some(state) = reached.get(k).copied() {
            for next in STEPS.iter().filter_map(|step| state.after(*step)) {
                assert_ne!(next, state, "a step leads on");
                if !reached.contains(&next) {
                    reached.push(next);
                }
            }
            k += 1;
        }
        assert_eq!(reached.len(), STATES.len(), "from {from:?}");
    }
    // An ended print can only be ordered again; an open print can't.
    for state in STATES {
        let can = |step| state.after(step).is_some();
        assert_eq!(can(PrintStep::Retry), !state.is_open(), "{state:?}");
        assert_eq!(can(PrintStep::Cancel), state.is_open(), "{state:?}");
        assert_eq!(can(PrintStep::Finish), state == PrintState::Printing, "{state:?}");
    }
}

#[test]
fn a_print_is_ordered_sliced_printed_and_done() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    booth.ask_print(&id, &wish(TALL), (7, true), "bob", START).unwrap();
    let order = rig.print(&id);
    assert_eq!((order.state, order.estimate), (PrintState::Ordered, EstimateState::Waiting));
    assert_eq!((order.filament.as_str(), order.note.as_str()), ("white", "by five,\r\nplease"));
    let job = booth.next_slice(START).unwrap().expect("it waits");
    assert_eq!((job.order.order, job.sculpture.id), (7, id.0));
    booth.note_slice(7, &KNOWN, seconds(1)).unwrap();
    let order = rig.print(&id);
    assert_eq!((order.state, order.estimate), (PrintState::Sliced, EstimateState::Known));
    assert_eq!((order.minutes, order.tenths_gram), (Some(95), Some(123)));
    assert_eq!(booth.next_slice(START).unwrap(), None);
    // A repeated outcome, such as after a power cut, changes nothing.
    booth.note_slice(7, &SliceOutcome::Unknown("?".into()), seconds(2)).unwrap();
    assert_eq!(rig.print(&id), order);
    rig.step(PrintStep::Start);
    assert_eq!(status(booth.step_print(7, (PrintStep::Start, true), "bob", START)), 409);
    rig.step(PrintStep::Finish);
    assert_eq!(rig.print(&id).state, PrintState::Done);
    let audit = booth.list_audit(10).unwrap();
    for action in ["print", "print started", "print done"] {
        assert!(audit.iter().any(|entry| entry.action == action), "{action}");
    }
    rig.step(PrintStep::Retry);
    let order = rig.print(&id);
    assert_eq!(
        (order.state, order.estimate, order.minutes),
        (PrintState::Ordered, EstimateState::Waiting, None)
    );
    assert_eq!(status(booth.step_print(8, (PrintStep::Start, true), "bob", START)), 404);
}

#[test]
fn without_a_slicer_a_print_is_started_by_hand_and_no_size_follows_from_a_time() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    let by_time = wish(PrintSize::Minutes(120));
    assert_eq!(status(booth.ask_print(&id, &by_time, (7, false), "bob", START)), 400);
    booth.ask_print(&id, &wish(TALL), (7, false), "bob", START).unwrap();
    assert_eq!(rig.print(&id).estimate, EstimateState::Unknown);
    assert_eq!(booth.next_slice(START).unwrap(), None);
    rig.step(PrintStep::Start);
    rig.step(PrintStep::Fail);
    assert_eq!(rig.print(&id).state, PrintState::Failed);
}

#[test]
fn a_slicer_that_fails_fails_what_needs_it_alone() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    let failed = SliceOutcome::Unknown("it took too long".into());
    booth.ask_print(&id, &wish(TALL), (7, true), "bob", START).unwrap();
    booth.note_slice(7, &failed, seconds(1)).unwrap();
    let order = rig.print(&id);
    assert_eq!((order.state, order.why.as_str()), (PrintState::Ordered, "it took too long"));
    assert_eq!(booth.next_slice(START).unwrap(), None, "it isn't tried for ever");
    let by_time = wish(PrintSize::Minutes(120));
    booth.ask_print(&id, &by_time, (8, true), "bob", seconds(2)).unwrap();
    booth.note_slice(8, &failed, seconds(3)).unwrap();
    assert_eq!((rig.print(&id).order, rig.print(&id).state), (8, PrintState::Failed));
    booth.step_print(8, (PrintStep::Retry, true), "bob", seconds(4)).unwrap();
    booth.note_slice(8, &KNOWN, seconds(5)).unwrap();
    assert_eq!(rig.print(&id).height_tenths_mm, 800);
    booth.step_print(8, (PrintStep::Cancel, true), "bob", seconds(6)).unwrap();
    assert_eq!(status(booth.step_print(8, (PrintStep::Retry, false), "bob", seconds(7))), 400);
}

#[test]
fn a_print_that_is_begun_before_it_is_sliced_is_still_estimated() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    let outcomes = [KNOWN, SliceOutcome::Unknown("it took too long".into())];
    for (number, outcome) in (7..).zip(outcomes) {
        booth.ask_print(&id, &wish(TALL), (number, true), "bob", START).unwrap();
        booth.step_print(number, (PrintStep::Start, true), "bob", START).unwrap();
        assert_eq!(booth.next_slice(START).unwrap().map(|job| job.order.order), Some(number));
        booth.note_slice(number, &outcome, seconds(10)).unwrap();
        let order = booth.find_print(number).unwrap().order;
        assert_eq!(order.state, PrintState::Printing);
        assert_eq!(order.minutes.is_some(), outcome == KNOWN);
        assert_eq!(booth.next_slice(START).unwrap(), None, "nobody waits for it any more");
    }
}

#[test]
fn the_queue_shows_what_is_open_first() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    for order in 1..=4 {
        booth.ask_print(&id, &wish(TALL), (order, true), "bob", seconds(order)).unwrap();
    }
    booth.note_slice(3, &KNOWN, seconds(10)).unwrap();
    booth.step_print(2, (PrintStep::Start, true), "bob", seconds(11)).unwrap();
    booth.step_print(1, (PrintStep::Cancel, true), "bob", seconds(12)).unwrap();
    let queue = booth.list_print_queue().unwrap();
    let orders: Vec<u64> = queue.iter().map(|job| job.order.order).collect();
    assert_eq!(orders, [2, 3, 4, 1]);
}

#[test]
fn what_is_withdrawn_is_not_printed_and_what_is_deleted_has_no_orders() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    booth.ask_print(&id, &wish(TALL), (7, true), "bob", START).unwrap();
    booth.ask_print(&id, &wish(TALL), (8, true), "bob", START).unwrap();
    booth.step_print(8, (PrintStep::Start, true), "bob", START).unwrap();
    booth.withdraw(&id, "bob", seconds(1)).unwrap();
    let state = |order| booth.find_print(order).unwrap().order.state;
    // People deal with a print that is running.
    assert_eq!((state(7), state(8)), (PrintState::Cancelled, PrintState::Printing));
    assert_eq!(status(booth.ask_print(&id, &wish(TALL), (9, true), "bob", START)), 404);
    assert_eq!(status(booth.step_print(7, (PrintStep::Retry, true), "bob", START)), 404);
    booth.bring_back(&id, "bob", seconds(2)).unwrap();
    booth.step_print(7, (PrintStep::Retry, true), "bob", seconds(3)).unwrap();
    booth.delete(&id, "bob", seconds(4)).unwrap();
    assert_eq!(booth.list_prints(&id).unwrap(), []);
    assert_eq!(booth.next_slice(START).unwrap(), None);
    booth.note_slice(7, &KNOWN, seconds(5)).unwrap();
    assert_eq!(status(booth.find_print(7)), 404);
}

#[test]
fn an_order_is_within_its_bounds() {
    let (rig, id) = with_sculpture();
    let ask = |wish: &PrintWish, order| rig.booth.ask_print(&id, wish, (order, true), "bob", START);
    let fine = wish(TALL);
    for bad in [
        wish(PrintSize::Height(99)),
        wish(PrintSize::Height(10_001)),
        wish(PrintSize::Minutes(4)),
        wish(PrintSize::Minutes(u32::MAX)),
        PrintWish { filament: "a".repeat(41), ..fine.clone() },
        PrintWish { filament: "a\nb".into(), ..fine.clone() },
        PrintWish { note: "ά".repeat(301), ..fine.clone() },
        PrintWish { note: "a\0".into(), ..fine.clone() },
    ] {
        assert_eq!(status(ask(&bad, 1)), 400, "{bad:?}");
    }
    assert_eq!(rig.booth.list_prints(&id).unwrap(), []);
    ask(&fine, 0).unwrap();
    assert_eq!(status(ask(&fine, 0)), 409, "its number is another's");
    for order in 1..MAX_PRINTS_OF_ONE {
        ask(&fine, order).unwrap();
    }
    assert_eq!(status(ask(&fine, 99)), 409);
    assert_eq!(
        status(rig.booth.ask_print(&SculptureId([9; 16]), &fine, (98, true), "bob", START)),
        404
    );
}
