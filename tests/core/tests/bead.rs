//! Paste as a bead: a steady stroke of the fill gun lays an even line at any speed of the hand.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::session::{BenchItem, Tool, commands};
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, WorldEvent};
use paros_models::cases::sample_cases;
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{BOX_MM, RIGHT, input_with_bit_at, take_item, volume_of};
use paros_models::world_harness::WorldHarness;

static SMALL: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

/// The top of the stone in its box, and the nozzle's radius, in millimetres.
const TOP_MM: f32 = 225.0;
const NOZZLE_MM: f32 = 12.0;

/// The thickness of the slices that are compared: four layers of voxels at 128.
const SLICE_MM: f32 = BOX_MM / 32.0;

/// Speeds of a hand, in m/s.
const SPEEDS: [f32; 4] = [0.1, 0.3, 0.6, 1.0];

/// A straight path of the nozzle's centre, in millimetres.
#[derive(Clone, Copy, Debug)]
struct Way {
    from: Vec3,
    to: Vec3,
}

/// Returns the paths: over flat stone, half sunk and on top, straight and oblique; and off its edge into the
/// air, where only the bead itself supports what follows. The stone ends at x = 300.
fn ways() -> [Way; 5] {
    let at = Vec3::new;
    let along_z = |x, above, z| at(x, TOP_MM + above, z);
    [
        Way { from: along_z(181.3, 0.7, 60.0), to: along_z(181.3, 0.7, 390.0) },
        Way { from: along_z(181.3, 10.3, 60.0), to: along_z(181.3, 10.3, 390.0) },
        Way { from: at(60.0, 229.0, 81.0), to: at(270.0, 231.0, 333.0) },
        Way { from: at(240.0, 235.5, 200.2), to: at(430.0, 235.5, 200.2) },
        Way { from: at(240.0, 228.0, 100.0), to: at(420.0, 321.0, 280.0) },
    ]
}

/// A fill gun in the right hand.
struct Gun<'a, const N: usize>
where
    Grid<N>: Size,
{
    harness: &'a mut WorldHarness<N, 2>,
    /// Number of voxels laid, including those that fall later.
    added: u32,
}

impl<const N: usize> Gun<'_, N>
where
    Grid<N>: Size,
{
    fn step_at(&mut self, place_mm: Vec3, trigger: u8) {
        let input = input_with_bit_at(self.harness, place_mm, Quat::IDENTITY, trigger);
        self.harness.step(&input);
        for event in self.harness.world.events() {
            if let WorldEvent::Edited { report, .. } = event {
                self.added += report.added;
            }
        }
    }

    /// Lays a bead.
    fn lay(&mut self, way: &Way, speed: f32) -> DenseVolume {
        self.lay_after(way, speed, 0)
    }

    /// Lays a bead with the symmetry mirror on.
    fn lay_mirrored(&mut self, way: &Way, speed: f32) -> DenseVolume {
        self.lay_after(way, speed, commands::SYMMETRY)
    }

    /// Lays a bead after some commands, releases the trigger at the end of the path, and waits for pending
    /// work. Returns the voxels laid.
    fn lay_after(&mut self, way: &Way, speed: f32, commands: u8) -> DenseVolume {
        let voxel = BOX_MM / N as f32;
        let is_stone = |at: f32, end: f32| (at + 0.5) * voxel < end;
        self.harness
            .start_from_voxels(|[x, y, _]| is_stone(x as f32, 300.0) && is_stone(y as f32, TOP_MM));
        take_item(self.harness, RIGHT, BenchItem::Tool(Tool::FillGun));
        self.harness.step(&TickInput { commands, ..TickInput::default() });
        let before = volume_of(self.harness);
        (0..3).for_each(|_| self.step_at(way.from + Vec3::Y * 60.0, 0));
        (0..3).for_each(|_| self.step_at(way.from, 0));
        let ticks = (way.from.distance(way.to) / speed * 72e-3).round();
        for tick in 0..=ticks as u32 {
            self.step_at(way.from.lerp(way.to, tick as f32 / ticks), 255);
        }
        (0..8).for_each(|_| self.step_at(way.to, 0));
        // Waits until islands have fallen.
        (0..40).for_each(|_| self.harness.step(&TickInput::default()));
        volume_of(self.harness).difference(&before)
    }
}

/// Returns the bead's cross-section in cubic millimetres a millimetre, in slices across the path, without its
/// ends.
fn cross_sections(laid: &DenseVolume, way: &Way) -> Vec<f32> {
    let voxel = BOX_MM / laid.side() as f32;
    let (length, ahead) = (way.from.distance(way.to), (way.to - way.from).normalize());
    let first = NOZZLE_MM + 3.6;
    let mut slices = vec![0.0; ((length - 2.0 * first) / SLICE_MM) as usize];
    for place in laid.occupied() {
        let middle = (Vec3::from_array(place.map(|i| i as f32)) + 0.5) * voxel;
        let along = (middle - way.from).dot(ahead) - first;
        if let Some(slice) = slices.get_mut((along / SLICE_MM).floor() as usize)
            && along >= 0.0
        {
            *slice += voxel.powi(3) / SLICE_MM;
        }
    }
    slices
}

/// Asserts that on each path the cross-sections of all speeds together are even.
fn check_beads<const N: usize>(
    harness: &Mutex<WorldHarness<N, 2>>,
    ways: impl Iterator<Item = Way>,
    speeds: &[f32],
) where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(PoisonError::into_inner);
    for way in ways {
        let lay = |speed: &f32| Gun { harness: &mut harness, added: 0 }.lay(&way, *speed);
        let laid: Vec<_> = speeds.iter().map(lay).collect();
        let sections: Vec<_> = laid.iter().flat_map(|laid| cross_sections(laid, &way)).collect();
        let mean = sections.iter().sum::<f32>() / sections.len() as f32;
        let [least, most] = [f32::min, f32::max].map(|of| sections.iter().copied().fold(mean, of));
        println!("{N} {way:?}: {mean:.0} mm2, {:.3} to {:.3} of it", least / mean, most / mean);
        assert!(mean > 100.0 && least > 0.85 * mean && most < 1.15 * mean, "{N} {way:?}");
        for laid in &laid {
            let first = laid.occupied().next().expect("a bead");
            assert_eq!(laid.connected_to(vec![first]), *laid, "{N} {way:?} in parts");
        }
    }
}

#[test]
fn a_bead_is_even_at_every_speed_at_128() {
    check_beads(&SMALL, ways().into_iter(), &SPEEDS);
}

/// Tests one path at a slow and a quick speed; the nightly run tests all paths at every speed.
#[test]
fn a_bead_is_even_at_every_speed_at_256() {
    let speeds: Vec<f32> = sample_cases(SPEEDS.into_iter().rev(), 2).collect();
    check_beads(&LARGE, sample_cases(ways(), 5), &speeds);
}

/// A nozzle in the air, a finger above the stone, lays nothing, even if its mirror image touches the stone.
#[test]
fn paste_holds_to_what_it_touches() {
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut gun = Gun { harness: &mut harness, added: 0 };
    let at = |x: f32, y: f32| Way { from: Vec3::new(x, y, 100.0), to: Vec3::new(x, y, 300.0) };
    gun.lay(&at(150.0, TOP_MM + NOZZLE_MM + 10.0), 0.3);
    // A nozzle in the air lays nothing, though its mirror image is on the stone.
    gun.lay_mirrored(&at(BOX_MM - 100.0, TOP_MM + 5.0), 0.3);
    assert_eq!(gun.added, 0, "in the air");
    // The mirror image of x = 100 is beside the stone, and that of x = 200 is on it.
    for (x, is_image_held) in [(100.0, false), (200.0, true)] {
        gun.added = 0;
        let laid = gun.lay_mirrored(&at(x, TOP_MM + 5.0), 0.3);
        let own = laid.occupied().filter(|at| at[0] < 64).count() as u32;
        assert!(own > 1000, "{own} voxels at {x}");
        assert_eq!(gun.added, if is_image_held { 2 * own } else { own }, "at {x}");
    }
}
