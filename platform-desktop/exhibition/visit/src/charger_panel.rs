//! The panel in the room that warns if the battery drains while the headset is charged.

use glam::Vec3;
use paros_shaders::panel::layout::{PanelNotice, draw_notice, palette};
use paros_shaders::panel::{FillingValue, Icon, Language, Message, Panel, PanelPose};
use paros_shell::headset::device_health::DeviceHealth;

/// The centre of the panel, in the room: far to the left, away from the sculptor and all panels of a visit.
const MIDDLE: Vec3 = Vec3::new(-1.0, 1.4, -0.7);

/// The eyes that the panel faces: those of a visitor in front of the stool.
const EYES: Vec3 = Vec3::new(0.0, 1.45, 0.0);

/// The warning panel in a headset's room. It is laid out again whenever the percentage changes.
#[derive(Debug)]
pub struct ChargerPanel {
    panel: Panel,
    /// The shown percentage; `None` while the panel is hidden.
    percent: Option<u8>,
}

impl ChargerPanel {
    /// Applies the device's health: shows the warning as long as the charger is too weak.
    pub fn follow_health(&mut self, health: &DeviceHealth) {
        let percent = health.battery_percent.filter(|_| health.drains_on_charger);
        if let Some(percent) = percent.filter(|_| self.percent != percent) {
            let notice = PanelNotice {
                icon: Icon::Battery,
                color: palette::AMBER,
                title: Message::ChargerTitle,
                body: Message::ChargerBody,
                fillings: &[("percent", FillingValue::Number(percent.into()))],
                progress: None,
            };
            draw_notice(&mut self.panel, Language::English, &notice, &[]);
        }
        self.percent = percent;
    }

    /// Returns the panels to draw: the warning, or nothing.
    #[must_use]
    pub fn panels(&self) -> &[Panel] {
        match self.percent {
            Some(_) => core::slice::from_ref(&self.panel),
            None => &[],
        }
    }
}

/// Starts hidden.
impl Default for ChargerPanel {
    fn default() -> Self {
        let mut panel = Panel::new([0.0; 2]);
        panel.pose = PanelPose::facing(MIDDLE, EYES);
        ChargerPanel { panel, percent: None }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use paros_shaders::panel::Panel;
    use paros_shell::headset::device_health::{Battery, DeviceHealth, ThermalState};

    use super::{ChargerPanel, EYES, MIDDLE};
    use crate::{PanelSpot, room_pose};

    const WEAK: DeviceHealth = DeviceHealth {
        thermal: ThermalState::Normal,
        battery_percent: Some(40),
        drains_on_charger: true,
        battery: Battery { percent: Some(40), charging: true },
    };

    /// Returns the bearings of a panel's left and right side, in degrees to the right of straight ahead.
    fn bearings(panel: &Panel, eyes: Vec3) -> [f32; 2] {
        [-0.5, 0.5].map(|side| {
            let aside = Vec3::X * (side * panel.size_mm()[0] * 1e-3);
            let at = panel.pose.middle + panel.pose.rotation * aside - eyes;
            at.x.atan2(-at.z).to_degrees()
        })
    }

    /// Holds wherever a visitor's head is, up to a step aside. The choice's panel is the widest.
    #[test]
    fn it_stands_beside_the_widest_panel_of_a_visit() {
        let mut charger = ChargerPanel::default();
        charger.follow_health(&WEAK);
        let mut main = Panel::new([1358.0, 900.0]);
        main.pose = room_pose(PanelSpot::Main, main.size_mm(), 1.5);
        for aside in [-0.2, 0.0, 0.2] {
            let eyes = EYES + Vec3::X * aside;
            let [own, others] = [&charger.panels()[0], &main].map(|panel| bearings(panel, eyes));
            assert!(own[0] < own[1] && own[1] < others[0], "{own:?}, {others:?} at {aside}");
            assert!(own[0] > -90.0, "it is behind the visitor: {own:?}");
        }
    }

    #[test]
    fn a_weak_charger_is_told_with_each_percent_until_it_is_changed() {
        let weak = |percent| DeviceHealth { battery_percent: Some(percent), ..WEAK };
        let mut charger = ChargerPanel::default();
        assert!(charger.panels().is_empty());
        charger.follow_health(&weak(41));
        let first = charger.panels()[0].quads().to_vec();
        charger.follow_health(&weak(41));
        assert!(charger.panels()[0].quads() == first);
        charger.follow_health(&weak(40));
        assert!(charger.panels()[0].quads() != first, "another percent");
        let fine = DeviceHealth { drains_on_charger: false, ..weak(40) };
        charger.follow_health(&fine);
        assert!(charger.panels().is_empty());
        charger.follow_health(&weak(40));
        assert_eq!(charger.panels().len(), 1);
        // The text is as large as all text in the room.
        let degrees = charger.panels()[0].least_text_degrees(MIDDLE.distance(EYES));
        assert!(degrees.is_some_and(|degrees| degrees >= 1.0), "{degrees:?}");
    }
}
