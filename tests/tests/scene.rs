//! The studio: its meshes, and what an assembled frame shows.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::events::Event;
use paros_core::frame::STOOL;
use paros_core::input::{HandInput, Input, Mode};
use paros_core::tools::{Bit, Shape, Tool};
use paros_core::workbench::{Item, Place};
use paros_shaders::limits::{INSTANCES, PARTICLES};
use paros_shaders::scene::particles::{LONGEST, TRACE};
use paros_shaders::scene::{Assembly, Fresh, MESHES, MeshId, ROOM_AMBIENT, meshes};
use paros_tests::models::puppet::{RIGHT, hand_at, reach, squeeze, take, with};
use paros_tests::models::studio::Studio;

static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());

fn studio() -> MutexGuard<'static, Studio<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// All meshes, by what holds of them.
fn all_meshes() -> Vec<MeshId> {
    let mut all = vec![MeshId::Room, MeshId::Outside, MeshId::Workbench, MeshId::StoolBase];
    all.extend([MeshId::StoolTop, MeshId::Chip, MeshId::Speck]);
    all.extend(Tool::ALL.map(MeshId::of_tool));
    all.extend(Bit::ALL.map(MeshId::of_bit));
    all.extend(
        [(0, true), (0, false), (1, true), (1, false)].map(|(hand, c)| MeshId::of_hand(hand, c)),
    );
    all
}

fn position(mesh: MeshId, index: u16) -> Vec3 {
    Vec3::from_array(mesh.vertices()[usize::from(index)].position)
}

#[test]
fn the_tables_hold_every_mesh() {
    let all = all_meshes();
    assert_eq!(all.len(), MESHES);
    let vertices: usize = all.iter().map(|mesh| mesh.vertices().len()).sum();
    let triangles: usize = all.iter().map(|mesh| mesh.indices().len() / 3).sum();
    assert_eq!((vertices, triangles), (meshes::vertices().len(), meshes::indices().len() / 3));
    // What a frame draws but for particles: everything, with one pair of hands.
    let pair = [0, 1].map(|hand| MeshId::of_hand(hand, true).indices().len() / 3);
    let drawn = triangles - pair.iter().sum::<usize>();
    assert!(drawn < 40_000, "{drawn} triangles");
    for mesh in all {
        assert!(mesh.indices().iter().all(|i| usize::from(*i) < mesh.vertices().len()), "{mesh:?}");
        for vertex in mesh.vertices() {
            let normal = Vec3::from_array([0, 1, 2].map(|i| f32::from(vertex.normal[i]) / 127.0));
            assert!((normal.length() - 1.0).abs() < 0.015, "{mesh:?}: {normal}");
            assert!(Vec3::from_array(vertex.position).length() <= mesh.mesh().radius * 1.000_01);
        }
    }
}

#[test]
fn meshes_are_closed_and_face_outward() {
    for mesh in all_meshes() {
        let mut edges: HashMap<[[i32; 3]; 2], i32> = HashMap::new();
        let mut facing = [0; 2];
        for t in mesh.indices().chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| position(mesh, i));
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

/// How far a point is from a bit's analytic surface, in metres.
fn from_surface(bit: Bit, p: Vec3) -> f32 {
    match bit.data().shape {
        Shape::Ball { radius } => (p.length() - radius as f32 * 1e-6).abs(),
        Shape::Box { half } => {
            let q = p.abs() - Vec3::from_array(half.map(|h| h as f32 * 1e-6));
            (q.max(Vec3::ZERO).length() + q.max_element().min(0.0)).abs()
        }
    }
}

#[test]
fn a_bit_is_seen_where_it_cuts() {
    for bit in Bit::ALL {
        let mesh = MeshId::of_bit(bit);
        let reach = match bit.data().shape {
            Shape::Ball { radius } => Vec3::splat(radius as f32 * 1e-6),
            Shape::Box { half } => Vec3::from_array(half.map(|h| h as f32 * 1e-6)),
        };
        let (mut lo, mut hi, mut brush) = (Vec3::MAX, Vec3::MIN, 0);
        for vertex in mesh.vertices() {
            let p = Vec3::from_array(vertex.position);
            let shank = p.z > reach.z - 0.002 && p.truncate().length() < 0.0125;
            if shank && from_surface(bit, p) > 1e-4 {
                continue;
            }
            assert!(from_surface(bit, p) < 1e-5, "{bit:?}: {p}");
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

fn fresh_at(time: f64) -> Fresh {
    Fresh { fraction: 1.0, hands: true, time, ..Fresh::default() }
}

#[test]
fn a_held_tool_is_at_the_freshest_grip_pushed_out() {
    let mut studio = studio();
    studio.start_from(|[_, y, _]| y < 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    reach(&mut studio, RIGHT, Vec3::new(32.0, 50.0, 32.0), false);
    reach(&mut studio, RIGHT, Vec3::new(32.0, 28.0, 32.0), false);
    let push = studio.world.push_out(RIGHT);
    assert!(push.length() > 0.01, "{push}");
    let mut scene = Assembly::new();
    // Without a fresher grip the drawn tip is the core's.
    let list = scene.assemble(&studio.world, &fresh_at(0.0));
    let tip = studio.world.hand(RIGHT).tip(0.13).0 + push;
    let drawn = list.of(MeshId::MediumBall)[0].place(Vec3::ZERO);
    assert!(drawn.distance(tip) < 1e-5, "{drawn} for {tip}");
    let centre = studio.world.frame().to_room(&studio.world.hand(RIGHT).frozen).0;
    assert!(drawn.distance(centre) < 1e-4, "{drawn} for {centre}");
    let grip = (Vec3::new(0.2, 1.3, -0.4), Quat::from_rotation_y(0.7));
    let fresh = Fresh { grips: [None, Some(grip)], ..fresh_at(0.01) };
    let list = scene.assemble(&studio.world, &fresh);
    let body = list.of(MeshId::Rotary)[0].place(Vec3::ZERO);
    assert!(body.distance(grip.0 + push) < 1e-5, "{body}");
    let bit = list.of(MeshId::MediumBall)[0].place(Vec3::ZERO);
    let tip = grip.0 + push + grip.1 * Vec3::new(0.0, 0.0, -0.13);
    assert!(bit.distance(tip) < 1e-5, "{bit} for {tip}");
    assert_eq!(list.of(MeshId::ClosedRightHand).len(), 1);
    assert_eq!(list.of(MeshId::Rotary).len(), 1, "and not on the bench too");
}

#[test]
fn everything_on_the_bench_is_drawn_once() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let mut scene = Assembly::new();
    let list = scene.assemble(&studio.world, &fresh_at(0.0));
    for mesh in Tool::ALL.map(MeshId::of_tool).into_iter().chain(Bit::ALL.map(MeshId::of_bit)) {
        assert_eq!(list.of(mesh).len(), 1, "{mesh:?}");
    }
    let total: u32 = list.batches().iter().map(|batch| batch.count).sum();
    assert_eq!(total as usize, list.instances().len());
}

#[test]
fn what_turns_and_falls_is_between_two_ticks() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let mut scene = Assembly::new();
    let stick = HandInput { stick: [127, 0], ..hand_at(Vec3::new(-0.3, 1.0, -0.2)) };
    scene.assemble(&studio.world, &fresh_at(0.0));
    studio.step(&with(0, stick));
    scene.assemble(&studio.world, &fresh_at(0.01));
    let whole = scene.sculpture().turn;
    assert!(whole > 0.01, "{whole}");
    scene.assemble(&studio.world, &Fresh { fraction: 0.25, ..fresh_at(0.012) });
    assert!((scene.sculpture().turn - 0.25 * whole).abs() < 1e-4);

    take(&mut studio, RIGHT, Item::Tool(Tool::Rasp));
    squeeze(&mut studio, RIGHT, Vec3::new(-0.8, 1.2, -0.3));
    let heights: Vec<f32> = (0..3)
        .map(|_| {
            studio.step(&Input::default());
            assert!(matches!(
                studio.world.bench().place(Item::Tool(Tool::Rasp)),
                Place::Falling(_)
            ));
            let list = scene.assemble(&studio.world, &fresh_at(0.02));
            list.of(MeshId::Rasp)[0].place(Vec3::ZERO).y
        })
        .collect();
    let list = scene.assemble(&studio.world, &Fresh { fraction: 0.5, ..fresh_at(0.02) });
    let between = list.of(MeshId::Rasp)[0].place(Vec3::ZERO).y;
    assert!((between - 0.5 * (heights[1] + heights[2])).abs() < 1e-5, "{between} in {heights:?}");
}

/// Carves for a while and returns the scene after each tick's frame, as seen by `each`.
fn carve(studio: &mut Studio<64>, scene: &mut Assembly, mut each: impl FnMut(&Assembly)) -> f64 {
    studio.start_from(|[_, y, _]| y < 30);
    take(studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut time = 0.0;
    for i in 0..400u32 {
        let x = 8.0 + 48.0 * (i % 40) as f32 / 40.0;
        reach(studio, RIGHT, Vec3::new(x, 33.0 - (i / 40) as f32, 32.0), true);
        time = f64::from(i) / 72.0;
        scene.assemble(&studio.world, &fresh_at(time));
        each(scene);
    }
    time
}

#[test]
fn chips_fly_and_are_gone_and_nothing_grows() {
    let mut studio = studio();
    let mut scene = Assembly::new();
    let capacity = scene.list().capacity();
    assert_eq!(capacity.0, INSTANCES);
    let mut most = 0;
    let time = carve(&mut studio, &mut scene, |scene| {
        most = most.max(scene.particles().alive());
        assert_eq!(scene.list().capacity(), capacity);
    });
    assert!((40..=PARTICLES).contains(&most), "{most}");
    assert!(scene.list().instances().len() <= INSTANCES);
    for i in 1..=(f64::from(LONGEST) * 72.0) as u32 + 1 {
        scene.assemble(&studio.world, &fresh_at(time + f64::from(i) / 72.0));
    }
    assert_eq!(scene.particles().alive(), 0);
    assert_eq!(scene.list().of(MeshId::Chip), []);
}

#[test]
fn the_same_ticks_and_times_show_the_same() {
    let frames = || {
        let mut studio = studio();
        let mut scene = Assembly::new();
        let mut frames = Vec::new();
        carve(&mut studio, &mut scene, |scene| frames.push(scene.list().instances().to_vec()));
        frames
    };
    assert!(frames() == frames());
}

#[test]
fn a_removed_island_leaves_a_trace_where_it_was() {
    let mut studio = studio();
    // A stone on a thin stem, which is cut.
    studio.start_from(|[x, y, z]| {
        y < 8
            || y >= 40 && (20..44).contains(&x) && (20..44).contains(&z) && y < 56
            || (31..34).contains(&x) && (31..34).contains(&z) && y < 40
    });
    let mut scene = Assembly::new();
    scene.assemble(&studio.world, &fresh_at(0.0));
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut removed = false;
    stroke_until(&mut studio, |studio| {
        removed =
            studio.world.events().iter().any(|e| matches!(e, Event::Islands(r) if r.removed > 0));
        scene.assemble(&studio.world, &fresh_at(0.0));
        removed
    });
    assert!(removed);
    let motes = scene.list().of(MeshId::Chip);
    assert!(motes.len() > 30, "{}", motes.len());
    let voxel = studio.world.frame().voxel();
    let high = motes.iter().filter(|m| (m.place(Vec3::ZERO).y - STOOL.y) / voxel > 38.0).count();
    assert!(high > 30, "{high} over where it was");
    for i in 1..=(f64::from(TRACE) * 72.0) as u32 + 1 {
        scene.assemble(&studio.world, &fresh_at(f64::from(i) / 72.0));
    }
    let left = scene.list().of(MeshId::Chip);
    assert!(
        left.iter().all(|m| (m.place(Vec3::ZERO).y - STOOL.y) / voxel < 38.0),
        "the trace fades"
    );
}

/// Drives the burr through the stem until `each` has seen enough.
fn stroke_until(studio: &mut Studio<64>, mut each: impl FnMut(&Studio<64>) -> bool) {
    reach(studio, RIGHT, Vec3::new(10.0, 24.0, 32.0), false);
    for i in 0..400 {
        reach(studio, RIGHT, Vec3::new(10.0 + 0.2 * i as f32, 24.0, 32.0), true);
        if each(studio) {
            return;
        }
    }
}
