//! Interaction profiles: the controllers and hands that the actions are bound to.

use openxr as xr;
use paros_shell::headset::hand_reader::HandProfile;

use super::actions::{ActionHandles, HANDS};
use crate::error::{CallContext, Error};

/// The log line for a runtime that accepts no interaction profile.
pub(crate) const NO_PROFILE: &str = "the OpenXR runtime takes no profile of controllers, expected Touch, \
     Touch Plus, Touch Pro, Index or simple ones, or hands' interaction";

/// The interaction profiles that bindings were suggested for.
pub(crate) struct SuggestedProfiles {
    /// The number of profiles that the runtime accepted.
    pub(crate) accepted: u32,
    /// A log line for each profile that the runtime refused.
    pub(crate) refusals: Vec<String>,
    simple: xr::Path,
    hand_interaction: xr::Path,
}

/// The set of components of a profile.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum ProfileLayout {
    /// The components of `oculus/touch_controller` and of its successors.
    Touch,
    Index,
    Simple,
    HandInteraction,
}

/// A profile's path, a test that its extension is enabled, and its components.
type Profile = (&'static str, fn(&xr::ExtensionSet) -> bool, ProfileLayout);

const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";
const HAND_INTERACTION: &str = "/interaction_profiles/ext/hand_interaction_ext";

const PROFILES: [Profile; 6] = [
    ("/interaction_profiles/oculus/touch_controller", |_| true, ProfileLayout::Touch),
    (
        "/interaction_profiles/meta/touch_controller_plus",
        |enabled| enabled.meta_touch_controller_plus,
        ProfileLayout::Touch,
    ),
    (
        "/interaction_profiles/facebook/touch_controller_pro",
        |enabled| enabled.fb_touch_controller_pro,
        ProfileLayout::Touch,
    ),
    ("/interaction_profiles/valve/index_controller", |_| true, ProfileLayout::Index),
    (SIMPLE, |_| true, ProfileLayout::Simple),
    (HAND_INTERACTION, |enabled| enabled.ext_hand_interaction, ProfileLayout::HandInteraction),
];

impl SuggestedProfiles {
    /// Suggests bindings for each profile whose extension is enabled. A profile that the runtime refuses is
    /// skipped.
    ///
    /// # Errors
    /// A path that can't be made.
    pub(super) fn suggest(
        instance: &xr::Instance,
        actions: &ActionHandles,
        enabled: &xr::ExtensionSet,
    ) -> Result<Self, Error> {
        let path = |profile| instance.string_to_path(profile).could_not("name a profile");
        let (simple, hand_interaction) = (path(SIMPLE)?, path(HAND_INTERACTION)?);
        let (mut accepted, mut refusals) = (0, Vec::new());
        for (profile, is_enabled, layout) in PROFILES {
            if !is_enabled(enabled) {
                continue;
            }
            let mut list = BindingList { instance, bindings: Vec::new() };
            list.bind_profile(actions, layout)?;
            match instance.suggest_interaction_profile_bindings(path(profile)?, &list.bindings) {
                Ok(()) => accepted += 1,
                Err(why) => {
                    refusals.push(format!("the OpenXR runtime refuses {profile}: {why:?}"));
                }
            }
        }
        Ok(SuggestedProfiles { accepted, refusals, simple, hand_interaction })
    }

    /// Returns the kind of a hand's current profile.
    pub(super) fn classify(&self, current: xr::Path) -> HandProfile {
        match current {
            path if path == self.simple => HandProfile::SimpleController,
            path if path == self.hand_interaction => HandProfile::HandInteraction,
            _ => HandProfile::Controller,
        }
    }
}

/// The suggested bindings of an interaction profile.
struct BindingList<'a> {
    instance: &'a xr::Instance,
    bindings: Vec<xr::Binding<'a>>,
}

impl<'a> BindingList<'a> {
    fn bind_profile(
        &mut self,
        actions: &'a ActionHandles,
        layout: ProfileLayout,
    ) -> Result<(), Error> {
        // The simple controller has two buttons: one runs the tool, the other takes it. That is enough to
        // sculpt.
        let [run, take] = match layout {
            ProfileLayout::Touch | ProfileLayout::Index => {
                ["input/trigger/value", "input/squeeze/value"]
            }
            ProfileLayout::Simple => ["input/select/click", "input/menu/click"],
            ProfileLayout::HandInteraction => ["input/pinch_ext/value", "input/grasp_ext/value"],
        };
        for hand in HANDS {
            self.bind(&actions.aim, hand, "input/aim/pose")?;
            self.bind(&actions.grip, hand, "input/grip/pose")?;
            self.bind(&actions.trigger, hand, run)?;
            self.bind(&actions.squeeze, hand, take)?;
            if layout != ProfileLayout::HandInteraction {
                self.bind(&actions.haptic, hand, "output/haptic")?;
            }
        }
        match layout {
            ProfileLayout::Touch => {
                self.bind_sticks(actions)?;
                self.bind_buttons(actions, ["x", "y"], ["a", "b"])?;
                // The right controller's menu button belongs to the system, and so does the only one of an
                // Index.
                self.bind(&actions.menu, HANDS[0], "input/menu/click")
            }
            ProfileLayout::Index => {
                self.bind_sticks(actions)?;
                self.bind_buttons(actions, ["a", "b"], ["a", "b"])
            }
            ProfileLayout::Simple | ProfileLayout::HandInteraction => Ok(()),
        }
    }

    fn bind_sticks(&mut self, actions: &'a ActionHandles) -> Result<(), Error> {
        for hand in HANDS {
            self.bind(&actions.stick, hand, "input/thumbstick")?;
            self.bind(&actions.mirror, hand, "input/thumbstick/click")?;
        }
        Ok(())
    }

    /// Binds the lower and the upper button of the left and the right hand.
    fn bind_buttons(
        &mut self,
        actions: &'a ActionHandles,
        left: [&str; 2],
        right: [&str; 2],
    ) -> Result<(), Error> {
        for (hand, [lower, upper]) in HANDS.into_iter().zip([left, right]) {
            self.bind(&actions.undo, hand, &format!("input/{lower}/click"))?;
            self.bind(&actions.redo, hand, &format!("input/{upper}/click"))?;
        }
        Ok(())
    }

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
}
