//! The panels' colours: plaster, sand and clay, as a sculptor's studio has them.

use crate::panel::model::PanelColor;

/// A panel's ground: plaster.
pub const GROUND: PanelColor = [0xf5, 0xf0, 0xe6, 0xff];
/// Text and pictures on clay, and a selected button's ground.
pub const PLASTER: PanelColor = [0xff, 0xfb, 0xf4, 0xff];
/// A button's ground.
pub const SAND: PanelColor = [0xe9, 0xdf, 0xce, 0xff];
/// A button's ground, pointed at.
pub const SAND_LIGHT: PanelColor = [0xf6, 0xe3, 0xc6, 0xff];
/// Outlines, and the track of a progress bar.
pub const LINE: PanelColor = [0xcf, 0xc1, 0xaa, 0xff];
/// Letters.
pub const INK: PanelColor = [0x2e, 0x26, 0x20, 0xff];
/// Letters of secondary texts.
pub const SOFT_INK: PanelColor = [0x63, 0x56, 0x4a, 0xff];
/// Letters of a disabled button.
pub const FAINT: PanelColor = [0xa5, 0x98, 0x88, 0xff];
/// A primary button's ground.
pub const CLAY: PanelColor = [0xac, 0x4f, 0x33, 0xff];
/// A primary button's ground, pointed at.
pub const CLAY_LIGHT: PanelColor = [0xc2, 0x66, 0x48, 0xff];
/// A button's ground, pressed.
pub const CLAY_DARK: PanelColor = [0x86, 0x3a, 0x24, 0xff];
/// Success, or a selection.
pub const OLIVE: PanelColor = [0x66, 0x77, 0x3c, 0xff];
/// A warning, or little time left.
pub const AMBER: PanelColor = [0xb8, 0x70, 0x14, 0xff];
/// An error, or almost no time left.
pub const RED: PanelColor = [0xa8, 0x2c, 0x24, 0xff];
/// A panel's shadow.
pub const SHADOW: PanelColor = [0x20, 0x16, 0x0c, 0x78];
