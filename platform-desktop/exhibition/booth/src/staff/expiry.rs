//! The notices to admins of what lets headsets and browsers in and ends soon: fleets' files and certificates.

use std::time::Duration;

use maud::{Markup, html};
use paros_booth_rules::records::EnrolToken;
use paros_booth_rules::{BoothTime, LoggedIn};
use tokio_rustls::rustls::pki_types::{CertificateDer, pem::PemObject as _};

use super::admin_texts::AdminTexts;
use super::sculptures::utc;
use crate::settings::SiteFacts;
use crate::staff_certificate::end_of;

/// How long before an end it is told.
const TOLD_BEFORE: Duration = Duration::from_secs(30 * 86_400);

/// Draws a notice for each file that lets headsets in yet, and each certificate, that ends within 30 days. Nothing for
/// attendants.
pub(super) fn draw_expiry(
    facts: &SiteFacts,
    words: &AdminTexts,
    login: &LoggedIn,
    tokens: &[EnrolToken],
    now: BoothTime,
) -> Markup {
    if login.check_admin().is_err() {
        return Markup::default();
    }
    let is_soon = |end: &BoothTime| *end <= now.after(TOLD_BEFORE);
    let is_valid =
        |token: &&EnrolToken| !token.is_revoked && token.uses_left > 0 && now < token.expires_at;
    let files = tokens.iter().filter(is_valid).filter(|token| is_soon(&token.expires_at));
    let authority = CertificateDer::from_pem_slice(facts.ca_pem.as_bytes());
    let authority = authority.ok().and_then(|der| end_of(&der)).filter(is_soon);
    let of_staff = facts.of_staff.end().filter(is_soon);
    html! {
        @for token in files {
            p class="note" { (words.file_ends(&token.note, &utc(token.expires_at))) }
        }
        @if let Some(end) = of_staff { p class="note" { (words.staff_certificate_ends(&utc(end))) } }
        @if let Some(end) = authority { p class="note" { (words.authority_ends(&utc(end))) } }
    }
}
