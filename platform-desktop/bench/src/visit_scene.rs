//! The scene of a visit with everything on screen (panels, previews, tools and hands), beside the sculpture's
//! pass. It must take less than a third of that pass.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Quat, Vec2, Vec3};
use paros_core::TickInput;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool};
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::Image;
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, FrameTimes, RenderPath, RenderStyle, SculpturePlacement,
};
use paros_shaders::limits::PANEL_CELL_TEXELS;
use paros_shaders::panel::layout::{self, Clock};
use paros_shaders::panel::{BoxStyle, Icon, Language, Message, Panel, PanelPose};
use paros_shaders::scene::{LatestInput, SKY, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shell::statics::Resident;
use paros_shell::tick_runner::with_fresh_world;
use paros_visit::{PanelSpot, room_pose};

use super::clock::OursTheirs;
use super::frames::{FrameFormat, FrameTimer, mean_ms};
use super::framing::VIEWS;
use super::render::BENCH;
use super::row::ReportRow;
use super::subject::BenchSubject;

/// Height of a visitor's eyes, in metres.
const EYE_HEIGHT: f32 = 1.6;

/// The cards of the start choice, each with a preview.
const CARDS: [(Message, Icon); 3] = [
    (Message::FigureOwl, Icon::Owl),
    (Message::ChoiceFree, Icon::Stone),
    (Message::ChoiceShape, Icon::Shape),
];

/// Measures the scene. The subject is already loaded into the renderers. A visitor stands before it with a
/// tool in each hand; the stool turns.
pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + Resident<N, 1>,
{
    let (scene, panels) = (assemble_scene::<N>(), lay_out_panels());
    let pose = scene.sculpture_placement();
    let eye = Eye {
        position: Vec3::Y * EYE_HEIGHT,
        rotation: Quat::from_rotation_x(-0.35),
        fov: Fov { left: -0.75, right: 0.75, up: 0.8, down: -0.8 },
    };
    let mut rows = vec![];
    for format in [FrameFormat::ALL[0], FrameFormat::HEADSET] {
        let eyes = [eye; 2];
        let renderer = timer.renderer_for(VolumeFormat::of::<N, 1>(), format)?;
        let mut best = [[u64::MAX; 2]; VIEWS];
        for run in 0..=runs {
            for (view, best) in best.iter_mut().enumerate() {
                let turn_radians = view as f32 * (TAU / VIEWS as f32);
                let request = FrameRequest {
                    eyes: &eyes[..format.eyes as usize],
                    placement: SculpturePlacement { turn_radians, ..pose },
                    style: RenderStyle::in_studio(RenderPath::Fast),
                    backdrop: SKY,
                    scene: Some(scene.draw_list()),
                    panels: &[&panels],
                };
                // Like the start choice, in which a preview changes with every frame.
                let cell = view % CARDS.len();
                renderer.set_panel_picture(cell as u8, &preview_picture(cell));
                let times = renderer.draw_frame(&request, &vec![])?;
                // The first run is a warm-up for drivers that defer work.
                if run > 0 {
                    let times = split_times(&times);
                    *best = [0, 1].map(|part| best[part].min(times[part]));
                }
            }
        }
        let what = "the sculpture's pass, ours the rest of a visit's scene, panels and previews";
        let times = OursTheirs {
            ours: mean_ms(&best.map(|[scene, _]| scene)),
            theirs: mean_ms(&best.map(|[_, sculpture]| sculpture)),
        };
        let row = ReportRow::new(BENCH, subject.name(), N, format!("{what}; {}", format.name()));
        rows.push(row.with_times_ms(times));
    }
    Ok(rows)
}

/// Returns the nanoseconds of a frame's scene, with the shadow map and the pictures' upload, and of its
/// sculpture.
fn split_times(times: &FrameTimes) -> [u64; 2] {
    let in_pass = times.sculpture_ns.unwrap_or(0);
    let sculpture = times.tiles_ns + in_pass;
    [times.total_ns.saturating_sub(sculpture), sculpture]
}

/// Assembles the studio with a tool in each hand, from a world's state.
fn assemble_scene<const N: usize>() -> SceneAssembler
where
    Grid<N>: Size + Resident<N, 1>,
{
    with_fresh_world::<N, 1, _>(|mut runner| {
        runner.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
        for (hand, tool) in [(0, Tool::Rasp), (1, Tool::Rotary)] {
            let item = BenchItem::Tool(tool).number() as u8;
            let pointer = PointerCommand::Take { hand, item };
            runner.run_tick(&TickInput { pointer, ..TickInput::default() });
        }
        let grip = |x: f32| Some((Vec3::new(x, 1.1, -0.25), Quat::from_rotation_x(0.3)));
        let fresh = LatestInput {
            grips: [grip(-0.2), grip(0.2)],
            show_hands: true,
            tick_fraction: 1.0,
            ..LatestInput::default()
        };
        let mut scene = SceneAssembler::new();
        scene.assemble_frame(runner.world(), &fresh);
        scene
    })
}

/// Lays out the start choice with its previews before the visitor, a clock, a warning and buttons at the
/// side, and a ray from each hand.
fn lay_out_panels() -> Vec<Panel> {
    let language = Language::Greek;
    let mut choice = Panel::new([0.0; 2]);
    let cards = layout::choice_buttons(0, &CARDS).into_iter().zip(0..);
    let cards: Vec<_> = cards.map(|(card, cell)| card.with_cell(cell)).collect();
    layout::draw_choice(&mut choice, language, Message::ChoiceTitle, &cards);
    let clock = Clock { seconds: Some([119, 600]), warning: Some(Message::WarningTwoMinutes) };
    let labels = [
        (Message::UndoStroke, Icon::Undo),
        (Message::TurnStone, Icon::Turn),
        (Message::PutBack, Icon::PutBack),
        (Message::Ready, Icon::Tick),
    ];
    let mut side = Panel::new([0.0; 2]);
    layout::draw_clock(&mut side, language, &clock, &clock.buttons(0, labels));
    for (panel, spot) in [(&mut choice, PanelSpot::Main), (&mut side, PanelSpot::Side)] {
        panel.pose = room_pose(spot, panel.size_mm(), EYE_HEIGHT);
    }
    let rays = [-0.2, 0.2].map(|x| {
        let mut ray = Panel::new([700.0, 5.0]);
        let style = BoxStyle { fill: [255, 246, 224, 120], ..BoxStyle::default() };
        ray.add_box(ray.rect(), &style);
        let rotation = Quat::from_rotation_y(FRAC_PI_2);
        ray.pose = PanelPose { middle: Vec3::new(x, 1.3, -0.7), rotation, scale: 1.0 };
        ray
    });
    let [left, right] = rays;
    vec![choice, side, left, right]
}

/// Returns a picture like those of the previews.
fn preview_picture(cell: usize) -> Image {
    let side = PANEL_CELL_TEXELS;
    let middle = Vec2::splat(0.5 * side as f32);
    let texel = |at: usize| {
        let place = Vec2::new((at % side) as f32, (at / side) as f32);
        let shade = 250.0 - 1.5 * place.distance(middle) - 20.0 * cell as f32;
        [shade as u8; 3]
    };
    Image { width: side, height: side, pixels: (0..side * side).flat_map(texel).collect() }
}

#[cfg(test)]
mod tests {
    use paros_shaders::gpu::FrameTimes;

    use super::{lay_out_panels, split_times};

    #[test]
    fn a_frame_is_its_sculpture_and_the_rest() {
        let times = FrameTimes {
            uploads_ns: 3,
            shadow_ns: 20,
            tiles_ns: 100,
            pass_ns: 9_000,
            sculpture_ns: Some(7_000),
            total_ns: 9_123,
        };
        assert_eq!(split_times(&times), [2_023, 7_100]);
        assert_eq!(split_times(&FrameTimes::default()), [0, 0]);
    }

    #[test]
    fn the_panels_of_a_visit_are_laid_out() {
        let panels = lay_out_panels();
        let quads: Vec<usize> = panels.iter().map(|panel| panel.quads().len()).collect();
        assert!(quads[0] > 40 && quads[1] > 40 && quads[2] == 1 && quads[3] == 1, "{quads:?}");
    }
}
