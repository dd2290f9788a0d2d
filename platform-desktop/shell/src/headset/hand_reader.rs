//! Input source selection: chooses, tick by tick, whether a hand is read from controller actions or from
//! joints, and which of its pinches and fists count.
//!
//! Runtimes report hands in several ways. Meta's runtime reports a tracked hand as a simple controller with a
//! valid grip too, if that interaction profile is suggested. Others report joints of a hand that holds a
//! controller, or a controller that lies on a table beside a bare hand.

use super::hand_sample::HandSample;

/// The kind of device of a hand's current interaction profile (`xrGetCurrentInteractionProfile`).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum HandProfile {
    /// A controller with a trigger and a grip, or nothing at all.
    #[default]
    Controller,
    /// A controller with two buttons (`khr/simple_controller`), or a bare hand in its place.
    SimpleController,
    /// A bare hand's gestures (`ext/hand_interaction_ext`).
    HandInteraction,
}

/// The source that a hand is read from.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum HandSource {
    /// None: the hand is not tracked.
    #[default]
    None,
    /// The actions of a controller.
    Controller,
    /// The joints of a bare hand.
    Joints,
    /// The actions of a bare hand.
    HandInteraction,
}

/// A runtime's complete report of a hand at one time.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct HandReport {
    /// The current interaction profile.
    pub profile: HandProfile,
    /// The hand's state according to the actions.
    pub actions: HandSample,
    /// The hand's state according to the joints; `None` while they are not tracked.
    pub joints: Option<HandSample>,
}

/// The reader of one hand: the source of the last tick, and the state for hysteresis.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct HandReader {
    source: HandSource,
    /// The last source other than [`HandSource::None`].
    last_known: HandSource,
    /// `true` if the current simple controller has once been reported together with tracked joints.
    simple_is_hand: bool,
    trigger: ControlGate,
    squeeze: ControlGate,
    /// Ticks for which the trigger has been pulled.
    pull_ticks: u32,
}

impl HandReader {
    /// Returns the hand's source in the last tick.
    #[must_use]
    pub const fn source(&self) -> HandSource {
        self.source
    }

    /// Reads a tick's report. Returns the sample of the chosen source, or all zeros if the hand is not
    /// tracked. Trigger and squeeze are 0 where they don't count.
    ///
    /// After a change of source, trigger and squeeze count only once they have been seen released: a hand
    /// that lays a controller down is half a fist, and would drop its tool. After a loss of tracking this
    /// holds for the squeeze alone; the trigger stays pressed, so that the stroke continues.
    pub fn read_tick(&mut self, report: &HandReport) -> HandSample {
        let source = choose_source(self.last_known, self.simple_is_hand, report);
        self.simple_is_hand = report.profile == HandProfile::SimpleController
            && (self.simple_is_hand || report.joints.is_some());
        let was_lost = core::mem::replace(&mut self.source, source) == HandSource::None;
        let mut sample = match source {
            HandSource::None => return HandSample::default(),
            HandSource::Joints => report.joints.unwrap_or_default(),
            HandSource::Controller => report.actions,
            HandSource::HandInteraction => HandSample {
                fingertip: report.joints.and_then(|hand| hand.fingertip),
                ..report.actions
            },
        };
        let took_over = core::mem::replace(&mut self.last_known, source) != source;
        if took_over {
            self.trigger.close();
        }
        if took_over || was_lost {
            self.squeeze.close();
        }
        self.gate_controls(&mut sample);
        sample
    }

    /// Skips a tick, as if the hand's tracking was lost.
    pub fn skip_tick(&mut self) {
        self.source = HandSource::None;
    }

    /// Sets trigger and squeeze to 0 where they don't count. A bare hand's gestures overlap, and the first
    /// one counts: a fist doesn't run the tool until a new pinch begins, and fingers that curl in the middle
    /// of a stroke don't drop the tool.
    fn gate_controls(&mut self, sample: &mut HandSample) {
        let is_bare = self.source != HandSource::Controller;
        if is_bare && self.pull_ticks > FIST_WITHIN_TICKS && !self.squeeze.is_pressed {
            self.squeeze.close();
        }
        let was_squeezed = self.squeeze.is_pressed;
        sample.squeeze = self.squeeze.pass(sample.squeeze);
        if is_bare && self.squeeze.is_pressed && !was_squeezed {
            self.trigger.close();
        }
        sample.trigger = self.trigger.pass(sample.trigger);
        self.pull_ticks =
            if self.trigger.is_pressed { self.pull_ticks.saturating_add(1) } else { 0 };
    }
}

/// A trigger or a squeeze that counts only after it has been seen released.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
struct ControlGate {
    is_closed: bool,
    is_pressed: bool,
}

impl ControlGate {
    const fn close(&mut self) {
        (self.is_closed, self.is_pressed) = (true, false);
    }

    /// Returns the value, 0 to 1, or 0 where it doesn't count. NaN counts as released.
    fn pass(&mut self, value: f32) -> f32 {
        if value >= RELEASED_BELOW {
            self.is_pressed |= !self.is_closed && value >= PRESSED_FROM;
        } else {
            *self = ControlGate::default();
        }
        if self.is_closed { 0.0 } else { value }
    }
}

/// Hysteresis thresholds: those of the core, 128 and 96 of 255, up to rounding.
const PRESSED_FROM: f32 = 0.5;
const RELEASED_BELOW: f32 = 0.37;

/// Ticks, an eighth of a second, within which a fist that follows a pinch replaces it: thumb and index finger
/// meet while a fist closes.
const FIST_WITHIN_TICKS: u32 = 9;

/// Distances in metres between a controller's grip and a bare hand's, if both are tracked. Below the first,
/// the hand takes up the controller; above the second, it has laid it down; between them nothing changes.
const TAKEN_UP_M: f32 = 0.1;
const LAID_DOWN_M: f32 = 0.2;

/// Chooses a hand's source. `last_known` is the last source other than [`HandSource::None`]. `simple_is_hand`
/// is `true` if the simple controller of this report has had joints: without joints it is a lost hand, not a
/// controller.
fn choose_source(last_known: HandSource, simple_is_hand: bool, report: &HandReport) -> HandSource {
    let of_actions = match report.profile {
        HandProfile::HandInteraction => HandSource::HandInteraction,
        _ => HandSource::Controller,
    };
    match (report.profile, report.actions.grip, report.joints.and_then(|joints| joints.grip)) {
        (_, None, None) => HandSource::None,
        (_, None, Some(_)) | (HandProfile::SimpleController, Some(_), Some(_)) => {
            HandSource::Joints
        }
        (HandProfile::SimpleController, Some(_), None) if simple_is_hand => HandSource::None,
        (HandProfile::HandInteraction, Some(_), _) | (_, Some(_), None) => of_actions,
        (HandProfile::Controller, Some((held, _)), Some((bare, _))) => {
            let is_bare = last_known == HandSource::Joints;
            let within_m = if is_bare { TAKEN_UP_M } else { LAID_DOWN_M };
            if held.distance(bare) < within_m { of_actions } else { HandSource::Joints }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::{
        FIST_WITHIN_TICKS, HandProfile, HandReader, HandReport, HandSource, LAID_DOWN_M, TAKEN_UP_M,
    };
    use crate::headset::hand_sample::HandSample;
    use HandProfile::{Controller, HandInteraction, SimpleController};

    /// Returns a hand at a position along x, in metres, with its trigger and squeeze.
    fn hand_at(x: f32, trigger: f32, squeeze: f32) -> HandSample {
        let pose = Some((Vec3::X * x, Quat::IDENTITY));
        HandSample { aim: pose, grip: pose, trigger, squeeze, ..HandSample::default() }
    }

    fn report(profile: HandProfile, actions: Option<f32>, joints: Option<f32>) -> HandReport {
        HandReport {
            profile,
            actions: actions.map_or(HandSample::default(), |x| hand_at(x, 0.0, 0.0)),
            joints: joints.map(|x| hand_at(x, 0.0, 0.0)),
        }
    }

    /// Returns the sources that are chosen for these reports, one per tick.
    fn sources<const N: usize>(reports: [HandReport; N]) -> [HandSource; N] {
        let mut reader = HandReader::default();
        reports.map(|report| {
            let sample = reader.read_tick(&report);
            assert_eq!(sample.grip.is_some(), reader.source() != HandSource::None);
            reader.source()
        })
    }

    #[test]
    fn each_report_has_its_source() {
        for (profile, actions, joints, source) in [
            (Controller, None, None, HandSource::None),
            (Controller, Some(0.0), None, HandSource::Controller),
            (Controller, None, Some(0.0), HandSource::Joints),
            (Controller, Some(0.0), Some(0.05), HandSource::Controller),
            (SimpleController, None, None, HandSource::None),
            (SimpleController, Some(0.0), None, HandSource::Controller),
            (SimpleController, None, Some(0.0), HandSource::Joints),
            // A tracked hand as Meta's runtime reports it.
            (SimpleController, Some(0.0), Some(0.0), HandSource::Joints),
            (HandInteraction, None, None, HandSource::None),
            (HandInteraction, Some(0.0), None, HandSource::HandInteraction),
            (HandInteraction, None, Some(0.0), HandSource::Joints),
            (HandInteraction, Some(0.0), Some(0.0), HandSource::HandInteraction),
        ] {
            let report = report(profile, actions, joints);
            assert_eq!(sources([report]), [source], "{report:?}");
        }
    }

    /// A hand that holds a controller has a fingertip too, but doesn't point with it.
    #[test]
    fn a_bare_hand_has_the_fingertip_of_its_joints() {
        for (profile, has_tip) in
            [(Controller, false), (SimpleController, true), (HandInteraction, true)]
        {
            let mut told = report(profile, Some(0.0), Some(0.0));
            let tip = Some(Vec3::X);
            told.joints = told.joints.map(|hand| HandSample { fingertip: tip, ..hand });
            let read = HandReader::default().read_tick(&told);
            assert_eq!(read.fingertip, tip.filter(|_| has_tip), "{profile:?}");
        }
    }

    #[test]
    fn a_hand_that_loses_its_joints_is_no_simple_controller() {
        let hand = report(SimpleController, Some(0.0), Some(0.0));
        let lost = report(SimpleController, Some(0.0), None);
        let nothing = report(SimpleController, None, None);
        let laid_down = report(Controller, None, None);
        let known = [HandSource::Joints, HandSource::None, HandSource::None, HandSource::None];
        assert_eq!(sources([hand, lost, nothing, lost]), known);
        // After a change of profile it is a new controller.
        let taken_up = [HandSource::Joints, HandSource::None, HandSource::Controller];
        assert_eq!(sources([hand, laid_down, lost]), taken_up);
    }

    #[test]
    fn a_controller_and_a_hand_part_and_meet_with_hysteresis() {
        let at = |metres| report(Controller, Some(0.0), Some(metres));
        let between = TAKEN_UP_M.midpoint(LAID_DOWN_M);
        let (beside, far) = (TAKEN_UP_M - 0.01, LAID_DOWN_M + 0.01);
        let told = sources([at(between), at(far), at(between), at(beside), at(between)]);
        let (held, bare) = (HandSource::Controller, HandSource::Joints);
        assert_eq!(told, [held, bare, bare, held, held]);
        let lost = report(Controller, None, None);
        assert_eq!(sources([at(far), lost, at(between)]), [bare, HandSource::None, bare]);
    }

    /// A controller's trigger and squeeze in a report without joints.
    fn held(trigger: f32, squeeze: f32) -> HandReport {
        HandReport { actions: hand_at(0.0, trigger, squeeze), ..HandReport::default() }
    }

    /// Returns a report of a bare hand's pinch and fist, by joints and as Meta's runtime reports it.
    fn bare(trigger: f32, squeeze: f32) -> HandReport {
        let joints = Some(hand_at(0.0, trigger, squeeze));
        HandReport { joints, ..report(SimpleController, Some(0.0), None) }
    }

    fn read(reader: &mut HandReader, report: HandReport) -> [f32; 2] {
        let sample = reader.read_tick(&report);
        [sample.trigger, sample.squeeze]
    }

    #[test]
    fn what_takes_over_counts_once_it_was_open() {
        for (from, to) in
            [(held as fn(f32, f32) -> HandReport, bare as fn(f32, f32) -> _), (bare, held)]
        {
            let mut reader = HandReader::default();
            assert_eq!(read(&mut reader, from(0.0, 0.0)), [0.0, 0.0]);
            assert_eq!(read(&mut reader, from(0.0, 1.0)), [0.0, 1.0], "it takes a tool");
            assert_eq!(read(&mut reader, from(0.0, 0.0)), [0.0, 0.0]);
            // The hand is lost while it changes from one source to the other.
            read(&mut reader, HandReport::default());
            for _ in 0..3 {
                assert_eq!(read(&mut reader, to(0.8, 0.8)), [0.0, 0.0], "half a fist");
            }
            assert_eq!(read(&mut reader, to(0.2, 0.8)), [0.2, 0.0]);
            assert_eq!(read(&mut reader, to(0.7, 0.8)), [0.7, 0.0], "a pinch runs it");
            assert_eq!(read(&mut reader, to(0.2, 0.3)), [0.2, 0.3]);
            assert_eq!(read(&mut reader, to(0.2, 0.8)), [0.2, 0.8]);
        }
    }

    #[test]
    fn a_stroke_goes_on_after_a_loss_and_no_squeeze_is_seen_twice() {
        for report in [held, bare] {
            for is_skipped in [false, true] {
                let mut reader = HandReader::default();
                let lose = |reader: &mut HandReader| match is_skipped {
                    true => reader.skip_tick(),
                    false => assert_eq!(read(reader, HandReport::default()), [0.0, 0.0]),
                };
                read(&mut reader, report(0.0, 0.0));
                assert_eq!(read(&mut reader, report(1.0, 0.0)), [1.0, 0.0]);
                lose(&mut reader);
                assert_eq!(reader.source(), HandSource::None);
                assert_eq!(read(&mut reader, report(1.0, 0.0)), [1.0, 0.0]);
                read(&mut reader, report(0.0, 0.0));
                assert_eq!(read(&mut reader, report(0.0, 1.0)), [0.0, 1.0]);
                lose(&mut reader);
                assert_eq!(read(&mut reader, report(0.0, 1.0)), [0.0, 0.0]);
                read(&mut reader, report(0.0, 0.0));
                assert_eq!(read(&mut reader, report(0.0, 1.0)), [0.0, 1.0]);
            }
        }
    }

    #[test]
    fn of_a_bare_hands_gestures_the_first_counts() {
        let begin = |report: fn(f32, f32) -> HandReport| {
            let mut reader = HandReader::default();
            read(&mut reader, report(0.0, 0.0));
            reader
        };
        // A fist that is also a pinch; then a finger that leaves it, and pinches.
        let mut reader = begin(bare);
        assert_eq!(read(&mut reader, bare(1.0, 1.0)), [0.0, 1.0]);
        assert_eq!(read(&mut reader, bare(1.0, 1.0)), [0.0, 1.0]);
        assert_eq!(read(&mut reader, bare(0.1, 1.0)), [0.1, 1.0]);
        assert_eq!(read(&mut reader, bare(1.0, 1.0)), [1.0, 1.0]);
        // A fist whose thumb meets the index finger first.
        let mut reader = begin(bare);
        for _ in 0..FIST_WITHIN_TICKS {
            assert_eq!(read(&mut reader, bare(1.0, 0.4)), [1.0, 0.4]);
        }
        assert_eq!(read(&mut reader, bare(1.0, 1.0)), [0.0, 1.0]);
        // A stroke in which the other fingers curl.
        let mut reader = begin(bare);
        for _ in 0..=FIST_WITHIN_TICKS {
            read(&mut reader, bare(1.0, 0.0));
        }
        assert_eq!(read(&mut reader, bare(1.0, 1.0)), [1.0, 0.0]);
        assert_eq!(read(&mut reader, bare(0.0, 1.0)), [0.0, 0.0], "it was no fist");
        assert_eq!(read(&mut reader, bare(0.0, 0.0)), [0.0, 0.0]);
        assert_eq!(read(&mut reader, bare(0.0, 1.0)), [0.0, 1.0]);
        // On a controller, trigger and squeeze are independent.
        let mut reader = begin(held);
        for _ in 0..=2 * FIST_WITHIN_TICKS {
            assert_eq!(read(&mut reader, held(1.0, 0.0)), [1.0, 0.0]);
        }
        assert_eq!(read(&mut reader, held(1.0, 1.0)), [1.0, 1.0]);
        assert_eq!(read(&mut reader, held(f32::NAN, 1.0))[1], 1.0);
    }
}
