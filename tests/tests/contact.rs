//! Contact and freeze against a walk over plain voxels, and against walls of every tilt.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{IVec3, Quat, Vec3};
use paros_core::contact::{Contact, Frozen, Obstacle, looks};
use paros_core::frame::BOX;
use paros_core::limits::{LOOKS, deep_steps, short_walk_steps, walk_steps};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::pose::{Pose, SUB};
use paros_core::size::{Grid, Size};
use paros_core::tools::{Bit, GridBit, GridShape};
use paros_tests::models::contact::{Block, path};
use paros_tests::models::dense::{Dense, masked_volumes};
use proptest::prelude::*;

/// A volume and its mask where the core can see them.
struct Stone<const N: usize>
where
    Grid<N>: Size,
{
    rows: Plane<N>,
    mask: Maps<N>,
    masked: bool,
}

impl<const N: usize> Stone<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Stone { rows: Plane::new(), mask: Maps::new(), masked: false }
    }

    fn set(&mut self, volume: &Dense, mask: &Dense) {
        self.rows.clear();
        volume.write_plane(&mut self.rows);
        mask.write_maps(&mut self.mask);
        self.masked = !mask.is_empty();
    }

    fn obstacle(&self) -> Obstacle<'_, N> {
        Obstacle { rows: &self.rows, mask: self.masked.then_some(&self.mask) }
    }

    fn contact(&self, bit: &GridBit, pose: &Pose) -> Contact {
        self.obstacle().contact(bit, pose)
    }

    fn freeze(&self, bit: &GridBit, from: &Pose, raw: &Pose) -> Frozen {
        self.obstacle().freeze(bit, from, raw, walk_steps(N))
    }
}

static STONE_16: Mutex<Stone<16>> = Mutex::new(Stone::new());
static STONE_64: Mutex<Stone<64>> = Mutex::new(Stone::new());
static STONE_128: Mutex<Stone<128>> = Mutex::new(Stone::new());
static STONE_256: Mutex<Stone<256>> = Mutex::new(Stone::new());

fn held<T>(stone: &'static Mutex<T>) -> MutexGuard<'static, T> {
    stone.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Side of a voxel in micrometres, for a grid of `n`.
fn voxel(n: usize) -> f32 {
    BOX / n as f32 * 1e6
}

fn table_bit(number: u8, n: usize) -> GridBit {
    Bit::from_number(number).expect("a bit of the table").on_grid(voxel(n))
}

/// Those of the table at both sizes, and others of any proportion.
fn bits() -> impl Strategy<Value = GridBit> {
    let table =
        (0..9u8, prop_oneof![Just(128), Just(256)]).prop_map(|(number, n)| table_bit(number, n));
    let balls = (1..6 * SUB, 0..1000).prop_map(|(radius, share)| GridBit {
        shape: GridShape::Ball(radius),
        bite: radius * share / 1000,
    });
    let boxes = ([1..6 * SUB, 1..6 * SUB, 1..6 * SUB], 0..1000).prop_map(|(half, share)| {
        let half = IVec3::from_array(half);
        GridBit { shape: GridShape::Box(half), bite: half.min_element() * share / 1000 }
    });
    prop_oneof![3 => table, 2 => balls, 2 => boxes]
}

fn rotations() -> impl Strategy<Value = Quat> {
    let any = [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(|q| {
        let q = Quat::from_array(q);
        if q.length_squared() > 1e-3 { q.normalize() } else { Quat::IDENTITY }
    });
    prop_oneof![1 => Just(Quat::IDENTITY), 4 => any]
}

/// In and about a grid of `n`; now and then on a voxel's centre or corner, and metres away.
fn poses(n: usize) -> impl Strategy<Value = Pose> {
    let n = n as f32;
    let near = [-6.0..n + 6.0, -6.0..n + 6.0, -6.0..n + 6.0];
    let halves = near.clone().prop_map(|p| p.map(|f: f32| (f * 2.0).round() / 2.0));
    let far = [-5000.0..5000.0f32, -5000.0..5000.0f32, -5000.0..5000.0f32];
    let position = prop_oneof![6 => near, 2 => halves, 2 => far];
    (position, rotations())
        .prop_map(|(p, rotation)| Pose { position: Vec3::from_array(p), rotation })
}

/// Where a hand goes from one tick to the next: a jump, a small motion, a turn on the spot.
fn motions(n: usize) -> impl Strategy<Value = Motion> {
    let small = [-3.0..3.0f32, -3.0..3.0f32, -3.0..3.0f32].prop_map(Vec3::from_array);
    prop_oneof![
        2 => poses(n).prop_map(Motion::To),
        4 => (small.clone(), (small.clone(), 0.0..0.4f32)).prop_map(|(by, (axis, angle))| {
            Motion::By(by, Quat::from_axis_angle(axis.normalize_or(Vec3::X), angle))
        }),
        1 => rotations().prop_map(|turn| Motion::By(Vec3::ZERO, turn)),
        1 => small.prop_map(|by| Motion::By(by, Quat::IDENTITY)),
        1 => Just(Motion::By(Vec3::ZERO, Quat::IDENTITY)),
    ]
}

#[derive(Clone, Copy, Debug)]
enum Motion {
    To(Pose),
    By(Vec3, Quat),
}

impl Motion {
    fn from(self, pose: &Pose) -> Pose {
        match self {
            Motion::To(pose) => pose,
            Motion::By(by, turn) => {
                Pose { position: pose.position + by, rotation: (turn * pose.rotation).normalize() }
            }
        }
    }
}

/// The last pose of a path's walk, its slide, and what all of it may not do.
fn freeze_follows_the_walk(
    stone: &Stone<16>,
    block: &Block,
    bit: &GridBit,
    from: &Pose,
    raw: &Pose,
) -> Result<Frozen, TestCaseError> {
    let mut frozen = Frozen { pose: *from, blocked: false, steps: 0 };
    for most in [short_walk_steps(16), walk_steps(16)] {
        frozen = stone.obstacle().freeze(bit, from, raw, most);
        prop_assert_eq!(frozen, block.freeze(bit, from, raw, most));
        let (before, after) = (block.depths(bit, from), block.depths(bit, &frozen.pose));
        prop_assert!(after.volume <= bit.bite.max(before.volume), "{before:?} -> {after:?}");
        prop_assert!(after.mask <= before.mask, "{before:?} -> {after:?}");
        if !frozen.blocked && frozen.steps < most {
            prop_assert_eq!(frozen.pose, *raw);
        }
    }
    Ok(frozen)
}

/// The greatest way that a point of the bit makes between two poses, in voxels.
fn farthest_way(bit: &GridBit, a: &Pose, b: &Pose) -> f32 {
    let half = match bit.shape {
        GridShape::Ball(_) => Vec3::ZERO,
        GridShape::Box(half) => half.as_vec3() / SUB as f32,
    };
    let corner = |pose: &Pose, k: i32| {
        let sign = |bit: i32| if k & bit == 0 { -1.0 } else { 1.0 };
        pose.position + pose.rotation * (half * Vec3::new(sign(1), sign(2), sign(4)))
    };
    (0..8).map(|k| corner(a, k).distance(corner(b, k))).fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn contact_is_that_of_the_voxels((volume, mask) in masked_volumes(16), bit in bits(), pose in poses(16)) {
        let mut stone = held(&STONE_16);
        stone.set(&volume, &mask);
        let block = Block::new(volume, &mask);
        prop_assert_eq!(stone.contact(&bit, &pose), block.contact(&bit, &pose));
    }

    #[test]
    fn no_step_is_longer_than_a_quarter_voxel(bit in bits(), from in poses(16), motion in motions(16)) {
        let mut last = from;
        for next in path(&bit, &from, &motion.from(&from)).take(400) {
            let way = farthest_way(&bit, &last, &next);
            // Positions thousands of voxels off are held to a two-thousandth of a voxel.
            prop_assert!(way < 0.2525, "a step of {way} voxels");
            last = next;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(700))]

    /// From anywhere, deep inside too, as after an undo, a fill or a load.
    #[test]
    fn freeze_is_the_walk_from_anywhere(
        (volume, mask) in masked_volumes(16),
        bit in bits(),
        from in poses(16),
        motions in proptest::collection::vec(motions(16), 1..5),
    ) {
        let mut stone = held(&STONE_16);
        stone.set(&volume, &mask);
        let block = Block::new(volume, &mask);
        let mut pose = from;
        for motion in motions {
            let raw = motion.from(&pose);
            pose = freeze_follows_the_walk(&stone, &block, &bit, &pose, &raw)?.pose;
        }
    }

    /// From outside, a bit is never deeper than its bite, and never in the mask.
    #[test]
    fn from_outside_nothing_gets_deeper_than_its_bite(
        (volume, mask) in masked_volumes(16),
        bit in bits(),
        start in rotations(),
        side in [-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32],
        motions in proptest::collection::vec(motions(16), 1..6),
    ) {
        let mut stone = held(&STONE_16);
        stone.set(&volume, &mask);
        let block = Block::new(volume, &mask);
        let away = Vec3::from_array(side).normalize_or(Vec3::Y) * 40.0;
        let mut pose = Pose { position: Vec3::splat(8.0) + away, rotation: start };
        for motion in motions {
            let raw = motion.from(&pose);
            pose = freeze_follows_the_walk(&stone, &block, &bit, &pose, &raw)?.pose;
            let sits = block.depths(&bit, &pose);
            prop_assert!(sits.volume <= bit.bite && sits.mask == 0, "{sits:?}");
        }
    }
}

/// A plate one voxel thick across the grid: the voxels through whose middle third the plane runs
/// along the normal's longest axis.
#[derive(Clone, Copy, Debug)]
struct Plate {
    normal: Vec3,
    middle: Vec3,
}

impl Plate {
    fn height(&self, point: Vec3) -> f32 {
        (point - self.middle).dot(self.normal)
    }

    fn voxels(&self, n: usize) -> Dense {
        let thin = self.normal.abs().max_element() / 2.0;
        Dense::from_fn(n, |voxel| {
            let height = self.height(IVec3::from_array(voxel).as_vec3() + 0.5);
            -thin < height && height <= thin
        })
    }
}

fn plates() -> impl Strategy<Value = Plate> {
    let normal = prop_oneof![
        3 => [-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32].prop_map(Vec3::from_array),
        1 => [-1..2i32, -1..2i32, -1..2i32].prop_map(|n| IVec3::from_array(n).as_vec3()),
    ];
    (normal, [28.0..36.0f32, 28.0..36.0f32, 28.0..36.0f32]).prop_map(|(normal, middle)| Plate {
        normal: normal.normalize_or(Vec3::Y),
        middle: Vec3::from_array(middle),
    })
}

/// A way from one side of a plate's middle to the other, centimetres to metres long.
fn crossings() -> impl Strategy<Value = (Vec3, f32, f32)> {
    let lengths =
        prop_oneof![Just(30.0f32), Just(45.0), Just(300.0), Just(6000.0), 30.0..3000.0f32];
    let tilt = [-0.7..0.7f32, -0.7..0.7f32, -0.7..0.7f32].prop_map(Vec3::from_array);
    (tilt, lengths.clone(), lengths)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    /// Every bit of the table, at both sizes of voxel, at any speed, turning as it goes.
    #[test]
    fn nothing_passes_a_plate_one_voxel_thick(
        plate in plates(),
        as_mask in any::<bool>(),
        (tilt, before, after) in crossings(),
        (start, end) in (rotations(), rotations()),
    ) {
        let mut stone = held(&STONE_64);
        let voxels = plate.voxels(64).closure();
        stone.set(&voxels, &if as_mask { voxels.clone() } else { Dense::new(64) });
        let way = (plate.normal + tilt).normalize();
        let way = if way.dot(plate.normal) < 0.3 { plate.normal } else { way };
        let from = Pose { position: plate.middle - way * before, rotation: start };
        let to = Pose { position: plate.middle + way * after, rotation: end };
        for (number, n) in (0..9u8).flat_map(|number| [(number, 128), (number, 256)]) {
            let bit = table_bit(number, n);
            if stone.contact(&bit, &from).overlap != 0 {
                continue;
            }
            let mut frozen = stone.freeze(&bit, &from, &to);
            while !frozen.blocked && frozen.pose != to {
                let last = frozen.pose;
                frozen = stone.freeze(&bit, &last, &to);
                prop_assert!(frozen.blocked || frozen.pose != last);
            }
            let depth = stone.contact(&bit, &frozen.pose).depth;
            let bite = if as_mask { 0 } else { bit.bite };
            prop_assert!(frozen.blocked, "bit {number} at {n} went through");
            prop_assert!(depth <= bite, "bit {number} at {n}: {depth} of {bite}");
            // Beside the grid a slide may lead round the plate's edge.
            let beside = frozen.pose.position - Vec3::splat(32.0);
            if beside.abs().max_element() < 31.0 {
                let height = plate.height(frozen.pose.position);
                prop_assert!(height < 0.0, "bit {number} at {n} is {height} beyond");
            }
        }
    }
}

/// A bit that some tick left deep in the stone comes out the way it can, and goes no deeper.
#[test]
fn a_buried_bit_can_only_come_out() {
    let mut stone = held(&STONE_64);
    stone.set(&Dense::from_fn(64, |[_, y, _]| y < 40), &Dense::new(64));
    for number in 0..9u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        let sits = stone.contact(&bit, &at(39.0)).depth;
        assert!(sits > bit.bite, "bit {number} is buried");
        let down = stone.freeze(&bit, &at(39.0), &at(20.0));
        assert!(stone.contact(&bit, &down.pose).depth <= sits, "bit {number}: {down:?}");
        let mut up = Frozen { pose: at(39.0), blocked: false, steps: 0 };
        for _ in 0..21 * 4 * deep_steps(64) / walk_steps(64) + 1 {
            up = stone.freeze(&bit, &up.pose, &at(60.0));
        }
        assert_eq!((up.pose, up.blocked), (at(60.0), false), "bit {number}");
        // Half way out counts: what was gained is not given back.
        let half = stone.freeze(&bit, &at(39.0), &at(41.0)).pose;
        let again = stone.freeze(&bit, &half, &at(39.0)).pose;
        assert!(
            stone.contact(&bit, &again).depth <= stone.contact(&bit, &half).depth.max(bit.bite)
        );
    }
}

/// However deep it is: the hand that left it behind in the stone is far away.
#[test]
fn a_bit_comes_out_of_the_middle_of_a_block() {
    let mut stone = held(&STONE_64);
    stone.set(&Dense::from_fn(64, |[_, y, _]| y < 60), &Dense::new(64));
    for number in 0..9u8 {
        let bit = table_bit(number, 128);
        let at = |y: f32| Pose { position: Vec3::new(32.0, y, 32.0), rotation: Quat::IDENTITY };
        let mut pose = at(20.0);
        for _ in 0..20 {
            pose = stone.freeze(&bit, &pose, &at(120.0)).pose;
        }
        assert_eq!(pose, at(120.0), "bit {number}");
    }
}

/// As an undo leaves it: in a slot narrower than itself, whose walls it would catch at.
#[test]
fn a_bit_comes_out_of_a_slot() {
    let mut stone = held(&STONE_64);
    for width in 1..12 {
        let in_wall = |x: i32| (26..32).contains(&x) || (32 + width..38 + width).contains(&x);
        stone.set(&Dense::from_fn(64, |[x, y, _]| y < 40 && in_wall(x)), &Dense::new(64));
        let x = 32.0 + width as f32 / 2.0;
        for (number, turn) in (0..9u8).flat_map(|number| [(number, 0.0), (number, 0.3)]) {
            let bit = table_bit(number, 128);
            let rotation = Quat::from_rotation_y(turn);
            let at = |y: f32| Pose { position: Vec3::new(x, y, 32.3), rotation };
            let mut pose = at(20.1);
            for _ in 0..20 {
                pose = stone.freeze(&bit, &pose, &at(80.0)).pose;
            }
            assert_eq!(pose, at(80.0), "bit {number}, turned by {turn}, {width} voxels");
            // Not through the wall.
            let aside = Pose { position: Vec3::new(62.0, 20.1, 32.3), rotation };
            let held = stone.freeze(&bit, &at(20.1), &aside).pose;
            let is_buried = stone.contact(&bit, &at(20.1)).depth > bit.inner_radius() - 222;
            assert!(is_buried || held.position.x < x + width as f32, "bit {number}: {held:?}");
        }
    }
}

/// A bit pushed aslant into a floor goes on along it.
#[test]
fn a_blocked_bit_slides() {
    let mut stone = held(&STONE_64);
    stone.set(&Dense::from_fn(64, |[_, y, _]| y < 20), &Dense::new(64));
    let bit = Bit::MediumBall.on_grid(voxel(128));
    let at = |x: f32, y: f32| Pose { position: Vec3::new(x, y, 32.0), rotation: Quat::IDENTITY };
    let mut frozen = stone.freeze(&bit, &at(20.0, 30.0), &at(40.0, 10.0));
    for _ in 0..2 {
        frozen = stone.freeze(&bit, &frozen.pose, &at(40.0, 10.0));
    }
    let rest = 20.0 + (bit.inner_radius() - bit.bite) as f32 / SUB as f32;
    let position = frozen.pose.position;
    assert!(frozen.blocked && (position.x - 40.0).abs() < 0.3, "{position}");
    assert!((position.y - rest).abs() < 0.8, "{position}, {rest}");
}

/// Along a floor every step is taken singly; in the air the first four of them count as one, and then
/// every sixteen.
fn a_tick_goes_so_far<const N: usize>(stone: &'static Mutex<Stone<N>>)
where
    Grid<N>: Size,
{
    let mut stone = held(stone);
    stone.set(&Dense::from_fn(N, |[_, y, _]| y < 20), &Dense::new(N));
    let bit = Bit::MediumBall.on_grid(voxel(N));
    let rest = 19.53 + (bit.inner_radius() - bit.bite) as f32 / SUB as f32;
    let at = |x: f32, y: f32| Pose { position: Vec3::new(x, y, 40.5), rotation: Quat::IDENTITY };
    let walked = |y: f32, to: f32| {
        let frozen = stone.freeze(&bit, &at(20.0, y), &at(to, y));
        assert!(!frozen.blocked && frozen.steps == walk_steps(N), "{frozen:?}");
        frozen.pose.position.x - 20.0
    };
    let far = walk_steps(N) as f32 / 4.0;
    assert!((walked(rest, 120.0) - far).abs() < 0.1);
    assert!((walked(60.0, 1e4) - (16.0 * far - 3.0)).abs() < 0.1);
}

#[test]
fn a_tick_goes_so_far_at_128() {
    a_tick_goes_so_far::<128>(&STONE_128);
}

#[test]
fn a_tick_goes_so_far_at_256() {
    a_tick_goes_so_far::<256>(&STONE_256);
}

#[test]
fn looks_are_spread_over_the_rest_of_the_way() {
    for steps in 1..200 {
        for i in 0..steps + 1 {
            let looks: Vec<u32> = looks(i, steps).collect();
            let ways: Vec<u32> = [i].iter().chain(&looks).zip(&looks).map(|(a, b)| b - a).collect();
            assert_eq!(looks.len() as u32, LOOKS.min(steps - i));
            assert_eq!(ways.iter().sum::<u32>(), steps - i);
            let widest = ways.iter().max().copied().unwrap_or(1);
            assert!(ways.iter().all(|way| (1..=widest).contains(way) && widest - way <= 1));
        }
    }
}
