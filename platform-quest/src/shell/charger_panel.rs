//! The warning in the room that the battery falls though the headset is charged.

use glam::Vec3;
use paros_shaders::panel::layout::{PanelNotice, draw_notice, palette};
use paros_shaders::panel::{FillingValue, Icon, Language, Message, Panel, PanelPose};
use paros_shell::headset::device_health::DeviceHealth;

/// The middle of the panel, in the room: left of the stone and beyond it, out of a sculptor's way.
const MIDDLE: Vec3 = Vec3::new(-0.72, 1.4, -0.93);

/// The eyes that it is turned to: those of a visitor before the stool.
const EYES: Vec3 = Vec3::new(0.0, 1.45, 0.0);

/// The panel, laid out anew with each percent that goes.
#[derive(Debug)]
pub(super) struct ChargerPanel {
    panel: Panel,
    /// What it shows, if it is shown.
    percent: Option<u8>,
}

impl ChargerPanel {
    /// Not shown.
    pub(super) fn new() -> Self {
        let mut panel = Panel::new([0.0; 2]);
        panel.pose = PanelPose::facing(MIDDLE, EYES);
        ChargerPanel { panel, percent: None }
    }

    /// Takes in the device's health: a charger that is too weak is told until it no longer is.
    pub(super) fn follow_health(&mut self, health: &DeviceHealth) {
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

    /// What is to be drawn of it.
    pub(super) fn panels(&self) -> &[Panel] {
        match self.percent {
            Some(_) => core::slice::from_ref(&self.panel),
            None => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_shell::headset::device_health::{DeviceHealth, ThermalState};

    use super::{ChargerPanel, EYES, MIDDLE};

    #[test]
    fn a_weak_charger_is_told_with_each_percent_until_it_is_changed() {
        let weak = |percent| DeviceHealth {
            thermal: ThermalState::Normal,
            battery_percent: Some(percent),
            drains_on_charger: true,
        };
        let mut charger = ChargerPanel::new();
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
        // As large as all text in the room.
        let degrees = charger.panels()[0].least_text_degrees(MIDDLE.distance(EYES));
        assert!(degrees.is_some_and(|degrees| degrees >= 1.0), "{degrees:?}");
    }
}
