//! The planner, which turns a tick into its plan.

use paros_core::edit::Pose;
use paros_core::glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, RoomPose, STOOL_TOP};
use paros_core::session::{HandState, SessionState, TICK_RATE, Tool, ToolBit};
use paros_core::visit::{VisitPhase, WARNING_SECONDS};
use paros_core::volume::{Grid, Size, VoxelBox};
use paros_core::{TickInput, World, WorldEvent};

use crate::plan::{Shot, ShotKind, SoundPlan, VoiceKind, VoicePlan};

/// The greatest pan: a sound at one ear is heard by the other ear too.
const WIDEST_PAN: f32 = 0.85;

/// The speed at which a rasp is loudest, in metres per second.
const FULL_RASP_SPEED: f32 = 0.5;

/// The head of a visitor in front of the stool, used until a head has been tracked.
const DEFAULT_HEAD: RoomPose = (Vec3::new(0.0, 1.6, 0.0), Quat::IDENTITY);

/// Makes a plan for each tick. It stores the last poses of the head and the bits.
#[derive(Clone, Copy, Debug)]
pub struct SoundPlanner {
    head: RoomPose,
    /// The positions of the bits after the last tick, in the room, in metres.
    bits: [Option<Vec3>; 2],
}

impl Default for SoundPlanner {
    fn default() -> Self {
        SoundPlanner { head: DEFAULT_HEAD, bits: [None; 2] }
    }
}

impl SoundPlanner {
    /// Returns the plan for a tick, from the world after it and its input.
    pub fn plan_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        input: &TickInput,
    ) -> SoundPlan
    where
        Grid<N>: Size,
    {
        self.head = input.head.to_clamped_metres().unwrap_or(self.head);
        let mut plan = SoundPlan::default();
        if world.visit().phase() == VisitPhase::Attract {
            // The attract screen carves all day, and is silent.
            return plan;
        }
        for hand in 0..2 {
            let place = bit_place(world, hand);
            let last = core::mem::replace(&mut self.bits[hand], place);
            let (Some(place), Some((tool, bit))) = (place, world.held_tool(hand)) else { continue };
            let moved = last.map_or(0.0, |last| (place - last).length());
            let state = world.hand_state(hand);
            let pan = self.pan_of(place);
            let speed = moved * TICK_RATE as f32;
            plan.voices[hand] = VoicePlan { pan, ..voice_of_tool(tool, bit, state, speed) };
            if let Some((kind, strength)) = blow_of_hammer(tool, bit, state) {
                plan.push(Shot { kind, strength, pan });
            }
        }
        for event in world.events() {
            if let Some((kind, strength)) = shot_of_event(event, world.visit().phase()) {
                let pan = self.pan_of(self.place_of_event(world, event));
                plan.push(Shot { kind, strength, pan });
            }
        }
        plan
    }

    /// Returns the position of an event's sound in the room: its hand's bit, the middle of its voxels, or
    /// else the stone.
    fn place_of_event<const N: usize, const K: usize>(
        &self,
        world: &World<N, K>,
        event: &WorldEvent,
    ) -> Vec3
    where
        Grid<N>: Size,
    {
        let stone = STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE);
        let of_hand = |hand: u8| {
            let hand = usize::from(hand) & 1;
            let state = world.hand_state(hand);
            self.bits[hand].unwrap_or(if state.tracked { state.grip.0 } else { stone })
        };
        match *event {
            WorldEvent::Split { within, .. } => room_middle(world, within).unwrap_or(stone),
            WorldEvent::Edited { hand, .. }
            | WorldEvent::Took { hand, .. }
            | WorldEvent::Released { hand, .. }
            | WorldEvent::Returned { hand, .. } => of_hand(hand),
            _ => stone,
        }
    }

    /// Returns the pan of a position in the room: negative on the left of the head, positive on the right.
    fn pan_of(&self, place: Vec3) -> f32 {
        let (head, rotation) = self.head;
        let direction = (place - head).normalize_or_zero();
        WIDEST_PAN * direction.dot(rotation * Vec3::X).clamp(-1.0, 1.0)
    }
}

/// Returns the position of a hand's bit in the room; `None` if its tool is not in use.
fn bit_place<const N: usize, const K: usize>(world: &World<N, K>, hand: usize) -> Option<Vec3>
where
    Grid<N>: Size,
{
    let lets_work =
        world.session_state() == SessionState::Sculpting && world.visit().phase().lets_hands_work();
    let state = world.hand_state(hand);
    let in_use = lets_work && state.tracked && state.has_frozen_pose;
    in_use.then(|| world.stool_frame().to_room(&state.frozen_pose).0)
}

/// Returns the middle of a box of voxels, in the room; `None` without voxels.
fn room_middle<const N: usize, const K: usize>(
    world: &World<N, K>,
    within: VoxelBox,
) -> Option<Vec3>
where
    Grid<N>: Size,
{
    let middle = within.ranges().map(|range| 0.5 * (range.first() + range.last() + 1) as f32);
    let pose = Pose { position: Vec3::from_array(middle), rotation: Quat::IDENTITY };
    (!within.is_empty()).then(|| world.stool_frame().to_room(&pose).0)
}

/// Returns the voice of a tool whose bit moves at `speed`, in metres per second.
fn voice_of_tool(tool: Tool, bit: ToolBit, state: &HandState, speed: f32) -> VoicePlan {
    let load = f32::from(state.haptic) / 255.0;
    let voice = |kind, level| VoicePlan { kind, level, load, ..VoicePlan::default() };
    match tool {
        _ if !state.is_running() => VoicePlan::default(),
        Tool::Rotary => VoicePlan { pitch_hz: motor_pitch_hz(bit), ..voice(VoiceKind::Motor, 1.0) },
        Tool::Rasp if state.haptic > 0 => {
            let pressed = if state.is_light { 0.5 } else { 1.0 };
            voice(VoiceKind::Scrape, pressed * (speed / FULL_RASP_SPEED).min(1.0))
        }
        Tool::FillGun => voice(VoiceKind::Hiss, 1.0),
        // A hammer's sounds are its blows.
        Tool::Rasp | Tool::Impact => VoicePlan::default(),
    }
}

/// Returns the pitch of the motor with a bit: heavier bits turn more slowly.
const fn motor_pitch_hz(bit: ToolBit) -> f32 {
    match bit {
        ToolBit::SmallBall => 420.0,
        ToolBit::MediumBall => 330.0,
        ToolBit::LargeBall => 255.0,
        ToolBit::Cylinder => 300.0,
        ToolBit::Grinder => 200.0,
        ToolBit::RoughingBall => 165.0,
        ToolBit::DiscSaw => 480.0,
        // These bits are not turned by a motor.
        ToolBit::PointChisel
        | ToolBit::FlatChisel
        | ToolBit::PitchingChisel
        | ToolBit::Nozzle
        | ToolBit::File
        | ToolBit::Float => 0.0,
    }
}

/// Returns the blow that a pneumatic hammer begins in a tick, and its strength.
fn blow_of_hammer(tool: Tool, bit: ToolBit, state: &HandState) -> Option<(ShotKind, f32)> {
    let period = u16::from(bit.spec().bite_period);
    let is_struck =
        tool == Tool::Impact && state.trigger && state.trigger_ticks.is_multiple_of(period);
    is_struck.then(|| match state.haptic {
        0 => (ShotKind::Puff, 0.6),
        haptic => (ShotKind::Blow, 0.4 + 0.6 * f32::from(haptic) / 255.0),
    })
}

/// Returns the sound of an event, and its strength; `None` if it has no sound of its own.
fn shot_of_event(event: &WorldEvent, phase: VisitPhase) -> Option<(ShotKind, f32)> {
    match *event {
        WorldEvent::Took { .. } | WorldEvent::HandsSwapped => Some((ShotKind::Take, 1.0)),
        WorldEvent::Released { .. } | WorldEvent::Returned { .. } => Some((ShotKind::PutBack, 1.0)),
        WorldEvent::Edited { bit, report, .. } => {
            let is_chip = bit.spec().tool == Tool::Impact && report.removed > 0;
            is_chip.then(|| (ShotKind::Chip, strength_of_voxels(report.removed)))
        }
        WorldEvent::Split { removed, .. } => Some((ShotKind::Flake, strength_of_voxels(removed))),
        WorldEvent::Islands(report) => {
            (report.removed > 0).then(|| (ShotKind::Fall, strength_of_voxels(report.removed)))
        }
        WorldEvent::Undone => Some((ShotKind::Undo, 1.0)),
        WorldEvent::Redone => Some((ShotKind::Redo, 1.0)),
        WorldEvent::Bared { tenths } => Some((ShotKind::Bared { tenths }, 1.0)),
        WorldEvent::Found => Some((ShotKind::Found, 1.0)),
        WorldEvent::TimeLeft { seconds } => {
            let earlier = WARNING_SECONDS.iter().filter(|warning| **warning > seconds).count();
            Some((ShotKind::Clock { strokes: 1 + earlier.min(2) as u8 }, 1.0))
        }
        // A visit ends for its visitor with the phase `HandsOff`; the sculpture is finished some seconds
        // later.
        WorldEvent::Visit(VisitPhase::HandsOff) => Some((ShotKind::End, 1.0)),
        WorldEvent::Finished if phase == VisitPhase::Closed => Some((ShotKind::End, 1.0)),
        WorldEvent::Finished
        | WorldEvent::Visit(_)
        | WorldEvent::Started(_)
        | WorldEvent::NoSuchStart
        | WorldEvent::Symmetry(_) => None,
    }
}

/// Returns the strength of a sound for a number of voxels: a fifth for one, 1 for 30,000, rising by the same
/// amount with each doubling.
fn strength_of_voxels(count: u32) -> f32 {
    (0.2 + 0.8 * count.max(1).ilog2() as f32 / 15.0).min(1.0)
}

#[cfg(test)]
mod tests {
    use paros_core::WorldEvent;
    use paros_core::edit::{EditReport, IslandReport};
    use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
    use paros_core::visit::{VisitPhase, WARNING_SECONDS};
    use paros_core::volume::VoxelBox;

    use super::{motor_pitch_hz, shot_of_event};
    use crate::plan::ShotKind;

    fn kind_of(event: WorldEvent) -> Option<ShotKind> {
        shot_of_event(&event, VisitPhase::Closed).map(|(kind, strength)| {
            assert!(strength > 0.0 && strength <= 1.0, "{event:?}");
            kind
        })
    }

    #[test]
    fn events_sound_as_what_happened() {
        let (hand, item, tool) = (0, BenchItem::Tool(Tool::Rasp), Tool::Rasp);
        let mode = SessionMode::FreeForm;
        for (event, kind) in [
            (WorldEvent::Started(mode), None),
            (WorldEvent::NoSuchStart, None),
            (WorldEvent::Took { hand, item }, Some(ShotKind::Take)),
            (WorldEvent::HandsSwapped, Some(ShotKind::Take)),
            (WorldEvent::Released { hand, tool }, Some(ShotKind::PutBack)),
            (WorldEvent::Returned { hand, tool }, Some(ShotKind::PutBack)),
            (
                WorldEvent::Split { hand, removed: 900, within: VoxelBox::EMPTY },
                Some(ShotKind::Flake),
            ),
            (WorldEvent::Undone, Some(ShotKind::Undo)),
            (WorldEvent::Redone, Some(ShotKind::Redo)),
            (WorldEvent::Symmetry(true), None),
            (WorldEvent::Bared { tenths: 4 }, Some(ShotKind::Bared { tenths: 4 })),
            (WorldEvent::Found, Some(ShotKind::Found)),
            (WorldEvent::Finished, Some(ShotKind::End)),
        ] {
            assert_eq!(kind_of(event), kind, "{event:?}");
        }
    }

    #[test]
    fn chisels_chip_and_other_bits_have_their_voices() {
        for bit in ToolBit::ALL {
            let edited = |removed| {
                let report = EditReport { removed, ..EditReport::default() };
                kind_of(WorldEvent::Edited { hand: 1, bit, report })
            };
            let chips = bit.spec().tool == Tool::Impact;
            assert_eq!(edited(30), chips.then_some(ShotKind::Chip), "{bit:?}");
            assert_eq!(edited(0), None, "{bit:?}");
            assert_eq!(motor_pitch_hz(bit) > 0.0, bit.spec().tool == Tool::Rotary, "{bit:?}");
        }
    }

    #[test]
    fn what_falls_is_heard_the_louder_the_larger_it_is() {
        let fall = |removed, kept| {
            let report = IslandReport { removed, kept, unsupported: false };
            shot_of_event(&WorldEvent::Islands(report), VisitPhase::Closed)
        };
        assert_eq!(fall(0, 12), None);
        let strengths = [1, 40, 2_000, 40_000, u32::MAX].map(|removed| {
            let (kind, strength) = fall(removed, 0).expect("something fell");
            assert_eq!(kind, ShotKind::Fall);
            strength
        });
        assert!(strengths.is_sorted() && strengths[0] >= 0.2 && strengths[4] == 1.0);
    }

    #[test]
    fn the_clock_strikes_more_often_towards_the_end() {
        let strokes = WARNING_SECONDS.map(|seconds| kind_of(WorldEvent::TimeLeft { seconds }));
        let expected = [1, 2, 3].map(|strokes| Some(ShotKind::Clock { strokes }));
        assert_eq!(strokes, expected);
    }

    #[test]
    fn a_visit_ends_once() {
        for phase in VisitPhase::ALL {
            let told = shot_of_event(&WorldEvent::Visit(phase), phase).map(|(kind, _)| kind);
            let is_end = phase == VisitPhase::HandsOff;
            assert_eq!(told, is_end.then_some(ShotKind::End), "{phase:?}");
            // The sculpture is finished in the export phase, when the end has already sounded.
            let finished = shot_of_event(&WorldEvent::Finished, phase).is_some();
            assert_eq!(finished, phase == VisitPhase::Closed, "{phase:?}");
        }
    }
}
