//! A program that holds visits, for the tests of this crate and of `paros-upload`.

use std::path::Path;

use glam::Vec3;
use paros_core::TickInput;
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, Tool};
use paros_core::visit::{PanelAction, PlanSetting, Presence, VisitCommand, VisitInput, VisitPhase};
use paros_core::volume::Grid;

use super::{DrawPicture, Resident as _, Studio, StudioPaths};

/// Returns a visit's input with a command.
pub(crate) fn told(command: VisitCommand) -> TickInput {
    let visit = VisitInput { presence: Presence::Worn, is_used: true, command };
    TickInput { visit, ..TickInput::default() }
}

/// Runs ticks from the opening of visits to the first ticks of an export, with something cut.
pub(crate) fn sculpt_in_a_visit(studio: &mut Studio<'_, 128>) {
    studio.run_tick(&told(VisitCommand::Open));
    studio.run_tick(&told(VisitCommand::Set { setting: PlanSetting::HandsOff, value: 0 }));
    sculpt_as_next_visitor(studio);
}

/// Runs ticks from the arrival of a visitor to the first ticks of an export, with something cut.
pub(crate) fn sculpt_as_next_visitor(studio: &mut Studio<'_, 128>) {
    let press = |action| told(VisitCommand::Press(action));
    for input in [
        told(VisitCommand::None),
        press(PanelAction::Confirm),
        press(PanelAction::Confirm),
        press(PanelAction::Skip { all: true }),
    ] {
        studio.run_tick(&input);
    }
    let item = BenchItem::Tool(Tool::Rotary).number() as u8;
    let pointer = PointerCommand::Take { hand: 1, item };
    studio.run_tick(&TickInput { pointer, ..told(VisitCommand::None) });
    for tick in 0..60u16 {
        let position = Vec3::new(64.0, 64.0, 150.0 - f32::from(tick));
        let mut input = told(VisitCommand::None);
        input.hands[1] = studio.world().hand_with_bit_at(1, &Pose { position, ..Pose::ZERO });
        input.hands[1].trigger = 255;
        studio.run_tick(&input);
    }
    studio.run_tick(&press(PanelAction::Finish));
    while studio.world().visit().phase() != VisitPhase::Export {
        studio.run_tick(&told(VisitCommand::None));
    }
}

/// Runs a program's studio in a folder, from an empty world to the state in which `test` leaves it.
pub(crate) fn run_program(
    folder: &Path,
    draw_picture: DrawPicture<128>,
    test: impl FnOnce(&mut Studio<'_, 128>),
) {
    let (mut resident, mut stl_buffers) =
        (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
    resident.generate_starts();
    resident.world.clear();
    let paths = StudioPaths::inside_folder(folder);
    let mut studio = Studio::new(&mut resident, &mut stl_buffers, paths, draw_picture);
    test(&mut studio);
    drop(studio);
    // Other tests share the world.
    resident.world.clear();
}
