//! The window's link to a booth.

use std::io::{self, Write as _};
use std::sync::Arc;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::settings::BoothSettings;
use paros_shell::statics::Resident;
use paros_shell::studio::{Notice, Studio};
use paros_sound::Speaker;
use paros_upload::connect;
use paros_upload::courier::{Courier, CourierLink, read_clock_ms};
use paros_upload::enrolment::Enrolment;
use paros_visit::{DeviceStatus, VisitOptions, answer_without_visits, send_plan};

use super::app::App;
#[cfg(not(feature = "booth"))]
use crate::commands::BUILD_COMMAND;

/// Starts uploading a studio's sculptures to the booth at which the device is enrolled. Returns the courier
/// that uploads them; `None` if the device isn't enrolled. Failures are reported, and the studio runs without
/// uploads.
pub(super) fn bring_to_booth<const N: usize>(
    studio: &mut Studio<'_, N>,
    settings: &BoothSettings,
    visits: Option<&VisitOptions>,
) -> Option<Arc<Courier>>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let sessions = studio.paths().sessions.clone();
    let courier = Courier::open_enrolled(settings, &sessions, read_clock_ms, open_link);
    let courier = courier.unwrap_or_else(|why| {
        write_line(&why);
        if visits.is_none() {
            studio.push_notice(Notice::Bad(why));
        }
        None
    });
    courier.map(|courier| connect(studio, courier, send_plan(settings, visits)))
}

/// Connects to the booth of an enrolment by HTTPS.
#[cfg(feature = "booth")]
#[expect(clippy::unnecessary_wraps, reason = "a build without HTTPS has an error")]
fn open_link(enrolment: &Enrolment) -> Result<CourierLink, String> {
    let (address, times) = (enrolment.booth_address(), paros_protocol::LinkTimes::default());
    Ok(Box::new(paros_upload_https::open_link(&address, times)))
}

/// Returns an error: this build has no HTTPS.
#[cfg(not(feature = "booth"))]
fn open_link(enrolment: &Enrolment) -> Result<CourierLink, String> {
    let address = &enrolment.address;
    Err(format!("nothing is sent to {address}: this build has no HTTPS; `{BUILD_COMMAND}` adds it"))
}

fn write_line(line: &str) {
    // Standard error may be closed.
    let _ = writeln!(io::stderr(), "paros: {line}");
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Carries out the booth's requests, reports the window's state to it, and shows the upload status of
    /// sculptures.
    pub(super) fn follow_booth(&mut self) {
        let Some(courier) = &self.courier else { return };
        let device = DeviceStatus::default();
        match &mut self.visits {
            Some(visits) => {
                visits.host.follow_courier(courier, self.studio.world().visit(), device);
                if visits.host.take_ring() {
                    self.speaker.iter_mut().for_each(Speaker::ring);
                }
            }
            None => answer_without_visits(courier, device),
        }
        let notes = courier.take_notes();
        for note in notes {
            write_line(&note);
            if self.visits.is_none() {
                self.studio.push_notice(Notice::Bad(note));
            }
        }
    }
}
