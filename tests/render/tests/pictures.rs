//! The CPU twin's light, noise, camera and whole pictures.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use paros_core::RangeMaps;
use paros_models::dense::DenseVolume;
use paros_models::twin::{
    self as model, BALL_CENTRE, BALL_RADIUS, sample_directions, with_maps_of_16, with_maps_of_ball,
};
use paros_shaders::harmonics::sh_basis;
use paros_shaders::{
    Camera, Image, RenderOptions, TwinScene, TwinSettings, constants, contact_sheet, light, noise,
    render_image, shade_ray,
};

#[test]
fn depth_and_position_agree_with_the_turned_stool() {
    with_maps_of_ball(|maps| {
        let scene = TwinScene::new(maps, 0.7, TwinSettings::default());
        let camera = Camera::orbiting(0.0, 0.3);
        let mut hits = 0;
        for (x, y) in (0..400).map(|i| (i as f32 % 20.0 / 10.0 - 1.0, i as f32 / 200.0 - 1.0)) {
            let ray = camera.ray_through(x, y);
            if let Some(hit) = shade_ray(&scene, &ray, 0.5) {
                assert!((ray.at(hit.depth) - hit.position).length() < 1e-4);
                let inside = scene.point_to_grid(hit.position);
                assert!(((inside - BALL_CENTRE).length() - BALL_RADIUS).abs() < 1.0);
                assert!((scene.point_to_studio(inside) - hit.position).length() < 1e-5);
                hits += 1;
            }
        }
        assert!(hits > 40, "{hits}");
    });
}

#[test]
fn azimuth_chooses_the_side() {
    let cross = DenseVolume::from_fn(16, |[x, y, z]| {
        y < 12 && ((6..10).contains(&x) || (6..10).contains(&z))
    });
    with_maps_of_16(&cross, |maps| {
        for (quarter, axis, end) in [(0, 2, 15), (1, 0, 15), (2, 2, 0), (3, 0, 0)] {
            let camera = Camera::orbiting(quarter as f32 * std::f32::consts::FRAC_PI_2, 0.0);
            let scene = TwinScene::new(maps, -camera.azimuth, TwinSettings::default());
            let hit = shade_ray(&scene, &camera.ray_through(0.0, 0.0), 0.5)
                .expect("the cross fills the centre");
            assert_eq!(hit.voxel[axis], end, "azimuth {quarter} quarters");
        }
    });
}

#[test]
fn ambient_constants_are_the_projected_environment() {
    let vec = |d: [f64; 3]| Vec3::from_array(d.map(|c| c as f32));
    for (i, color) in constants::AMBIENT_HARMONICS.into_iter().enumerate() {
        for (channel, stored) in color.into_iter().enumerate() {
            let projected = model::integrate_over_sphere(|d| {
                f64::from(light::environment_radiance(vec(d))[channel] * sh_basis(vec(d))[i])
            });
            let stored = f64::from(stored);
            assert!(
                (projected - stored).abs() < 2e-4,
                "{i}, {channel}: {projected} is stored as {stored}"
            );
        }
    }
    for normal in sample_directions().into_iter().step_by(7) {
        let exact = model::integrate_over_sphere(|d| {
            f64::from(light::environment_radiance(vec(d)).y * vec(d).dot(normal).max(0.0))
                / std::f64::consts::PI
        });
        let error = f64::from(light::ambient_over_pi(normal).y) / exact - 1.0;
        assert!(error.abs() < 0.05, "{normal}: {error}");
    }
}

#[test]
fn noise_is_smooth_repeats_and_vanishes_on_the_lattice() {
    let texture = noise::noise_texture();
    let period = constants::NOISE_CELLS as f32;
    let (mut worst, mut most) = (0.0f32, 0.0f32);
    for i in 0..4000u32 {
        let part = |salt: u32| noise::hash_u32(i * 3 + salt) as f32 / 4_294_967_296.0 * period;
        let at = Vec3::new(part(0), part(1), part(2));
        let exact = noise::gradient_noise(at);
        most = most.max(exact.abs());
        worst = worst.max((noise::sample_noise(texture, at) - exact).abs());
        assert!((noise::gradient_noise(at + Vec3::splat(period)) - exact).abs() < 1e-3);
        assert!(noise::gradient_noise(at.floor()).abs() < 1e-6);
    }
    assert!((0.5..=1.0).contains(&most), "{most}");
    assert!(worst < 0.15, "{worst}");
}

fn small_options(settings: TwinSettings) -> RenderOptions {
    RenderOptions { width: 96, height: 72, samples: 1, settings, fast: false }
}

fn render_in_threads(threads: usize, maps: &RangeMaps<64>, options: &RenderOptions) -> Image {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| render_image(maps, &Camera::orbiting(0.4, 0.2), options, &|_| ()))
}

#[test]
fn a_picture_does_not_depend_on_the_threads_or_the_march() {
    with_maps_of_ball(|maps| {
        let options = RenderOptions { samples: 2, ..small_options(TwinSettings::default()) };
        let one = render_in_threads(1, maps, &options);
        assert!(one == render_in_threads(3, maps, &options));
        let fast = RenderOptions { fast: true, ..options };
        assert!(render_in_threads(1, maps, &fast) == render_in_threads(3, maps, &fast));
        let full = TwinSettings { full_march: true, ..TwinSettings::default() };
        assert!(one == render_in_threads(2, maps, &RenderOptions { settings: full, ..options }));
    });
}

#[test]
fn a_picture_shows_a_ball_in_a_studio() {
    with_maps_of_ball(|maps| {
        let plain = TwinSettings { shading: false, ..TwinSettings::default() };
        let image = render_in_threads(2, maps, &small_options(plain));
        let studio = with_maps_of_16(&DenseVolume::empty(16), |empty| {
            render_image(empty, &Camera::orbiting(0.4, 0.2), &small_options(plain), &|_| ())
        });
        let ball =
            (0..96 * 72).filter(|i| image.pixel(i % 96, i / 96) != studio.pixel(i % 96, i / 96));
        // The ball's outline covers a disc, and its shadow some of the stool.
        let part = ball.count() as f32 / (96.0 * 72.0);
        assert!((0.10..0.35).contains(&part), "{part}");
        let lit = render_in_threads(2, maps, &small_options(TwinSettings::default()));
        let grey = |x, y| lit.pixel(x, y).map(u32::from).iter().sum::<u32>();
        assert!(grey(44, 24) > 3 * 180, "white marble in the sun: {}", grey(44, 24));
        assert!(grey(42, 24) > grey(54, 48) + 40, "the side away from the sun is darker");
    });
}

#[test]
fn progress_is_told_row_by_row() {
    with_maps_of_ball(|maps| {
        let calls = AtomicU32::new(0);
        let most = Mutex::new(0.0f32);
        let image = render_image(
            maps,
            &Camera::orbiting(0.0, 0.1),
            &small_options(TwinSettings::default()),
            &|part| {
                calls.fetch_add(1, Ordering::Relaxed);
                let mut most = most.lock().expect("no panic");
                *most = most.max(part);
            },
        );
        assert_eq!(calls.into_inner(), 72);
        assert_eq!(most.into_inner().expect("no panic"), 1.0);
        assert_eq!(image.pixels.len(), 96 * 72 * 3);
    });
}

#[test]
fn a_picture_without_pixels_is_no_error() {
    with_maps_of_ball(|maps| {
        for (width, height) in [(0, 5), (5, 0), (0, 0)] {
            let options = RenderOptions { width, height, ..small_options(TwinSettings::default()) };
            let image = render_image(maps, &Camera::orbiting(0.0, 0.1), &options, &|_| ());
            assert!(image.pixels.is_empty());
            assert!(image.write_png(Vec::new()).is_err());
        }
    });
}

#[test]
fn png_files_read_back() {
    let mut image = Image::filled(7, 5, [1, 2, 3]);
    image.pixels.iter_mut().enumerate().for_each(|(i, byte)| *byte = (i * 37) as u8);
    let mut file = Vec::new();
    image.write_png(&mut file).expect("a vector takes any picture");
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG file");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("a picture");
    assert_eq!((info.width, info.height, info.color_type), (7, 5, png::ColorType::Rgb));
    assert_eq!(pixels, image.pixels);
}

#[test]
fn contact_sheets_hold_every_picture() {
    let images: Vec<Image> = (1..=5).map(|i| Image::filled(10, 8, [i * 40, 0, 0])).collect();
    let sheet = contact_sheet(&images, 3);
    let reds = |level: u8| sheet.pixels.chunks(3).filter(|p| p[..] == [level, 0, 0]).count();
    for i in 1..=5 {
        assert_eq!(reds(i * 40), 80);
    }
    assert!(sheet.width > 30 && sheet.width < 60 && sheet.height > 16 && sheet.height < 40);
    let left =
        |level: u8| sheet.pixels.chunks(3).position(|p| p[..] == [level, 0, 0]).expect("there");
    assert_eq!(left(160) % sheet.width, left(40) % sheet.width, "the fourth starts the second row");
    assert!(contact_sheet(&[], 3).pixels.is_empty());
    assert!(contact_sheet(&images, 0).pixels.is_empty());
}
