//! Layout of the panels in a frame.

use paros_core::limits::INTERVALS;
use paros_core::session::BitSize;
use paros_core::volume::{Grid, Size};
use paros_shaders::gpu::{self, RenderPath};
use paros_shell::statics::Resident;
use paros_shell::stl_export::{DEFAULT_HEIGHT_MM, print_scale};
use paros_visit::is_at_work;

use super::App;
use crate::window::display::supports_file_drops;
use crate::window::hands::RIGHT;
use crate::window::panels::{
    BitOutline, ItemGlow, MirrorGuide, StudioStatus, is_pasting_beyond_box,
};

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Lays the panels out in a picture of `size` pixels, and performs the actions that the visitor chose in
    /// them.
    pub(super) fn lay_out_panels_and_act(&mut self, size: [u32; 2]) {
        self.panels.input.time = Some(self.begun.elapsed().as_secs_f64());
        self.panels.set_window(size, self.scale);
        let world = self.studio.world();
        let session = world.session_state();
        let held = world.held_tool(RIGHT);
        let outline = BitOutline::project_bit(world, &self.hands.orbit, size);
        let mirror = MirrorGuide::project_mirror(world, &self.hands.orbit, size);
        let pointed = self.hands.pointed_item(world).filter(|_| !self.panels.wants_pointer());
        let glow =
            pointed.and_then(|item| ItemGlow::project_item(world, &self.hands.orbit, size, item));
        let (device, times) = match &self.view {
            Some(view) => (view.device_name(), view.gpu_times()),
            None => ("", gpu::FrameTimes::default()),
        };
        let status = StudioStatus {
            session,
            mode: world.mode(),
            held,
            size: held.map_or(BitSize::NATURAL, |(_, bit)| world.workbench().size_of(bit)),
            is_steadied: world.string_mm() > 0,
            depth_mm: self.hands.depth_mm(world),
            print_scale: print_scale(world, DEFAULT_HEIGHT_MM),
            bared_percent: world.bared_ends().percent(),
            tick: world.tick(),
            runs: world.hand_state(RIGHT).trigger,
            is_on_figure: world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask),
            pastes_beyond_box: is_pasting_beyond_box(world),
            symmetry: world.is_mirrored(),
            undo: world.undo_counts(),
            unfinished: self.studio.has_unfinished_sculpture(),
            one_before: self.studio.has_one_before(),
            printing: self.studio.is_exporting(),
            printed: self.studio.session_stl_path(),
            unwritten: self.studio.has_writes_to_retry(),
            slow: self.slowness.verdict().filter(|_| !self.kiosk.is_on && self.visits.is_none()),
            grid_side: N,
            fault: self.studio.save_error(),
            opening: self.studio.path_being_read(),
            language: self.visit_language(),
            visit: self.visit_phase(),
            has_guide: self.has_visit_guide(),
            is_asking: self.is_visit_asking(),
            kiosk: self.kiosk.is_on,
            seconds_to_handover: self.kiosk.seconds_to_handover(session, self.idle.time()),
            drops: self.window.as_deref().is_some_and(supports_file_drops),
            fast: self.path == RenderPath::Fast,
            device,
            times,
            outline: outline.as_ref(),
            mirror: mirror.as_ref(),
            glow: glow.as_ref(),
        };
        let (output, actions) = self.panels.lay_out(&status);
        // Visit phases without tools have no tool bar.
        let has_bar = self.visit_phase().is_none_or(is_at_work);
        let covered = if has_bar { self.panels.covered_part() } else { 0.0 };
        self.hands.orbit.set_covered_part(covered);
        self.egui_buffers.apply_atlas_changes(&output.textures_delta);
        let scale = output.pixels_per_point;
        let triangles = self.panels.context.tessellate(output.shapes, scale);
        self.egui_buffers.set_triangles_of_frame(&triangles, scale);
        actions.into_iter().for_each(|action| self.perform_action(action));
        self.click_by_touch();
    }
}
