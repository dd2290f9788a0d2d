//! Bare hands as Meta's runtime reports them. The layer turns the controller of Monado's driver into a hand:
//! its trigger is a pinch, its squeeze a fist, and its grip a palm with another rotation. A word in the file
//! `hands` in the layer's folder selects the state from the next `xrSyncActions` on:
//!
//! - `bare`: hands are tracked. Their interaction profile is `hand_interaction_ext` if bindings were accepted
//!   for it; otherwise `khr/simple_controller`, with a valid grip, if accepted; otherwise none.
//! - `fist`: like `bare`, but always closed, whatever the driver reports.
//! - `frozen`: hands are lost: all poses stay where they were, valid and not tracked.
//! - `gone`: like `frozen`, and the joints are inactive.
//! - `around`: hands are tracked around their controllers, which stay tracked.
//! - `beside`: like `around`, but the hands are 40 cm above the controllers.
//!
//! Without the file Monado's own hands and controllers are reported.

use std::collections::HashMap;
use std::fs;
use std::sync::{LazyLock, Mutex};

use glam::{Mat3, Quat, Vec3};
use openxr::sys;
use sys::{HandJointEXT as Joint, Handle, Result as Status, SpaceLocationFlags as Flags, pfn};

use super::actions::{HAND_INTERACTION, find_action, is_accepted, name_action, path_text};
use super::chain::{call_next, next_layer};
use super::folder::{layer_folder, log_line};

/// The last visible joints of a hand.
type Joints = [sys::HandJointLocationEXT; sys::HAND_JOINT_COUNT_EXT];

#[derive(Default)]
struct HandsState {
    /// The word in the file.
    word: String,
    /// The spaces of hands, with their last poses, and the grip spaces of both hands.
    spaces: HashMap<u64, Option<sys::Posef>>,
    grips: [sys::Space; 2],
    trackers: HashMap<u64, Tracker>,
}

#[derive(Clone, Copy)]
struct Tracker {
    session: sys::Session,
    hand: usize,
    last: Option<Joints>,
}

static STATE: LazyLock<Mutex<HandsState>> = LazyLock::new(Mutex::default);

const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";
const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

/// The distance from the palm joint to the skin, in metres.
const PALM_RADIUS: f32 = 0.015;

fn valid() -> Flags {
    Flags::POSITION_VALID | Flags::ORIENTATION_VALID
}

fn tracked() -> Flags {
    valid() | Flags::POSITION_TRACKED | Flags::ORIENTATION_TRACKED
}

fn state() -> std::sync::MutexGuard<'static, HandsState> {
    STATE.lock().expect("no holder panics")
}

impl HandsState {
    /// Returns `true` if hands are bare, whether visible or lost.
    fn is_bare(&self) -> bool {
        matches!(&*self.word, "bare" | "fist") || self.is_lost()
    }

    fn is_lost(&self) -> bool {
        matches!(&*self.word, "frozen" | "gone")
    }
}

/// Returns the interaction profile of bare hands.
fn profile_of_bare_hands() -> Option<&'static str> {
    [HAND_INTERACTION, SIMPLE].into_iter().find(|profile| is_accepted(profile))
}

pub(crate) unsafe extern "system" fn sync_actions(
    session: sys::Session,
    info: *const sys::ActionsSyncInfo,
) -> Status {
    let word = fs::read_to_string(layer_folder().join("hands")).unwrap_or_default();
    let mut state = state();
    if state.word != word {
        log_line(&format!("hands {word}"));
        state.word = word;
    }
    drop(state);
    call_next!(c"xrSyncActions": SyncActions, session, info)
}

pub(crate) unsafe extern "system" fn create_action_space(
    session: sys::Session,
    info: *const sys::ActionSpaceCreateInfo,
    space: *mut sys::Space,
) -> Status {
    let made = call_next!(c"xrCreateActionSpace": CreateActionSpace, session, info, space);
    if made == Status::SUCCESS {
        // SAFETY: the shell's structure is valid during the call, which has succeeded.
        let (info, space) = unsafe { (&*info, *space) };
        let instance = next_layer().expect("there is an instance").instance;
        let of_hand = path_text(instance, info.subaction_path);
        let mut state = state();
        state.spaces.insert(space.into_raw(), None);
        if name_action(info.action) == "grip" {
            state.grips[usize::from(of_hand == HANDS[1])] = space;
        }
    }
    made
}

pub(crate) unsafe extern "system" fn create_hand_tracker(
    session: sys::Session,
    info: *const sys::HandTrackerCreateInfoEXT,
    tracker: *mut sys::HandTrackerEXT,
) -> Status {
    let made = call_next!(c"xrCreateHandTrackerEXT": CreateHandTrackerEXT, session, info, tracker);
    if made == Status::SUCCESS {
        // SAFETY: as above.
        let (hand, tracker) = unsafe { ((*info).hand, *tracker) };
        let hand = usize::from(hand == sys::HandEXT::RIGHT);
        state().trackers.insert(tracker.into_raw(), Tracker { session, hand, last: None });
    }
    made
}

pub(crate) unsafe extern "system" fn get_current_profile(
    session: sys::Session,
    user_path: sys::Path,
    profile: *mut sys::InteractionProfileState,
) -> Status {
    let done = call_next!(c"xrGetCurrentInteractionProfile": GetCurrentInteractionProfile, session, user_path, profile);
    if done == Status::SUCCESS && state().is_bare() {
        let path = profile_of_bare_hands().map_or(sys::Path::NULL, find_path);
        // SAFETY: the shell has room for a profile.
        unsafe { (*profile).interaction_profile = path };
    }
    done
}

pub(crate) unsafe extern "system" fn get_float(
    session: sys::Session,
    info: *const sys::ActionStateGetInfo,
    value: *mut sys::ActionStateFloat,
) -> Status {
    let done = call_next!(c"xrGetActionStateFloat": GetActionStateFloat, session, info, value);
    let state = state();
    if done != Status::SUCCESS || !state.is_bare() {
        return done;
    }
    // SAFETY: the shell's structures are valid during the call, which has succeeded.
    let (name, value) = unsafe { (name_action((*info).action), &mut *value) };
    match profile_of_bare_hands() {
        Some(HAND_INTERACTION) => {
            if name == "take" && state.word == "fist" {
                value.current_state = 1.0;
            }
        }
        // A pinch clicks; a fist does nothing.
        Some(_) if name == "run" => value.current_state = value.current_state.round(),
        Some(_) => value.current_state = 0.0,
        None => (value.is_active, value.current_state) = (false.into(), 0.0),
    }
    done
}

pub(crate) unsafe extern "system" fn locate_space(
    space: sys::Space,
    base: sys::Space,
    time: sys::Time,
    location: *mut sys::SpaceLocation,
) -> Status {
    let done = call_next!(c"xrLocateSpace": LocateSpace, space, base, time, location);
    let mut state = state();
    let (is_bare, is_lost) = (state.is_bare(), state.is_lost());
    let Some(last) = state.spaces.get_mut(&space.into_raw()) else { return done };
    if done != Status::SUCCESS || !is_bare {
        return done;
    }
    // SAFETY: the shell has room for a location.
    let location = unsafe { &mut *location };
    let is_seen = location.location_flags.contains(tracked()) && !is_lost;
    match (profile_of_bare_hands(), &last) {
        (Some(_), _) if is_seen => *last = Some(location.pose),
        (Some(_), Some(frozen)) => (location.location_flags, location.pose) = (valid(), *frozen),
        _ => location.location_flags = Flags::EMPTY,
    }
    done
}

pub(crate) unsafe extern "system" fn locate_joints(
    tracker: sys::HandTrackerEXT,
    info: *const sys::HandJointsLocateInfoEXT,
    locations: *mut sys::HandJointLocationsEXT,
) -> Status {
    let done = call_next!(c"xrLocateHandJointsEXT": LocateHandJointsEXT, tracker, info, locations);
    let mut state = state();
    if done != Status::SUCCESS || state.word.is_empty() {
        return done;
    }
    let Some(mut of_hand) = state.trackers.get(&tracker.into_raw()).copied() else { return done };
    // SAFETY: the shell's structure is valid during the call.
    let (base, time) = unsafe { ((*info).base_space, (*info).time) };
    if !state.is_lost() {
        of_hand.last = pose_hand(&state, of_hand, base, time);
        state.trackers.insert(tracker.into_raw(), of_hand);
    }
    let is_active = of_hand.last.is_some() && state.word != "gone";
    let mut joints = of_hand.last.unwrap_or([sys::HandJointLocationEXT::default(); _]);
    for joint in &mut joints {
        joint.location_flags = match (is_active, state.is_lost()) {
            (true, false) => tracked(),
            (true, true) => valid(),
            (false, _) => Flags::EMPTY,
        };
    }
    // SAFETY: the shell has room for as many joints as there are.
    unsafe {
        (*locations).is_active = is_active.into();
        (*locations).joint_locations.cast::<Joints>().write(joints);
    }
    done
}

/// Returns the joints of a hand whose controller is tracked.
fn pose_hand(
    state: &HandsState,
    tracker: Tracker,
    base: sys::Space,
    time: sys::Time,
) -> Option<Joints> {
    let mut location = sys::SpaceLocation {
        ty: sys::SpaceLocation::TYPE,
        next: core::ptr::null_mut(),
        location_flags: Flags::EMPTY,
        pose: sys::Posef::IDENTITY,
    };
    let (grip, to) = (state.grips[tracker.hand], &raw mut location);
    let done = call_next!(c"xrLocateSpace": LocateSpace, grip, base, time, to);
    if done != Status::SUCCESS || !location.location_flags.contains(tracked()) {
        return None;
    }
    let fist = if state.word == "fist" { 1.0 } else { driven_value(tracker, "take") };
    let sys::Posef { position: p, orientation: q } = location.pose;
    let above = if state.word == "beside" { 0.4 } else { 0.0 };
    let grip = (Vec3::new(p.x, p.y + above, p.z), Quat::from_xyzw(q.x, q.y, q.z, q.w));
    Some(joints_of_hand(grip, tracker.hand, driven_value(tracker, "run"), fist))
}

/// Returns the driver's value of a controller's action.
fn driven_value(tracker: Tracker, name: &str) -> f32 {
    let info = sys::ActionStateGetInfo {
        ty: sys::ActionStateGetInfo::TYPE,
        next: core::ptr::null(),
        action: find_action(name),
        subaction_path: find_path(HANDS[tracker.hand]),
    };
    let mut value = sys::ActionStateFloat::out(core::ptr::null_mut());
    let (info, to) = (&raw const info, value.as_mut_ptr());
    let done = call_next!(c"xrGetActionStateFloat": GetActionStateFloat, tracker.session, info, to);
    // SAFETY: the call has succeeded.
    if done == Status::SUCCESS { unsafe { value.assume_init() }.current_state } else { 0.0 }
}

/// The joints of a right hand's fingertips in metres from its palm, which faces -y with its fingers along -z:
/// open, in a fist, and in a pinch.
const FINGERTIPS: [(Joint, [[f32; 3]; 3]); 5] = [
    (Joint::THUMB_TIP, [[-0.07, -0.01, -0.04], [-0.03, -0.04, -0.025], [-0.035, -0.05, -0.08]]),
    (Joint::INDEX_TIP, [[-0.03, 0.0, -0.115], [-0.02, -0.03, -0.02], [-0.03, -0.045, -0.08]]),
    (Joint::MIDDLE_TIP, [[0.0, 0.0, -0.12], [0.0, -0.03, -0.015], [0.0, 0.0, -0.12]]),
    (Joint::RING_TIP, [[0.02, 0.0, -0.115], [0.015, -0.03, -0.01], [0.02, 0.0, -0.115]]),
    (Joint::LITTLE_TIP, [[0.04, 0.0, -0.095], [0.03, -0.03, 0.0], [0.04, 0.0, -0.095]]),
];

/// Returns the joints of a hand at a grip pose. In a pinch from a fist, only thumb and index finger leave the
/// fist.
fn joints_of_hand(
    (position, rotation): (Vec3, Quat),
    hand: usize,
    pinch: f32,
    fist: f32,
) -> Joints {
    let side = if hand == 0 { -1.0 } else { 1.0 };
    // The palm's axes in the grip's space: the fingers point along the grip's -y, the back of the hand along
    // x or -x.
    let of_grip = Mat3::from_cols(Vec3::Z * side, Vec3::X * side, Vec3::Y);
    let rotation = rotation * Quat::from_mat3(&of_grip);
    let palm = position + rotation * Vec3::Y * PALM_RADIUS;
    let joint_at = |at: Vec3| sys::HandJointLocationEXT {
        location_flags: tracked(),
        pose: sys::Posef {
            position: sys::Vector3f { x: at.x, y: at.y, z: at.z },
            orientation: sys::Quaternionf {
                x: rotation.x,
                y: rotation.y,
                z: rotation.z,
                w: rotation.w,
            },
        },
        radius: PALM_RADIUS,
    };
    let mut joints = [joint_at(palm); sys::HAND_JOINT_COUNT_EXT];
    for (joint, [open, closed, pinched]) in FINGERTIPS {
        let mut at = Vec3::from_array(open).lerp(Vec3::from_array(closed), fist);
        if joint == Joint::THUMB_TIP || joint == Joint::INDEX_TIP {
            at = at.lerp(Vec3::from_array(pinched), pinch);
        }
        at.x *= side;
        joints[joint.into_raw() as usize] = joint_at(palm + rotation * at);
    }
    joints
}

fn find_path(text: &str) -> sys::Path {
    let instance = next_layer().expect("there is an instance").instance;
    let text = std::ffi::CString::new(text).expect("a path");
    let mut path = sys::Path::NULL;
    let (from, to) = (text.as_ptr(), &raw mut path);
    let done = call_next!(c"xrStringToPath": StringToPath, instance, from, to);
    assert_eq!(done, Status::SUCCESS, "a text without a path");
    path
}
