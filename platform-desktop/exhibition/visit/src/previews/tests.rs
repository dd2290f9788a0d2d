//! Previews without a thread, and with a thread under a host.

use std::fs::File;
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::session::{SessionMode, TICK_RATE};
use paros_shaders::gpu::{Eye, Fov};
use paros_shaders::limits::PANEL_CELLS;
use paros_shaders::panel::{Language, Message, Panel, PanelPictures, layout};
use paros_shaders::{Image, render_panels_with_pictures};
use paros_shell::modes::parse_mode;

use super::cell_of_card;
use super::show::{LIVE, PreviewShow};
use super::stage::{PreviewStage, PreviewSubject};

const OWN_FIGURE: SessionMode = SessionMode::Constrained { figure: 250 };

fn starts() -> Vec<SessionMode> {
    let figure = |name| parse_mode(name).expect("a figure");
    vec![
        SessionMode::FreeForm,
        OWN_FIGURE,
        figure("owl"),
        SessionMode::Creative,
        figure("cat"),
        SessionMode::Own,
        figure("dolphin"),
    ]
}

/// Counts pixels that differ by more than a shade.
fn count_differing(a: &Image, b: &Image) -> usize {
    let pairs = a.pixels.as_chunks::<3>().0.iter().zip(b.pixels.as_chunks::<3>().0);
    pairs.filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 24)).count()
}

/// Returns the pictures of each cell in this many ticks, in their order.
fn pictures_of_ticks(show: &mut PreviewShow, ticks: u32) -> [Vec<Image>; PANEL_CELLS] {
    let mut all = [const { Vec::new() }; PANEL_CELLS];
    for (cell, picture) in (0..ticks).filter_map(|_| show.run_tick()) {
        all[usize::from(cell)].push(picture);
    }
    all
}

/// Three starts are live; the others have a still picture, or none if their volume isn't made here.
#[test]
fn the_previews_of_a_choice_change_and_differ() {
    let mut show = PreviewShow::new(&starts());
    let all = pictures_of_ticks(&mut show, 400);
    let counts = all.each_ref().map(Vec::len);
    let live = [0, 2, 3];
    assert_eq!(live.len(), LIVE);
    for cell in live {
        assert!(counts[cell] > 10, "{counts:?}");
        for (before, after) in all[cell].iter().zip(&all[cell][1..]) {
            assert!(count_differing(before, after) > 100, "cell {cell} stands still");
        }
    }
    for cell in [4, 6] {
        assert!((1..4).contains(&counts[cell]), "{counts:?}");
        assert!(all[cell].iter().all(|picture| *picture == all[cell][0]), "cell {cell} moves");
    }
    assert_eq!([counts[1], counts[5], counts[7]], [0; 3], "the operator's own, the visitor's own");
    let has_cell = |(k, start): (usize, &SessionMode)| cell_of_card(k, *start) == Some(k as u8);
    let shown: Vec<_> = starts().iter().enumerate().map(has_cell).collect();
    assert_eq!(shown, counts[..7].iter().map(|count| *count > 0).collect::<Vec<_>>());
    for a in [0, 2, 3, 4, 6] {
        for b in (0..a).filter(|b| counts[*b] > 0) {
            let apart = count_differing(&all[a][0], &all[b][0]);
            assert!(apart > 2000, "{a} is as {b}: {apart} pixels differ");
        }
    }
}

/// Each start is worked on to its end within a minute, and begins again; a hidden figure stays whole.
#[test]
fn each_start_is_worked_on() {
    let [owl, whole, half] =
        ["owl", "owl-whole", "owl-half"].map(|name| parse_mode(name).expect("a figure"));
    // The least remaining stone in percent: of a vase, of a waist, and of figures with stone around them that
    // is no wider than the bit.
    let lefts = [
        (SessionMode::FreeForm, 55),
        (SessionMode::Creative, 96),
        (owl, 80),
        (half, 60),
        (whole, 50),
    ];
    for (start, left) in lefts {
        let mut stage = PreviewStage::new(PreviewSubject::of_start(start).expect("a subject"));
        stage.run_tick();
        let first = stage.world().volume().count_voxels();
        // Three worlds share the ticks of a minute.
        let counts: Vec<_> = (0..60 * TICK_RATE / LIVE as u32)
            .map(|tick| {
                stage.run_tick();
                assert!(!tick.is_multiple_of(50) || stage.figure_is_whole(), "{start:?}");
                stage.world().volume().count_voxels()
            })
            .collect();
        let (done, least) =
            counts.iter().enumerate().min_by_key(|(_, count)| **count).expect("ticks");
        assert!(least * 100 < first * left, "{start:?}: {least} of {first}");
        assert!(counts[done..].contains(&first), "{start:?} begins anew");
    }
}

#[test]
fn without_a_start_that_is_made_here_nothing_is_drawn() {
    let mut show = PreviewShow::new(&[SessionMode::Own, OWN_FIGURE]);
    assert!((0..100).all(|_| show.run_tick().is_none()));
    let mut nothing = PreviewShow::new(&[]);
    assert!(nothing.run_tick().is_none());
}

/// Writes the panel of a choice with previews, for visual inspection.
#[test]
#[ignore = "for looking at"]
fn the_choice_in_large() {
    let starts = [0, 2, 3, 4, 6].map(|k| starts()[k]);
    for (count, ticks) in [(3, 400), (3, 1500), (5, 900)] {
        let mut show = PreviewShow::new(&starts[..count]);
        let mut pictures = PanelPictures::default();
        for (cell, picture) in (0..ticks).filter_map(|_| show.run_tick()) {
            assert!(pictures.set(cell, &picture));
        }
        let cards: Vec<_> =
            starts[..count].iter().map(|s| crate::cards::card_of_start(*s)).collect();
        let buttons = layout::choice_buttons(0, &cards);
        let buttons: Vec<_> = (0..).zip(buttons).map(|(k, button)| button.with_cell(k)).collect();
        let mut panel = Panel::default();
        layout::draw_choice(&mut panel, Language::English, Message::ChoiceTitle, &buttons);
        let [width, height] = panel.size_mm();
        let half = |mm: f32| (0.5e-3 * mm).atan();
        let fov =
            Fov { left: -half(width), right: half(width), up: half(height), down: -half(height) };
        let eye = Eye { position: Vec3::Z, rotation: Quat::IDENTITY, fov };
        let size = [width as usize, height as usize];
        let image = render_panels_with_pictures(&[panel], &pictures, &eye, size, 2, Vec3::ZERO);
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../target/tmp");
        let file = File::create(folder.join(format!("choice-{count}-{ticks}.png")));
        image.write_png(file.expect("a picture's file")).expect("a picture");
    }
}
