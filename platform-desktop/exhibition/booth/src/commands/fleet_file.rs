//! The fleet file, which lets headsets enrol: the booth's address, its keys, and a token with a limited
//! number of uses and an expiry date.

use std::time::Duration;

use paros_booth_rules::{Booth, BoothTime, Expected, Refusal};
use paros_protocol::EnrolmentToken;

use crate::random::random_bytes;

/// The parameters of an enrolment token.
pub(crate) struct FleetToken<'a> {
    /// The booth's address that headsets connect to.
    pub address: &'a str,
    /// The number of headsets that the token can enrol.
    pub uses: u32,
    /// Days until it expires.
    pub days: u16,
    /// A note that staff see beside the token.
    pub note: &'a str,
}

/// Makes a token, and returns the fleet file with it. The token itself is not stored, so it can't be shown
/// again.
///
/// # Errors
/// [`Refusal::Unfit`] if the address isn't a booth's; errors of the store.
pub(crate) fn make_fleet_file(
    booth: &Booth,
    ca_pem: &str,
    token: &FleetToken<'_>,
    by: &str,
    now: BoothTime,
) -> Result<String, Refusal> {
    let FleetToken { address, uses, days, note } = *token;
    let is_plain = address
        .chars()
        .all(|letter| letter.is_ascii_graphic() && !matches!(letter, '"' | '\\' | '<' | '>'));
    if !address.starts_with("https://") || address.len() > 200 || !is_plain {
        return Err(Refusal::Unfit(Expected::BoothAddress));
    }
    let bits = EnrolmentToken(random_bytes()?);
    let expires_at = now.after(Duration::from_secs(86_400) * u32::from(days));
    booth.add_enrol_token(&bits, (uses, expires_at), note, Some(by), now)?;
    let keys = booth.keys();
    Ok(format!(
        "# Lets {uses} headsets enrol within {days} days. Whoever has it can enrol one: keep it to yourself.\n\
         address = \"{address}\"\nsite = \"{}\"\n\
         enrolment_token = \"{}\"\nca = \"\"\"\n{ca_pem}\"\"\"\n",
        keys.site,
        bits.reveal(),
    ))
}
