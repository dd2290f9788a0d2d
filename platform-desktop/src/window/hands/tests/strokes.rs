//! Mouse strokes at the speeds of people's hands.

use paros_core::session::{PointerCommand, SessionMode};

use super::HandsFixture;
use crate::window::hands::{HandAction, HandButton, InputEvent, RIGHT};

#[test]
fn a_stroke_is_one_groove_however_fast_the_hand_is() {
    let groove = |points: u32| {
        let mut fixture = HandsFixture::new(SessionMode::FreeForm);
        fixture.handle(InputEvent::Moved([440.0, 400.0]));
        fixture.ticks(10);
        let before = fixture.voxel_count();
        fixture.handle(InputEvent::Pressed(HandButton::Left));
        fixture.ticks(10);
        for i in 1..=points {
            fixture.handle(InputEvent::Moved([440.0 + 120.0 * i as f32 / points as f32, 400.0]));
            fixture.tick();
        }
        fixture.ticks(150);
        fixture.handle(InputEvent::Released(HandButton::Left));
        fixture.ticks(2);
        before - fixture.voxel_count()
    };
    let (slow, fast) = (groove(100), groove(1));
    assert!(slow > 400, "{slow} voxels");
    assert!(fast * 10 > slow * 9 && slow * 10 > fast * 9, "{slow} slowly, {fast} fast");
}

/// The tool is put back in the middle of a swipe, as in the hands-off phase.
#[test]
fn a_tool_that_was_put_back_finishes_no_stroke_once_it_is_taken_again() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.handle(InputEvent::Moved([440.0, 400.0]));
    fixture.ticks(10);
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    fixture.handle(InputEvent::Moved([640.0, 400.0]));
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.tick();
    fixture.hands.pointers.push_back(PointerCommand::Return { hand: RIGHT as u8 });
    fixture.ticks(3);
    assert!(fixture.resident.world.held_tool(RIGHT).is_none());
    let before = fixture.digest();
    fixture.tap_key_and_tick(HandAction::Tool(0));
    fixture.ticks(60);
    assert!(fixture.resident.world.held_tool(RIGHT).is_some());
    assert_eq!(fixture.digest(), before, "nobody pulls its trigger");
}

/// A natural swipe is 170 pixels in 0.38 s, with the button released at its end. A slow one follows more of
/// the stone's bumps.
#[test]
fn a_quick_swipe_cuts_to_where_the_button_went_up() {
    let slow = swipe(600);
    for (ticks, name) in [(27, "in 0.38 s"), (4, "in a frame")] {
        let quick = swipe(ticks);
        let cut =
            quick.depths.iter().zip(&slow.depths).filter(|(quick, slow)| *quick * 2.0 >= **slow);
        let (cut, way) = (cut.count(), slow.depths.len());
        assert!(cut * 100 >= way * 95, "{name}: {cut} of {way} pixels of the way are cut");
        let (quick, slow) = (quick.removed, slow.removed);
        assert!(quick * 100 >= slow * 85, "{name}: {quick} voxels, slowly {slow}");
        assert!(quick * 100 <= slow * 110, "{name}: {quick} voxels, slowly {slow}");
    }
}

/// The result of a swipe of 170 pixels.
struct Swiped {
    /// Number of voxels removed.
    removed: u64,
    /// Depth of the cut at each pixel of the swipe, along the eye's ray, in voxels.
    depths: Vec<f32>,
}

/// Swipes over the lump in `ticks` ticks and releases the button; then the cursor moves on.
fn swipe(ticks: u32) -> Swiped {
    const WAY: u32 = 170;
    let pixel = |along: f32| [400.0 + along, 400.0];
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.handle(InputEvent::Moved(pixel(0.0)));
    fixture.ticks(10);
    let (voxels, surface) =
        (fixture.voxel_count(), fixture.surface_depths((0..=WAY).map(|i| pixel(i as f32))));
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    for i in 1..=ticks {
        fixture.handle(InputEvent::Moved(pixel((WAY * i) as f32 / ticks as f32)));
        fixture.tick();
    }
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.handle(InputEvent::Moved([300.0, 300.0]));
    fixture.ticks(60);
    let cut = fixture.surface_depths((0..=WAY).map(|i| pixel(i as f32)));
    let depths = cut.iter().zip(surface).map(|(cut, surface)| cut - surface).collect();
    Swiped { removed: voxels - fixture.voxel_count(), depths }
}

/// Two pulls are two strokes, even if the tool still cuts the first when the second begins.
#[test]
fn a_new_press_while_the_tool_follows_is_a_new_stroke() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.handle(InputEvent::Moved([400.0, 400.0]));
    fixture.ticks(10);
    for [from, to] in [[400.0, 560.0], [420.0, 600.0]] {
        fixture.handle(InputEvent::Moved([from, 400.0]));
        fixture.handle(InputEvent::Pressed(HandButton::Left));
        fixture.ticks(8);
        fixture.handle(InputEvent::Moved([to, 400.0]));
        fixture.tick();
        fixture.handle(InputEvent::Released(HandButton::Left));
    }
    fixture.ticks(100);
    assert_eq!(fixture.resident.world.undo_counts().undoable, 2);
}
