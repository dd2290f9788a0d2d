//! Pointing at panels with hands, rays and cursors: hovering and pressing.

use glam::Vec3;
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::TICK_RATE;
use paros_shaders::panel::{Panel, PanelButton, PanelPoint, find_button};
use paros_shell::headset::hand_sample::HandSample;

/// Largest number of pointers: left hand, right hand, and a cursor.
pub const POINTERS: usize = 3;

/// Distance from the block's centre, in metres, within which a hand counts as working on the block. Includes
/// the length of the held tool.
const AT_WORK: f32 = 0.45;

/// Distance in metres before or behind a panel at which a fingertip presses.
const TOUCH_DEPTH: f32 = 0.015;

/// Distance from a hand's grip to its foremost point in metres: a controller's ring, or knuckles.
const GRIP_REACH: f32 = 0.08;

/// Trigger value from which a press counts, as in the core: 128 of 255.
pub(crate) const PRESSED_FROM: f32 = 128.0 / 255.0;

/// Ticks for which new buttons can't be pressed: 300 ms. Earlier presses are meant for what was before.
pub(crate) const UNAIMED_TICKS: u32 = (TICK_RATE * 3).div_ceil(10);

/// Haptic levels when a hand moves onto a button, and when it presses the button, of 255.
const HOVER_TAP: u8 = 70;
const PRESS_TAP: u8 = 170;

/// A pointer at panels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pointer {
    /// The origin of the ray, in metres of the room.
    pub origin: Vec3,
    /// The direction of the ray.
    pub direction: Vec3,
    /// `true` while the trigger or button is down.
    pub is_pressed: bool,
    /// The fingertip or the foremost point of a hand, which presses by touch.
    pub fingertip: Option<Vec3>,
}

/// A ray that ends on a panel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct PanelRay {
    /// The index of the panel.
    pub(crate) panel: usize,
    /// The origin and the end of the ray, in metres of the room.
    pub(crate) ends: [Vec3; 2],
}

/// The state of a pointer since the last tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
struct PointerState {
    was_pressed: bool,
    was_touching: bool,
    /// `true` if the current press began on a panel. Until its release it has no other effect.
    holds_press: bool,
    /// The button under the pointer.
    hot: Option<u16>,
    /// The ray, if it ends on a panel with buttons.
    ray: Option<PanelRay>,
    /// The haptic level of this tick, of 255.
    tap: u8,
}

/// The state of all pointers since the last tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(crate) struct Pointing {
    states: [PointerState; POINTERS],
    /// The remaining ticks of [`UNAIMED_TICKS`].
    unaimed_ticks: u32,
}

/// A button of a shown panel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct ShownButton {
    /// The index of the panel.
    pub(crate) panel: usize,
    /// The button, whose number is unique among all shown buttons.
    pub(crate) button: PanelButton<'static>,
}

impl Pointer {
    /// Makes the pointer of a headset's hand. The aim gives the ray, and trigger or pinch press. The tip of
    /// the index finger presses by touch; without it, the hand's foremost point does. Returns `None` if the
    /// aim is unknown.
    #[must_use]
    pub fn of_hand(sample: &HandSample) -> Option<Self> {
        let (origin, rotation) = sample.aim?;
        let foremost = |(position, rotation)| position + rotation * Vec3::NEG_Z * GRIP_REACH;
        Some(Pointer {
            origin,
            direction: rotation * Vec3::NEG_Z,
            is_pressed: sample.trigger >= PRESSED_FROM,
            fingertip: sample.fingertip.or(sample.grip.map(foremost)),
        })
    }
}

impl Pointing {
    /// Processes the pointers of a tick. Returns the button that was pressed in this tick. New buttons can't
    /// be pressed at first. With `is_stone_between`, rays through the stone are at work on it, and don't
    /// point at panels behind it.
    pub(crate) fn follow(
        &mut self,
        pointers: &[Option<Pointer>; POINTERS],
        panels: &[Panel],
        buttons: &[ShownButton],
        is_stone_between: bool,
    ) -> Option<u16> {
        let mut pressed = None;
        let is_unaimed = self.unaimed_ticks > 0;
        self.unaimed_ticks = self.unaimed_ticks.saturating_sub(1);
        for (state, pointer) in self.states.iter_mut().zip(pointers) {
            let Some(pointer) = pointer else {
                // A press or touch may continue when the pointer is seen again, which is no new press.
                (state.hot, state.ray, state.tap) = (None, None, 0);
                continue;
            };
            let touched =
                pointer.fingertip.and_then(|tip| find_touched_button(panels, buttons, tip));
            let ray = find_ray(panels, buttons, pointer, is_stone_between);
            let pointed = ray.and_then(|ray| {
                let point = panels[ray.panel].project_point(ray.ends[1]);
                button_at(buttons, ray.panel, point)
            });
            let is_new_press = pointer.is_pressed && !state.was_pressed;
            let is_new_touch = touched.is_some() && !state.was_touching;
            let press = match (is_new_touch, is_new_press) {
                _ if is_unaimed => None,
                (true, _) => touched,
                (false, true) => pointed,
                (false, false) => None,
            };
            pressed = pressed.or(press);
            let hot = touched.or(pointed);
            let tap = match (press, hot) {
                (Some(_), _) => PRESS_TAP,
                (None, Some(_)) if hot != state.hot => HOVER_TAP,
                (None, _) => 0,
            };
            let has_pressed = state.holds_press || is_new_press && pointed.is_some();
            *state = PointerState {
                was_pressed: pointer.is_pressed,
                was_touching: touched.is_some(),
                holds_press: pointer.is_pressed && has_pressed,
                hot,
                ray,
                tap,
            };
        }
        pressed
    }

    /// Returns `true` if a pointer is on a button, or still holds the press that began on a button.
    pub(crate) fn is_on_button(&self, pointer: usize) -> bool {
        self.states.get(pointer).is_some_and(|state| state.hot.is_some() || state.holds_press)
    }

    /// Returns the buttons under the pointers.
    pub(crate) fn hot_buttons(&self) -> [Option<u16>; POINTERS] {
        self.states.map(|state| state.hot)
    }

    /// Returns the rays that end on panels.
    pub(crate) fn rays(&self) -> [Option<PanelRay>; POINTERS] {
        self.states.map(|state| state.ray)
    }

    /// Returns a pointer's haptic level of this tick, of 255: low when it moves onto a button, higher when it
    /// presses.
    pub(crate) fn tap(&self, pointer: usize) -> u8 {
        self.states.get(pointer).map_or(0, |state| state.tap)
    }

    /// Resets the pointers when other buttons are shown. A held press doesn't press the new buttons, and no
    /// press counts for [`UNAIMED_TICKS`].
    pub(crate) fn forget_buttons(&mut self) {
        self.unaimed_ticks = UNAIMED_TICKS;
        self.states.iter_mut().for_each(|state| {
            (state.hot, state.ray, state.was_touching) = (None, None, true);
        });
    }
}

/// Returns the button at a point of a panel.
fn button_at(buttons: &[ShownButton], panel: usize, point: PanelPoint) -> Option<u16> {
    let of_panel = buttons.iter().filter(|shown| shown.panel == panel);
    let at = |shown: &ShownButton| find_button(core::slice::from_ref(&shown.button), point.at_mm);
    of_panel.filter_map(at).next_back()
}

fn find_touched_button(panels: &[Panel], buttons: &[ShownButton], tip: Vec3) -> Option<u16> {
    (0..).zip(panels).find_map(|(k, panel)| {
        let point = panel.project_point(tip);
        (point.distance.abs() <= TOUCH_DEPTH).then(|| button_at(buttons, k, point)).flatten()
    })
}

/// Returns the pointer's ray to the nearest panel that it meets; `None` if that panel has no buttons.
fn find_ray(
    panels: &[Panel],
    buttons: &[ShownButton],
    pointer: &Pointer,
    is_stone_between: bool,
) -> Option<PanelRay> {
    let Pointer { origin, direction, .. } = *pointer;
    let hit = |(k, panel): (usize, &Panel)| Some((k, panel.intersect_ray(origin, direction)?));
    let hits = panels.iter().enumerate().filter_map(hit);
    let (panel, point) = hits.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
    let is_behind = is_stone_between && crosses_stone(origin, direction);
    let has_buttons = buttons.iter().any(|shown| shown.panel == panel);
    let end = origin + direction.normalize_or_zero() * point.distance;
    (has_buttons && !is_behind).then_some(PanelRay { panel, ends: [origin, end] })
}

/// Returns `true` if a ray starts near the block, in a hand at work on it, or passes through the block.
fn crosses_stone(origin: Vec3, direction: Vec3) -> bool {
    let middle = STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE);
    let from = origin - middle;
    let half = Vec3::splat(0.5 * BOX_SIDE);
    // The slab method: the ray enters the box at the last slab and leaves it at the first. A ray parallel to
    // a slab divides by zero, and the infinities compare correctly.
    let (a, b) = ((-half - from) / direction, (half - from) / direction);
    let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
    from.length() < AT_WORK || leaves >= enters.max(0.0)
}

#[cfg(test)]
mod tests;
