//! The table of bits: the properties that other code relies on, and each bit's haptic pulse train.

use std::f32::consts::PI;

use glam::{Quat, Vec3};
use paros_core::edit::{Contact, Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{
    BOX_SIDE, BitAction, GridBit, GridShape, ToolBitSpec, haptic_amplitude,
};
use paros_core::limits::{SHELL_DEPTH, SMOOTH_LINES, SWEEP_PIECES};
use paros_core::session::{BitSize, Tool, ToolBit};
use paros_models::cases::random_cases;
use proptest::prelude::*;

/// Returns both grid sizes with the side of their voxels in micrometres.
fn grid_sizes() -> [(usize, f32); 2] {
    [128, 256].map(|n| (n, BOX_SIDE / n as f32 * 1e6))
}

/// Returns each bit in each of its sizes.
fn all_sizes() -> impl Iterator<Item = (ToolBit, ToolBitSpec)> {
    ToolBit::ALL.into_iter().flat_map(|bit| {
        let sizes = (i8::MIN..=i8::MAX).filter_map(move |steps| BitSize::of_bit(bit, steps));
        sizes.map(move |size| (bit, bit.spec_at(size)))
    })
}

fn all_grid_bits() -> impl Iterator<Item = (ToolBit, usize, GridBit)> {
    all_sizes()
        .flat_map(|(bit, spec)| grid_sizes().map(|(n, voxel)| (bit, n, spec.to_grid_bit(voxel))))
}

fn half_extents(bit: &GridBit) -> Vec3 {
    match bit.shape {
        GridShape::Ball(radius) => Vec3::splat(radius as f32 / SUBUNITS_PER_VOXEL as f32),
        GridShape::Box(half) => half.as_vec3() / SUBUNITS_PER_VOXEL as f32,
        GridShape::Disc { radius, half_thickness } => {
            Vec3::new(half_thickness as f32, radius as f32, radius as f32)
                / SUBUNITS_PER_VOXEL as f32
        }
    }
}

/// If a bit is no deeper than its bite at two poses a quarter voxel apart, its centre isn't in a voxel
/// between them.
#[test]
fn no_bit_can_jump_a_wall() {
    for (bit, n, grid) in all_grid_bits() {
        if let GridShape::Disc { half_thickness, .. } = grid.shape {
            // The part of a disc that may not enter stone is five eighths of it: thicker than a layer of
            // voxels, so a wall neither slips past it nor fits between two steps across its plane.
            assert!(2 * half_thickness * 5 / 8 > SUBUNITS_PER_VOXEL, "{bit:?} at {n}");
            continue;
        }
        let left =
            (grid.inscribed_radius_subunits() - grid.bite) as f32 / SUBUNITS_PER_VOXEL as f32;
        assert!(left > 0.87, "{bit:?} at {n}: {left}");
        let between = (left * left - 0.125 * 0.125).sqrt();
        assert!(between > 3f32.sqrt() / 2.0, "{bit:?} at {n}: {between}");
    }
}

#[test]
fn the_shell_is_as_deep_as_the_bite() {
    for ((bit, spec), (n, voxel)) in
        all_sizes().flat_map(|sized| grid_sizes().map(|grid| (sized, grid)))
    {
        let (grid, bite) = (spec.to_grid_bit(voxel), spec.bite_um as f32 / voxel);
        assert_eq!(grid.bite_depth_voxels(), bite.ceil() as usize, "{bit:?} at {n}");
        assert!((1..=SHELL_DEPTH).contains(&grid.bite_depth_voxels()), "{bit:?} at {n}");
    }
}

/// Half a turn is the maximum, because the shorter way round is taken.
#[test]
fn half_a_turn_fits_the_pieces_of_a_sweep() {
    for (bit, n, grid) in all_grid_bits() {
        let GridShape::Box(_) = grid.shape else { continue };
        let corner = half_extents(&grid).length();
        assert!(((corner * PI).ceil() as usize) < SWEEP_PIECES, "{bit:?} at {n}");
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE.normalize()] {
            let at = |angle| Pose {
                position: Vec3::splat(n as f32 / 2.0),
                rotation: Quat::from_axis_angle(axis, angle),
            };
            let pieces = grid.swept_brush(&at(0.0), &at(PI - 1e-3)).pieces().len();
            let turn = corner * (PI - 1e-3) / (pieces - 1) as f32;
            assert!(turn <= 1.001, "{bit:?} at {n}: corners move {turn} voxels");
        }
    }
}

proptest! {
    #![proptest_config(random_cases(2000))]

    /// A standing rasp fits the scratch memory at any rotation.
    #[test]
    fn a_rasp_fits_the_lines_of_a_smoothing_edit(
        turn in [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0],
    ) {
        for (n, voxel) in grid_sizes() {
            let rotation = Quat::from_array(turn).normalize();
            let rotation = if rotation.is_finite() { rotation } else { Quat::IDENTITY };
            let pose = Pose { position: Vec3::splat(n as f32 / 2.0), rotation };
            for bit in [ToolBit::File, ToolBit::Float] {
                let brush = bit.spec().to_grid_brush(voxel);
                let bounds = brush.swept_brush(&pose, &pose).bounds(n).expect("in the grid");
                let side = |i: usize| bounds.hi[i] - bounds.lo[i] + 1;
                let (ys, zs) = (side(1), side(2));
                prop_assert!(ys * zs <= SMOOTH_LINES * n, "{:?}: {} x {} at {}", bit, ys, zs, n);
            }
        }
    }
}

#[test]
fn names_numbers_and_tools_agree() {
    for (number, bit) in ToolBit::ALL.into_iter().enumerate() {
        assert_eq!(ToolBit::from_number(number as u8), Some(bit));
        assert_eq!(bit as usize, number);
        let data = bit.spec();
        assert_eq!(data.action == BitAction::Fill, data.tool == Tool::FillGun);
        assert_eq!(data.action.is_rubbing(), data.tool == Tool::Rasp);
        assert_eq!(data.bite_period > 1, data.tool == Tool::Impact, "impact tools bite in pulses");
        assert_eq!(
            data.haptic_train.len() % usize::from(data.bite_period),
            0,
            "pulses go with the bites"
        );
        let strongest = data.haptic_train.iter().max().expect("a train");
        assert!(
            data.bite_period == 1 || data.haptic_train[0] == *strongest,
            "strongest as it bites"
        );
    }
    assert_eq!(ToolBit::from_number(13), None);
    for tool in Tool::ALL {
        assert_eq!(tool.default_bit().spec().tool, tool);
    }
    let on = |tool| ToolBit::ALL.iter().filter(|bit| bit.spec().tool == tool).count();
    assert_eq!(Tool::ALL.map(on), [7, 3, 1, 2]);
}

fn contact_on(on_mask: bool) -> Contact {
    Contact { overlap: 7, depth: 100, normal: Vec3::Y, on_mask }
}

/// Two periods of each bit at 20 mm a tick: in stone, on the mask, and at rest.
const PULSES: &str = "\
small ball burr: 112 75 112 75 / 180 120 180 120 / 40
medium ball burr: 125 87 125 87 / 200 140 200 140 / 40
large ball burr: 138 138 94 138 138 94 / 220 220 150 220 220 150 / 40
cylinder cutter: 125 100 125 100 / 200 160 200 160 / 40
flat grinder: 94 106 119 106 94 106 119 106 / 150 170 190 170 150 170 190 170 / 40
point chisel: 160 75 25 0 0 0 160 75 25 0 0 0 / 255 120 40 0 0 0 255 120 40 0 0 0 / 40
flat chisel: 160 87 37 12 0 0 0 0 160 87 37 12 0 0 0 0 / 255 140 60 20 0 0 0 0 255 140 60 20 0 0 0 0 / 40
roughing ball burr: 160 138 150 112 160 138 150 112 / 255 220 240 180 255 220 240 180 / 40
disc saw: 100 125 112 138 100 125 112 138 / 160 200 180 220 160 200 180 220 / 40
paste nozzle: 37 37 / 60 60 / 40
rasp file: 56 18 56 37 56 18 56 37 / 90 30 90 60 90 30 90 60 / 40
float: 69 31 69 31 / 110 50 110 50 / 40
pitching chisel: 160 112 56 25 0 0 0 0 160 112 56 25 0 0 0 0 / 255 180 90 40 0 0 0 0 255 180 90 40 0 0 0 0 / 40
";

#[test]
fn pulse_trains_are_the_golden_ones() {
    let mut text = String::new();
    for bit in ToolBit::ALL {
        let data = bit.spec();
        let train = |on_mask| {
            let level = |phase| {
                haptic_amplitude(data, &contact_on(on_mask), true, phase, 20_000).to_string()
            };
            (0..2 * data.haptic_train.len() as u16).map(level).collect::<Vec<_>>().join(" ")
        };
        let rest = haptic_amplitude(data, &contact_on(false), false, 0, 20_000);
        text += &format!("{}: {} / {} / {rest}\n", data.name, train(false), train(true));
    }
    assert_eq!(text, PULSES, "\n{text}");
}

proptest! {
    #![proptest_config(random_cases(3000))]

    #[test]
    fn haptics_grow_with_speed_and_are_strongest_on_the_mask(
        number in 0..9u8,
        running in any::<bool>(),
        phase in any::<u16>(),
        mut speeds in [0..1_000_000u32, 0..60_000u32],
    ) {
        let data = ToolBit::from_number(number).expect("a bit of the table").spec();
        speeds.sort_unstable();
        let level = |contact: &Contact, speed| haptic_amplitude(data, contact, running, phase, speed);
        let [slow, fast] = speeds.map(|speed| level(&contact_on(false), speed));
        prop_assert!(slow <= fast);
        let on_mask = speeds.map(|speed| level(&contact_on(true), speed));
        prop_assert!(fast <= on_mask[0] && on_mask[0] <= on_mask[1]);
        let pulse = !running || data.haptic_train[usize::from(phase) % data.haptic_train.len()] > 0;
        prop_assert!(!pulse || slow > 0 && on_mask[0] > fast);
        let nothing = Contact { overlap: 0, depth: 0, normal: Vec3::ZERO, on_mask: false };
        prop_assert_eq!(speeds.map(|speed| level(&nothing, speed)), [0, 0]);
    }
}
