//! The studio: its meshes, and the contents of an assembled frame.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec2, Vec3, Vec3Swizzles};
use paros_core::internals::{BitShape, STOOL_TOP, ToolPlace};
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::scripted_hand::{
    RIGHT, hand_input_at, input_with_hand, squeeze_and_release, step_with_bit_at, take_item,
};
use paros_models::world_harness::WorldHarness;
use paros_shaders::limits::{FALLING_STONE_CELLS, INSTANCES, PARTICLES};
use paros_shaders::scene::particles::MAX_LIFE_SECONDS;
use paros_shaders::scene::{
    HandShape, LatestInput, MAX_FALL_SECONDS, MESHES, MeshId, ROOM_AMBIENT, SceneAssembler, meshes,
};

static STUDIO: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

fn lock_studio() -> MutexGuard<'static, WorldHarness<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns all meshes.
fn all_meshes() -> Vec<MeshId> {
    let mut all = vec![MeshId::Room, MeshId::Outside, MeshId::Workbench, MeshId::StoolBase];
    all.extend([MeshId::StoolTop, MeshId::Shard, MeshId::Chip, MeshId::Speck]);
    all.extend(Tool::ALL.map(MeshId::of_tool));
    all.extend(ToolBit::ALL.map(MeshId::of_bit));
    all.extend([HandShape::Closed, HandShape::Open].map(MeshId::of_left_hand));
    all.extend([HandShape::Closed, HandShape::Open].map(MeshId::of_right_hand));
    all
}

fn vertex_position(mesh: MeshId, index: u16) -> Vec3 {
    Vec3::from_array(mesh.vertices()[usize::from(index)].position)
}

#[test]
fn the_tables_hold_every_mesh() {
    let all = all_meshes();
    assert_eq!(all.len(), MESHES);
    let vertices: usize = all.iter().map(|mesh| mesh.vertices().len()).sum();
    let triangles: usize = all.iter().map(|mesh| mesh.indices().len() / 3).sum();
    assert_eq!(
        (vertices, triangles),
        (meshes::all_vertices().len(), meshes::all_indices().len() / 3)
    );
    // The triangles of a frame without particles: every mesh, with one pair of hands.
    let pair = [MeshId::of_left_hand, MeshId::of_right_hand]
        .map(|of| of(HandShape::Closed).indices().len() / 3);
    let drawn = triangles - pair.iter().sum::<usize>();
    assert!(drawn < 54_000, "{drawn} triangles");
    for mesh in all {
        assert!(mesh.indices().iter().all(|i| usize::from(*i) < mesh.vertices().len()), "{mesh:?}");
        for vertex in mesh.vertices() {
            let normal = Vec3::from_array([0, 1, 2].map(|i| f32::from(vertex.normal[i]) / 127.0));
            assert!((normal.length() - 1.0).abs() < 0.015, "{mesh:?}: {normal}");
            assert!(Vec3::from_array(vertex.position).length() <= mesh.range().radius * 1.000_01);
        }
    }
}

#[test]
fn meshes_are_closed_and_face_outward() {
    for mesh in all_meshes() {
        let mut edges: HashMap<[[i32; 3]; 2], i32> = HashMap::new();
        let mut facing = [0; 2];
        for t in mesh.indices().chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| vertex_position(mesh, i));
            let across = (b - a).cross(c - a);
            let normal: Vec3 = t
                .iter()
                .map(|i| {
                    Vec3::from_array(
                        [0, 1, 2].map(|k| f32::from(mesh.vertices()[usize::from(*i)].normal[k])),
                    )
                })
                .sum();
            facing[usize::from(across.dot(normal) > 0.0)] += 1;
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let [p, q] = [p, q].map(|p| (p * 1e6).to_array().map(|f| f.round() as i32));
                *edges.entry([p, q]).or_default() += 1;
                *edges.entry([q, p]).or_default() -= 1;
            }
        }
        assert_eq!(facing[0], 0, "{mesh:?}: triangles that face against their normals");
        // The room's sheets are open at the back.
        if mesh != MeshId::Room {
            assert!(edges.values().all(|sum| *sum == 0), "{mesh:?} is open");
        }
    }
}

/// Half the thickness of the drawn saw blade, in metres.
const DISC_HALF_THICKNESS: f32 = 0.0018;

/// Returns the distance of a point from a bit's analytic surface, in metres.
fn distance_from_surface(bit: ToolBit, p: Vec3) -> f32 {
    match bit.spec().shape {
        BitShape::Ball { radius_um } => (p.length() - radius_um as f32 * 1e-6).abs(),
        BitShape::Box { half_extents_um } => {
            let q = p.abs() - Vec3::from_array(half_extents_um.map(|h| h as f32 * 1e-6));
            (q.max(Vec3::ZERO).length() + q.max_element().min(0.0)).abs()
        }
        BitShape::Disc { radius_um } => {
            let (rim, face) =
                (p.yz().length() - radius_um as f32 * 1e-6, p.x.abs() - DISC_HALF_THICKNESS);
            (Vec2::new(rim, face).max(Vec2::ZERO).length() + rim.max(face).min(0.0)).abs()
        }
    }
}

#[test]
fn a_bit_is_seen_where_it_cuts() {
    for bit in ToolBit::ALL {
        let mesh = MeshId::of_bit(bit);
        let reach = match bit.spec().shape {
            BitShape::Ball { radius_um } => Vec3::splat(radius_um as f32 * 1e-6),
            BitShape::Box { half_extents_um } => {
                Vec3::from_array(half_extents_um.map(|h| h as f32 * 1e-6))
            }
            BitShape::Disc { radius_um } => {
                let radius = radius_um as f32 * 1e-6;
                Vec3::new(DISC_HALF_THICKNESS, radius, radius)
            }
        };
        let (mut lo, mut hi, mut brush) = (Vec3::MAX, Vec3::MIN, 0);
        for vertex in mesh.vertices() {
            let p = Vec3::from_array(vertex.position);
            // A blade's shank ends at the blade's centre.
            let behind = if bit == ToolBit::DiscSaw { -0.015 } else { reach.z - 0.002 };
            let shank = p.z > behind && p.truncate().length() < 0.0125;
            if shank && distance_from_surface(bit, p) > 1e-4 {
                continue;
            }
            assert!(distance_from_surface(bit, p) < 1e-5, "{bit:?}: {p}");
            (lo, hi, brush) = (lo.min(p), hi.max(p), brush + 1);
        }
        assert!(brush >= 24, "{bit:?}");
        let short = (hi - reach).abs().max((lo + reach).abs()).max_element();
        assert!(short < 1e-4, "{bit:?} is {lo} to {hi}, and cuts {reach}");
    }
}

#[test]
fn the_room_is_lit_from_the_window() {
    let about = ROOM_AMBIENT.map(Vec3::from_array);
    assert!(about[0].min_element() > 0.3 && about[0].max_element() < 4.0, "{}", about[0]);
    // The third harmonic of band 1 grows along x: the window is at -x.
    assert!(about[3].max_element() < 0.0, "{}", about[3]);
}

fn fresh_at(time: f64) -> LatestInput {
    LatestInput {
        tick_fraction: 1.0,
        show_hands: true,
        time_seconds: time,
        ..LatestInput::default()
    }
}

#[test]
fn a_held_tool_is_at_the_freshest_grip_pushed_out() {
    let mut studio = lock_studio();
    studio.start_from_voxels(|[_, y, _]| y < 30);
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    step_with_bit_at(&mut studio, RIGHT, Vec3::new(32.0, 50.0, 32.0), false);
    step_with_bit_at(&mut studio, RIGHT, Vec3::new(32.0, 28.0, 32.0), false);
    let push = studio.world.push_out_metres(RIGHT);
    assert!(push.length() > 0.01, "{push}");
    let mut scene = SceneAssembler::new();
    // Without a newer grip the drawn tip equals the core's.
    let list = scene.assemble_frame(&studio.world, &fresh_at(0.0));
    let tip = studio.world.hand_state(RIGHT).bit_centre_pose(0.13).0 + push;
    let drawn = list.instances_of(MeshId::MediumBall)[0].transform_point(Vec3::ZERO);
    assert!(drawn.distance(tip) < 1e-5, "{drawn} for {tip}");
    let centre = studio.world.stool_frame().to_room(&studio.world.hand_state(RIGHT).frozen_pose).0;
    assert!(drawn.distance(centre) < 1e-4, "{drawn} for {centre}");
    let grip = (Vec3::new(0.2, 1.3, -0.4), Quat::from_rotation_y(0.7));
    let fresh = LatestInput { grips: [None, Some(grip)], ..fresh_at(0.01) };
    let list = scene.assemble_frame(&studio.world, &fresh);
    let body = list.instances_of(MeshId::Rotary)[0].transform_point(Vec3::ZERO);
    assert!(body.distance(grip.0 + push) < 1e-5, "{body}");
    let bit = list.instances_of(MeshId::MediumBall)[0].transform_point(Vec3::ZERO);
    let tip = grip.0 + push + grip.1 * Vec3::new(0.0, 0.0, -0.13);
    assert!(bit.distance(tip) < 1e-5, "{bit} for {tip}");
    assert_eq!(list.instances_of(MeshId::ClosedRightHand).len(), 1);
    assert_eq!(list.instances_of(MeshId::Rotary).len(), 1, "and not on the bench too");
}

#[test]
fn everything_on_the_bench_is_drawn_once() {
    let mut studio = lock_studio();
    studio.start_session(SessionMode::FreeForm);
    let mut scene = SceneAssembler::new();
    let list = scene.assemble_frame(&studio.world, &fresh_at(0.0));
    for mesh in Tool::ALL.map(MeshId::of_tool).into_iter().chain(ToolBit::ALL.map(MeshId::of_bit)) {
        assert_eq!(list.instances_of(mesh).len(), 1, "{mesh:?}");
    }
    let total: u32 = list.batches().iter().map(|batch| batch.count).sum();
    assert_eq!(total as usize, list.instances().len());
}

#[test]
fn what_turns_and_falls_is_between_two_ticks() {
    let mut studio = lock_studio();
    studio.start_session(SessionMode::FreeForm);
    let mut scene = SceneAssembler::new();
    let stick = HandInput { stick: [127, 0], ..hand_input_at(Vec3::new(-0.3, 1.0, -0.2)) };
    scene.assemble_frame(&studio.world, &fresh_at(0.0));
    studio.step(&input_with_hand(0, stick));
    scene.assemble_frame(&studio.world, &fresh_at(0.01));
    let whole = scene.sculpture_placement().turn_radians;
    assert!(whole > 0.01, "{whole}");
    scene.assemble_frame(&studio.world, &LatestInput { tick_fraction: 0.25, ..fresh_at(0.012) });
    assert!((scene.sculpture_placement().turn_radians - 0.25 * whole).abs() < 1e-4);

    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rasp));
    squeeze_and_release(&mut studio, RIGHT, Vec3::new(-0.8, 1.2, -0.3));
    let heights: Vec<f32> = (0..3)
        .map(|_| {
            studio.step(&TickInput::default());
            assert!(matches!(
                studio.world.workbench().place_of(BenchItem::Tool(Tool::Rasp)),
                ToolPlace::Falling(_)
            ));
            let list = scene.assemble_frame(&studio.world, &fresh_at(0.02));
            list.instances_of(MeshId::Rasp)[0].transform_point(Vec3::ZERO).y
        })
        .collect();
    let list =
        scene.assemble_frame(&studio.world, &LatestInput { tick_fraction: 0.5, ..fresh_at(0.02) });
    let between = list.instances_of(MeshId::Rasp)[0].transform_point(Vec3::ZERO).y;
    assert!((between - 0.5 * (heights[1] + heights[2])).abs() < 1e-5, "{between} in {heights:?}");
}

/// Carves for a while and calls `each` after each tick's frame. Returns the time of the last frame.
fn carve_strokes(
    studio: &mut WorldHarness<64>,
    scene: &mut SceneAssembler,
    mut each: impl FnMut(&SceneAssembler),
) -> f64 {
    studio.start_from_voxels(|[_, y, _]| y < 30);
    take_item(studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut time = 0.0;
    for i in 0..400u32 {
        let x = 8.0 + 48.0 * (i % 40) as f32 / 40.0;
        step_with_bit_at(studio, RIGHT, Vec3::new(x, 33.0 - (i / 40) as f32, 32.0), true);
        time = f64::from(i) / 72.0;
        scene.assemble_frame(&studio.world, &fresh_at(time));
        each(scene);
    }
    time
}

#[test]
fn chips_fly_and_are_gone_and_nothing_grows() {
    let mut studio = lock_studio();
    let mut scene = SceneAssembler::new();
    let capacity = scene.draw_list().capacity();
    assert_eq!(capacity.instances, INSTANCES);
    let mut most = 0;
    let time = carve_strokes(&mut studio, &mut scene, |scene| {
        most = most.max(scene.particles().alive_count());
        assert_eq!(scene.draw_list().capacity(), capacity);
    });
    assert!((40..=PARTICLES).contains(&most), "{most}");
    assert!(scene.draw_list().instances().len() <= INSTANCES);
    for i in 1..=(f64::from(MAX_LIFE_SECONDS) * 72.0) as u32 + 1 {
        scene.assemble_frame(&studio.world, &fresh_at(time + f64::from(i) / 72.0));
    }
    assert_eq!(scene.particles().alive_count(), 0);
    assert_eq!(scene.draw_list().instances_of(MeshId::Chip), []);
}

#[test]
fn the_same_ticks_and_times_show_the_same() {
    let frames = || {
        let mut studio = lock_studio();
        let mut scene = SceneAssembler::new();
        let mut frames = Vec::new();
        carve_strokes(&mut studio, &mut scene, |scene| {
            frames.push(scene.draw_list().instances().to_vec());
        });
        frames
    };
    assert!(frames() == frames());
}

#[test]
fn a_removed_island_falls_as_one_and_breaks() {
    let mut studio = lock_studio();
    // A stone on a thin stem, which is cut through.
    studio.start_from_voxels(|[x, y, z]| {
        y < 8
            || y >= 40 && (20..44).contains(&x) && (20..44).contains(&z) && y < 56
            || (31..34).contains(&x) && (31..34).contains(&z) && y < 40
    });
    let mut scene = SceneAssembler::new();
    scene.assemble_frame(&studio.world, &fresh_at(0.0));
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut removed = false;
    stroke_until(&mut studio, |studio| {
        let falls = |e: &WorldEvent| matches!(e, WorldEvent::Islands(r) if r.removed > 0);
        removed = studio.world.events().iter().any(falls);
        scene.assemble_frame(&studio.world, &fresh_at(0.0));
        removed
    });
    assert!(removed);
    let voxel = studio.world.stool_frame().voxel_metres();
    // Heights in voxels over the stool.
    let heights = |scene: &SceneAssembler, mesh| -> Vec<f32> {
        let shards = scene.draw_list().instances_of(mesh).iter();
        shards.map(|m| (m.transform_point(Vec3::ZERO).y - STOOL_TOP.y) / voxel).collect()
    };
    let mean = |heights: &[f32]| heights.iter().sum::<f32>() / heights.len() as f32;
    let at_first = heights(&scene, MeshId::Shard);
    assert!((40..=FALLING_STONE_CELLS).contains(&at_first.len()), "{}", at_first.len());
    assert!((mean(&at_first) - 48.0).abs() < 2.0, "{}", mean(&at_first));
    scene.assemble_frame(&studio.world, &fresh_at(0.1));
    let later = heights(&scene, MeshId::Shard);
    assert_eq!(later.len(), at_first.len(), "it falls as one");
    assert!(mean(&later) < mean(&at_first) - 4.0, "{} voxels high", mean(&later));
    let mut time = 0.1;
    while !heights(&scene, MeshId::Shard).is_empty() {
        time += 1.0 / 72.0;
        assert!(time < f64::from(MAX_FALL_SECONDS) + 0.1, "it hangs in the air");
        scene.assemble_frame(&studio.world, &fresh_at(time));
    }
    let chips = heights(&scene, MeshId::Chip);
    assert!(chips.len() >= at_first.len() / 2, "{} chips", chips.len());
    assert!(mean(&chips) < 40.0, "they lie where it landed");
    for i in 1..=(f64::from(MAX_LIFE_SECONDS) * 72.0) as u32 + 1 {
        scene.assemble_frame(&studio.world, &fresh_at(time + f64::from(i) / 72.0));
    }
    assert!(heights(&scene, MeshId::Chip).is_empty(), "and are gone");
}

/// Moves the burr through the stem until `each` returns true.
fn stroke_until(studio: &mut WorldHarness<64>, mut each: impl FnMut(&WorldHarness<64>) -> bool) {
    step_with_bit_at(studio, RIGHT, Vec3::new(10.0, 24.0, 32.0), false);
    for i in 0..400 {
        step_with_bit_at(studio, RIGHT, Vec3::new(10.0 + 0.2 * i as f32, 24.0, 32.0), true);
        if each(studio) {
            return;
        }
    }
}
