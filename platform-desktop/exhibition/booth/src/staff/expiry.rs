//! The notices to admins of what lets headsets and browsers in and ends soon: fleets' files and certificates.

use std::time::Duration;

use maud::{Markup, html};
use paros_booth_rules::records::EnrolToken;
use paros_booth_rules::{BoothTime, LoggedIn};

use super::admin_texts::AdminTexts;
use super::sculptures::utc;
use crate::commands::settings::SiteFacts;

/// The time before an end from which on admins are told of it.
const TOLD_BEFORE: Duration = Duration::from_secs(30 * 86_400);

/// Draws a notice for each certificate, and each file by which headsets can enrol, that ends within 30 days. Draws nothing
/// for attendants.
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
    let is_told = |token: &&EnrolToken| token.has_uses_left(now) && is_soon(&token.expires_at);
    let files = tokens.iter().filter(is_told);
    let authority = facts.ca_end.filter(is_soon);
    let of_staff = facts.of_staff.end().filter(is_soon);
    html! {
        @for token in files {
            p class="note" { (words.file_ends(&token.note, &utc(token.expires_at))) }
        }
        @if let Some(end) = of_staff { p class="note" { (words.staff_certificate_ends(&utc(end))) } }
        @if let Some(end) = authority { p class="note" { (words.authority_ends(&utc(end))) } }
    }
}
