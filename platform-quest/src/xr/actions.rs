//! Controllers through OpenXR's actions: poses, buttons and haptics. A runtime may also drive the actions by
//! bare hands.

use openxr as xr;
use paros_core::internals::RoomPose;
use paros_core::session::buttons;
use paros_shell::headset::hand_reader::HandProfile;
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::headset::haptics::HapticChange;

use super::convert_location;
use super::profiles::SuggestedProfiles;
use crate::error::{CallContext, Error};

/// The action set of the studio, and the action spaces of both hands.
pub(crate) struct ControllerActions {
    set: xr::ActionSet,
    hands: [HandSpaces; 2],
    actions: ActionHandles,
    /// The interaction profiles that bindings were suggested for.
    pub(crate) profiles: SuggestedProfiles,
}

struct HandSpaces {
    path: xr::Path,
    aim: xr::Space,
    grip: xr::Space,
}

/// All actions.
pub(super) struct ActionHandles {
    pub(super) aim: xr::Action<xr::Posef>,
    pub(super) grip: xr::Action<xr::Posef>,
    pub(super) trigger: xr::Action<f32>,
    pub(super) squeeze: xr::Action<f32>,
    pub(super) stick: xr::Action<xr::Vector2f>,
    pub(super) undo: xr::Action<bool>,
    pub(super) redo: xr::Action<bool>,
    pub(super) mirror: xr::Action<bool>,
    pub(super) menu: xr::Action<bool>,
    pub(super) haptic: xr::Action<xr::Haptic>,
}

pub(super) const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

impl ControllerActions {
    /// Creates the actions, suggests all bindings, and attaches the action set to a session.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn create(
        instance: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        extensions: &xr::ExtensionSet,
    ) -> Result<Self, Error> {
        let purpose = "make an action";
        let set = instance.create_action_set("sculpting", "Sculpting", 0).could_not(purpose)?;
        let path = |hand: &str| instance.string_to_path(hand).could_not("name a hand");
        let paths = [path(HANDS[0])?, path(HANDS[1])?];
        let button =
            |name, words| set.create_action::<bool>(name, words, &paths).could_not(purpose);
        let actions = ActionHandles {
            aim: set.create_action("aim", "Where the hand points", &paths).could_not(purpose)?,
            grip: set.create_action("grip", "Where the tool is held", &paths).could_not(purpose)?,
            trigger: set.create_action("run", "Run the tool", &paths).could_not(purpose)?,
            squeeze: set.create_action("take", "Take and let go", &paths).could_not(purpose)?,
            stick: set.create_action("turn", "Turn the stool", &paths).could_not(purpose)?,
            undo: button("undo", "Undo")?,
            redo: button("redo", "Redo")?,
            mirror: button("mirror", "Mirror")?,
            menu: button("menu", "Finish, if held")?,
            haptic: set.create_action("feel", "Feel the stone", &paths).could_not(purpose)?,
        };
        let space = |action: &xr::Action<xr::Posef>, path| {
            action.create_space(session, path, xr::Posef::IDENTITY).could_not("make a hand's space")
        };
        let hand = |path| -> Result<HandSpaces, Error> {
            Ok(HandSpaces {
                path,
                aim: space(&actions.aim, path)?,
                grip: space(&actions.grip, path)?,
            })
        };
        let hands = [hand(paths[0])?, hand(paths[1])?];
        let profiles = SuggestedProfiles::suggest(instance, &actions, extensions)?;
        session.attach_action_sets(&[&set]).could_not("attach the actions")?;
        Ok(ControllerActions { set, hands, actions, profiles })
    }

    /// Updates the state of all actions (`xrSyncActions`).
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sync_actions(&self, session: &xr::Session<xr::Vulkan>) -> Result<(), Error> {
        session.sync_actions(&[(&self.set).into()]).could_not("ask the controllers")
    }

    /// Returns the kind of each hand's current interaction profile. Profiles change only in
    /// [`ControllerActions::sync_actions`].
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn current_profiles(
        &self,
        session: &xr::Session<xr::Vulkan>,
    ) -> Result<[HandProfile; 2], Error> {
        let mut profiles = [HandProfile::default(); 2];
        for (profile, hand) in profiles.iter_mut().zip(&self.hands) {
            let path = session.current_interaction_profile(hand.path);
            *profile = self.profiles.classify(path.could_not("ask which controllers there are")?);
        }
        Ok(profiles)
    }

    /// Samples a hand's controller: its poses at a time, and its buttons as of the last
    /// [`ControllerActions::sync_actions`].
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sample_hand(
        &self,
        session: &xr::Session<xr::Vulkan>,
        room: &xr::Space,
        hand: usize,
        time: xr::Time,
    ) -> Result<HandSample, Error> {
        let purpose = "ask a controller";
        let path = self.hands[hand].path;
        let value = |action: &xr::Action<f32>| action.state(session, path).could_not(purpose);
        let actions = &self.actions;
        let stick = actions.stick.state(session, path).could_not(purpose)?.current_state;
        let mut pressed = 0;
        for (action, bit) in [
            (&actions.undo, buttons::LOWER),
            (&actions.redo, buttons::UPPER),
            (&actions.mirror, buttons::STICK),
        ] {
            let state = action.state(session, path).could_not(purpose)?;
            pressed |= if state.current_state { bit } else { 0 };
        }
        Ok(HandSample {
            aim: locate_tracked(&self.hands[hand].aim, room, time)?,
            grip: locate_tracked(&self.hands[hand].grip, room, time)?,
            trigger: value(&actions.trigger)?.current_state,
            squeeze: value(&actions.squeeze)?.current_state,
            stick: [stick.x, stick.y],
            buttons: pressed,
            fingertip: None,
        })
    }

    /// Locates a hand's grip pose at a time.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn locate_grip(
        &self,
        room: &xr::Space,
        hand: usize,
        time: xr::Time,
    ) -> Result<Option<RoomPose>, Error> {
        locate_tracked(&self.hands[hand].grip, room, time)
    }

    /// Returns `true` if the menu button was down at the last [`ControllerActions::sync_actions`].
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn is_menu_down(&self, session: &xr::Session<xr::Vulkan>) -> Result<bool, Error> {
        let state =
            self.actions.menu.state(session, xr::Path::NULL).could_not("ask a controller")?;
        Ok(state.current_state)
    }

    /// Begins or stops a vibration of a hand's controller.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn change_haptics(
        &self,
        session: &xr::Session<xr::Vulkan>,
        hand: usize,
        change: HapticChange,
    ) -> Result<(), Error> {
        let path = self.hands[hand].path;
        let pulse = match change {
            HapticChange::None => return Ok(()),
            HapticChange::Stop => {
                return self
                    .actions
                    .haptic
                    .stop_feedback(session, path)
                    .could_not("end a vibration");
            }
            HapticChange::Begin(pulse) => pulse,
        };
        let event = xr::HapticVibration::new()
            .amplitude(pulse.amplitude)
            .frequency(pulse.frequency_hz)
            .duration(xr::Duration::from_nanos(pulse.nanos));
        self.actions.haptic.apply_feedback(session, path, &event).could_not("vibrate")
    }
}

fn locate_tracked(
    space: &xr::Space,
    room: &xr::Space,
    time: xr::Time,
) -> Result<Option<RoomPose>, Error> {
    let location = space.locate(room, time).could_not("find a hand")?;
    Ok(convert_location(location.location_flags, location.pose).if_tracked())
}
