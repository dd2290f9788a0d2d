//! Panels on a GPU against their CPU twin, and their cost.

use glam::{Quat, Vec3};
use paros_core::badge::BadgeNumber;
use paros_shaders::gpu::{Eye, Fov, FrameRequest, RenderStyle, SculpturePlacement, programs};
use paros_shaders::limits::{PANEL_CELL_TEXELS, PANEL_CELLS};
use paros_shaders::panel::{
    ButtonState, Language, Message, Panel, PanelPictures, PanelPose, PanelRect, layout,
};
use paros_shaders::scene::{resting_placement, resting_studio};
use paros_shaders::upload::VolumeFormat;
use paros_shaders::{Image, render_panels, render_panels_with_pictures};
use paros_tests_vulkan::count_differing;
use paros_tests_vulkan::test_renderer::{TestRenderer, test_device};

const SIZE: [u32; 2] = [640, 480];
const BACKDROP: Vec3 = Vec3::new(0.2, 0.25, 0.3);

/// Returns an eye at a place, looking along -z.
fn eye_at(x: f32) -> Eye {
    let fov = Fov { left: -0.5, right: 0.55, up: 0.4, down: -0.42 };
    Eye { position: Vec3::new(x, 1.5, 0.0), rotation: Quat::IDENTITY, fov }
}

/// Returns oblique panels, one partly over another: a badge, buttons with icons, and a clock with a ring.
fn panels() -> Vec<Panel> {
    let badge = BadgeNumber::new(1 << 18 | 4242).expect("a number").badge();
    let mut buttons = layout::welcome_buttons(0, 3);
    buttons[3].state = ButtonState::Hot;
    let mut all = [Panel::default(), Panel::default(), Panel::default()];
    layout::draw_badge(&mut all[0], Language::English, (&badge, Message::BadgeBody), &[]);
    layout::draw_welcome(&mut all[1], Language::Greek, 3, &buttons);
    let warning = Some(Message::WarningTenSeconds);
    let clock = layout::Clock { seconds: Some([70, 300]), warning };
    layout::draw_clock(&mut all[2], Language::English, &clock, &[]);
    let places =
        [Vec3::new(-0.5, 1.45, -1.4), Vec3::new(0.55, 1.6, -1.5), Vec3::new(0.0, 1.15, -0.9)];
    for (panel, place) in all.iter_mut().zip(places) {
        panel.pose = PanelPose::facing(place, Vec3::new(0.3, 1.9, 0.4));
    }
    all.into()
}

fn request<'a>(eyes: &'a [Eye], panels: &'a [&'a [Panel]]) -> FrameRequest<'a> {
    FrameRequest {
        eyes,
        // Behind the eye.
        placement: SculpturePlacement { foot: Vec3::Z * 5.0, side: 0.3, turn_radians: 0.0 },
        style: RenderStyle::default(),
        scene: None,
        panels,
        backdrop: BACKDROP.to_array(),
    }
}

#[test]
fn the_gpu_draws_panels_as_its_twin_does() {
    let Some(gpu) = test_device() else { return };
    let eyes = [eye_at(-0.03), eye_at(0.03)];
    let panels = panels();
    // Grouped as in the shells: a visit's panels, and a notice.
    let (first, rest) = panels.split_at(2);
    let twins = eyes.map(|eye| {
        let size = SIZE.map(|side| side as usize);
        let image = render_panels(&panels, &eye, size, 1, BACKDROP);
        let pixels = image.pixels.as_chunks::<3>().0;
        pixels.iter().map(|&[r, g, b]| [r, g, b, 255]).collect::<Vec<[u8; 4]>>()
    });
    for (samples, views) in [(1, 1), (1, 2), (4, 2)] {
        let mut drawing =
            TestRenderer::new(&gpu, VolumeFormat::of::<128, 2>(), [samples, views], SIZE);
        let layers = drawing.draw_picture(&request(&eyes[..views as usize], &[first, rest]));
        for (layer, twin) in layers.iter().zip(&twins) {
            let differing = count_differing(layer, twin);
            let bare = twin.iter().filter(|pixel| **pixel == twin[0]).count();
            assert!(bare < twin.len() / 2, "panels fill the picture: {bare} pixels are bare");
            // A texel's fraction has 8 bits on a GPU, and two neighbouring pixels share a derivative.
            assert!(
                differing <= 200,
                "{samples} samples, {views} views: {differing} pixels differ"
            );
            let apart = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|i| a[i].abs_diff(b[i])).max();
            let most = layer.iter().zip(twin).filter_map(apart).max();
            assert!(most < Some(64), "{samples} samples, {views} views: {most:?} apart");
        }
        let without = drawing.draw_picture(&request(&eyes[..views as usize], &[]));
        let first = without[0][0];
        assert!(without[0].iter().all(|pixel| *pixel == first), "nothing is left of them");
    }
}

/// Returns a picture for a cell: shades that differ by cell, and a dark corner, so that rotated or exchanged
/// pictures are detected.
fn picture_of_cell(cell: u8) -> Image {
    let side = PANEL_CELL_TEXELS;
    let mut picture = Image::filled(side, side, [30 * cell, 0, 0]);
    for (at, pixel) in picture.pixels.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let (x, y) = (at % side, at / side);
        if x + y > side / 3 {
            (pixel[1], pixel[2]) = (x as u8, y as u8);
        }
    }
    picture
}

/// Returns an oblique panel with every cell's picture, in two rows, with round corners.
fn panel_of_cells() -> Panel {
    let mut panel = Panel::new([1000.0, 500.0]);
    panel.add_box(panel.rect(), &paros_shaders::panel::BoxStyle::default());
    for cell in 0..PANEL_CELLS as u8 {
        let (column, row) = (f32::from(cell % 4), f32::from(cell / 4));
        let rect = PanelRect::new(250.0 * column, 250.0 * row, 250.0, 250.0).grown(-10.0);
        panel.add_image(cell, rect, 30.0);
    }
    panel.pose = PanelPose::facing(Vec3::new(0.0, 1.5, -1.1), Vec3::new(0.3, 1.9, 0.4));
    panel
}

#[test]
fn the_gpu_draws_the_pictures_of_cells_as_its_twin_does() {
    let Some(gpu) = test_device() else { return };
    let eyes = [eye_at(-0.03), eye_at(0.03)];
    let panels = [panel_of_cells()];
    // One cell has no picture, and one is set twice.
    let cells = [6, 0, 1, 2, 3, 4, 7];
    let mut pictures = PanelPictures::default();
    let size = SIZE.map(|side| side as usize);
    let twin = |pictures: &PanelPictures, eye| {
        let image = render_panels_with_pictures(&panels, pictures, eye, size, 1, BACKDROP);
        let pixels = image.pixels.as_chunks::<3>().0;
        pixels.iter().map(|&[r, g, b]| [r, g, b, 255]).collect::<Vec<[u8; 4]>>()
    };
    let bare = twin(&pictures, &eyes[0]);
    assert!(cells.into_iter().all(|cell| pictures.set(cell, &picture_of_cell(cell))));
    let twins = eyes.each_ref().map(|eye| twin(&pictures, eye));
    assert!(count_differing(&bare, &twins[0]) > 50_000, "pictures fill the panel");
    for (samples, views) in [(1, 1), (1, 2), (4, 2)] {
        let mut drawing =
            TestRenderer::new(&gpu, VolumeFormat::of::<128, 2>(), [samples, views], SIZE);
        let eyes = &eyes[..views as usize];
        let before = drawing.draw_picture(&request(eyes, &[&panels]));
        assert!(count_differing(&before[0], &bare) <= 100, "nothing has been set");
        let another = Image::filled(PANEL_CELL_TEXELS, PANEL_CELL_TEXELS, [255; 3]);
        assert!(drawing.renderer.set_panel_picture(6, &another));
        let layers = drawing.draw_picture(&request(eyes, &[&panels]));
        assert!(count_differing(&layers[0], &before[0]) > 5000, "it is seen in the next frame");
        for cell in cells {
            assert!(drawing.renderer.set_panel_picture(cell, &picture_of_cell(cell)));
        }
        assert!(!drawing.renderer.set_panel_picture(PANEL_CELLS as u8, &another), "no cell");
        assert!(!drawing.renderer.set_panel_picture(0, &Image::filled(9, 9, [0; 3])), "too small");
        // A frame uploads one picture.
        for _ in 1..cells.len() {
            let layers = drawing.draw_picture(&request(eyes, &[&panels]));
            assert!(count_differing(&layers[0], &twins[0]) > 3000, "a frame uploads one");
        }
        let layers = drawing.draw_picture(&request(eyes, &[&panels]));
        for (layer, twin) in layers.iter().zip(&twins) {
            let differing = count_differing(layer, twin);
            assert!(differing <= 200, "{samples} samples, {views} views: {differing} differ");
        }
        // A picture that changes in every frame doesn't starve the others.
        assert!(drawing.renderer.set_panel_picture(7, &another));
        let turns = [0, 0].map(|cell| {
            assert!(drawing.renderer.set_panel_picture(cell, &picture_of_cell(cell)));
            count_differing(&drawing.draw_picture(&request(eyes, &[&panels]))[0], &twins[0])
        });
        assert!(turns[1] > 3000, "{turns:?}: the seventh had no turn");
    }
}

/// An object before a panel hides it, and a panel hides objects behind it.
#[test]
fn panels_are_tested_against_the_room() {
    let Some(gpu) = test_device() else { return };
    let mut drawing = TestRenderer::new(&gpu, VolumeFormat::of::<128, 2>(), [1, 1], SIZE);
    let scene = resting_studio();
    let eyes = [Eye { position: Vec3::new(0.0, 1.5, 0.9), ..eye_at(0.0) }];
    let mut picture = |panels: &[Panel]| {
        let panels = [panels];
        let lit = FrameRequest {
            placement: resting_placement(),
            scene: Some(&scene),
            ..request(&eyes, &panels)
        };
        drawing.draw_picture(&lit).remove(0)
    };
    let mut panel = panels().remove(0);
    panel.pose = PanelPose { middle: Vec3::new(0.0, 1.5, 0.0), ..PanelPose::default() };
    let bare = picture(&[]);
    let before = picture(std::slice::from_ref(&panel));
    assert!(count_differing(&bare, &before) > 20_000, "a panel before the room is seen");
    panel.pose.middle.z = -30.0;
    assert_eq!(count_differing(&bare, &picture(std::slice::from_ref(&panel))), 0, "behind a wall");
    panel.pose.middle.z = 0.0;
    panel.pose.rotation = Quat::from_rotation_y(3.1);
    assert_eq!(count_differing(&bare, &picture(&[panel])), 0, "from behind");
}

/// A pixel of a quad fetches at most one texel: the program samples shapes and pictures, each in its own
/// function that is called only for quads of its kind, and it has no loop.
#[test]
fn a_pixel_of_a_quad_fetches_one_texel_at_most() {
    const OP_FUNCTION: u32 = 54;
    const OP_IMAGE_SAMPLE_IMPLICIT: u32 = 87;
    const OP_IMAGE_FETCH: u32 = 95;
    const OP_LOOP_MERGE: u32 = 246;
    let words = programs::PANEL.words();
    let (mut at, mut fetches, mut loops) = (5, Vec::new(), 0);
    while at < words.len() {
        let code = words[at] & 0xffff;
        if code == OP_FUNCTION {
            fetches.push(0);
        }
        if (OP_IMAGE_SAMPLE_IMPLICIT..=OP_IMAGE_FETCH + 2).contains(&code) {
            *fetches.last_mut().expect("a function") += 1;
        }
        loops += u32::from(code == OP_LOOP_MERGE);
        at += (words[at] >> 16) as usize;
    }
    fetches.retain(|count| *count > 0);
    assert_eq!((fetches, loops), (vec![1, 1], 0));
}
