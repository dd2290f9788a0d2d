//! A virtual headset, under whose number the booth lists the sculptures that it adds itself.

use paros_booth_rules::records::Device;
use paros_booth_rules::{Booth, BoothTime, Refusal};
use paros_protocol::{
    ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolmentToken, FleetEnrolment,
};

use crate::random::random_bytes;

/// Enrols a headset with this name, by an enrolment token that has this note and is valid for one minute.
///
/// # Errors
/// The name is not valid for a headset; the errors of [`Booth::enrol_fleet`].
pub(super) fn enrol_own_headset(
    booth: &Booth,
    (name, note): (&str, &str),
    now: BoothTime,
) -> Result<Device, Refusal> {
    let (fleet, token) = (EnrolmentToken(random_bytes()?), DeviceToken(random_bytes()?));
    let expires_at = BoothTime(now.0.saturating_add(60_000));
    booth.add_enrol_token(&fleet, (1, expires_at), note, None, now)?;
    let enrolment = FleetEnrolment {
        enrolment_token: fleet,
        token_hash: ContentHash::of(&token.0),
        hint: DeviceHint(random_bytes()?),
        name: DeviceName::new(name)
            .ok_or_else(|| Refusal::BadRequest("expected a headset's name".into()))?,
    };
    booth.enrol_fleet(&enrolment, now)?;
    booth.authenticate(&token)
}
