//! The visual guides for the hands: the rim of the next bite on the stone, the hidden bit, and the mirror's
//! plane and reflection.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use paros_core::HandInput;
use paros_core::internals::STOOL_TOP;
use paros_core::session::{BenchItem, Tool, ToolBit, buttons};
use paros_models::scripted_hand::{
    RIGHT, hand_input_at, input_with_hand, step_with_bit_at, take_item,
};
use paros_models::world_harness::WorldHarness;
use paros_shaders::limits::BITE_DOTS;
use paros_shaders::scene::{DrawGroup, LatestInput, MeshId, MeshInstance, SceneAssembler};

static STUDIO: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

/// The top of the flat stone, in voxels.
const TOP: f32 = 30.0;

/// Starts with a flat stone, and the first bit of the rotary tool in the right hand.
fn lock_studio() -> MutexGuard<'static, WorldHarness<64>> {
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    studio.start_from_voxels(|[_, y, _]| y < TOP as usize);
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    studio
}

fn held_bit(studio: &WorldHarness<64>) -> ToolBit {
    studio.world.held_tool(RIGHT).expect("a tool").1
}

/// Returns the places of instances in voxels from the stone's corner; the stool isn't turned.
fn places(studio: &WorldHarness<64>, instances: &[MeshInstance]) -> Vec<Vec3> {
    let voxel = studio.world.stool_frame().voxel_metres();
    let corner = STOOL_TOP - Vec3::new(32.0, 0.0, 32.0) * voxel;
    let place = |one: &MeshInstance| (one.transform_point(Vec3::ZERO) - corner) / voxel;
    instances.iter().map(place).collect()
}

fn dots(studio: &WorldHarness<64>, latest: &LatestInput) -> Vec<Vec3> {
    let mut scene = SceneAssembler::new();
    let list = scene.assemble_frame(&studio.world, latest);
    // Excludes dust, which isn't amber.
    let specks = list.instances_of(MeshId::Speck).iter().copied();
    let amber: Vec<MeshInstance> = specks.filter(|speck| speck.tint[0] > 1.0).collect();
    places(studio, &amber)
}

#[test]
fn a_rim_of_dots_shows_what_the_next_bite_takes() {
    let mut studio = lock_studio();
    let radius = match held_bit(&studio).spec().shape {
        paros_core::internals::BitShape::Ball { radius_um } => radius_um as f32 * 1e-6,
        other => panic!("{other:?}"),
    };
    let voxel = studio.world.stool_frame().voxel_metres();
    for _ in 0..40 {
        // Pressed into the stone by half its radius, the bit is stopped at the stone's top.
        step_with_bit_at(
            &mut studio,
            RIGHT,
            Vec3::new(30.0, TOP + 0.5 * radius / voxel, 32.0),
            false,
        );
    }
    let rim = |depth: f32| (radius * radius - (radius - depth).powi(2)).sqrt() / voxel;
    for (next, depth) in [(None, 0.5 * radius), (Some(Vec3::NEG_Y * 0.9 * radius), 0.9 * radius)] {
        let latest = LatestInput { next_bites: [None, next], ..LatestInput::default() };
        let dots = dots(&studio, &latest);
        let state = studio.world.hand_state(RIGHT);
        let poses = [state.raw_pose.position, state.frozen_pose.position];
        assert_eq!(dots.len(), BITE_DOTS as usize, "{poses:?}");
        for dot in dots {
            let aside = (dot - Vec3::new(30.0, dot.y, 32.0)).length();
            // Half a voxel by which the bit may rest above or below, plus the step to the next sample.
            assert!(
                (dot.y - TOP).abs() < 0.7 && aside < rim(depth) + 1.0,
                "{dot} of {}",
                rim(depth)
            );
            assert!(aside > 0.5 * rim(depth) - 0.5, "{dot} of {}", rim(depth));
        }
    }
    // The hand is far ahead of the bit.
    step_with_bit_at(&mut studio, RIGHT, Vec3::new(30.0, TOP - 20.0, 32.0), true);
    assert!(studio.world.hand_state(RIGHT).frozen_pose.position.y > TOP - 18.0);
    assert_eq!(dots(&studio, &LatestInput::default()), [], "it is done, not shown, while it runs");
    step_with_bit_at(&mut studio, RIGHT, Vec3::new(30.0, TOP + 20.0, 32.0), false);
    assert_eq!(dots(&studio, &LatestInput::default()), [], "nothing is taken from the air");
}

#[test]
fn a_bit_is_drawn_where_it_is_hidden_while_it_is_near() {
    let mut studio = lock_studio();
    let mut hidden = |y: f32| {
        step_with_bit_at(&mut studio, RIGHT, Vec3::new(30.0, y, 32.0), false);
        let mut scene = SceneAssembler::new();
        let list = scene.assemble_frame(&studio.world, &LatestInput::default());
        let bit = MeshId::of_bit(held_bit(&studio));
        let [seen, hidden] = [DrawGroup::Handheld, DrawGroup::Hidden]
            .map(|group| list.instances_in_group(bit, group).to_vec());
        assert_eq!(seen.len(), 1);
        // The hidden instance has the same transform.
        hidden.iter().for_each(|one| assert_eq!(one.transform, seen[0].transform));
        hidden.len()
    };
    assert_eq!(hidden(TOP + 10.0), 1);
    assert_eq!(hidden(120.0), 0, "far from the stone");
}

#[test]
fn the_mirror_shows_its_plane_and_the_reflected_bit() {
    let mut studio = lock_studio();
    let press = HandInput { buttons: buttons::STICK, ..hand_input_at(STOOL_TOP + Vec3::Y) };
    studio.step(&input_with_hand(RIGHT, press));
    step_with_bit_at(&mut studio, RIGHT, Vec3::new(20.0, TOP + 10.0, 40.0), false);
    assert!(studio.world.is_mirrored());
    let bit = MeshId::of_bit(held_bit(&studio));
    let at = studio.world.hand_state(RIGHT).frozen_pose.position;
    for show_mirror in [true, false] {
        let mut scene = SceneAssembler::new();
        let latest = LatestInput { show_mirror, ..LatestInput::default() };
        let list = scene.assemble_frame(&studio.world, &latest);
        let reflected = places(&studio, list.instances_in_group(bit, DrawGroup::Particles));
        let edges = places(&studio, list.instances_of(MeshId::Speck));
        if show_mirror {
            assert!(edges.len() == 4 && edges.iter().all(|edge| (edge.x - 32.0).abs() < 0.1));
            assert!(reflected[0].distance(Vec3 { x: 64.0 - at.x, ..at }) < 0.1, "{reflected:?}");
        }
        assert_eq!((edges.is_empty(), reflected.len()), (!show_mirror, usize::from(show_mirror)));
    }
}
