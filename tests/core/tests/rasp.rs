//! The rasp at work: its effect on ripples, edges and balls, in millimetres.

use std::f32::consts::{PI, TAU};
use std::sync::{Mutex, PoisonError};

use glam::{EulerRot, Quat, Vec2, Vec3};
use paros_core::session::{BenchItem, Tool};
use paros_core::volume::{Grid, Size};
use paros_models::cases::sample_cases;
use paros_models::scripted_hand::{BOX_MM, RIGHT, input_with_bit_at, start_from_stone, take_item};
use paros_models::world_harness::WorldHarness;

static SMALL: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

const TICKS_PER_SECOND: f32 = 72.0;

const WAVE_MM: f32 = 85.0;

/// Trigger values: fully and lightly pulled.
const FULL: u8 = 255;
const LIGHT: u8 = 150;

/// A rasp in the right hand, at a stone. Lengths are in millimetres of the stone's box.
struct Rasp<'a, const N: usize>(&'a mut WorldHarness<N, 2>)
where
    Grid<N>: Size;

impl<'a, const N: usize> Rasp<'a, N>
where
    Grid<N>: Size,
{
    /// Holds the rasp at a stone made of all voxels whose centres satisfy `is_stone`.
    fn take(harness: &'a mut WorldHarness<N, 2>, is_stone: impl Fn(Vec3) -> bool) -> Self {
        start_from_stone(harness, is_stone);
        take_item(harness, RIGHT, BenchItem::Tool(Tool::Rasp));
        Rasp(harness)
    }

    /// Runs a tick with the file's centre at a place.
    fn step_at(&mut self, place: Vec3, rotation: Quat, trigger: u8) {
        let input = input_with_bit_at(self.0, place, rotation, trigger);
        self.0.step(&input);
    }

    /// Returns the top of the stone in a column, in millimetres.
    fn height_at(&self, [x, z]: [usize; 2]) -> f32 {
        let rows = self.0.world.volume().rows();
        let top = (0..N).rev().find(|&y| rows.contains([x, y, z]));
        top.map_or(0.0, |top| (top + 1) as f32 * BOX_MM / N as f32)
    }

    /// Returns the columns within ranges of x and z.
    fn columns_of(x: [f32; 2], z: [f32; 2]) -> Vec<[usize; 2]> {
        let to_voxels = |ends: [f32; 2]| ends.map(|end| (end * N as f32 / BOX_MM).round() as usize);
        let [xs, zs] = [x, z].map(to_voxels);
        (xs[0]..xs[1]).flat_map(|x| (zs[0]..zs[1]).map(move |z| [x, z])).collect()
    }

    fn mean_height_of(&self, x: [f32; 2], z: [f32; 2]) -> f32 {
        let columns = Self::columns_of(x, z);
        columns.iter().map(|&column| self.height_at(column)).sum::<f32>() / columns.len() as f32
    }

    /// Returns the amplitude of the height ripple with wavelength [`WAVE_MM`] along x, over whole waves. The
    /// surface's slope is ignored.
    fn ripple_of(&self, x: [f32; 2], z: [f32; 2]) -> f32 {
        let columns = Self::columns_of(x, z);
        let places = columns.iter().map(|&column| {
            let x_mm = (column[0] as f32 + 0.5) * BOX_MM / N as f32 - (x[0] + x[1]) / 2.0;
            Vec2::new(x_mm, self.height_at(column))
        });
        let mean = places.clone().sum::<Vec2>() / columns.len() as f32;
        let of_slope = places.clone().map(|place| place - mean);
        let (rise, run) = of_slope.fold((0.0, 0.0), |(rise, run), place| {
            (rise + place.x * place.y, run + place.x * place.x)
        });
        let waves = places.map(|place| {
            let height = place.y - mean.y - rise / run * (place.x - mean.x);
            Vec2::from_angle(TAU * place.x / WAVE_MM) * height
        });
        2.0 * waves.sum::<Vec2>().length() / columns.len() as f32
    }
}

/// Returns the amplitude left of 10 mm ripples after the file has moved to and fro until it has spent half a
/// second at each place.
fn ripple_after<const N: usize>(harness: &mut WorldHarness<N, 2>, (speed, press): (f32, f32)) -> f32
where
    Grid<N>: Size,
{
    let mut rasp = Rasp::take(harness, |p| p.y < 200.0 + 10.0 * (TAU * p.x / WAVE_MM).sin());
    let (xs, zs) = ([145.0, 145.0 + WAVE_MM], [195.0, 225.0]);
    let height = rasp.mean_height_of(xs, zs);
    // Strokes of 180 mm with a file of 20 mm in three lanes: a single lane would stay bent between its edges.
    let ways = 3.0 * f32::ceil(0.5 * speed / 20.0);
    let ticks = (ways * 180.0 / speed * TICKS_PER_SECOND).round() as usize;
    let place_after = |tick: usize| {
        let gone = speed * tick as f32 / TICKS_PER_SECOND;
        let lane = f32::floor(gone / 180.0) % 3.0 - 1.0;
        let x = 280.0 - (gone % 360.0 - 180.0).abs();
        Vec3::new(x, 207.0 - press, 210.0 + 45.0 * lane)
    };
    rasp.step_at(place_after(0) + 30.0 * Vec3::Y, Quat::IDENTITY, 0);
    (0..ticks).for_each(|tick| rasp.step_at(place_after(tick), Quat::IDENTITY, FULL));
    (0..6).for_each(|_| rasp.step_at(place_after(ticks), Quat::IDENTITY, 0));
    let change = rasp.mean_height_of(xs, zs) - height;
    assert!(change.abs() < 1.0, "{N}, {speed} mm/s: {change} mm higher");
    rasp.ripple_of(xs, zs)
}

/// Tests a quick hand and a slow hand; at 256 the slow hand runs only in the nightly run.
fn ripples_fall_to_a_tenth<const N: usize>(harness: &Mutex<WorldHarness<N, 2>>)
where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    for strokes in sample_cases([(500.0, 15.0), (150.0, 5.0)], if N > 128 { 2 } else { 1 }) {
        let left = ripple_after(harness, strokes);
        println!("{N}, mm/s and mm deep {strokes:?}: {left:.2} mm of 10");
        assert!(left < 1.0, "{N}, {strokes:?}: {left} mm of 10");
    }
}

#[test]
fn ripples_fall_to_a_tenth_at_128() {
    ripples_fall_to_a_tenth(&SMALL);
}

#[test]
fn ripples_fall_to_a_tenth_at_256() {
    ripples_fall_to_a_tenth(&LARGE);
}

/// Holds the file for half a second on an edge of 90 degrees, at 45 degrees to its faces. Returns the radius
/// of the fillet that would remove as much from the edge.
fn fillet_of_edge<const N: usize>(harness: &mut WorldHarness<N, 2>, trigger: u8) -> f32
where
    Grid<N>: Size,
{
    let mut rasp = Rasp::take(harness, |p| p.x < 225.0 && p.y < 225.0);
    let rotation = Quat::from_rotation_z(-TAU / 8.0);
    let corner = Vec3::new(225.0, 225.0, 225.0);
    rasp.step_at(corner + Vec3::new(30.0, 30.0, 0.0), rotation, 0);
    let place = corner - Vec3::new(2.0, 2.0, 0.0);
    (0..36).for_each(|_| rasp.step_at(place, rotation, trigger));
    (0..6).for_each(|_| rasp.step_at(place, rotation, 0));
    let rows = rasp.0.world.volume().rows();
    let (corner, layers) = (N / 2, N / 2 - 2..N / 2 + 2);
    let columns = (corner / 2..corner).flat_map(|x| (corner / 2..corner).map(move |y| [x, y]));
    let places = columns.flat_map(|[x, y]| layers.clone().map(move |z| [x, y, z]));
    let missing =
        places.filter(|&place| !rows.contains(place)).count() as f32 / layers.len() as f32;
    (missing / (1.0 - PI / 4.0)).sqrt() * BOX_MM / N as f32
}

#[test]
fn a_light_file_keeps_an_edge() {
    let small = &mut *SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let large = &mut *LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let [light, full] = [LIGHT, FULL]
        .map(|trigger| [fillet_of_edge(small, trigger), fillet_of_edge(large, trigger)]);
    println!("fillets of {light:.1?} mm, and {full:.1?} mm");
    assert!(light.iter().all(|&fillet| fillet <= 15.0), "{light:?} mm");
    assert!(full.iter().zip(light).all(|(full, light)| *full > 1.5 * light), "{full:?} mm");
}

/// Rasps a ball of 140 mm radius all over for ten seconds. Asserts that the radius changes by at most 1.8 mm,
/// plus half a voxel for the grid.
fn ball_keeps_its_radius<const N: usize>(harness: &Mutex<WorldHarness<N, 2>>)
where
    Grid<N>: Size,
{
    const RADIUS: f32 = 140.0;
    let middle = Vec3::splat(BOX_MM / 2.0);
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let mut rasp = Rasp::take(harness, |p| p.distance(middle) < RADIUS);
    let mut turn_to = |angle: f32, height: f32, trigger: u8| {
        let rotation = Quat::from_euler(EulerRot::YXZ, angle, height, 0.0);
        // The file's wide lower face lies on the ball.
        let place = middle + rotation * (RADIUS + 4.0) * Vec3::Y;
        rasp.step_at(place, rotation, trigger);
    };
    turn_to(0.0, 0.2, 0);
    let ticks = 10 * TICKS_PER_SECOND as usize;
    for tick in 0..ticks {
        let part = tick as f32 / ticks as f32;
        // From the top to the equator, in twelve rounds.
        turn_to(12.0 * TAU * part, 0.2 + 1.4 * part, FULL);
    }
    (0..6).for_each(|_| turn_to(0.0, 1.6, 0));
    let rows = rasp.0.world.volume().rows();
    let voxel = BOX_MM / N as f32;
    let mut worst: f32 = 0.0;
    for round in 0..64 {
        for step in 0..24 {
            let height = 0.3 + 1.2 * step as f32 / 24.0;
            let angle = TAU * round as f32 / 64.0;
            let out = Quat::from_euler(EulerRot::YXZ, angle, height, 0.0) * Vec3::Y;
            let is_stone = |radius: f32| {
                let voxel = ((middle + radius * out) / voxel).floor().max(Vec3::ZERO);
                rows.contains(voxel.to_array().map(|i| (i as usize).min(N - 1)))
            };
            let radius = (0..200).map(|i| 160.0 - 0.25 * i as f32).find(|&r| is_stone(r));
            worst = worst.max((radius.unwrap_or(0.0) - RADIUS).abs());
        }
    }
    println!("{N}: radius off by {worst:.2} mm at most");
    assert!(worst <= 1.8 + voxel / 2.0, "{worst} mm");
}

#[test]
fn a_ball_keeps_its_radius() {
    ball_keeps_its_radius(&SMALL);
    ball_keeps_its_radius(&LARGE);
}

/// The running file dithers its cut; a few ticks after its release no grain is left on a flat face.
#[test]
fn no_grain_is_left() {
    let harness = &mut *LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut rasp = Rasp::take(harness, |p| p.y < 200.0 + 0.1 * p.x);
    let place_after = |tick: usize| Vec3::new(150.0 + 2.0 * tick as f32, 222.0, 210.0);
    rasp.step_at(place_after(0) + 30.0 * Vec3::Y, Quat::IDENTITY, 0);
    (0..72).for_each(|tick| rasp.step_at(place_after(tick), Quat::IDENTITY, FULL));
    let grain = |rasp: &Rasp<'_, 256>| {
        let columns = Rasp::<256>::columns_of([150.0, 300.0], [180.0, 240.0]);
        let is_pit_or_peak = |&&[x, z]: &&[usize; 2]| {
            let around = [[x - 1, z], [x + 1, z], [x, z - 1], [x, z + 1]];
            let rises = around.map(|column| rasp.height_at(column) - rasp.height_at([x, z]));
            rises.iter().all(|&rise| rise > 0.0) || rises.iter().all(|&rise| rise < 0.0)
        };
        columns.iter().filter(is_pit_or_peak).count()
    };
    let running = grain(&rasp);
    (0..6).for_each(|_| rasp.step_at(place_after(72), Quat::IDENTITY, 0));
    let finished = grain(&rasp);
    println!("{running} pits and peaks while it runs, {finished} after");
    assert!(running > 0, "the dither shows while the file runs");
    assert_eq!(finished, 0, "pits and peaks");
}
