//! Hands, rays and cursors on panels: what they point at, and when that is pressed.

use glam::Vec3;
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::TICK_RATE;
use paros_shaders::panel::{Panel, PanelButton, PanelPoint, find_button};
use paros_shell::headset::hand_sample::HandSample;

/// Pointers that a shell may have: left and right hand, and a cursor.
pub const POINTERS: usize = 3;

/// How near the block's middle a hand is at work on it, with what it holds before it, in metres.
const AT_WORK: f32 = 0.45;

/// How near a fingertip presses, in metres before a panel or behind it.
const TOUCH_DEPTH: f32 = 0.015;

/// How far before a hand's grip its foremost point is, in metres: a controller's ring, or knuckles.
const GRIP_REACH: f32 = 0.08;

/// A trigger that is pulled so far presses, as the core has it: 128 of 255.
pub(crate) const PRESSED_FROM: f32 = 128.0 / 255.0;

/// Ticks for which buttons that have just appeared are not pressed: 300 ms. Who presses so soon meant what was there before.
pub(crate) const UNAIMED_TICKS: u32 = (TICK_RATE * 3).div_ceil(10);

/// What is felt of a button that a hand comes onto, and of one that is pressed, of 255.
const HOVER_TAP: u8 = 70;
const PRESS_TAP: u8 = 170;

/// What points at panels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pointer {
    /// Where its ray begins, in metres of the room.
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
    /// Whether its trigger or button is down.
    pub is_pressed: bool,
    /// A fingertip or the foremost point of a hand, which presses by touch.
    pub fingertip: Option<Vec3>,
}

/// A ray that ends on a panel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct PanelRay {
    /// The panel's place among them.
    pub(crate) panel: usize,
    /// Where it begins, and where it ends on the panel, in metres of the room.
    pub(crate) ends: [Vec3; 2],
}

/// What a pointer was on, and did.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
struct PointerState {
    was_pressed: bool,
    was_touching: bool,
    /// What is held down has pressed a panel: until it is let go it is for nothing else.
    holds_press: bool,
    /// The button under it.
    hot: Option<u16>,
    /// Its ray, where it ends on a panel that has buttons.
    ray: Option<PanelRay>,
    /// What is felt of it in this tick, of 255.
    tap: u8,
}

/// All pointers as of the last tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(crate) struct Pointing {
    states: [PointerState; POINTERS],
    /// Ticks left of [`UNAIMED_TICKS`].
    unaimed_ticks: u32,
}

/// A button of one of the panels that are shown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct ShownButton {
    /// The panel's place among them.
    pub(crate) panel: usize,
    /// Its number is unique among all of them.
    pub(crate) button: PanelButton<'static>,
}

impl Pointer {
    /// A headset's hand: its aim is the ray, its trigger or pinch presses, and so does the touch of its index finger's
    /// tip or, where that isn't known, its foremost point. None where it isn't known where it aims.
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
    /// Takes in where the pointers are in a tick. Returns the button that one of them has pressed just now, unless it has
    /// only just appeared. `is_stone_between` tells that rays through the stone are at work on it, and point at nothing beyond.
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
                // What was held down or touched may be so still when it is seen again: that is no other press.
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

    /// Whether a pointer is on a button, or still holds down what it pressed one with.
    pub(crate) fn is_on_button(&self, pointer: usize) -> bool {
        self.states.get(pointer).is_some_and(|state| state.hot.is_some() || state.holds_press)
    }

    /// The buttons that are pointed at.
    pub(crate) fn hot_buttons(&self) -> [Option<u16>; POINTERS] {
        self.states.map(|state| state.hot)
    }

    /// The rays that end on panels.
    pub(crate) fn rays(&self) -> [Option<PanelRay>; POINTERS] {
        self.states.map(|state| state.ray)
    }

    /// What is felt of a pointer's button in this tick, of 255: a light tap where it comes onto it, and a clear one
    /// where it presses.
    pub(crate) fn tap(&self, pointer: usize) -> u8 {
        self.states.get(pointer).map_or(0, |state| state.tap)
    }

    /// Forgets what is under the pointers: other buttons are shown. What is held down presses none of them, and nothing
    /// does for [`UNAIMED_TICKS`].
    pub(crate) fn forget_buttons(&mut self) {
        self.unaimed_ticks = UNAIMED_TICKS;
        self.states.iter_mut().for_each(|state| {
            (state.hot, state.ray, state.was_touching) = (None, None, true);
        });
    }
}

/// The button of a panel at a point of it.
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

/// The pointer's ray to the panel that it meets first, unless that has no buttons.
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

/// Whether a ray begins at the block, in a hand at work there, or passes through the block.
fn crosses_stone(origin: Vec3, direction: Vec3) -> bool {
    let middle = STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE);
    let from = origin - middle;
    let half = Vec3::splat(0.5 * BOX_SIDE);
    // The slabs of the box: where the ray enters the last one and leaves the first. A ray along a slab divides by zero,
    // which is what the comparison wants.
    let (a, b) = ((-half - from) / direction, (half - from) / direction);
    let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
    from.length() < AT_WORK || leaves >= enters.max(0.0)
}

#[cfg(test)]
mod tests;
