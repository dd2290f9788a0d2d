//! Controllers by OpenXR's actions: poses, buttons and haptics, bound for each interaction profile.

use openxr as xr;
use paros_core::session::buttons;
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::headset::haptics::HapticChange;

use super::convert_location;
use crate::error::{CallContext, Error};

/// The action set of the studio, and the action spaces of both hands.
pub(crate) struct ControllerActions {
    set: xr::ActionSet,
    hands: [HandSpaces; 2],
    trigger: xr::Action<f32>,
    squeeze: xr::Action<f32>,
    stick: xr::Action<xr::Vector2f>,
    buttons: [(xr::Action<bool>, u8); 3],
    menu: xr::Action<bool>,
    haptic: xr::Action<xr::Haptic>,
    /// How many interaction profiles the runtime has accepted bindings for.
    pub(crate) profiles: u32,
}

/// The line for the log where the runtime accepts no interaction profile.
pub(crate) const NO_PROFILE: &str =
    "the OpenXR runtime takes no profile of controllers, expected Touch, Touch Plus or simple ones";

struct HandSpaces {
    path: xr::Path,
    aim: xr::Space,
    grip: xr::Space,
}

/// The pose actions, which the action spaces are made from.
struct PoseActions {
    aim: xr::Action<xr::Posef>,
    grip: xr::Action<xr::Posef>,
}

const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

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
        let poses = PoseActions {
            aim: set.create_action("aim", "Where the hand points", &paths).could_not(purpose)?,
            grip: set.create_action("grip", "Where the tool is held", &paths).could_not(purpose)?,
        };
        let button =
            |name, words| set.create_action::<bool>(name, words, &paths).could_not(purpose);
        let space = |action: &xr::Action<xr::Posef>, path| {
            action.create_space(session, path, xr::Posef::IDENTITY).could_not("make a hand's space")
        };
        let hand = |path| -> Result<HandSpaces, Error> {
            Ok(HandSpaces { path, aim: space(&poses.aim, path)?, grip: space(&poses.grip, path)? })
        };
        let mut actions = ControllerActions {
            hands: [hand(paths[0])?, hand(paths[1])?],
            trigger: set.create_action("run", "Run the tool", &paths).could_not(purpose)?,
            squeeze: set.create_action("take", "Take and let go", &paths).could_not(purpose)?,
            stick: set.create_action("turn", "Turn the stool", &paths).could_not(purpose)?,
            buttons: [
                (button("undo", "Undo")?, buttons::LOWER),
                (button("redo", "Redo")?, buttons::UPPER),
                (button("mirror", "Mirror")?, buttons::STICK),
            ],
            menu: button("menu", "Finish, if held")?,
            haptic: set.create_action("feel", "Feel the stone", &paths).could_not(purpose)?,
            profiles: 0,
            set,
        };
        actions.profiles =
            actions.suggest_bindings_and_count_accepted(instance, &poses, extensions)?;
        session.attach_action_sets(&[&actions.set]).could_not("attach the actions")?;
        Ok(actions)
    }

    /// Suggests bindings for all interaction profiles; one that the runtime doesn't know is passed over.
    /// Returns how many are accepted.
    fn suggest_bindings_and_count_accepted(
        &self,
        instance: &xr::Instance,
        poses: &PoseActions,
        extensions: &xr::ExtensionSet,
    ) -> Result<u32, Error> {
        let mut known = 0;
        for (profile, offered) in
            [(TOUCH, true), (TOUCH_PLUS, extensions.meta_touch_controller_plus), (SIMPLE, true)]
        {
            if !offered {
                continue;
            }
            let mut list = BindingList { instance, bindings: Vec::new() };
            list.bind_poses(poses)?;
            match profile {
                SIMPLE => self.bind_buttons_of_simple(&mut list)?,
                _ => self.bind_touch(&mut list)?,
            }
            let path = instance.string_to_path(profile).could_not("name a profile")?;
            let suggest = instance.suggest_interaction_profile_bindings(path, &list.bindings);
            known += u32::from(suggest.is_ok());
        }
        Ok(known)
    }

    fn bind_touch<'a>(&'a self, list: &mut BindingList<'a>) -> Result<(), Error> {
        for hand in HANDS {
            list.bind(&self.trigger, hand, "input/trigger/value")?;
            list.bind(&self.squeeze, hand, "input/squeeze/value")?;
            list.bind(&self.stick, hand, "input/thumbstick")?;
            list.bind(&self.buttons[2].0, hand, "input/thumbstick/click")?;
            list.bind(&self.haptic, hand, "output/haptic")?;
        }
        let [left, right] = HANDS;
        for (hand, [lower, upper]) in [
            (left, ["input/x/click", "input/y/click"]),
            (right, ["input/a/click", "input/b/click"]),
        ] {
            list.bind(&self.buttons[0].0, hand, lower)?;
            list.bind(&self.buttons[1].0, hand, upper)?;
        }
        list.bind(&self.menu, left, "input/menu/click")
    }

    /// The simple controller has two buttons: one runs the tool, the other takes it. Enough to sculpt.
    fn bind_buttons_of_simple<'a>(&'a self, list: &mut BindingList<'a>) -> Result<(), Error> {
        for hand in HANDS {
            list.bind(&self.trigger, hand, "input/select/click")?;
            list.bind(&self.squeeze, hand, "input/menu/click")?;
            list.bind(&self.haptic, hand, "output/haptic")?;
        }
        Ok(())
    }

    /// Updates the state of all actions (`xrSyncActions`).
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sync_actions(&self, session: &xr::Session<xr::Vulkan>) -> Result<(), Error> {
        session.sync_actions(&[(&self.set).into()]).could_not("ask the controllers")
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
        let stick = self.stick.state(session, path).could_not(purpose)?.current_state;
        let mut pressed = 0;
        for (action, bit) in &self.buttons {
            let state = action.state(session, path).could_not(purpose)?;
            pressed |= if state.current_state { *bit } else { 0 };
        }
        Ok(HandSample {
            aim: locate_tracked(&self.hands[hand].aim, room, time)?,
            grip: locate_tracked(&self.hands[hand].grip, room, time)?,
            trigger: value(&self.trigger)?.current_state,
            squeeze: value(&self.squeeze)?.current_state,
            stick: [stick.x, stick.y],
            buttons: pressed,
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
    ) -> Result<Option<paros_core::internals::RoomPose>, Error> {
        locate_tracked(&self.hands[hand].grip, room, time)
    }

    /// Whether the menu button is down, as of the last sync.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn is_menu_down(&self, session: &xr::Session<xr::Vulkan>) -> Result<bool, Error> {
        let state = self.menu.state(session, xr::Path::NULL).could_not("ask a controller")?;
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
                return self.haptic.stop_feedback(session, path).could_not("end a vibration");
            }
            HapticChange::Begin(pulse) => pulse,
        };
        let event = xr::HapticVibration::new()
            .amplitude(pulse.amplitude)
            .frequency(pulse.frequency_hz)
            .duration(xr::Duration::from_nanos(pulse.nanos));
        self.haptic.apply_feedback(session, path, &event).could_not("vibrate")
    }
}

const TOUCH: &str = "/interaction_profiles/oculus/touch_controller";
const TOUCH_PLUS: &str = "/interaction_profiles/meta/touch_controller_plus";
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";

/// The suggested bindings of an interaction profile.
struct BindingList<'a> {
    instance: &'a xr::Instance,
    bindings: Vec<xr::Binding<'a>>,
}

impl<'a> BindingList<'a> {
    fn bind<T: xr::ActionTy>(
        &mut self,
        action: &'a xr::Action<T>,
        hand_path: &str,
        component_path: &str,
    ) -> Result<(), Error> {
        let path = self.instance.string_to_path(&format!("{hand_path}/{component_path}"));
        self.bindings.push(xr::Binding::new(action, path.could_not("name a button")?));
        Ok(())
    }

    fn bind_poses(&mut self, poses: &'a PoseActions) -> Result<(), Error> {
        for hand in HANDS {
            self.bind(&poses.aim, hand, "input/aim/pose")?;
            self.bind(&poses.grip, hand, "input/grip/pose")?;
        }
        Ok(())
    }
}

fn locate_tracked(
    space: &xr::Space,
    room: &xr::Space,
    time: xr::Time,
) -> Result<Option<paros_core::internals::RoomPose>, Error> {
    let location = space.locate(room, time).could_not("find a hand")?;
    Ok(convert_location(location.location_flags, location.pose).if_tracked())
}
