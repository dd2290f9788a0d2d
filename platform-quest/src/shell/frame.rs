//! A frame: wait, begin, ticks, drawing for both eyes, end.

use std::path::Path;
use std::time::Duration;

use openxr as xr;
use paros_core::limits::INTERVALS;
use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_shaders::gpu::{FrameSemaphores, Viewpoint};
use paros_shaders::scene::LatestInput;
use paros_shell::statics::Resident;

use super::HeadsetShell;
use crate::error::{CallContext, Error};
use crate::platform::Platform;
use crate::session_resources::SessionResources;
use crate::test_commands::write_picture;
use crate::xr::FrameCapture;

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Waits for the next frame, runs the ticks up to its display time, and draws it if the runtime
    /// wants it rendered.
    pub(super) fn wait_and_run_frame(
        &mut self,
        resources: &mut SessionResources<N>,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        let frame = resources.session.waiter.wait().could_not("wait for a frame")?;
        resources.session.stream.begin().could_not("begin a frame")?;
        let display_time = frame.predicted_display_time;
        self.run_ticks(resources, display_time, platform)?;
        self.frames += 1;
        if frame.should_render {
            let period = frame.predicted_display_period.as_nanos().max(0).cast_unsigned();
            self.draw_frame(resources, display_time, Duration::from_nanos(period), platform)?;
        } else {
            let (stream, blend_mode) =
                (&mut resources.session.stream, resources.runtime.blend_mode);
            stream.end(display_time, blend_mode, &[]).could_not("end an empty frame")?;
        }
        self.start.note_frame();
        Ok(())
    }

    /// Acquires both eyes' images, draws the world at the display time, and submits them.
    fn draw_frame(
        &mut self,
        resources: &mut SessionResources<N>,
        display_time: xr::Time,
        period: Duration,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        self.hand_over_previews(&mut resources.show.renderer);
        let world = self.studio.world();
        resources.show.wait_and_begin_frame(world)?;
        if self.resolution.observe_frame(resources.show.renderer.gpu_frame_times().total_ns, period)
        {
            let percent = self.resolution.percent();
            platform.log(format_args!("pictures of {percent} % a side, by the GPU's times"));
        }
        resources.eyes.choose_drawn_extent(&self.resolution);
        let framebuffer = resources.eyes.acquire_framebuffer()?;
        let has_focus = self.phase.has_focus();
        let is_moved = self.host_moves_hands();
        let session = &resources.session;
        let mut grips = [None; 2];
        if has_focus && !is_moved {
            // These grip poses are newer than any tick's.
            for (hand, reader) in self.hand_readers.iter().enumerate() {
                grips[hand] = session.locate_grip(hand, reader.source(), display_time)?;
            }
        }
        let time = (world.tick() as f64 + f64::from(self.tick_fraction)) / f64::from(TICK_RATE);
        let fresh = LatestInput {
            grips,
            show_hands: has_focus || is_moved,
            tick_fraction: self.tick_fraction,
            time_seconds: time,
            next_bites: [None; 2],
            show_mirror: true,
            light_targets: has_focus && !is_moved,
        };
        // Locate the eyes as late as possible: a later prediction is better.
        let [left, right] = session.locate_eyes(display_time)?;
        let seen = Viewpoint {
            eyes: &[left.eye, right.eye],
            latest: fresh,
            render_path: self.options.path,
            panels: &[self.charger.panels(), self.visit_panels()],
        };
        resources.show.draw_frame(
            world,
            &seen,
            &resources.eyes.surface,
            framebuffer,
            FrameSemaphores::default(),
        )?;
        if let Some(prefix) = self.capture_prefix.take() {
            write_capture(&resources.eyes.capture_frame(framebuffer)?, &prefix)?;
        }
        resources.eyes.release_images()?;
        let blend_mode = resources.runtime.blend_mode;
        resources.eyes.end_frame(
            &mut resources.session,
            display_time,
            blend_mode,
            &[left.view, right.view],
        )
    }
}

/// Writes both eyes' pictures to `PREFIX-left.png` and `PREFIX-right.png`.
fn write_capture(capture: &FrameCapture, prefix: &Path) -> Result<(), Error> {
    for (name, pixels) in ["left", "right"].into_iter().zip(&capture.eyes) {
        write_picture(prefix, name, capture.extent, pixels)?;
    }
    Ok(())
}
