//! Draw order of the whole scene: the shipped order of tools, sculpture and room, beside other orders.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, RenderPath, RenderStyle, SculptureOrder, SculpturePlacement,
};
use paros_shaders::scene::{LatestInput, SKY, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shell::statics::Resident;

use super::clock::OursTheirs;
use super::frames::{FrameFormat, FrameTimer, mean_ms};
use super::framing::VIEWS;
use super::row::ReportRow;
use super::subject::BenchSubject;

/// The shipped order, then the others.
const ORDERS: [(SculptureOrder, &str); 3] = [
    (SculptureOrder::Between, "tools, sculpture, room"),
    (SculptureOrder::First, "the sculpture first"),
    (SculptureOrder::Last, "the sculpture last"),
];

/// Measures the draw orders. The subject is already loaded into the renderers. The eye leans over it with a
/// hand in front, while the stool turns.
pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + Resident<N, 1>,
{
    let middle = STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE);
    let scene = assemble_scene::<N>(middle);
    let pose = scene.sculpture_placement();
    let eye = Eye {
        position: middle + Vec3::new(0.0, 0.15, 0.75),
        rotation: Quat::from_rotation_x(-0.2),
        fov: Fov { left: -0.75, right: 0.75, up: 0.8, down: -0.8 },
    };
    let mut rows = vec![];
    for format in [FrameFormat::ALL[0], FrameFormat::HEADSET] {
        let eyes = [eye; 2];
        let renderer = timer.renderer_for(VolumeFormat::of::<N, 1>(), format)?;
        let mut best = [[u64::MAX; VIEWS]; ORDERS.len()];
        for run in 0..=runs {
            for view in 0..VIEWS {
                let turn = view as f32 * (TAU / VIEWS as f32);
                let request = FrameRequest {
                    eyes: &eyes[..format.eyes as usize],
                    placement: SculpturePlacement {
                        foot: pose.foot,
                        side: pose.side,
                        turn_radians: turn,
                    },
                    style: RenderStyle::in_studio(RenderPath::Fast),
                    backdrop: SKY,
                    scene: Some(scene.draw_list()),
                    panels: &[],
                };
                for ((order, _), best) in ORDERS.iter().zip(&mut best) {
                    renderer.set_draw_order(*order);
                    let times = renderer.draw_frame(&request, &vec![])?;
                    // The first run is a warm-up for drivers that defer work.
                    if run > 0 {
                        best[view] = best[view].min(times.tiles_ns + times.pass_ns);
                    }
                }
            }
        }
        renderer.set_draw_order(SculptureOrder::default());
        let [ours, others @ ..] = best;
        for (other, (_, name)) in others.iter().zip(&ORDERS[1..]) {
            let against = format!("{name}, ours {}; {}", ORDERS[0].1, format.name());
            let times = OursTheirs { ours: mean_ms(&ours), theirs: mean_ms(other) };
            rows.push(ReportRow::new("render", subject.name(), N, against).with_times_ms(times));
        }
    }
    Ok(rows)
}

/// Assembles the scene with a hand in front of the sculpture, whose middle is given in the room.
fn assemble_scene<const N: usize>(sculpture_middle_m: Vec3) -> SceneAssembler
where
    Grid<N>: Size + Resident<N, 1>,
{
    let grip = (sculpture_middle_m + Vec3::new(0.05, 0.05, 0.36), Quat::from_rotation_x(0.3));
    let fresh = LatestInput {
        grips: [None, Some(grip)],
        show_hands: true,
        tick_fraction: 1.0,
        ..LatestInput::default()
    };
    let mut scene = SceneAssembler::new();
    scene.assemble_frame(&Grid::<N>::lock_world().world, &fresh);
    scene
}
