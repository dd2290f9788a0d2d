//! A shell's pictures on panels, one for each cell: the CPU twin reads them here, the device has a copy.

use glam::{Vec2, Vec3};

use super::quad::{QuadColor, linear_color};
use crate::Image;
use crate::limits::{PANEL_CELL_TEXELS, PANEL_CELLS};

/// The pictures of the cells that have one.
#[derive(Clone, Default, Debug)]
pub struct PanelPictures {
    cells: [Option<Image>; PANEL_CELLS],
}

impl PanelPictures {
    /// All cells without a picture.
    pub const EMPTY: Self = PanelPictures { cells: [const { None }; PANEL_CELLS] };

    /// Sets a cell's picture. Returns `false`, without effect, if there is no such cell or the picture
    /// isn't [`PANEL_CELL_TEXELS`] wide and high.
    pub fn set(&mut self, cell: u8, picture: &Image) -> bool {
        let fits = is_cell_picture(cell, picture);
        if fits {
            self.cells[usize::from(cell)] = Some(picture.clone());
        }
        fits
    }

    /// Returns the bilinearly interpolated colour at a place of a cell's picture, 0 to 1 from its upper
    /// left corner; transparent if the cell has no picture.
    pub(crate) fn color_at(&self, cell: f32, place: Vec2) -> QuadColor {
        // A negative number or NaN selects the first cell; no panel has either.
        let Some(Some(picture)) = self.cells.get(cell as usize) else {
            return QuadColor { rgb: Vec3::ZERO, alpha: 0.0 };
        };
        let last = PANEL_CELL_TEXELS as i32 - 1;
        let texels = place * PANEL_CELL_TEXELS as f32 - Vec2::splat(0.5);
        let (x, y) = (texels.x.floor(), texels.y.floor());
        let texel = |i: i32, j: i32| {
            let at = |from: f32, by: i32| (from as i32 + by).clamp(0, last) as usize;
            let [r, g, b] = picture.pixel(at(x, i), at(y, j));
            linear_color([r, g, b, 255]).rgb
        };
        let row = |j| texel(0, j).lerp(texel(1, j), texels.x - x);
        QuadColor { rgb: row(0).lerp(row(1), texels.y - y), alpha: 1.0 }
    }
}

/// Returns `true` if there is such a cell, and the picture has a cell's size.
pub(crate) const fn is_cell_picture(cell: u8, picture: &Image) -> bool {
    (cell as usize) < PANEL_CELLS
        && picture.width == PANEL_CELL_TEXELS
        && picture.height == PANEL_CELL_TEXELS
        && picture.pixels.len() == 3 * PANEL_CELL_TEXELS * PANEL_CELL_TEXELS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_takes_a_picture_of_its_size() {
        let picture = |width, height| Image::filled(width, height, [200, 100, 50]);
        let mut pictures = PanelPictures::default();
        assert!(!pictures.set(0, &picture(PANEL_CELL_TEXELS, 10)));
        assert!(!pictures.set(0, &picture(10, PANEL_CELL_TEXELS)));
        let right = picture(PANEL_CELL_TEXELS, PANEL_CELL_TEXELS);
        assert!(!pictures.set(PANEL_CELLS as u8, &right));
        assert!(!pictures.set(255, &right));
        let alpha =
            |pictures: &PanelPictures, cell| pictures.color_at(cell, Vec2::splat(0.5)).alpha;
        assert!((0..PANEL_CELLS + 2).all(|cell| alpha(&pictures, cell as f32) == 0.0));
        assert!(pictures.set(5, &right));
        let seen: Vec<_> = (0..PANEL_CELLS + 2).map(|cell| alpha(&pictures, cell as f32)).collect();
        assert_eq!(seen, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
