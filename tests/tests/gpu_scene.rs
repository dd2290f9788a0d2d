//! The studio drawn by the renderer, from the visitor's eyes. Pictures go to the target's folder
//! for temporary files.

use std::path::PathBuf;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::input::Mode;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::tools::Tool;
use paros_core::workbench::Item;
use paros_shaders::field::Field;
use paros_shaders::gpu::{Context, Eye, Fov, Look, Parts, Path, Picture, Stand};
use paros_shaders::scene::{Assembly, Fresh, MeshId, SKY, SUN_DIRECTION};
use paros_shell::figures::Figure;
use paros_tests::models::desk::{Desk, Layers, device};
use paros_tests::models::puppet::{RIGHT, reach, take};
use paros_tests::models::studio::Studio;

const N: usize = 128;
const PATHS: [(&str, Path); 2] = [("fast", Path::Fast), ("paper", Path::Paper(Parts::Whole))];

static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());

fn studio() -> MutexGuard<'static, Studio<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A desk and what it shows: the owl, or nothing.
struct Show {
    desk: Desk,
    /// How far the figure is turned, beyond the stool.
    turn: f32,
}

const SIZE: [u32; 2] = [640, 480];

impl Show {
    /// The owl for one eye, or none where there is no device.
    fn of_owl(samples: u32) -> Option<Self> {
        Some(Self::on(&device()?, [samples, 1]))
    }

    fn on(gpu: &Context, kind: [u32; 2]) -> Self {
        let mut show = Show { desk: Desk::new(gpu, N, kind, SIZE), turn: 0.0 };
        show.owl();
        show
    }

    fn owl(&mut self) {
        self.desk.load(&FIELDS[0]);
    }

    fn nothing(&mut self) {
        self.desk.load(&FIELDS[1]);
    }

    /// A picture of the scene, or of the sculpture alone, for each eye.
    fn draw(&mut self, scene: &Assembly, with_scene: bool, path: Path, view: &View) -> Layers {
        let views = self.desk.renderer.format().views;
        let eyes: Vec<Eye> = (0..views).map(|i| view.eye(i, views)).collect();
        let pose = scene.sculpture();
        let shown = SKY.map(|c| c * (1.0 + 0.25 * c) / (1.0 + c));
        self.desk.draw(&Picture {
            eyes: &eyes,
            stand: Stand { foot: pose.foot, side: pose.side, turn: pose.turn + self.turn },
            look: Look::studio(path),
            scene: with_scene.then(|| scene.list()),
            backdrop: shown,
        })
    }

    /// The same for one eye.
    fn draws(&mut self, scene: &Assembly, path: Path) -> Vec<[u8; 4]> {
        self.draw(scene, true, path, &VISITOR).remove(0)
    }

    fn draws_alone(&mut self, scene: &Assembly, path: Path) -> Vec<[u8; 4]> {
        self.draw(scene, false, path, &VISITOR).remove(0)
    }
}

/// Where the picture is taken from.
#[derive(Clone, Copy)]
struct View {
    eye: Vec3,
    at: Vec3,
    angle: f32,
}

/// A standing visitor.
const VISITOR: View =
    View { eye: Vec3::new(0.0, 1.6, 0.25), at: Vec3::new(0.05, 1.0, -0.75), angle: 1.2 };

impl View {
    fn rotation(&self) -> Quat {
        let ahead = (self.at - self.eye).normalize();
        let right = ahead.cross(Vec3::Y).normalize();
        Quat::from_mat3(&glam::Mat3::from_cols(right, right.cross(ahead), -ahead))
    }

    /// One of so many eyes.
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

    /// The pixel that shows a point of the room to one eye of one.
    fn pixel(&self, point: Vec3) -> usize {
        let clip = self.eye(0, 1).clip_from_room() * point.extend(1.0);
        let [w, h] = SIZE.map(|pixels| pixels as f32);
        let x = ((clip.x / clip.w * 0.5 + 0.5) * w) as usize;
        let y = ((clip.y / clip.w * 0.5 + 0.5) * h) as usize;
        y * SIZE[0] as usize + x
    }
}

/// The textures of a figure, and of nothing.
static FIELDS: LazyLock<[Box<Field<N>>; 2]> = LazyLock::new(|| {
    let mut plane: Box<Plane<N>> = Box::new(Plane::new());
    let mut maps: Box<Maps<N>> = Box::new(Maps::new());
    let mut fields = [Box::new(Field::new()), Box::new(Field::new())];
    fields[1].rebuild(&maps);
    Figure::Owl.carve_into(&mut plane, &mut maps);
    fields[0].rebuild(&maps);
    fields
});

/// The studio at rest, the rotary tool in the right hand at a grip.
fn held_at(grip: Vec3, rotation: Quat) -> Assembly {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut scene = Assembly::new();
    let fresh = Fresh {
        grips: [None, Some((grip, rotation))],
        hands: true,
        fraction: 1.0,
        ..Fresh::default()
    };
    scene.assemble(&studio.world, &fresh);
    scene
}

fn write(name: &str, pixels: &[[u8; 4]]) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let mut image = paros_shaders::Image::filled(SIZE[0] as usize, SIZE[1] as usize, [0; 3]);
    for (to, from) in image.pixels.chunks_exact_mut(3).zip(pixels) {
        to.copy_from_slice(&from[..3]);
    }
    let file = std::fs::File::create(folder.join(format!("{name}.png"))).expect("a file");
    image.write_png(file).expect("a picture");
}

fn sum(pixel: [u8; 4]) -> i32 {
    pixel[..3].iter().map(|c| i32::from(*c)).sum()
}

/// How many pixels differ by more than a shade.
fn differing(a: &[[u8; 4]], b: &[[u8; 4]]) -> usize {
    let far = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|i| a[i].abs_diff(b[i]) > 8);
    a.iter().zip(b).filter(far).count()
}

const ASIDE: (Vec3, Quat) = (Vec3::new(0.32, 1.15, -0.25), Quat::IDENTITY);

#[test]
fn the_room_is_drawn_from_the_visitors_eyes() {
    let Some(gpu) = device() else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (samples, views) in [(1, 1), (4, 1), (4, 2)] {
        let mut show = Show::on(&gpu, [samples, views]);
        for (name, path) in PATHS {
            let layers = show.draw(&scene, true, path, &VISITOR);
            for (i, layer) in layers.iter().enumerate() {
                write(&format!("scene-{name}-{samples}-{views}-{i}"), layer);
            }
            let times = show.desk.renderer.times();
            if gpu.needs.timestamp_period > 0 {
                assert!(times.shadow > 0 && times.scene > 0, "{times:?}");
            }
            if let [left, right] = &layers[..] {
                assert!(differing(left, right) > left.len() / 20, "{name}: the eyes see the same");
            }
        }
        if (samples, views) == (1, 1) {
            for (name, path) in PATHS {
                shadow_falls(&mut show, name, path);
            }
        }
    }
}

/// The figure's shadow lies on the stool: away from the sun, which stands to the left and behind
/// the visitor.
fn shadow_falls(show: &mut Show, name: &str, path: Path) {
    let scene = held_at(ASIDE.0, ASIDE.1);
    let with = show.draws(&scene, path);
    show.nothing();
    let without = show.draws(&scene, path);
    write(&format!("scene-{name}-empty"), &without);
    show.owl();
    let mut dark = 0;
    let sun = Vec3::from_array(SUN_DIRECTION);
    let ground = |height: f32| STOOL - Vec3::new(sun.x, 0.0, sun.z) * (height / sun.y);
    for i in 0..10 {
        // Where the shadow of the figure's axis falls on the stool's top, beside the figure.
        let at = VISITOR.pixel(ground((0.3 + 0.01 * i as f32) * BOX));
        dark += i32::from(sum(with[at]) * 10 < sum(without[at]) * 8);
        // Towards the sun there is none.
        let at = VISITOR.pixel(ground((-0.3 - 0.01 * i as f32) * BOX));
        assert!((sum(with[at]) - sum(without[at])).abs() < 12, "{name}: dark towards the sun");
    }
    assert!(dark >= 9, "{name}: {dark} places of 10 lie in the sculpture's shadow");
}

#[test]
fn tools_and_sculpture_hide_each_other() {
    let Some(mut show) = Show::of_owl(1) else { return };
    let middle = STOOL + Vec3::Y * (0.4 * BOX);
    let ahead = (VISITOR.eye - middle).normalize();
    for (name, path) in PATHS {
        // The tool's tip points up in both, before the figure and behind it.
        for (place, towards, hides) in [("before", 0.35, true), ("behind", -0.30, false)] {
            let grip = middle + ahead * towards;
            let scene = held_at(grip, Quat::from_rotation_x(1.2));
            show.owl();
            let both = show.draws(&scene, path);
            write(&format!("scene-{name}-{place}"), &both);
            show.nothing();
            let tool = show.draws(&scene, path);
            // Where the tool is, seen from its instance's own points.
            let (mut seen, mut all) = (0, 0);
            for instance in scene.list().of(MeshId::of_tool(Tool::Rotary)) {
                for vertex in MeshId::of_tool(Tool::Rotary).vertices() {
                    let point = instance.place(Vec3::from_array(vertex.position));
                    let at = VISITOR.pixel(point);
                    all += 1;
                    seen += i32::from(differing(&tool[at..=at], &both[at..=at]) == 0);
                }
            }
            let part = seen as f32 / all as f32;
            assert!(hides == (part > 0.8), "{name}, {place}: {part} of the tool is as without");
        }
    }
}

/// A hand between the sun and the box, out of which the figure's own rays have passed there.
#[test]
fn shadows_fall_on_the_sculpture() {
    let Some(mut show) = Show::of_owl(1) else { return };
    let middle = STOOL + Vec3::Y * (0.3 * BOX);
    let lit = held_at(ASIDE.0, ASIDE.1);
    let hidden = held_at(middle + Vec3::from_array(SUN_DIRECTION) * 0.6, ASIDE.1);
    for (name, path) in PATHS {
        let light = show.draws(&lit, path);
        let dark = show.draws(&hidden, path);
        write(&format!("scene-{name}-hidden"), &dark);
        let alone = show.draws_alone(&lit, path);
        // Where the sun's rays meet nothing else, the figure is as it is alone.
        let on_figure = alone.iter().map(|pixel| *pixel != alone[0]);
        let (mut all, mut darker, mut lighter) = (0, 0, 0);
        for ((light, dark), _) in light.iter().zip(&dark).zip(on_figure).filter(|(_, on)| *on) {
            all += 1;
            darker += i32::from(sum(*dark) * 10 < sum(*light) * 9);
            lighter += i32::from(sum(*dark) * 9 > sum(*light) * 10);
        }
        assert!(darker * 12 > all && lighter == 0, "{name}: {darker} of {all}, {lighter} lighter");
    }
}

/// The map holds the figure too, but nothing of it is beyond where its own rays leave the box.
#[test]
fn the_figure_is_lit_as_it_is_alone() {
    let Some(mut show) = Show::of_owl(1) else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (name, path) in PATHS {
        for turn in 0..8 {
            show.turn = turn as f32 * 0.7;
            let alone = show.draws_alone(&scene, path);
            let within = show.draws(&scene, path);
            // Lower down the stool's top may hide what stands on it.
            let above = alone.iter().zip(&within).take(VISITOR.pixel(STOOL));
            let on_figure = above.filter(|(pixel, _)| **pixel != alone[0]);
            let other = on_figure.filter(|(a, b)| (sum(**a) - sum(**b)).abs() > 3).count();
            assert_eq!(other, 0, "{name}, turned by {}: pixels in its own shadow", show.turn);
        }
    }
}

#[test]
fn chips_are_drawn_and_fade() {
    let Some(mut show) = Show::of_owl(4) else { return };
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut scene = Assembly::new();
    for i in 0..300 {
        reach(&mut studio, RIGHT, Vec3::new(63.0 - 0.1 * i as f32, 30.0, 32.0), true);
        scene.follow(&studio.world);
        if scene.particles().alive() > 12 {
            break;
        }
    }
    let view = View { eye: Vec3::new(0.5, 1.2, 0.0), at: STOOL + Vec3::Y * 0.2, angle: 0.7 };
    let mut frame = |time: f64| {
        let fresh = Fresh { time, fraction: 1.0, ..Fresh::default() };
        scene.assemble(&studio.world, &fresh);
        show.draw(&scene, true, Path::Fast, &view).remove(0)
    };
    let pictures = [0.0, 0.1, 0.2].map(&mut frame);
    write("scene-chips", &pictures[1]);
    let mut last = Vec::new();
    for i in 3..40 {
        last = frame(0.1 * f64::from(i));
    }
    let seen = pictures.map(|picture| differing(&picture, &last));
    assert!(seen.iter().all(|count| (8..20_000).contains(count)), "{seen:?} pixels show chips");
}

#[test]
fn without_a_scene_nothing_but_the_sculpture_is_drawn() {
    let Some(mut show) = Show::of_owl(1) else { return };
    let scene = held_at(ASIDE.0, ASIDE.1);
    for (name, path) in PATHS {
        let before = show.draws_alone(&scene, path);
        write(&format!("scene-{name}-alone"), &before);
        // What the map holds of a scene doesn't matter to a picture without one.
        show.draw(&scene, true, path, &VISITOR);
        let after = show.draws_alone(&scene, path);
        assert_eq!(differing(&before, &after), 0, "{name}");
        let backdrop = before[0];
        let drawn = before.iter().filter(|pixel| **pixel != backdrop).count();
        assert!(drawn > 4_000 && drawn < before.len() / 4, "{name}: {drawn} pixels");
    }
}
