//! Notices to admins: a jump of the clock, and certificates and enrolment tokens that expire soon.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::records::EnrolToken;
use paros_booth_rules::{BoothTime, ClockJump, LoggedIn, Refusal};

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::page::{StaffAnswer, StaffForm, action_button};
use crate::clock::{booth_time, write_time};
use crate::server::app::BoothApp;

/// The time before an expiry from which on admins are notified.
const TOLD_BEFORE: Duration = Duration::from_secs(30 * 86_400);

/// The records from which the notices are made. Attendants get no notices.
#[derive(Default)]
pub(super) struct AdminNotices {
    tokens: Vec<EnrolToken>,
    clock_jump: Option<ClockJump>,
}

impl AdminNotices {
    /// Loads the records for the notices.
    ///
    /// # Errors
    /// The errors of the store.
    pub(super) fn find(app: &BoothApp, is_admin: bool, now: BoothTime) -> Result<Self, Refusal> {
        if !is_admin {
            return Ok(AdminNotices::default());
        }
        let (tokens, clock_jump) =
            (app.booth.list_enrol_tokens()?, app.booth.find_clock_jump(now)?);
        Ok(AdminNotices { tokens, clock_jump })
    }

    /// Draws the question about a clock jump, and a notice for each certificate and each enrolment token that
    /// expires within 30 days.
    pub(super) fn draw(
        &self,
        app: &BoothApp,
        words: &AdminTexts,
        login: &LoggedIn,
        now: BoothTime,
    ) -> Markup {
        if login.check_admin().is_err() {
            return Markup::default();
        }
        let is_soon = |end: &BoothTime| *end <= now.after(TOLD_BEFORE);
        let is_told = |token: &&EnrolToken| token.has_uses_left(now) && is_soon(&token.expires_at);
        let files = self.tokens.iter().filter(is_told);
        let authority = app.facts.ca_end.filter(is_soon);
        let of_staff = app.facts.of_staff.end().filter(is_soon);
        html! {
            @if let Some(ClockJump { seen_at, now }) = self.clock_jump {
                div class="note" {
                    p { (words.clock_jumped(&write_time(now), &write_time(seen_at))) }
                    (action_button(login, "/staff/admin/clock", words.clock_is_right, ""))
                }
            }
            @for token in files {
                p class="note" { (words.file_ends(&token.note, &write_time(token.expires_at))) }
            }
            @if let Some(end) = of_staff { p class="note" { (words.staff_certificate_ends(&write_time(end))) } }
            @if let Some(end) = authority { p class="note" { (words.authority_ends(&write_time(end))) } }
        }
    }
}

/// `POST /staff/admin/clock`: confirms that the clock is right.
pub(crate) async fn confirm_clock(
    State(app): State<Arc<BoothApp>>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Result<Response, StaffAnswer> {
    let done = app.run(move |app| app.booth.confirm_clock(&login.account, booth_time())).await;
    done.map_err(|refusal| StaffAnswer(texts, refusal))?;
    Ok(Done::ClockConfirmed.lead_to("/staff"))
}
