//! The panels' screens in both languages, as the CPU twin draws them: compared with golden pictures, and
//! checked against the rules of every screen. `PAROS_GOLDEN=write cargo test -p paros-tests-render --test
//! main panels` writes the pictures.

use std::fs::{self, File};
use std::path::PathBuf;

use glam::{Quat, Vec2, Vec3};
use paros_core::RangeMaps;
use paros_core::badge::{BadgeColour, POINT_STEPS, Pictogram, covers_point};
use paros_models::twin::with_maps_of_ball;
use paros_shaders::constants::{PANEL_BOX, PANEL_IMAGE, PANEL_SHAPE};
use paros_shaders::gpu::{Eye, Fov};
use paros_shaders::limits::PANEL_CELL_TEXELS;
use paros_shaders::panel::button::ButtonLabel;
use paros_shaders::panel::layout::{self, READING_DISTANCE, palette};
use paros_shaders::panel::{
    BoxStyle, FontWeight, Icon, Language, Message, Panel, PanelButton, PanelColor, PanelPictures,
    PanelQuad, PanelRect, TextAlign, TextPlace, TextStyle, line_width,
};
use paros_shaders::{Camera, Image, RenderOptions, contact_sheet, lit_studio};
use paros_shaders::{
    render_image_in_room, render_image_with_panels, render_panel_flat, render_panels,
    render_panels_with_pictures,
};
use paros_tests_render::screens::{all_screens, pictures_of_cells};

const AGAIN: &str =
    "write it: PAROS_GOLDEN=write cargo test -p paros-tests-render --test main panels";

/// Returns a picture of a panel before a grey wall, at a resolution in pixels a millimetre.
fn picture_of(panel: &Panel, pixels_per_mm: f32) -> Image {
    let [width, height] = panel.size_mm().map(|mm| mm + 60.0);
    let half = |mm: f32| (0.5e-3 * mm / READING_DISTANCE).atan();
    let fov = Fov { left: -half(width), right: half(width), up: half(height), down: -half(height) };
    let eye = Eye { position: Vec3::Z * READING_DISTANCE, rotation: Quat::IDENTITY, fov };
    let size = [width, height].map(|mm| (mm * pixels_per_mm) as usize);
    let (panels, pictures) = (std::slice::from_ref(panel), pictures_of_cells());
    render_panels_with_pictures(panels, &pictures, &eye, size, 2, Vec3::splat(0.3))
}

/// Drawing quad by quad gives the same picture as the rays of an eye that sees only the panel.
#[test]
fn a_panel_drawn_flat_is_what_an_eye_before_it_sees() {
    let mut panel = Panel::new([400.0, 240.0]);
    let outline = BoxStyle { outline: palette::LINE, outline_mm: 3.0, ..BoxStyle::default() };
    let shadow = BoxStyle { softness_mm: 20.0, fill: palette::SHADOW, ..BoxStyle::default() };
    panel.add_box(PanelRect::new(30.0, 40.0, 330.0, 170.0), &shadow);
    let rect = PanelRect::new(20.3, 30.7, 330.0, 170.0);
    panel.add_box(rect, &BoxStyle { radius_mm: 20.0, fill: palette::GROUND, ..outline });
    let (weight, align) = (FontWeight::Bold, TextAlign::Left);
    let style = TextStyle { weight, capital_mm: 13.3, color: palette::INK, align };
    panel.add_paragraph("The studio is being made ready", Vec2::new(40.0, 70.0), 200.0, &style);
    panel.add_icon(Icon::Stone, PanelRect::new(250.0, 50.0, 61.0, 61.0), palette::CLAY);
    panel.add_ring(Vec2::new(380.0, 120.0), [41.0, 7.0], 0.7, palette::OLIVE);
    let half = |mm: f32| (0.5e-3 * mm / READING_DISTANCE).atan();
    let [width, height] = panel.size_mm();
    let fov = Fov { left: -half(width), right: half(width), up: half(height), down: -half(height) };
    let eye = Eye { position: Vec3::Z * READING_DISTANCE, rotation: Quat::IDENTITY, fov };
    let size = [width, height].map(|mm| mm as usize);
    let flat = render_panel_flat(&panel, [0; 3], size);
    let seen = render_panels(&[panel], &eye, size, 1, Vec3::ZERO);
    let differs = |(a, b): &(&u8, &u8)| a.abs_diff(**b) > 2;
    let differing = seen.pixels.iter().zip(&flat.pixels).filter(differs).count();
    assert!(differing < 30, "{differing} values differ");
    assert!(flat.pixels.iter().filter(|value| **value > 0).count() > flat.pixels.len() / 3);
}

#[test]
fn every_screen_looks_as_it_did() {
    for (language, name) in Language::ALL.into_iter().zip(["english", "greek"]) {
        let screens = all_screens(language);
        let pictures: Vec<Image> =
            screens.iter().map(|(_, panel)| picture_of(panel, 0.28)).collect();
        let sheet = contact_sheet(&pictures, 5);
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join(format!("../pictures/panels-{name}.png"));
        if std::env::var("PAROS_GOLDEN").as_deref() == Ok("write") {
            let file = File::create(&path).expect("a picture's file");
            sheet.write_png(file).expect("a picture");
        }
        let kept = fs::read(&path).unwrap_or_else(|error| panic!("{error}: {AGAIN}"));
        let mut reader = png::Decoder::new(std::io::Cursor::new(kept)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("a picture");
        let size = [info.width, info.height].map(|side| side as usize);
        assert_eq!(size, [sheet.width, sheet.height], "{name}: {AGAIN}");
        let differs = |(a, b): &(&u8, &u8)| a.abs_diff(**b) > 2;
        let differing = pixels.iter().zip(&sheet.pixels).filter(differs).count();
        assert_eq!(differing, 0, "{name}: {AGAIN}");
    }
}

#[test]
fn every_text_is_a_degree_high() {
    for language in Language::ALL {
        for (name, panel) in all_screens(language) {
            let degrees = panel.least_text_degrees(READING_DISTANCE).expect("a text");
            assert!(degrees >= 1.0, "{name}: {degrees} degrees");
        }
    }
}

/// Everything shown lies within its panel, at a distance from its edge.
#[test]
fn everything_is_within_its_panel() {
    for language in Language::ALL {
        for (name, panel) in all_screens(language) {
            let inner = panel.rect().grown(-12.0);
            // The first two quads are the panel's shadow and background.
            for quad in &panel.quads()[2..] {
                assert!(is_within(quad, &inner), "{name} in {language:?}: {quad:?}");
            }
        }
    }
}

/// Labels and pictures lie within their buttons.
#[test]
fn every_label_is_within_its_button() {
    let cards = [
        Message::ChoiceFree,
        Message::ChoiceFigure,
        Message::ChoiceShape,
        Message::FigureOwl,
        Message::FigureCat,
        Message::FigureDolphin,
        Message::FigureAmphora,
        Message::FigureToy,
        Message::FigureOwn,
        Message::FigureSurprise,
    ]
    .map(|message| (message, Icon::Stone));
    let mut buttons = layout::choice_buttons(0, &cards);
    buttons.extend(layout::welcome_buttons(0, 3));
    buttons.extend(layout::staff_buttons(0));
    buttons.extend(layout::pin_buttons(0));
    for message in [Message::Skip, Message::Next, Message::Back, Message::Finish, Message::Undo] {
        let button = layout::guide_buttons(0)[0];
        buttons.push(PanelButton { label: Some(ButtonLabel::Message(message)), ..button });
    }
    for message in [Message::HandoverCleaned, Message::Yes, Message::No, Message::Cancel] {
        buttons.push(layout::notice_button(0, message, 0, 2));
    }
    for (button, language) in buttons.iter().zip(Language::ALL.iter().cycle()) {
        for language in [*language, Language::Greek] {
            let mut panel = Panel::new([2000.0; 2]);
            panel.add_button(language, button);
            let inner = button.rect.grown(-8.0);
            for quad in &panel.quads()[1..] {
                assert!(is_within(quad, &inner), "{language:?}: {button:?}: {quad:?}");
            }
        }
    }
}

/// On the welcome screen, exactly one button has the colour of the next step; selected choices have ticks.
#[test]
fn one_button_of_the_welcome_leads_on() {
    for language in Language::ALL {
        let screens = all_screens(language);
        for (wanted, chosen) in [("welcome", 2), ("welcome-mouse", 1)] {
            let (_, panel) = screens.iter().find(|(name, _)| *name == wanted).expect("a screen");
            let count = |kind: u32, fill: PanelColor, least_half: f32| {
                let is_such = |quad: &&PanelQuad| {
                    quad.kind == kind && quad.fill == fill && quad.half[1] > least_half
                };
                panel.quads().iter().filter(is_such).count()
            };
            let leading = count(PANEL_BOX, palette::CLAY, 40.0);
            assert_eq!(leading, 1, "{wanted} in {language:?}: buttons that lead on");
            let ticks = count(PANEL_SHAPE, palette::OLIVE, 0.0);
            assert_eq!(ticks, chosen, "{wanted} in {language:?}: ticks");
        }
    }
}

/// Buttons don't overlap, and are large enough to touch: as wide as three fingers.
#[test]
fn buttons_are_large_and_apart() {
    let cards = [(Message::FigureOwl, Icon::Owl); 7];
    for count in 1..=cards.len() {
        assert_large_and_apart(&layout::choice_buttons(0, &cards[..count]));
    }
    assert_large_and_apart(&layout::welcome_buttons(0, 3));
    assert_large_and_apart(&layout::staff_buttons(0));
    assert_large_and_apart(&layout::pin_buttons(0));
    let two = [0, 1].map(|column| layout::notice_button(column, Message::Yes, column, 2));
    assert_large_and_apart(&two);
}

fn assert_large_and_apart(buttons: &[PanelButton<'_>]) {
    for (k, a) in buttons.iter().enumerate() {
        assert!(a.rect.width >= 100.0 && a.rect.height >= 80.0, "{a:?}");
        let near = a.rect.grown(16.0);
        for b in &buttons[k + 1..] {
            let apart = b.rect.x > near.x + near.width
                || b.rect.y > near.y + near.height
                || b.rect.x + b.rect.width < near.x
                || b.rect.y + b.rect.height < near.y;
            assert!(apart, "{a:?} {b:?}");
            assert_ne!(a.id, b.id);
        }
    }
}

fn is_within(quad: &PanelQuad, rect: &PanelRect) -> bool {
    let ([x, y], [half_width, half_height]) = (quad.middle, quad.half);
    let corner = |side: f32| Vec2::new(x + side * half_width, y + side * half_height);
    rect.contains(corner(-1.0)) && rect.contains(corner(1.0))
}

/// The words of every badge fit beside it, and the atlas has all their letters.
#[test]
fn every_word_of_a_badge_fits() {
    let place = TextPlace::Word.style();
    let known = |c: char| line_width(&c.to_string(), place.weight) > 0.0;
    for language in Language::ALL {
        let words = Pictogram::all().map(|pictogram| pictogram.name(language));
        for word in words.chain(BadgeColour::ALL.map(|colour| colour.name(language))) {
            let width = place.capital_mm * line_width(word, place.weight);
            assert!(width <= 300.0, "{word} is {width} mm wide");
            assert!(word.chars().all(known), "{word}");
            assert!(!missing_letters(word, place.weight), "{word}");
        }
    }
}

/// Returns `true` if a letter of a word is drawn as the question mark, because the atlas lacks it.
fn missing_letters(word: &str, weight: FontWeight) -> bool {
    let shape = |text: &str| {
        let mut panel = Panel::new([100.0; 2]);
        let style =
            TextStyle { weight, capital_mm: 30.0, color: palette::INK, align: TextAlign::Left };
        panel.add_line(text, Vec2::ZERO, &style);
        panel.quads()[0].shape
    };
    word.chars().any(|c| shape(&c.to_string()) == shape("?"))
}

/// The atlas's distances have the sign given by the core's shapes, except within half a texel of an edge.
#[test]
fn pictograms_are_inked_as_the_core_says() {
    let mut panel = Panel::new([64.0; 2]);
    let (ground, ink) = ([255; 4], [0, 0, 0, 255]);
    for pictogram in Pictogram::all() {
        panel.clear([64.0; 2]);
        let plain = BoxStyle { fill: ground, ..BoxStyle::default() };
        panel.add_box(panel.rect().grown(10.0), &plain);
        panel.add_pictogram(pictogram, panel.rect(), ink);
        // One pixel for a 64th of the picture's side.
        let fov = Fov { left: -0.785, right: 0.785, up: 0.785, down: -0.785 };
        let distance = 0.032 / 0.785_f32.tan();
        let eye = Eye { position: Vec3::Z * distance, rotation: Quat::IDENTITY, fov };
        let image = render_panels(std::slice::from_ref(&panel), &eye, [64; 2], 1, Vec3::ZERO);
        let mut wrong = 0;
        for (x, y) in (0..64 * 64).map(|i| (i % 64, i / 64)) {
            let near = |dx, dy| {
                let step = |c: usize, d: i32| (2 * c as i32 + 1) * POINT_STEPS / 2 + d;
                covers_point(pictogram.parts(), [step(x, dx), step(y, dy)])
            };
            let reach = POINT_STEPS * 3 / 4;
            let all = [(0, 0), (reach, 0), (-reach, 0), (0, reach), (0, -reach)];
            let inked = all.iter().filter(|(dx, dy)| near(*dx, *dy)).count();
            let dark = image.pixel(x, y)[0] < 128;
            wrong += usize::from(inked == all.len() && !dark || inked == 0 && dark);
        }
        assert!(wrong <= 6, "{pictogram:?}: {wrong} pixels");
    }
}

/// A card whose cell has no picture shows its icon; a picture, which covers more, replaces the icon entirely.
#[test]
fn a_card_shows_its_icon_until_there_is_a_picture() {
    let card = layout::choice_buttons(0, &[(Message::FigureOwl, Icon::Owl)])[0];
    let eye = Eye {
        position: Vec3::Z,
        rotation: Quat::IDENTITY,
        fov: Fov { left: -0.24, right: 0.24, up: 0.24, down: -0.24 },
    };
    let draw = |card: &PanelButton<'_>, pictures: &PanelPictures| {
        let mut panel = Panel::new([1000.0; 2]);
        let rect = PanelRect { x: 352.0, y: 340.0, ..card.rect };
        panel.add_button(Language::English, &PanelButton { rect, ..*card });
        render_panels_with_pictures(&[panel], pictures, &eye, [160; 2], 1, Vec3::ZERO)
    };
    let without = PanelPictures::default();
    let plain = draw(&card, &without);
    assert_eq!(draw(&card.with_cell(3), &without), plain);
    let mut with = PanelPictures::default();
    let magenta = Image::filled(PANEL_CELL_TEXELS, PANEL_CELL_TEXELS, [255, 0, 255]);
    assert!(with.set(2, &magenta));
    assert_eq!(draw(&card.with_cell(3), &with), plain, "another cell's");
    let pictured = draw(&card.with_cell(2), &with);
    let bare = draw(&PanelButton { picture: None, ..card }, &without);
    let shown = || (0..160 * 160).map(|at| [at % 160, at / 160]);
    let is_painted = |[x, y]: &[usize; 2]| pictured.pixel(*x, *y) == [255, 0, 255];
    assert!(shown().filter(is_painted).count() > 3000, "the picture is large");
    let is_icon = |[x, y]: &[usize; 2]| plain.pixel(*x, *y) != bare.pixel(*x, *y);
    assert!(shown().filter(is_icon).count() > 300, "the icon is drawn");
    assert!(shown().filter(is_icon).all(|at| is_painted(&at)), "the picture covers it");
}

/// In the room a panel hides objects behind it, and is hidden by objects before it.
#[test]
fn panels_stand_in_the_room() {
    let room = lit_studio();
    let options = RenderOptions { width: 96, height: 72, samples: 1, ..RenderOptions::default() };
    let camera = Camera::orbiting(0.0, 0.0);
    let draw = |maps: &RangeMaps<64>, panels: &[Panel]| {
        render_image_with_panels(maps, &camera, &options, &room, panels, &|_| {})
    };
    let mut panel = Panel::new([300.0, 200.0]);
    let paint = BoxStyle { fill: [255, 0, 255, 255], ..BoxStyle::default() };
    panel.add_box(panel.rect(), &paint);
    let empty = RangeMaps::<64>::new();
    with_maps_of_ball(|ball| {
        let mut count_painted = |maps, towards_eye: f32| {
            panel.pose.middle =
                room.stand.foot + Vec3::new(0.0, 0.43, towards_eye) * room.stand.side;
            let image = draw(maps, std::slice::from_ref(&panel));
            let is_painted = |i: &usize| image.pixel(i % 96, i / 96) == [255, 0, 255];
            (0..96 * 72).filter(is_painted).count()
        };
        let [before, behind] = [0.6, -0.7].map(|place| count_painted(&empty, place));
        assert!(before > 500 && behind > 300, "{before}, {behind} without the ball");
        assert_eq!(count_painted(ball, 0.6), before, "before the ball");
        let hidden = behind - count_painted(ball, -0.7);
        assert!((200..=behind).contains(&hidden), "the ball hides {hidden} of {behind}");
        assert_eq!(count_painted(ball, -20.0), 0, "behind the wall");
        let alone = render_image_in_room(ball, &camera, &options, &room, &|_| {});
        assert!(draw(ball, &[]) == alone, "without panels");
    });
}

/// Checks the cost of each screen for a GPU: quads, and the texels and fragments for each pixel of its panel.
/// The shaders' README lists these numbers.
#[test]
fn screens_are_cheap() {
    for language in Language::ALL {
        for (name, panel) in all_screens(language) {
            let area = |quad: &PanelQuad| 4.0 * quad.half[0] * quad.half[1];
            let [width, height] = panel.size_mm();
            let per_pixel = |is_counted: &dyn Fn(&PanelQuad) -> bool| {
                let counted = panel.quads().iter().filter(|quad| is_counted(quad));
                counted.map(area).sum::<f32>() / (width * height)
            };
            let texels = per_pixel(&|quad| [PANEL_SHAPE, PANEL_IMAGE].contains(&quad.kind));
            let fragments = per_pixel(&|_| true);
            assert!(panel.quads().len() <= 145, "{name}: {} quads", panel.quads().len());
            assert!(texels < 0.5 && fragments < 3.0, "{name}: {texels}, {fragments}");
        }
    }
}

/// Writes each screen as a large image for inspection.
#[test]
#[ignore = "for looking at"]
fn screens_in_large() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("panels");
    fs::create_dir_all(&folder).expect("a folder");
    for language in Language::ALL {
        for (k, (name, panel)) in all_screens(language).iter().enumerate() {
            let path = folder.join(format!("{language:?}-{k:02}-{name}.png"));
            let file = File::create(path).expect("a picture's file");
            picture_of(panel, 0.8).write_png(file).expect("a picture");
        }
    }
    let options = RenderOptions { width: 960, height: 720, ..RenderOptions::default() };
    let (room, camera) = (lit_studio(), Camera { angle: 0.9, ..Camera::orbiting(0.4, 0.1) });
    let (_, mut panel) = all_screens(Language::English).swap_remove(1);
    panel.pose.middle = room.stand.foot + Vec3::new(-0.5, 0.5, -0.3);
    let panels = [panel];
    let picture = with_maps_of_ball(|maps| {
        render_image_with_panels(maps, &camera, &options, &room, &panels, &|_| {})
    });
    let file = File::create(folder.join("room.png")).expect("a picture's file");
    picture.write_png(file).expect("a picture");
    let file = File::create(folder.join("pictures.png")).expect("a picture's file");
    picture_of(&all_pictures(), 1.0).write_png(file).expect("a picture");
}

/// Returns a panel with every pictogram and icon, ten in a row.
fn all_pictures() -> Panel {
    let mut panel = Panel::new([1200.0, 1200.0]);
    let ground = BoxStyle { fill: palette::GROUND, ..BoxStyle::default() };
    panel.add_box(panel.rect(), &ground);
    let place = |k: usize| {
        PanelRect::new((k % 10) as f32 * 120.0, (k / 10) as f32 * 120.0, 120.0, 120.0).grown(-8.0)
    };
    for pictogram in Pictogram::all() {
        panel.add_pictogram(pictogram, place(pictogram.number()), palette::INK);
    }
    for icon in Icon::ALL {
        panel.add_icon(icon, place(Pictogram::COUNT + icon as usize), palette::INK);
    }
    panel
}
