//! Simulates a newcomer's mouse: rows of strokes over the visible side, with the stool turned between, and no
//! knowledge of the figure.

use paros_core::session::{BenchItem, FOUND_PERCENT, TICK_RATE, ToolBit};
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};

use super::HandsFixture;
use crate::window::hands::{HandButton, InputEvent, RIGHT};
use crate::window::panels::StudioStatus;
use crate::window::panels::hints::Hints;
use crate::window::panels::tests::sculpting_status;

/// Ticks within which the owl must be found: four minutes.
const WITHIN: u64 = 240 * TICK_RATE as u64;

#[test]
fn rows_of_a_mouse_find_the_owl_within_four_minutes() {
    let owl = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Near };
    let mut fixture = HandsFixture::new(owl.mode());
    // Deep enough for the coat, as the hint at the wheel suggests.
    fixture.handle(InputEvent::Wheel(9.0));
    let begun = fixture.resident.world.tick();
    let is_found =
        |fixture: &HandsFixture| fixture.resident.world.bared_ends().percent() >= FOUND_PERCENT;
    'sides: while fixture.resident.world.tick() - begun < WITHIN {
        for row in 0..12_u8 {
            stroke_row(&mut fixture, 120.0 + 35.0 * f32::from(row), row % 2 == 1);
            if is_found(&fixture) {
                break 'sides;
            }
        }
        turn_stool(&mut fixture);
    }
    let seconds = (fixture.resident.world.tick() - begun) / u64::from(TICK_RATE);
    println!("{} % after {seconds} s", fixture.resident.world.bared_ends().percent());
    assert!(is_found(&fixture), "only {} %", fixture.resident.world.bared_ends().percent());
}

/// A visitor who takes the bits that the hints name finds the owl even under the whole stone. With the first
/// ball alone less than a quarter of the owl is bared by then.
#[test]
fn hints_lead_from_ball_to_ball_and_so_to_an_owl_under_all_of_the_stone() {
    let owl = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Whole };
    let mut fixture = HandsFixture::new(owl.mode());
    let (mut hints, mut taken) = (Hints::default(), Vec::new());
    let begun = fixture.resident.world.tick();
    'sides: while fixture.resident.world.tick() - begun < WITHIN {
        for row in 0..12_u8 {
            stroke_row_and_watch(
                &mut fixture,
                120.0 + 35.0 * f32::from(row),
                row % 2 == 1,
                |fixture| {
                    let status = status_of(fixture);
                    hints.note_strokes(status.undo);
                    let work = hints.note_work(&status, 0.0);
                    if let Some(bit) = hints.bit(work).filter(|bit| taken.last() != Some(bit)) {
                        fixture.hands.take_item(BenchItem::Bit(bit));
                        taken.push(bit);
                    }
                },
            );
            if fixture.resident.world.bared_ends().percent() >= FOUND_PERCENT {
                break 'sides;
            }
        }
        turn_stool(&mut fixture);
    }
    let seconds = (fixture.resident.world.tick() - begun) / u64::from(TICK_RATE);
    let percent = fixture.resident.world.bared_ends().percent();
    println!("{percent} % after {seconds} s, by {taken:?}");
    assert_eq!(taken, [ToolBit::RoughingBall, ToolBit::MediumBall]);
    assert!(percent >= FOUND_PERCENT, "only {percent} % in {seconds} s");
}

/// Returns the status that the panels would get.
fn status_of(fixture: &HandsFixture) -> StudioStatus<'static> {
    let world = &fixture.resident.world;
    StudioStatus {
        mode: world.mode(),
        held: world.held_tool(RIGHT),
        bared_percent: world.bared_ends().percent(),
        tick: world.tick(),
        runs: world.hand_state(RIGHT).trigger,
        is_on_figure: world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask),
        undo: world.undo_counts(),
        ..sculpting_status()
    }
}

/// Makes a stroke of 380 pixels in half a second.
fn stroke_row(fixture: &mut HandsFixture, y: f32, is_to_the_left: bool) {
    stroke_row_and_watch(fixture, y, is_to_the_left, |_| {});
}

/// Makes such a stroke, and calls `watch` with the world after each tick.
fn stroke_row_and_watch(
    fixture: &mut HandsFixture,
    y: f32,
    is_to_the_left: bool,
    mut watch: impl FnMut(&mut HandsFixture),
) {
    let pixel = |step: u8| {
        let along = f32::from(if is_to_the_left { 18 - step } else { step });
        [310.0 + 21.0 * along, y]
    };
    let mut ticks = |fixture: &mut HandsFixture, count: u32| {
        for _ in 0..count {
            fixture.tick();
            watch(fixture);
        }
    };
    fixture.handle(InputEvent::Moved(pixel(0)));
    ticks(fixture, 8);
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    for step in 1..=18 {
        fixture.handle(InputEvent::Moved(pixel(step)));
        ticks(fixture, 2);
    }
    fixture.handle(InputEvent::Released(HandButton::Left));
    ticks(fixture, 20);
}

/// Turns the stool by an eighth of a turn, with the middle button down.
fn turn_stool(fixture: &mut HandsFixture) {
    fixture.handle(InputEvent::Moved([300.0, 660.0]));
    fixture.handle(InputEvent::Pressed(HandButton::Middle));
    fixture.handle(InputEvent::Moved([425.0, 660.0]));
    fixture.handle(InputEvent::Released(HandButton::Middle));
    fixture.ticks(36);
}
