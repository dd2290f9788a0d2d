//! A newcomer's mouse: rows over what is seen, the stool turned between, and no knowledge of the figure.

use paros_core::session::{FOUND_PERCENT, TICK_RATE};
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};

use super::HandsFixture;
use crate::window::hands::{HandButton, InputEvent};

/// Ticks in which the owl is to be found: four minutes.
const WITHIN: u64 = 240 * TICK_RATE as u64;

#[test]
fn rows_of_a_mouse_find_the_owl_within_four_minutes() {
    let owl = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Near };
    let mut fixture = HandsFixture::new(owl.mode());
    // Deep enough for the coat, as the hint at the wheel says how.
    fixture.handle(InputEvent::Wheel(9.0));
    let begun = fixture.world.tick();
    let is_found = |fixture: &HandsFixture| fixture.world.bared_ends().percent() >= FOUND_PERCENT;
    'sides: while fixture.world.tick() - begun < WITHIN {
        for row in 0..12_u8 {
            stroke_row(&mut fixture, 120.0 + 35.0 * f32::from(row), row % 2 == 1);
            if is_found(&fixture) {
                break 'sides;
            }
        }
        turn_stool(&mut fixture);
    }
    let seconds = (fixture.world.tick() - begun) / u64::from(TICK_RATE);
    println!("{} % after {seconds} s", fixture.world.bared_ends().percent());
    assert!(is_found(&fixture), "only {} %", fixture.world.bared_ends().percent());
}

/// A stroke of 380 pixels in half a second.
fn stroke_row(fixture: &mut HandsFixture, y: f32, is_to_the_left: bool) {
    let pixel = |step: u8| {
        let along = f32::from(if is_to_the_left { 18 - step } else { step });
        [310.0 + 21.0 * along, y]
    };
    fixture.handle(InputEvent::Moved(pixel(0)));
    fixture.ticks(8);
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    for step in 1..=18 {
        fixture.handle(InputEvent::Moved(pixel(step)));
        fixture.ticks(2);
    }
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.ticks(20);
}

/// Turns the stool by an eighth, the middle button down.
fn turn_stool(fixture: &mut HandsFixture) {
    fixture.handle(InputEvent::Moved([300.0, 660.0]));
    fixture.handle(InputEvent::Pressed(HandButton::Middle));
    fixture.handle(InputEvent::Moved([425.0, 660.0]));
    fixture.handle(InputEvent::Released(HandButton::Middle));
    fixture.ticks(36);
}
