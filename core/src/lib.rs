//! Volume editing on range maps: a solid block that is carved and filled in real time, in fixed memory.
//!
//! The crate implements "Real-Time Volume Editing on Low-Power Virtual Reality Devices" (Evangelou,
//! Gkaravelis and Papaioannou, GRAPP 2023), *the paper* in these pages. A shell (an OpenXR program, a
//! window, a test) hands [`World::step`] the input of one tick, and reads events, dirty rectangles and a
//! digest of the state.
//!
//! # A range map in a picture
//! A [`RangeMaps`] holds one map an axis. A map holds one column for each cell of the face that its axis
//! passes through, and a column is an interval of occupied voxels. One layer of a volume, with its
//! columns along x on the right and those along y below:
//!
//! ```text
//!  y
//!  4   · · # # · ·    2..=3
//!  3   · # # # # ·    1..=4     columns along x: one for each (y, z)
//!  2   # # # # # #    0..=5
//!  1   # # # # # #    0..=5
//!  0   · # # # # ·    1..=4
//!  x   0 1 2 3 4 5
//!      1 0 0 0 0 1    first     columns along y: one for each (z, x)
//!      2 3 4 4 3 2    last
//! ```
//!
//! A voxel is occupied where all three of its columns hold it. At 128 voxels a side the three maps take
//! 96 KiB, where a grid of bytes takes 2 MiB.
//!
//! # The closure rule
//! The volume is always the intersection of its three range maps, and every range is *tight*: both
//! its end voxels are occupied. An edit is the exact boolean operation on voxels, followed by closure: the
//! ranges become the tight hulls of the result, and the volume becomes their intersection. So the only error
//! of a carve is to keep some voxels of its own brush, and a fill can add other voxels only along the three
//! beams of columns through its brush.
//!
//! A column of one interval can't hold a hole. `Volume<N, K>` and every type that holds a volume have a
//! second parameter: K, the number of intervals in a column, 1 by default. K intervals can represent K - 1
//! gaps. [`Volume`] documents the rule for them and its guarantees.
//!
//! # An example
//! A session on the solid block: the right hand takes the rotary tool and draws a groove through the top,
//! which is then exported as binary STL. To edit by brushes, without hands and tools, see [`apply_edit`].
//!
//! ```
//! use std::sync::Mutex;
//! use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool};
//! use paros_core::{Exporter, HandInput, RangeMaps, StartVolumes, TickInput, World};
//! use paros_core::{convert::ExportPhase, edit::Pose, glam::{Quat, Vec3}, volume::Axis};
//!
//! // All zero bytes at first: they live in statics and never move.
//! static WORLD: Mutex<World<64>> = Mutex::new(World::new());
//! static EXPORTER: Mutex<Exporter<64>> = Mutex::new(Exporter::new());
//! let (mut world, mut exporter) = (WORLD.lock().unwrap(), EXPORTER.lock().unwrap());
//! let mut block = RangeMaps::<64>::new();
//! block.fill_block();
//! let starts = StartVolumes { lump: &block, figures: &[], creative: &block, own: None };
//! world.step(&TickInput { start: SessionMode::FreeForm, ..Default::default() }, &starts);
//! let pointer = PointerCommand::Take { hand: 1, item: BenchItem::Tool(Tool::Rotary).number() as u8 };
//! world.step(&TickInput { pointer, ..Default::default() }, &starts);
//! for x in 20..44 {
//!     let bit = Pose { position: Vec3::new(x as f32, 63.0, 32.0), rotation: Quat::IDENTITY };
//!     let mut input = TickInput::default();
//!     input.hands[1] = HandInput { trigger: 255, ..world.hand_with_bit_at(1, &bit) };
//!     world.step(&input, &starts);
//!     println!("tick {}: {:?}, digest {:016x}", world.tick(), world.events(), world.digest());
//!     println!("upload {:?} of the map along y", world.dirty_rects().rects(Axis::Y));
//! }
//! # assert!(!world.volume().maps().contains([32, 63, 32]), "no groove");
//! let (mut stl, mut buffer) = (Vec::<u8>::new(), [0; 1 << 16]);
//! let mut phase = ExportPhase::Idle;
//! exporter.start_export(120.0).unwrap(); // millimetres high
//! while phase != ExportPhase::Done {
//!     let progress = exporter.advance_export(world.volume().rows(), world.mask(), 1000, &mut buffer);
//!     stl.extend(&buffer[..progress.written]);
//!     phase = progress.phase;
//! }
//! # assert_eq!(stl.len() as u64, exporter.file_len().unwrap());
//! ```
//!
//! `core/examples/` has two more examples: `carve_ball` edits a [`Volume`] by brushes, without hands and
//! tools, and `bare-metal` replays a session on a Cortex-M4 without an operating system.
//!
//! # Where things are
//! The root has the dozen types that a program starts from. The other public types are in five modules:
//! [`volume`] (grid, axes, columns, rectangles), [`edit`] (operations, poses, reports), [`convert`] (meshes
//! in, prints out), [`session`] (input, tools, hands) and [`codec`] (saves and traces). Two more modules are
//! independent of volumes: [`visit`], the state machine from putting on the headset to receiving the badge,
//! and [`badge`], the pictures by which a visitor finds a sculpture again, and the blocks of badge numbers.
//! Each module states its inputs and outputs, and what it doesn't depend on. [`limits`] has every capacity,
//! and [`internals`] the items that only tools and tests use.
//!
//! # What it does not do
//! It does no I/O, allocates nothing, reads no clock, draws no picture and never panics on input. Files, time
//! and devices belong to the shells (`paros-shell`), pictures to `paros-shaders`. A volume of one interval a
//! column can't hold a cavity that no axis sees; the [`EditReport`](edit::EditReport) says where.
//!
//! # Principles
//! 1. Data in, data out: a tick is a function of state, input and start volumes.
//! 2. Time is an argument: one step is a 72nd of a second, and the core reads no clock.
//! 3. Decisions are made in integers; floats carry poses between two ticks, and behave alike on
//!    every target (glam with `scalar-math`, libm).
//! 4. Memory is fixed: every capacity is in [`limits`] with its reason.
//! 5. All zero bytes are the empty world: it lives in a `static`, and never moves.
//! 6. Long work is a state machine with a budget in units of work, never in time.
//! 7. Every change is reported (columns, rows, events, rectangles), so that callers needn't compare states.
//! 8. Failure leaves the state untouched.
#![no_std]
#![forbid(unsafe_code)]

pub mod badge;
pub mod codec;
pub mod convert;
pub mod edit;
pub mod internals;
pub mod limits;
pub mod session;
pub mod visit;
pub mod volume;

pub use convert::bake::Baker;
pub use convert::export::Exporter;
pub use edit::brush::Brush;
pub use edit::operation::{Edit, apply_edit};
/// Vectors and quaternions used in public signatures.
pub use glam;
pub use session::events::WorldEvent;
pub use session::input::{HandInput, TickInput};
pub use session::start_volumes::{HiddenFigure, StartVolumes};
pub use session::world::World;
pub use volume::editable::Volume;
pub use volume::range_maps::RangeMaps;
