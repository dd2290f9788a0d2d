//! The reach of visitors from the place and at the height that the room gives them, standing or seated,
//! without a step or a lean.

use glam::{Vec2, Vec3};
use paros_core::internals::{BENCH_ITEMS, BOX_SIDE, STOOL_RADIUS, STOOL_TOP};
use paros_core::session::BenchItem;

use paros_shell::headset::height_step::HeightStep;

/// The dimensions of a body, in metres: Pheasant and Haslegrave, "Bodyspace", British adults of 19 to 65
/// years; seats are 0.42 high.
struct Body {
    name: &'static str,
    /// The height of the eyes above the floor.
    eye_height: f32,
    /// The height of the shoulder joint (acromion) above the floor.
    shoulder_height: f32,
    /// The distance between the shoulder joints (biacromial).
    shoulder_breadth: f32,
    /// The distance from the shoulder joint to the middle of a held object.
    grip_length: f32,
}

const fn body(
    name: &'static str,
    [eye_height, shoulder_height]: [f32; 2],
    shoulder_breadth: f32,
    grip_length: f32,
) -> Body {
    Body { name, eye_height, shoulder_height, shoulder_breadth, grip_length }
}

/// Women of the 5th percentile and men of the 95th.
const BODIES: [Body; 4] = [
    body("small, standing", [1.41, 1.215], 0.325, 0.555),
    body("tall, standing", [1.75, 1.535], 0.430, 0.715),
    body("small, seated", [1.10, 0.925], 0.325, 0.555),
    body("tall, seated", [1.27, 1.065], 0.430, 0.715),
];

/// The distance at which a hand takes an item: the core's `GRAB_DISTANCE`.
const GRAB_DISTANCE: f32 = 0.12;

/// The radius around the visitor's place in which hands stay: a metre.
const BOUNDARY: f32 = 1.0;

impl Body {
    /// Returns how far a place is beyond the reach of the nearer shoulder, in metres; 0 within reach. The
    /// visitor stands at the room's origin and turns the trunk. The worse of two room heights counts: the
    /// floor, and the visitor's height step.
    fn distance_beyond_reach(&self, place: Vec3, reach: f32) -> f32 {
        let across = Vec2::new(place.x, place.z).length() - self.shoulder_breadth / 2.0;
        let beyond = |step: HeightStep| {
            let height = place.y + step.offset_metres();
            (across.max(0.0).hypot(height - self.shoulder_height) - reach).max(0.0)
        };
        beyond(HeightStep::Middle).max(beyond(HeightStep::for_eyes(self.eye_height)))
    }

    /// Returns the same distance for an item at its place on the bench. A tool is taken by the hand, a bit
    /// also by the tip of its tool.
    fn distance_beyond_item(&self, item: BenchItem) -> f32 {
        self.distance_beyond_reach(item.home_position(), self.grip_length + taking_distance(item))
    }
}

/// Returns the maximum distance from the hand to the item that it takes.
fn taking_distance(item: BenchItem) -> f32 {
    match item {
        BenchItem::Tool(_) => GRAB_DISTANCE,
        BenchItem::Bit(bit) => GRAB_DISTANCE + bit.spec().tool.length_um() as f32 * 1e-6,
    }
}

fn items() -> impl Iterator<Item = BenchItem> {
    (0..BENCH_ITEMS).filter_map(BenchItem::from_number)
}

#[test]
fn tools_and_bits_are_taken_from_the_visitors_place() {
    for body in &BODIES {
        for item in items() {
            let beyond = body.distance_beyond_item(item);
            assert!(beyond <= 0.0, "{}: {item:?} is {beyond:.3} m beyond reach", body.name);
        }
    }
}

#[test]
fn the_sculptures_middle_is_reached_by_the_bare_hand() {
    let middle = STOOL_TOP + Vec3::Y * (BOX_SIDE / 2.0);
    for body in &BODIES {
        assert!(body.distance_beyond_reach(middle, body.grip_length) <= 0.0, "{}", body.name);
    }
}

/// The stool's rim is taken at the point nearest to the visitor, and moved an eighth of a turn to either
/// side.
#[test]
fn the_stool_is_turned_from_the_visitors_place() {
    for body in &BODIES {
        for i in -4..=4 {
            let (sine, cosine) = (i as f32 / 4.0 * core::f32::consts::FRAC_PI_4).sin_cos();
            let rim = STOOL_TOP + Vec3::new(sine, 0.0, cosine) * STOOL_RADIUS;
            let beyond = body.distance_beyond_reach(rim, body.grip_length + GRAB_DISTANCE);
            assert!(beyond <= 0.0, "{}: {rim} is {beyond:.3} m beyond reach", body.name);
        }
    }
}

#[test]
fn hands_stay_within_a_boundary_around_the_place() {
    for item in items() {
        let home = item.home_position();
        let from_place = Vec2::new(home.x, home.z).length() - taking_distance(item);
        assert!(from_place < BOUNDARY, "{item:?}: {from_place:.3} m from the place");
    }
    let beyond_stool = STOOL_TOP.z.abs() + BOX_SIDE / 2.0;
    assert!(beyond_stool < BOUNDARY, "the sculpture's back: {beyond_stool:.3} m");
}
