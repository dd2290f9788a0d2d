//! Frames of the whole studio in the order in which they are drawn, beside other orders.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::size::{Grid, Size};
use paros_shaders::gpu::{Eye, Fov, Look, Order, Path, Picture, Stand};
use paros_shaders::scene::{Assembly, Fresh, SKY};
use paros_shell::statics::Resident;

use super::frames::{Kind, Studio, VIEWS, mean_ms};
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

/// As frames have it, then the others.
const ORDERS: [(Order, &str); 3] = [
    (Order::Between, "tools, sculpture, room"),
    (Order::First, "the sculpture first"),
    (Order::Last, "the sculpture last"),
];

/// The volume hangs in the studio. A visitor leans over it, a hand before it, while the stool turns.
pub(super) fn rows<const N: usize>(
    subject: &Subject,
    runs: usize,
    studio: &mut Studio,
) -> Result<Vec<Row>, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let middle = STOOL + Vec3::Y * (0.5 * BOX);
    let grip = (middle + Vec3::new(0.05, 0.05, 0.36), Quat::from_rotation_x(0.3));
    let fresh = Fresh { grips: [None, Some(grip)], hands: true, fraction: 1.0, time: 0.0 };
    let mut scene = Assembly::new();
    scene.assemble(&Grid::<N>::world(), &fresh);
    let pose = scene.sculpture();
    let eye = Eye {
        position: middle + Vec3::new(0.0, 0.15, 0.75),
        rotation: Quat::from_rotation_x(-0.2),
        fov: Fov { left: -0.75, right: 0.75, up: 0.8, down: -0.8 },
    };
    let mut rows = vec![];
    for kind in [Kind::ALL[0], Kind::HEADSET] {
        let eyes = [eye; 2];
        let easel = studio.easel(N, kind)?;
        let mut best = [[u64::MAX; VIEWS]; ORDERS.len()];
        for run in 0..=runs {
            for view in 0..VIEWS {
                let turn = view as f32 * (TAU / VIEWS as f32);
                let picture = Picture {
                    eyes: &eyes[..kind.eyes as usize],
                    stand: Stand { foot: pose.foot, side: pose.side, turn },
                    look: Look::studio(Path::Fast),
                    backdrop: SKY,
                    scene: Some(scene.list()),
                };
                for ((order, _), best) in ORDERS.iter().zip(&mut best) {
                    easel.draw_in(*order);
                    let times = easel.draw(&picture, &vec![])?;
                    // The first run is for drivers that put work off.
                    if run > 0 {
                        best[view] = best[view].min(times.tiles + times.sculpture + times.scene);
                    }
                }
            }
        }
        easel.draw_in(Order::default());
        let [ours, others @ ..] = best;
        for (other, (_, name)) in others.iter().zip(&ORDERS[1..]) {
            let against = format!("{name}, ours {}; {}", ORDERS[0].1, kind.name());
            let times = [mean_ms(&ours), mean_ms(other)];
            rows.push(Row::new("render", subject.name(), N, against).times(times));
        }
    }
    Ok(rows)
}
