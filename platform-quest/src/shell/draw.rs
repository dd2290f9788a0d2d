//! A frame: its ticks, then what both eyes see.

use std::path::Path;

use openxr as xr;
use paros_core::hand::RoomPose;
use paros_core::input::TICK_RATE;
use paros_core::size::{Grid, Size};
use paros_shaders::Image;
use paros_shaders::gpu::{Seen, Sync};
use paros_shaders::scene::Fresh;
use paros_shell::durable;
use paros_shell::statics::Resident;

use super::Shell;
use crate::error::{Doing, Error};
use crate::host::Host;
use crate::rig::Rig;
use crate::xr::{Session, Shot};

impl<const N: usize> Shell<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Waits for the next frame, ticks up to it, and draws it if anyone sees it.
    pub(super) fn frame(&mut self, rig: &mut Rig<N>, host: &mut dyn Host) -> Result<(), Error> {
        let frame = rig.session.waiter.wait().doing("wait for a frame")?;
        rig.session.stream.begin().doing("begin a frame")?;
        let at = frame.predicted_display_time;
        self.ticks(rig, at, host)?;
        self.frames += 1;
        if frame.should_render {
            return self.draw(rig, at);
        }
        rig.session.stream.end(at, rig.runtime.blend, &[]).doing("end an empty frame")
    }

    fn draw(&mut self, rig: &mut Rig<N>, at: xr::Time) -> Result<(), Error> {
        let world = self.studio.world();
        rig.show.begin(world)?;
        let image = rig.eyes.acquire()?;
        let hands = self.life.listens();
        let grips = if hands { grips(&rig.session, at)? } else { [None; 2] };
        let time = (world.tick() as f64 + f64::from(self.fraction)) / f64::from(TICK_RATE);
        let fresh = Fresh { grips, hands, fraction: self.fraction, time };
        // As late as can be.
        let [(left, left_view), (right, right_view)] = rig.session.eyes(at)?;
        let seen = Seen { eyes: &[left, right], fresh, path: self.options.path };
        rig.show.draw(world, &seen, &rig.eyes.surface, image, Sync::default())?;
        if let Some(prefix) = self.shot.take() {
            write_shot(&rig.eyes.shoot(image)?, &prefix)?;
        }
        rig.eyes.release()?;
        let when = (at, rig.runtime.blend);
        rig.eyes.end(&mut rig.session.stream, when, &rig.session.room, &[left_view, right_view])
    }
}

/// The freshest grips: newer than any tick's.
fn grips(session: &Session, at: xr::Time) -> Result<[Option<RoomPose>; 2], Error> {
    let mut grips = [None; 2];
    for (hand, grip) in grips.iter_mut().enumerate() {
        *grip = session.actions.grip(&session.room, hand, at)?;
        if let (None, Some(bare)) = (&grip, &session.bare) {
            *grip = bare.sample(&session.room, hand, at)?.and_then(|sample| sample.grip);
        }
    }
    Ok(grips)
}

fn write_shot(shot: &Shot, prefix: &Path) -> Result<(), Error> {
    for (name, pixels) in ["left", "right"].into_iter().zip(&shot.eyes) {
        let [width, height] = shot.extent.map(|pixels| pixels as usize);
        let image = Image { width, height, pixels: pixels.clone() };
        let mut png = Vec::new();
        image.write_png(&mut png).map_err(|error| Error::Input(error.to_string()))?;
        let mut path = prefix.as_os_str().to_owned();
        path.push(format!("-{name}.png"));
        durable::write(Path::new(&path), &png)?;
    }
    Ok(())
}
