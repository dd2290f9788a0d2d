//! The studio drawn by the renderer, from the visitor's eyes. Pictures are written to the target's folder for
//! temporary files.

use std::path::PathBuf;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::RangeMaps;
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{BenchItem, SessionMode, Tool};
use paros_core::volume::BitGrid;
use paros_models::scripted_hand::{RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shaders::constants::TONE_WHITE_POINT;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, PaperVariant, RenderPath, RenderStyle, SculpturePlacement, SharedGpu,
};
use paros_shaders::scene::{LatestInput, MeshId, SKY, SUN_DIRECTION, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shell::figures::Figure;
use paros_tests_vulkan::test_renderer::{Layers, TestRenderer, test_device};
use paros_tests_vulkan::{count_differing, rgb_sum};

const N: usize = 128;
const PATHS: [(&str, RenderPath); 2] =
    [("fast", RenderPath::Fast), ("paper", RenderPath::Paper(PaperVariant::Whole))];

static STUDIO: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

fn studio() -> MutexGuard<'static, WorldHarness<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A renderer for a sculpture in the studio: the owl, or nothing.
struct SceneRig {
    test_renderer: TestRenderer,
    /// The figure's rotation relative to the stool.
    turn: f32,
}

const SIZE: [u32; 2] = [640, 480];

impl SceneRig {
    /// Creates a rig with the owl for one eye, or returns `None` if there is no device.
    fn with_owl(samples: u32) -> Option<Self> {
        Some(Self::on(&test_device()?, [samples, 1]))
    }

    fn on(gpu: &SharedGpu, kind: [u32; 2]) -> Self {
        let mut show = SceneRig {
            test_renderer: TestRenderer::new(gpu, VolumeFormat::of::<N, 1>(), kind, SIZE),
            turn: 0.0,
        };
        show.show_owl();
        show
    }

    fn show_owl(&mut self) {
        self.test_renderer.upload_field(&FIELDS[0]);
    }

    fn show_nothing(&mut self) {
        self.test_renderer.upload_field(&FIELDS[1]);
    }

    /// Draws the scene, or the sculpture alone, for each eye.
    fn draw(
        &mut self,
        scene: &SceneAssembler,
        with_scene: bool,
        path: RenderPath,
        view: &ViewSpec,
    ) -> Layers {
        let views = self.test_renderer.renderer.format().views;
        let eyes: Vec<Eye> = (0..views).map(|i| view.eye(i, views)).collect();
        let pose = scene.sculpture_placement();
        let white = TONE_WHITE_POINT * TONE_WHITE_POINT;
        let shown = SKY.map(|c| c * (1.0 + c / white) / (1.0 + c));
        self.test_renderer.draw_picture(&FrameRequest {
            eyes: &eyes,
            placement: SculpturePlacement {
                foot: pose.foot,
                side: pose.side,
                turn_radians: pose.turn_radians + self.turn,
            },
            style: RenderStyle::in_studio(path),
            scene: with_scene.then(|| scene.draw_list()),
            panels: &[],
            backdrop: shown,
        })
    }

    /// Draws the scene for one eye.
    fn draw_for_one_eye(&mut self, scene: &SceneAssembler, path: RenderPath) -> Vec<[u8; 4]> {
        self.draw(scene, true, path, &VISITOR).remove(0)
    }

    fn draw_alone(&mut self, scene: &SceneAssembler, path: RenderPath) -> Vec<[u8; 4]> {
        self.draw(scene, false, path, &VISITOR).remove(0)
    }
}

/// The camera of a picture.
#[derive(Clone, Copy)]
struct ViewSpec {
    eye: Vec3,
    at: Vec3,
    angle: f32,
}

/// The view of a standing visitor.
const VISITOR: ViewSpec =
    ViewSpec { eye: Vec3::new(0.0, 1.6, 0.25), at: Vec3::new(0.05, 1.0, -0.75), angle: 1.2 };

impl ViewSpec {
    fn rotation(&self) -> Quat {
        let ahead = (self.at - self.eye).normalize();
        let right = ahead.cross(Vec3::Y).normalize();
        Quat::from_mat3(&glam::Mat3::from_cols(right, right.cross(ahead), -ahead))
    }

    /// Returns the eye number `i` of `of` eyes.
    fn eye(&self, i: u32, of: u32) -> Eye {
        let rotation = self.rotation();
        let aside = 0.063 * (i as f32 - 0.5 * (of - 1) as f32);
        let up = 0.5 * self.angle;
        let side = (up.tan() * SIZE[0] as f32 / SIZE[1] as f32).atan();
        Eye {
            position: self.eye + rotation * Vec3::X * aside,
            rotation,
            fov: Fov { left: -side, right: side, up, down: -up },
        }
    }

    /// Returns the index of the pixel that shows a point of the room, for a single eye.
    fn pixel_index(&self, point: Vec3) -> usize {
        let clip = self.eye(0, 1).clip_from_room() * point.extend(1.0);
        let [w, h] = SIZE.map(|pixels| pixels as f32);
        let x = ((clip.x / clip.w * 0.5 + 0.5) * w) as usize;
        let y = ((clip.y / clip.w * 0.5 + 0.5) * h) as usize;
        y * SIZE[0] as usize + x
    }
}

/// The textures of a figure, and of an empty volume.
static FIELDS: LazyLock<[Box<DensityField<N>>; 2]> = LazyLock::new(|| {
    let mut plane: Box<BitGrid<N>> = Box::new(BitGrid::new());
    let mut maps: Box<RangeMaps<N>> = Box::new(RangeMaps::new());
    let mut fields = [Box::new(DensityField::new()), Box::new(DensityField::new())];
    fields[1].rebuild_from(&maps);
    Figure::Owl.rasterize_into(&mut maps, &mut plane);
    fields[0].rebuild_from(&maps);
    fields
});

/// Returns the studio at rest with the rotary tool in the right hand at a grip.
fn held_at(grip: Vec3, rotation: Quat) -> SceneAssembler {
    let mut studio = studio();
    studio.start_session(SessionMode::FreeForm);
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut scene = SceneAssembler::new();
    let fresh = LatestInput {
        grips: [None, Some((grip, rotation))],
        show_hands: true,
        tick_fraction: 1.0,
        ..LatestInput::default()
    };
    scene.assemble_frame(&studio.world, &fresh);
    scene
}

fn write_png_file(name: &str, pixels: &[[u8; 4]]) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let mut image = paros_shaders::Image::filled(SIZE[0] as usize, SIZE[1] as usize, [0; 3]);
    for (to, from) in image.pixels.chunks_exact_mut(3).zip(pixels) {
        to.copy_from_slice(&from[..3]);
    }
    let file = std::fs::File::create(folder.join(format!("{name}.png"))).expect("a file");
    image.write_png(file).expect("a picture");
}

const ASIDE: (Vec3, Quat) = (Vec3::new(0.32, 1.15, -0.25), Quat::IDENTITY);

#[test]
fn the_room_is_drawn_from_the_visitors_eyes() {
    let Some(gpu) = test_device() else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (samples, views) in [(1, 1), (4, 1), (4, 2)] {
        let mut show = SceneRig::on(&gpu, [samples, views]);
        for (name, path) in PATHS {
            let layers = show.draw(&scene, true, path, &VISITOR);
            for (i, layer) in layers.iter().enumerate() {
                write_png_file(&format!("scene-{name}-{samples}-{views}-{i}"), layer);
            }
            let times = show.test_renderer.renderer.gpu_frame_times();
            if gpu.features.timestamp_period_fs > 0 {
                assert!(times.shadow_ns > 0 && times.pass_ns > 0, "{times:?}");
                assert_eq!(times.sculpture_ns, None, "no timestamp within a pass");
            }
            if let [left, right] = &layers[..] {
                assert!(
                    count_differing(left, right) > left.len() / 20,
                    "{name}: the eyes see the same"
                );
            }
        }
        if (samples, views) == (1, 1) {
            for (name, path) in PATHS {
                check_shadow(&mut show, name, path);
            }
        }
    }
}

/// Checks that the figure's shadow lies on the stool, away from the sun, which stands to the left and behind
/// the visitor.
fn check_shadow(show: &mut SceneRig, name: &str, path: RenderPath) {
    let scene = held_at(ASIDE.0, ASIDE.1);
    let with = show.draw_for_one_eye(&scene, path);
    show.show_nothing();
    let without = show.draw_for_one_eye(&scene, path);
    write_png_file(&format!("scene-{name}-empty"), &without);
    show.show_owl();
    let mut dark = 0;
    let sun = Vec3::from_array(SUN_DIRECTION);
    // On the sunny side, the figure's foot, which ends 16 cm from the middle, darkens the stool beside it.
    let aside = Vec3::new(sun.x, 0.0, sun.z).normalize();
    let contact = [0.165, 0.17, 0.175, 0.2, 0.22].map(|metres| {
        let pixel = VISITOR.pixel_index(STOOL_TOP + aside * metres);
        rgb_sum(with[pixel]) as f32 / rgb_sum(without[pixel]) as f32
    });
    let darkens = contact[0] < 0.95 && contact.is_sorted() && contact[3] > 0.99;
    assert!(darkens, "{name}: {contact:.2?}");
    let ground = |height: f32| STOOL_TOP - Vec3::new(sun.x, 0.0, sun.z) * (height / sun.y);
    for i in 0..10 {
        // A point in the shadow of the figure's axis on the stool's top, beside the figure.
        let at = VISITOR.pixel_index(ground((0.3 + 0.01 * i as f32) * BOX_SIDE));
        dark += i32::from(rgb_sum(with[at]) * 10 < rgb_sum(without[at]) * 8);
        // On the sunny side there is no shadow.
        let at = VISITOR.pixel_index(ground((-0.3 - 0.01 * i as f32) * BOX_SIDE));
        assert!(
            (rgb_sum(with[at]) - rgb_sum(without[at])).abs() < 12,
            "{name}: dark towards the sun"
        );
    }
    assert!(dark >= 9, "{name}: {dark} places of 10 lie in the sculpture's shadow");
}

#[test]
fn tools_and_sculpture_hide_each_other() {
    let Some(mut show) = SceneRig::with_owl(1) else { return };
    let middle = STOOL_TOP + Vec3::Y * (0.4 * BOX_SIDE);
    let ahead = (VISITOR.eye - middle).normalize();
    for (name, path) in PATHS {
        // The tool's tip points up in both pictures, before the figure and behind it.
        for (place, towards, hides) in [("before", 0.35, true), ("behind", -0.30, false)] {
            let grip = middle + ahead * towards;
            let scene = held_at(grip, Quat::from_rotation_x(1.2));
            show.show_owl();
            let both = show.draw_for_one_eye(&scene, path);
            write_png_file(&format!("scene-{name}-{place}"), &both);
            show.show_nothing();
            let tool = show.draw_for_one_eye(&scene, path);
            // The tool's pixels, projected from points of its instance.
            let (mut seen, mut all) = (0, 0);
            for instance in scene.draw_list().instances_of(MeshId::of_tool(Tool::Rotary)) {
                for vertex in MeshId::of_tool(Tool::Rotary).vertices() {
                    let point = instance.transform_point(Vec3::from_array(vertex.position));
                    let at = VISITOR.pixel_index(point);
                    all += 1;
                    seen += i32::from(count_differing(&tool[at..=at], &both[at..=at]) == 0);
                }
            }
            let part = seen as f32 / all as f32;
            assert!(hides == (part > 0.8), "{name}, {place}: {part} of the tool is as without");
        }
    }
}

/// A hand between the sun and the box: the figure's own shadow rays have left the box before they reach it.
#[test]
fn shadows_fall_on_the_sculpture() {
    let Some(mut show) = SceneRig::with_owl(1) else { return };
    let middle = STOOL_TOP + Vec3::Y * (0.3 * BOX_SIDE);
    let lit = held_at(ASIDE.0, ASIDE.1);
    let hidden = held_at(middle + Vec3::from_array(SUN_DIRECTION) * 0.6, ASIDE.1);
    for (name, path) in PATHS {
        let light = show.draw_for_one_eye(&lit, path);
        let dark = show.draw_for_one_eye(&hidden, path);
        write_png_file(&format!("scene-{name}-hidden"), &dark);
        let alone = show.draw_alone(&lit, path);
        // Where nothing else blocks the sun, the figure looks the same as alone.
        let on_figure = alone.iter().map(|pixel| *pixel != alone[0]);
        let (mut all, mut darker, mut lighter) = (0, 0, 0);
        for ((light, dark), _) in light.iter().zip(&dark).zip(on_figure).filter(|(_, on)| *on) {
            all += 1;
            darker += i32::from(rgb_sum(*dark) * 10 < rgb_sum(*light) * 9);
            lighter += i32::from(rgb_sum(*dark) * 9 > rgb_sum(*light) * 10);
        }
        assert!(darker * 12 > all && lighter == 0, "{name}: {darker} of {all}, {lighter} lighter");
    }
}

/// The shadow map contains the figure too, but no part of it lies beyond the point where its own rays leave
/// the box.
#[test]
fn the_figure_is_lit_as_it_is_alone() {
    let Some(mut show) = SceneRig::with_owl(1) else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (name, path) in PATHS {
        for turn in 0..8 {
            show.turn = turn as f32 * 0.7;
            let alone = show.draw_alone(&scene, path);
            let within = show.draw_for_one_eye(&scene, path);
            // Lower down, the stool's top may hide objects that stand on it.
            let above = alone.iter().zip(&within).take(VISITOR.pixel_index(STOOL_TOP));
            let on_figure = above.filter(|(pixel, _)| **pixel != alone[0]);
            let other = on_figure.filter(|(a, b)| (rgb_sum(**a) - rgb_sum(**b)).abs() > 3).count();
            assert_eq!(other, 0, "{name}, turned by {}: pixels in its own shadow", show.turn);
        }
    }
}

#[test]
fn chips_are_drawn_and_fade() {
    let Some(mut show) = SceneRig::with_owl(4) else { return };
    let mut studio = studio();
    studio.start_session(SessionMode::FreeForm);
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut scene = SceneAssembler::new();
    for i in 0..300 {
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(63.0 - 0.1 * i as f32, 30.0, 32.0), true);
        scene.follow_tick(&studio.world);
        if scene.particles().alive_count() > 12 {
            break;
        }
    }
    let view =
        ViewSpec { eye: Vec3::new(0.5, 1.2, 0.0), at: STOOL_TOP + Vec3::Y * 0.2, angle: 0.7 };
    let mut frame = |time: f64| {
        let fresh =
            LatestInput { time_seconds: time, tick_fraction: 1.0, ..LatestInput::default() };
        scene.assemble_frame(&studio.world, &fresh);
        show.draw(&scene, true, RenderPath::Fast, &view).remove(0)
    };
    let pictures = [0.0, 0.1, 0.2].map(&mut frame);
    write_png_file("scene-chips", &pictures[1]);
    let mut last = Vec::new();
    for i in 3..40 {
        last = frame(0.1 * f64::from(i));
    }
    let seen = pictures.map(|picture| count_differing(&picture, &last));
    assert!(seen.iter().all(|count| (8..20_000).contains(count)), "{seen:?} pixels show chips");
}

/// Closure refuses a cut of the burr inside a tunnel in the studio's stone; the mark shows over the drawn
/// owl.
#[test]
fn what_closure_brought_back_is_drawn_and_fades() {
    let Some(mut show) = SceneRig::with_owl(4) else { return };
    let mut studio = studio();
    studio
        .start_from_voxels(|[_, y, z]| y < 50 && !((20..32).contains(&y) && (44..56).contains(&z)));
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut scene = SceneAssembler::new();
    for i in 0..20 {
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(50.0, 26.0, 50.0 + 0.3 * i as f32), true);
        scene.follow_tick(&studio.world);
    }
    assert!(studio.world.edit_report(RIGHT).refused_by_closure > 0);
    let view =
        ViewSpec { eye: Vec3::new(0.6, 1.3, -0.1), at: STOOL_TOP + Vec3::Y * 0.2, angle: 0.7 };
    let mut frame = |time_seconds: f64| {
        let fresh = LatestInput { time_seconds, tick_fraction: 1.0, ..LatestInput::default() };
        scene.assemble_frame(&studio.world, &fresh);
        show.draw(&scene, true, RenderPath::Fast, &view).remove(0)
    };
    let pictures = [0.0, 0.1, 0.2].map(&mut frame);
    write_png_file("scene-refused", &pictures[0]);
    let last = (3..12).map(|i| frame(0.1 * f64::from(i))).last().expect("a picture");
    let seen = pictures.map(|picture| count_differing(&picture, &last));
    assert!(seen[2] > 100 && seen[0] < 20_000, "{seen:?} pixels show the mark");
}

#[test]
fn without_a_scene_nothing_but_the_sculpture_is_drawn() {
    let Some(mut show) = SceneRig::with_owl(1) else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (name, path) in PATHS {
        let before = show.draw_alone(&scene, path);
        write_png_file(&format!("scene-{name}-alone"), &before);
        // The shadow map of a scene doesn't affect a picture without a scene.
        show.draw(&scene, true, path, &VISITOR);
        let after = show.draw_alone(&scene, path);
        assert_eq!(count_differing(&before, &after), 0, "{name}");
        let backdrop = before[0];
        let drawn = before.iter().filter(|pixel| **pixel != backdrop).count();
        assert!(drawn > 4_000 && drawn < before.len() / 4, "{name}: {drawn} pixels");
    }
}
