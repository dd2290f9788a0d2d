//! Rays of hands: a beam to the panel, and a dot on it. Both are separate panels, as they lie anywhere.

use glam::{Mat3, Quat, Vec2, Vec3};
use paros_shaders::panel::{BoxStyle, Panel, PanelColor, PanelPose};

use super::Screen;
use crate::pointing::{POINTERS, PanelRay};

/// Number of drawn rays: those of both hands. A cursor has its arrow instead.
pub(super) const RAYS: usize = 2;

/// Distance from the hand at which a beam begins, in metres: beyond its tool and fingers.
const CLEAR: f32 = 0.12;

/// The width of a beam in millimetres.
const WIDTH_MM: f32 = 5.0;

/// The dot's side and rim in millimetres, and its distance before the panel in metres. The rim makes it
/// visible on light grounds.
const DOT_MM: f32 = 22.0;
const RIM_MM: f32 = 4.0;
const DOT_HEIGHT: f32 = 0.002;

/// The colours of a dot and its rim, and of a translucent beam.
const LIGHT: PanelColor = [255, 246, 224, 255];
const DARK: PanelColor = [52, 40, 30, 255];
const BEAM: PanelColor = [255, 246, 224, 120];

impl Screen {
    /// Lays out the rays of hands, facing eyes at a place.
    pub(crate) fn draw_rays(&mut self, rays: &[Option<PanelRay>; POINTERS], eyes: Vec3) {
        self.ray_panels = 0;
        for ray in rays.iter().take(RAYS).flatten() {
            if ray.panel >= self.count {
                continue;
            }
            let rotation = self.panels[ray.panel].pose.rotation;
            if let Some((pose, length_mm)) = beam_pose(ray.ends, eyes) {
                let beam = self.next_panel([length_mm, WIDTH_MM]);
                beam.pose = pose;
                let softness_mm = 0.4 * WIDTH_MM;
                let style = BoxStyle { fill: BEAM, softness_mm, ..BoxStyle::default() };
                beam.add_box(beam.rect(), &style);
            }
            let dot = self.next_panel([DOT_MM; 2]);
            let middle = ray.ends[1] + rotation * Vec3::Z * DOT_HEIGHT;
            dot.pose = PanelPose { middle, rotation, scale: 1.0 };
            let (rect, radius_mm) = (dot.rect(), 0.5 * DOT_MM);
            let style = BoxStyle { radius_mm, fill: DARK, ..BoxStyle::default() };
            dot.add_box(rect, &style);
            dot.add_box(rect.grown(-RIM_MM), &BoxStyle { fill: LIGHT, ..style });
        }
    }

    /// Returns the next panel of the rays, emptied.
    fn next_panel(&mut self, size_mm: [f32; 2]) -> &mut Panel {
        let panel = &mut self.panels[self.count + self.ray_panels];
        self.ray_panels += 1;
        panel.clear(size_mm);
        panel
    }
}

/// Returns the pose and the length in millimetres of a beam. Its x axis goes from the hand to the panel, and
/// it faces the eyes. Returns `None` for a beam that is too short, or seen end-on.
fn beam_pose([from, to]: [Vec3; 2], eyes: Vec3) -> Option<(PanelPose, f32)> {
    let length = from.distance(to) - CLEAR;
    let along = (to - from).try_normalize().filter(|_| length > 0.0)?;
    let middle = to - along * (0.5 * length);
    let face = (eyes - middle).reject_from_normalized(along).try_normalize()?;
    let rotation = Quat::from_mat3(&Mat3::from_cols(along, face.cross(along), face));
    Some((PanelPose { middle, rotation, scale: 1.0 }, 1e3 * length))
}

/// Returns the place in the room of a point on a panel, given in millimetres from its upper left corner.
pub(crate) fn point_in_room(panel: &Panel, at_mm: Vec2) -> Vec3 {
    let from_middle = (at_mm - 0.5 * Vec2::from_array(panel.size_mm())) * 1e-3 * panel.pose.scale;
    panel.pose.middle + panel.pose.rotation * Vec3::new(from_middle.x, -from_middle.y, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beam_goes_from_the_hand_to_the_panel_and_faces_the_eyes() {
        let ends = [Vec3::new(0.3, 1.1, -0.2), Vec3::new(0.1, 1.7, -1.1)];
        let eyes = Vec3::new(0.0, 1.6, 0.0);
        let (pose, length_mm) = beam_pose(ends, eyes).expect("a beam");
        let half = pose.rotation * Vec3::X * (0.5e-3 * length_mm);
        let along = (ends[1] - ends[0]).normalize();
        assert!((pose.middle + half).distance(ends[1]) < 1e-5);
        assert!((pose.middle - half).distance(ends[0] + along * CLEAR) < 1e-5);
        assert!((pose.rotation * Vec3::Z).dot(eyes - pose.middle) > 0.0, "a panel has one face");
        assert!((pose.rotation * Vec3::Y).dot(eyes - pose.middle).abs() < 1e-5);
        assert_eq!(beam_pose([ends[0], ends[0] + Vec3::Z * 0.1], eyes), None);
        assert_eq!(beam_pose([Vec3::splat(f32::NAN), ends[1]], eyes), None);
        let [near, far] = [0.5, 2.0].map(|metres| eyes + Vec3::NEG_Z * metres);
        assert_eq!(beam_pose([near, far], eyes), None, "end-on");
    }

    #[test]
    fn a_hand_that_points_at_a_panel_has_a_beam_and_a_dot_and_a_cursor_has_none() {
        let mut screen = Screen::new();
        screen.count = 1;
        screen.panels[0] = Panel::new([900.0, 600.0]);
        screen.panels[0].pose = PanelPose::facing(Vec3::new(0.0, 1.6, -1.1), Vec3::Y * 1.6);
        let end = point_in_room(&screen.panels[0], Vec2::new(100.0, 50.0));
        let ray = Some(PanelRay { panel: 0, ends: [Vec3::new(0.3, 1.1, 0.0), end] });
        screen.draw_rays(&[None, ray, ray], Vec3::Y * 1.6);
        assert_eq!((screen.panels().len(), screen.drawn_panels().len()), (1, 3));
        let dot = &screen.drawn_panels()[2];
        assert!(dot.pose.middle.distance(end) < 0.003 && dot.size_mm() == [DOT_MM; 2]);
        assert_eq!(
            screen.panels[0].project_point(dot.pose.middle).at_mm.round(),
            [100.0, 50.0].into()
        );
        screen.draw_rays(&[ray, ray, None], Vec3::Y * 1.6);
        assert_eq!(screen.drawn_panels().len(), 5);
        screen.draw_rays(&[None; POINTERS], Vec3::Y * 1.6);
        assert_eq!(screen.drawn_panels().len(), 1);
    }
}
