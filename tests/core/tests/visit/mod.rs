//! Visits in the world, against their naive model and the invariants that hold whatever visitors do.

mod exhibition;
mod presence;

use exhibition::{Deed, Exhibition, N, Stretch};
use paros_core::TickInput;
use paros_core::limits::max_save_bytes;
use paros_core::session::{BenchItem, SessionMode, SessionState, TICK_RATE, Tool};
use paros_core::visit::{
    GuideStep, PanelAction, PlanSetting, Presence, StaffCommand, VisitCommand, VisitInput,
    VisitPhase,
};
use paros_models::cases::random_cases;
use paros_models::dense::DenseVolume;
use paros_models::visit::VisitModel;
use proptest::prelude::*;

fn any_command() -> impl Strategy<Value = VisitCommand> {
    let action = prop_oneof![
        4 => Just(PanelAction::Confirm),
        1 => (0u8..3).prop_map(PanelAction::Language),
        1 => Just(PanelAction::Start(SessionMode::Creative)),
        1 => Just(PanelAction::Start(SessionMode::Constrained { figure: 0 })),
        1 => Just(PanelAction::Start(SessionMode::Constrained { figure: 9 })),
        2 => any::<bool>().prop_map(|all| PanelAction::Skip { all }),
        1 => Just(PanelAction::Finish),
        1 => Just(PanelAction::PutBack),
    ];
    let staff =
        prop_oneof![Just(StaffCommand::Extend), Just(StaffCommand::End), Just(StaffCommand::Reset)];
    let set = (0..PlanSetting::ALL.len(), 0u16..4).prop_map(|(setting, value)| VisitCommand::Set {
        setting: PlanSetting::ALL[setting],
        value,
    });
    prop_oneof![
        6 => Just(VisitCommand::None),
        6 => action.prop_map(VisitCommand::Press),
        2 => staff.prop_map(VisitCommand::Staff),
        4 => set,
        1 => Just(VisitCommand::SetStart(SessionMode::Creative)),
        1 => (0u16..60).prop_map(|seconds| VisitCommand::Away { seconds }),
        2 => Just(VisitCommand::Exported),
        1 => (0u32..1 << 27).prop_map(|number| VisitCommand::Badge { number }),
        1 => Just(VisitCommand::Open),
    ]
}

fn any_stretch() -> impl Strategy<Value = Stretch> {
    let deed = prop_oneof![
        4 => Just(Deed::Nothing),
        2 => Just(Deed::Take(BenchItem::Tool(Tool::Rotary).number() as u8)),
        1 => Just(Deed::Take(BenchItem::Tool(Tool::Rasp).number() as u8)),
        4 => Just(Deed::Cut),
        2 => Just(Deed::CutAside),
        1 => Just(Deed::Undo),
        1 => Just(Deed::Turn),
    ];
    let presence = prop_oneof![
        4 => Just(Presence::Worn),
        1 => Just(Presence::Off),
        1 => Just(Presence::Unknown)
    ];
    (1u32..150, presence, any::<bool>(), any_command(), deed).prop_map(
        |(ticks, presence, is_used, command, deed)| Stretch {
            ticks,
            presence,
            is_used,
            command,
            deed,
        },
    )
}

proptest! {
    #![proptest_config(random_cases(10))]

    /// Each tick follows the model. Afterwards the visit always reaches attract, and every sculpture was
    /// finished.
    #[test]
    fn visits_follow_their_model(
        stretches in prop::collection::vec(any_stretch(), 1..60),
        length in 0u16..6,
    ) {
        let mut exhibition = Exhibition::open(length);
        for stretch in &stretches {
            exhibition.run(stretch);
        }
        let before = exhibition.finished;
        let is_due = exhibition.harness.world.visit().is_sculpted()
            && exhibition.harness.world.session_state() == SessionState::Sculpting;
        exhibition.leave_for(90);
        prop_assert_eq!(exhibition.phase(), VisitPhase::Attract);
        prop_assert!(!is_due || exhibition.finished > before, "a sculpture was lost");
    }
}

#[test]
fn a_visit_goes_from_attract_to_badge_and_back() {
    let mut exhibition = Exhibition::open(30);
    exhibition.cut_something();
    exhibition.do_for(31.0, Deed::Nothing);
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    exhibition.do_for(3.0, Deed::CutAside);
    assert_eq!(exhibition.phase(), VisitPhase::Export);
    assert_eq!(exhibition.harness.world.session_state(), SessionState::Finished);
    let number = 0x0123_4567 & ((1 << 27) - 1);
    exhibition.tell(Presence::Worn, VisitCommand::Badge { number });
    exhibition.tell(Presence::Worn, VisitCommand::Exported);
    assert_eq!(exhibition.harness.world.visit().badge(), Some(number));
    exhibition.press(PanelAction::Confirm);
    assert_eq!(exhibition.phase(), VisitPhase::Badge, "it is shown for ten seconds at least");
    exhibition.do_for(10.0, Deed::Nothing);
    exhibition.press(PanelAction::Confirm);
    assert_eq!(exhibition.phase(), VisitPhase::Thanks);
    exhibition.leave_for(5);
    assert_eq!(exhibition.phase(), VisitPhase::Attract);
    assert_eq!(exhibition.finished, 1);
    let way = [2, 3, 4, 5, 6, 7, 8, 9, 1].map(|number| VisitPhase::ALL[number]);
    assert_eq!(exhibition.phases[1..], way);
}

/// Without a press, timeouts advance the visit with its default choices.
#[test]
fn who_presses_nothing_sculpts_all_the_same() {
    let mut exhibition = Exhibition::open(600);
    exhibition.tell(Presence::Worn, VisitCommand::None);
    for (seconds, phase) in
        [(20, VisitPhase::Welcome), (45, VisitPhase::Choice), (60, VisitPhase::Guided)]
    {
        assert_eq!(exhibition.phase(), phase);
        exhibition.do_for(seconds as f32 - 0.5, Deed::Nothing);
        assert_eq!(exhibition.phase(), phase, "{seconds} s are not over");
        exhibition.do_for(0.5, Deed::Nothing);
    }
    assert_eq!(exhibition.phase(), VisitPhase::Sculpting);
    assert_eq!(exhibition.harness.world.mode(), SessionMode::FreeForm);
    assert_eq!(exhibition.harness.world.visit().working_hand(), 1);
}

#[test]
fn the_guided_steps_end_when_they_are_done() {
    let mut exhibition = Exhibition::open(0);
    exhibition.tell(Presence::Worn, VisitCommand::None);
    exhibition.press(PanelAction::Confirm);
    exhibition.press(PanelAction::Confirm);
    let step = |exhibition: &Exhibition| exhibition.harness.world.visit().guide_step();
    assert_eq!(step(&exhibition), GuideStep::TakeTool);
    exhibition.do_for(0.05, Deed::Take(BenchItem::Tool(Tool::Rotary).number() as u8));
    assert_eq!(step(&exhibition), GuideStep::Touch);
    exhibition.do_for(0.5, Deed::Cut);
    assert_eq!(step(&exhibition), GuideStep::Smooth, "touched and cut");
    exhibition.press(PanelAction::Skip { all: false });
    assert_eq!(step(&exhibition), GuideStep::Undo);
    exhibition.do_for(0.02, Deed::Undo);
    assert_eq!(step(&exhibition), GuideStep::TurnStool);
    exhibition.do_for(0.02, Deed::Turn);
    assert_eq!(exhibition.phase(), VisitPhase::Sculpting);
}

#[test]
fn what_was_sculpted_is_kept_when_the_visitor_goes_and_nothing_is_kept_of_nothing() {
    let mut exhibition = Exhibition::open(600);
    exhibition.cut_something();
    exhibition.leave_for(44);
    assert_eq!(exhibition.phase(), VisitPhase::Sculpting);
    exhibition.leave_for(2);
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    assert!(exhibition.harness.world.visit().is_left());
    exhibition.leave_for(9);
    assert_eq!((exhibition.finished, exhibition.phase()), (1, VisitPhase::Handover));
    exhibition.tell(Presence::Worn, VisitCommand::None);
    assert_eq!(exhibition.phase(), VisitPhase::Welcome, "the next one doesn't wait");
    exhibition.press(PanelAction::Confirm);
    exhibition.press(PanelAction::Confirm);
    exhibition.leave_for(10);
    assert_eq!((exhibition.finished, exhibition.phase()), (1, VisitPhase::Attract));
    // The headset slept and is back a minute later: the visitor is a new one.
    exhibition.cut_something();
    exhibition.tell(Presence::Worn, VisitCommand::Away { seconds: 60 });
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    // A visitor who has worn it since then needn't take it off.
    exhibition.do_for(4.0, Deed::Nothing);
    exhibition.tell(Presence::Worn, VisitCommand::Exported);
    assert_eq!((exhibition.finished, exhibition.phase()), (2, VisitPhase::Handover));
    assert_eq!(exhibition.harness.world.visit().idle_ticks(), 0);
    exhibition.tell(Presence::Worn, VisitCommand::None);
    assert_eq!(exhibition.phase(), VisitPhase::Welcome);
}

#[test]
fn the_staff_extends_ends_and_resets() {
    let mut exhibition = Exhibition::open(30);
    exhibition.cut_something();
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::Extend));
    exhibition.do_for(85.0, Deed::Nothing);
    assert_eq!(exhibition.phase(), VisitPhase::Sculpting);
    exhibition.do_for(6.0, Deed::Nothing);
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::Extend));
    assert_eq!(exhibition.phase(), VisitPhase::Sculpting, "a minute more, though it was over");
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::End));
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::Extend));
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::Reset));
    exhibition.do_for(4.0, Deed::Nothing);
    assert!(exhibition.finished == 1, "a reset keeps what was sculpted");
}

/// After *done* or the end of the time, the visitor may be gone when the staff arrives.
#[test]
fn the_staff_resets_while_hands_are_off() {
    let reset = VisitCommand::Staff(StaffCommand::Reset);
    let mut exhibition = Exhibition::open(600);
    exhibition.cut_something();
    exhibition.press(PanelAction::Finish);
    exhibition.do_for(1.0, Deed::Nothing);
    exhibition.tell(Presence::Worn, reset);
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::Extend));
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff, "nobody is there for a minute more");
    exhibition.do_for(3.0, Deed::Nothing);
    assert_eq!((exhibition.phase(), exhibition.finished), (VisitPhase::Export, 1));
    exhibition.tell(Presence::Worn, VisitCommand::Exported);
    assert_eq!(exhibition.phase(), VisitPhase::Handover, "nobody waits for a badge");
    // If nothing was cut, there is nothing to wait for.
    exhibition.leave_for(10);
    exhibition.tell(Presence::Worn, VisitCommand::None);
    exhibition.press(PanelAction::Confirm);
    exhibition.press(PanelAction::Confirm);
    exhibition.tell(Presence::Worn, VisitCommand::Staff(StaffCommand::End));
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    exhibition.tell(Presence::Worn, reset);
    assert_eq!((exhibition.phase(), exhibition.finished), (VisitPhase::Attract, 1));
}

/// A visit loaded from a save continues as if uninterrupted.
#[test]
fn a_visit_goes_on_from_its_save() {
    let mut exhibition = Exhibition::open(40);
    exhibition.cut_something();
    exhibition.do_for(7.0, Deed::Nothing);
    let mut save = vec![0; max_save_bytes(N, 1)];
    let len = exhibition.harness.world.save(&mut save);
    save.truncate(len);
    let run = |exhibition: &mut Exhibition| -> Vec<u64> {
        let input = TickInput {
            visit: VisitInput { presence: Presence::Worn, is_used: true, ..VisitInput::default() },
            ..TickInput::default()
        };
        let ticks = 0..50 * TICK_RATE;
        let digest = |_| {
            exhibition.harness.step(&input);
            exhibition.harness.world.digest()
        };
        ticks.map(digest).collect()
    };
    let uninterrupted = run(&mut exhibition);
    assert_eq!(exhibition.phase(), VisitPhase::Export);
    exhibition.harness.world.load(&save).expect("it was just written");
    assert!(run(&mut exhibition) == uninterrupted);
}

/// During hands-off, floating stone falls before the sculpture is final, even if a redo is possible, which
/// otherwise delays island removal. A hand that works on cuts nothing.
#[test]
fn what_floats_falls_before_the_sculpture_is_final() {
    let mut exhibition = Exhibition::open(600);
    let side = N as i32;
    let mut volume = DenseVolume::empty(N);
    for (x, y, z) in
        (0..side).flat_map(|x| (0..side).flat_map(move |y| (0..side).map(move |z| (x, y, z))))
    {
        let is_ground = y < side / 2;
        let floats = (2..5).contains(&x) && (2..5).contains(&z) && (24..27).contains(&y);
        volume.set([x, y, z], is_ground || floats);
    }
    exhibition.harness.reset_to_voxels(&volume, &DenseVolume::empty(N));
    exhibition.model = VisitModel::closed();
    exhibition.tell(Presence::Off, VisitCommand::Open);
    let floats =
        |exhibition: &Exhibition| exhibition.harness.world.volume().maps().contains([3, 25, 3]);
    exhibition.tell(Presence::Worn, VisitCommand::None);
    exhibition.press(PanelAction::Confirm);
    exhibition.press(PanelAction::Confirm);
    exhibition.press(PanelAction::Skip { all: true });
    exhibition.do_for(0.05, Deed::Take(BenchItem::Tool(Tool::Rotary).number() as u8));
    exhibition.do_for(0.5, Deed::Cut);
    // The pass requested by this undo waits while a redo is possible.
    exhibition.do_for(0.02, Deed::Undo);
    let undone = exhibition.harness.world.undo_counts();
    assert!(undone.redoable > 0, "{undone:?}");
    exhibition.press(PanelAction::Finish);
    exhibition.do_for(2.0, Deed::Cut);
    assert_eq!(exhibition.phase(), VisitPhase::HandsOff);
    exhibition.do_for(2.0, Deed::Cut);
    assert_eq!(exhibition.phase(), VisitPhase::Export);
    assert!(!floats(&exhibition), "a piece floats in the print");
}
