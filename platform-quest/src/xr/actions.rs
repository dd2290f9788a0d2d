//! Controllers: poses, buttons and vibration by actions, for the profiles that there are.

use openxr as xr;
use paros_core::input::buttons;

use super::tracked;
use crate::error::{Doing, Error};
use crate::pulse::Pulse;
use crate::sample::HandSample;

/// What hands do, and how they are found.
pub(crate) struct Actions {
    set: xr::ActionSet,
    hands: [Hand; 2],
    trigger: xr::Action<f32>,
    squeeze: xr::Action<f32>,
    stick: xr::Action<xr::Vector2f>,
    buttons: [(xr::Action<bool>, u8); 3],
    menu: xr::Action<bool>,
    pulse: xr::Action<xr::Haptic>,
    /// Profiles that the runtime has taken.
    pub(crate) profiles: u32,
}

/// What a runtime lacks that takes no profile.
pub(crate) const NO_PROFILE: &str =
    "the OpenXR runtime takes no profile of controllers, expected Touch, Touch Plus or simple ones";

struct Hand {
    path: xr::Path,
    aim: xr::Space,
    grip: xr::Space,
}

/// An action, as profiles bind it: its name, and what of a hand moves it.
struct Poses {
    aim: xr::Action<xr::Posef>,
    grip: xr::Action<xr::Posef>,
}

const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

impl Actions {
    /// Actions for a session, with all bindings suggested.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn new(
        instance: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        extensions: &xr::ExtensionSet,
    ) -> Result<Self, Error> {
        let doing = "make an action";
        let set = instance.create_action_set("sculpting", "Sculpting", 0).doing(doing)?;
        let path = |hand: &str| instance.string_to_path(hand).doing("name a hand");
        let paths = [path(HANDS[0])?, path(HANDS[1])?];
        let poses = Poses {
            aim: set.create_action("aim", "Where the hand points", &paths).doing(doing)?,
            grip: set.create_action("grip", "Where the tool is held", &paths).doing(doing)?,
        };
        let button = |name, words| set.create_action::<bool>(name, words, &paths).doing(doing);
        let space = |action: &xr::Action<xr::Posef>, path| {
            action.create_space(session, path, xr::Posef::IDENTITY).doing("make a hand's space")
        };
        let hand = |path| -> Result<Hand, Error> {
            Ok(Hand { path, aim: space(&poses.aim, path)?, grip: space(&poses.grip, path)? })
        };
        let mut actions = Actions {
            hands: [hand(paths[0])?, hand(paths[1])?],
            trigger: set.create_action("run", "Run the tool", &paths).doing(doing)?,
            squeeze: set.create_action("take", "Take and let go", &paths).doing(doing)?,
            stick: set.create_action("turn", "Turn the stool", &paths).doing(doing)?,
            buttons: [
                (button("undo", "Undo")?, buttons::LOWER),
                (button("redo", "Redo")?, buttons::UPPER),
                (button("mirror", "Mirror")?, buttons::STICK),
            ],
            menu: button("menu", "Finish, if held")?,
            pulse: set.create_action("feel", "Feel the stone", &paths).doing(doing)?,
            profiles: 0,
            set,
        };
        actions.profiles = actions.suggest(instance, &poses, extensions)?;
        session.attach_action_sets(&[&actions.set]).doing("attach the actions")?;
        Ok(actions)
    }

    /// Suggests bindings for all profiles; a profile that the runtime doesn't know is passed over.
    /// How many it takes.
    fn suggest(
        &self,
        instance: &xr::Instance,
        poses: &Poses,
        extensions: &xr::ExtensionSet,
    ) -> Result<u32, Error> {
        let mut known = 0;
        for (profile, offered) in
            [(TOUCH, true), (TOUCH_PLUS, extensions.meta_touch_controller_plus), (SIMPLE, true)]
        {
            if !offered {
                continue;
            }
            let mut bind = Bind { instance, bindings: Vec::new() };
            bind.poses(poses)?;
            match profile {
                SIMPLE => self.simple(&mut bind)?,
                _ => self.touch(&mut bind)?,
            }
            let path = instance.string_to_path(profile).doing("name a profile")?;
            let suggest = instance.suggest_interaction_profile_bindings(path, &bind.bindings);
            known += u32::from(suggest.is_ok());
        }
        Ok(known)
    }

    fn touch<'a>(&'a self, bind: &mut Bind<'a>) -> Result<(), Error> {
        for hand in HANDS {
            bind.to(&self.trigger, hand, "input/trigger/value")?;
            bind.to(&self.squeeze, hand, "input/squeeze/value")?;
            bind.to(&self.stick, hand, "input/thumbstick")?;
            bind.to(&self.buttons[2].0, hand, "input/thumbstick/click")?;
            bind.to(&self.pulse, hand, "output/haptic")?;
        }
        let [left, right] = HANDS;
        for (hand, [lower, upper]) in [
            (left, ["input/x/click", "input/y/click"]),
            (right, ["input/a/click", "input/b/click"]),
        ] {
            bind.to(&self.buttons[0].0, hand, lower)?;
            bind.to(&self.buttons[1].0, hand, upper)?;
        }
        bind.to(&self.menu, left, "input/menu/click")
    }

    /// One button runs the tool, the other takes: enough to sculpt.
    fn simple<'a>(&'a self, bind: &mut Bind<'a>) -> Result<(), Error> {
        for hand in HANDS {
            bind.to(&self.trigger, hand, "input/select/click")?;
            bind.to(&self.squeeze, hand, "input/menu/click")?;
            bind.to(&self.pulse, hand, "output/haptic")?;
        }
        Ok(())
    }

    /// Takes in what the controllers have done since it was called last.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sync(&self, session: &xr::Session<xr::Vulkan>) -> Result<(), Error> {
        session.sync_actions(&[(&self.set).into()]).doing("ask the controllers")
    }

    /// A hand's controller with its poses at a time, and its buttons as of the last
    /// [`Actions::sync`].
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sample(
        &self,
        session: &xr::Session<xr::Vulkan>,
        room: &xr::Space,
        hand: usize,
        at: xr::Time,
    ) -> Result<HandSample, Error> {
        let doing = "ask a controller";
        let path = self.hands[hand].path;
        let value = |action: &xr::Action<f32>| action.state(session, path).doing(doing);
        let stick = self.stick.state(session, path).doing(doing)?.current_state;
        let mut pressed = 0;
        for (action, bit) in &self.buttons {
            let state = action.state(session, path).doing(doing)?;
            pressed |= if state.current_state { *bit } else { 0 };
        }
        Ok(HandSample {
            aim: locate(&self.hands[hand].aim, room, at)?,
            grip: locate(&self.hands[hand].grip, room, at)?,
            trigger: value(&self.trigger)?.current_state,
            squeeze: value(&self.squeeze)?.current_state,
            stick: [stick.x, stick.y],
            buttons: pressed,
        })
    }

    /// Where a hand's palm is at a time.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn grip(
        &self,
        room: &xr::Space,
        hand: usize,
        at: xr::Time,
    ) -> Result<Option<paros_core::hand::RoomPose>, Error> {
        locate(&self.hands[hand].grip, room, at)
    }

    /// Whether the menu button is down.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn menu(&self, session: &xr::Session<xr::Vulkan>) -> Result<bool, Error> {
        let state = self.menu.state(session, xr::Path::NULL).doing("ask a controller")?;
        Ok(state.current_state)
    }

    /// Lets a hand feel something.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn pulse(
        &self,
        session: &xr::Session<xr::Vulkan>,
        hand: usize,
        pulse: Pulse,
    ) -> Result<(), Error> {
        let event = xr::HapticVibration::new()
            .amplitude(pulse.amplitude)
            .frequency(xr::FREQUENCY_UNSPECIFIED)
            .duration(xr::Duration::from_nanos(pulse.nanos));
        self.pulse.apply_feedback(session, self.hands[hand].path, &event).doing("vibrate")
    }
}

const TOUCH: &str = "/interaction_profiles/oculus/touch_controller";
const TOUCH_PLUS: &str = "/interaction_profiles/meta/touch_controller_plus";
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";

/// Bindings of a profile.
struct Bind<'a> {
    instance: &'a xr::Instance,
    bindings: Vec<xr::Binding<'a>>,
}

impl<'a> Bind<'a> {
    fn to<T: xr::ActionTy>(
        &mut self,
        action: &'a xr::Action<T>,
        hand: &str,
        part: &str,
    ) -> Result<(), Error> {
        let path = self.instance.string_to_path(&format!("{hand}/{part}"));
        self.bindings.push(xr::Binding::new(action, path.doing("name a button")?));
        Ok(())
    }

    fn poses(&mut self, poses: &'a Poses) -> Result<(), Error> {
        for hand in HANDS {
            self.to(&poses.aim, hand, "input/aim/pose")?;
            self.to(&poses.grip, hand, "input/grip/pose")?;
        }
        Ok(())
    }
}

fn locate(
    space: &xr::Space,
    room: &xr::Space,
    at: xr::Time,
) -> Result<Option<paros_core::hand::RoomPose>, Error> {
    let location = space.locate(room, at).doing("find a hand")?;
    Ok(tracked(location.location_flags, location.pose))
}
