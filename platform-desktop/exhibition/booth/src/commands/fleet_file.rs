//! The file that lets headsets enrol: the booth's address, its keys, and a token that is counted and expires.

use std::time::Duration;

use paros_booth_rules::{Booth, BoothTime, Expected, Refusal};
use paros_protocol::EnrolmentToken;

use crate::random::random_bytes;

/// What a token allows.
pub(crate) struct FleetToken<'a> {
    /// The booth's address, as headsets reach it.
    pub address: &'a str,
    /// Headsets that it lets in.
    pub uses: u32,
    /// Days until it expires.
    pub days: u16,
    /// For people.
    pub note: &'a str,
}

/// Makes a token, and the file with it. It can't be read again.
///
/// # Errors
/// [`Refusal::Unfit`] for what is no address of a booth; those of the store.
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
