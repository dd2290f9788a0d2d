//! The places of panels: in the room, or in front of a window's eye.

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_shaders::panel::PanelPose;

/// The spot of a panel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PanelSpot {
    /// In front of the visitor.
    Main,
    /// In a room, in front of the visitor. In a window, in its left half, beside the sculpture.
    Beside,
    /// In a room, in front of the visitor. In a window, beside the stone, which is worked on meanwhile.
    Guide,
    /// Beside the stone, out of the way.
    Side,
    /// Beside the stone like [`PanelSpot::Side`], but larger in a window, as it is the only panel.
    Caption,
}

/// Lower edge of panels in front of the visitor, in metres: visible above the stone.
const MAIN_FOOT: f32 = STOOL_TOP.y + BOX_SIDE + 0.05;

/// The z coordinate of these panels in metres, beyond the stone.
const MAIN_DEPTH: f32 = -1.15;

/// Centre of the upper edge of panels beside the stone, on its right. Their lowest button is visible over the
/// stone for the left hand.
const SIDE_HEAD: Vec3 = Vec3::new(0.78, 1.85, -0.9);

/// Lowest and highest eyes that panels face, in metres.
const EYE_HEIGHTS: [f32; 2] = [0.9, 2.1];

/// Distance from a window's eye to its panels in metres: nearer than any stone.
const VIEW_DEPTH: f32 = 0.2;

/// Largest share of a window's picture for a panel in front of the visitor, across and down.
const MAIN_PARTS: [f32; 2] = [0.86, 0.62];

/// The same for a panel beside the sculpture, and the panel's centre from the left.
const BESIDE_PARTS: [f32; 2] = [0.5, 0.84];
const BESIDE_MIDDLE: f32 = 0.27;

/// The same for panels beside the stone, on the left and on the right.
const GUIDE_PARTS: [f32; 2] = [0.36, 0.46];
const SIDE_PARTS: [f32; 2] = [0.26, 0.5];
const CAPTION_PARTS: [f32; 2] = [0.34, 0.5];

/// Margins between these panels and the picture's edges, as shares of its height: at the side, and at the
/// top, below the status.
const SIDE_MARGINS: [f32; 2] = [0.03, 0.075];

/// The view of a window: the eye, and the tangents of the angles to the four sides.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct WindowView {
    /// The position of the eye, in metres of the room.
    pub position: Vec3,
    /// The rotation of the eye, which looks along its -z axis.
    pub rotation: Quat,
    /// The tangent to the left side, mostly negative.
    pub left: f32,
    /// The tangent to the right side.
    pub right: f32,
    /// The tangent to the upper side.
    pub up: f32,
    /// The tangent to the lower side, negative below the centre. A tool bar's area is excluded.
    pub down: f32,
}

/// Returns the pose of a panel in the room, for eyes at the height `eye_height` in metres.
#[must_use]
pub fn room_pose(spot: PanelSpot, [_, height_mm]: [f32; 2], eye_height: f32) -> PanelPose {
    let half = 0.5e-3 * height_mm;
    let middle = match spot {
        PanelSpot::Main | PanelSpot::Beside | PanelSpot::Guide => {
            Vec3::new(0.0, MAIN_FOOT + half, MAIN_DEPTH)
        }
        PanelSpot::Side | PanelSpot::Caption => SIDE_HEAD - Vec3::Y * half,
    };
    PanelPose::facing(middle, Vec3::Y * eye_height.clamp(EYE_HEIGHTS[0], EYE_HEIGHTS[1]))
}

impl WindowView {
    /// Returns the pose of a panel of this size in front of the eye.
    #[must_use]
    pub fn panel_pose(&self, spot: PanelSpot, [width_mm, height_mm]: [f32; 2]) -> PanelPose {
        let (wide, high) = (self.right - self.left, self.up - self.down);
        let [across, down] = match spot {
            PanelSpot::Main => MAIN_PARTS,
            PanelSpot::Beside => BESIDE_PARTS,
            PanelSpot::Guide => GUIDE_PARTS,
            PanelSpot::Side => SIDE_PARTS,
            PanelSpot::Caption => CAPTION_PARTS,
        };
        // Size of a millimetre as a tangent.
        let fits = (wide * across / width_mm).min(high * down / height_mm);
        let at = match spot {
            PanelSpot::Main => [0.5 * (self.left + self.right), 0.5 * (self.up + self.down)],
            PanelSpot::Beside => [self.left + BESIDE_MIDDLE * wide, 0.5 * (self.up + self.down)],
            PanelSpot::Guide | PanelSpot::Side | PanelSpot::Caption => {
                let [aside, above] = SIDE_MARGINS.map(|margin| margin * high);
                let half = aside + 0.5 * fits * width_mm;
                let across = match spot {
                    PanelSpot::Guide => self.left + half,
                    _ => self.right - half,
                };
                [across, self.up - above - 0.5 * fits * height_mm]
            }
        };
        let ahead = Vec3::new(at[0], at[1], -1.0) * VIEW_DEPTH;
        PanelPose {
            middle: self.position + self.rotation * ahead,
            rotation: self.rotation,
            scale: 1e3 * fits * VIEW_DEPTH,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [PanelSpot; 5] =
        [PanelSpot::Main, PanelSpot::Beside, PanelSpot::Guide, PanelSpot::Side, PanelSpot::Caption];

    /// From seated children to tall people: panels in front of the visitor are visible above the stone.
    #[test]
    fn the_stone_hides_nothing_before_a_visitor() {
        for eye_height in [1.1, 1.25, 1.45, 1.6, 1.8] {
            for height_mm in [450.0, 720.0, 950.0] {
                let pose = room_pose(PanelSpot::Main, [1000.0, height_mm], eye_height);
                let eye = Vec3::Y * eye_height;
                let foot = pose.middle - pose.rotation * Vec3::Y * (0.5e-3 * height_mm);
                // The share of the line of sight to the panel's foot at which it passes the stone's far edge.
                let part = (STOOL_TOP.z - 0.5 * BOX_SIDE) / foot.z;
                let above = eye.y + (foot.y - eye.y) * part;
                assert!(above > STOOL_TOP.y + BOX_SIDE - 0.06, "{eye_height} {height_mm}: {above}");
                let distance = pose.middle.distance(eye);
                assert!((1.1..1.5).contains(&distance), "{distance}");
            }
        }
    }

    /// A panel about a sculpture leaves it the right half of the picture, to which the window has moved it.
    #[test]
    fn a_panel_beside_the_sculpture_leaves_it_half_of_a_window() {
        for [width, height] in [[640.0, 420.0], [1280.0, 800.0], [800.0, 600.0]] {
            let up = 0.376;
            let wide = 2.0 * up * width / height;
            let (left, right) = (-0.75 * wide, 0.25 * wide);
            let (position, rotation) = (Vec3::ZERO, Quat::IDENTITY);
            let view = WindowView { position, rotation, left, right, up, down: -up };
            for size in [[1000.0, 500.0], [1000.0, 650.0], [1000.0, 936.0]] {
                let pose = view.panel_pose(PanelSpot::Beside, size);
                let half = 0.5e-3 * pose.scale * size[0];
                let [from, to] =
                    [pose.middle.x - half, pose.middle.x + half].map(|x| x / VIEW_DEPTH);
                let parts = [from, to].map(|x| (x - left) / wide);
                assert!(parts[0] > 0.0 && parts[1] < 0.53, "{size:?}: {parts:?}");
                assert!(parts[1] - parts[0] > 0.33, "{size:?} is small: {parts:?}");
            }
        }
    }

    #[test]
    fn a_window_holds_panels_within_its_picture() {
        for [left, right, up, down] in [
            [-0.6, 0.6, 0.38, -0.4],
            [-0.3, 0.3, 0.38, -0.2],
            [-1.2, 1.2, 0.38, -0.38],
            [-0.9, 0.3, 0.38, -0.38],
        ] {
            let rotation = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(-0.3);
            let position = Vec3::new(0.3, 1.4, 0.2);
            let view = WindowView { position, rotation, left, right, up, down };
            for size in [[1080.0, 720.0], [560.0, 640.0], [1358.0, 900.0]] {
                for spot in ALL {
                    let pose = view.panel_pose(spot, size);
                    for corner in [[-0.5, -0.5], [0.5, 0.5]] {
                        let at = Vec3::new(corner[0] * size[0], corner[1] * size[1], 0.0) * 1e-3;
                        let at = pose.middle + pose.rotation * at * pose.scale - view.position;
                        let seen = rotation.inverse() * at;
                        let (x, y) = (seen.x / -seen.z, seen.y / -seen.z);
                        assert!(
                            x > left && x < right && y < up && y > down,
                            "{spot:?} {size:?}: {x} {y}"
                        );
                    }
                }
            }
        }
    }
}
