//! Enrolment with a fleet file: a single request, as the site and its authority are known beforehand.

use paros_protocol::{EnrolAnswer, FLEET_ENROLMENT_PATH, FleetEnrolment};

use super::{EnrolError, Enrolment, FleetFile, NewDevice, ask};
use crate::{BoothCaller, OutboxOwner};

/// Enrols a device. `link` must trust only the fleet file's authority.
///
/// # Errors
/// Returns an error if the booth refuses or can't be reached; [`EnrolError::AnotherSite`] if the booth isn't
/// of the file's site.
pub fn enrol_by_fleet(
    link: &mut impl BoothCaller,
    fleet: &FleetFile,
    device: &NewDevice,
) -> Result<Enrolment, EnrolError> {
    let asked = FleetEnrolment {
        enrolment_token: fleet.enrolment_token,
        token_hash: device.token.hash(),
        hint: device.hint,
        name: device.name,
    };
    let body = ask(link, FLEET_ENROLMENT_PATH, &asked.to_json())?;
    let EnrolAnswer { headset, site } = EnrolAnswer::from_json(&body)?;
    if site != fleet.site {
        return Err(EnrolError::AnotherSite);
    }
    Ok(Enrolment {
        address: fleet.address.clone(),
        ca: fleet.ca.clone(),
        token: device.token,
        owner: OutboxOwner { site, headset },
    })
}
