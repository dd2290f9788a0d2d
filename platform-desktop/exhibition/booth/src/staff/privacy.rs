//! Privacy pages: what is stored about visitors, for everybody; and the data under a badge, with export and
//! deletion, for admins.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use maud::{Markup, html};
use paros_booth_rules::records::MailOrder;
use paros_booth_rules::{BadgeRecords, Reason, Refusal, SculptureRecords};
use paros_core::badge::BadgeNumber;
use paros_protocol::SculptureId;

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::list_texts::ListTexts;
use super::page::{StaffAnswer, StaffForm, StaffView, action_button, frame_page};
use super::svg::draw_badge;
use super::texts::Texts;
use crate::clock::{booth_time, write_day, write_time};
use crate::commands::badge_export::write_export;
use crate::server::app::BoothApp;

type Answer = Result<Response, StaffAnswer>;

/// `GET /privacy`: lists what is stored and for how long. Public.
pub(crate) async fn show_privacy(State(app): State<Arc<BoothApp>>, headers: HeaderMap) -> Response {
    let texts = Texts::of_request(&headers);
    let words = AdminTexts::of(texts);
    let body = html! {
        @for line in words.privacy(&app.booth.plan()) { p { (line) } }
    };
    frame_page(texts, None, None, words.privacy_title, &body)
}

/// `GET /staff/badges/{number}`: all data that is stored under a badge.
pub(crate) async fn show_known(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Path(number): Path<u32>,
) -> Answer {
    let (login, texts) = (&view.login, view.texts);
    let words = AdminTexts::of(texts);
    let fail = |refusal| StaffAnswer(texts, refusal);
    let badge = find_badge(number).map_err(fail)?;
    let known = app.run(move |app| app.booth.list_known(badge)).await.map_err(fail)?;
    let at = format!("/staff/badges/{number}");
    let is_shared = known.sculptures.iter().any(|known| known.sculpture.claimed_badge.is_none());
    let body = html! {
        (draw_badge(&badge.badge(), texts.language))
        @if known == BadgeRecords::default() { p { (texts.nothing) } }
        @for known in &known.sculptures { (records_of(texts, words, known)) }
        @for announced in &known.announced {
            p { (texts.headset) " " (announced.headset) ", " (write_time(announced.heard_at)) ": " (texts.not_here_yet) }
        }
        @if !known.announced.is_empty() { p class="note" { (words.still_to_come) } }
        @for deleted in &known.deleted { p { (words.deleted_on) " " (write_time(deleted.deleted_at)) } }
        @if !known.sculptures.is_empty() {
            p { a class="button" href={ (at) "/export.zip" } { (words.export_all) } }
            @if is_shared { p class="note" { (words.others_too) } }
            details {
                summary { (words.delete_all) }
                (action_button(login, &format!("{at}/delete"), texts.delete_for_good, "danger"))
            }
        }
    };
    Ok(view.page(words.known, &body))
}

/// `GET /staff/badges/{number}/export.zip`.
pub(crate) async fn send_export(
    State(app): State<Arc<BoothApp>>,
    StaffView { texts, .. }: StaffView,
    Path(number): Path<u32>,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let badge = find_badge(number).map_err(fail)?;
    let made = app.run_decode(move |app| write_export(&app.booth, badge)).await;
    let head = [
        (header::CONTENT_TYPE, "application/zip".to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"paros-badge-{number}.zip\"")),
    ];
    Ok((head, Body::from(made.map_err(fail)?)).into_response())
}

/// `POST /staff/badges/{number}/delete`.
pub(crate) async fn delete_known(
    State(app): State<Arc<BoothApp>>,
    Path(number): Path<u32>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let badge = find_badge(number).map_err(fail)?;
    let done = app.run(move |app| app.booth.delete_known(badge, &login.account, booth_time()));
    done.await.map_err(fail)?;
    Ok(Done::BadgeDeleted.lead_to(&format!("/staff/badges/{number}")))
}

fn find_badge(number: u32) -> Result<BadgeNumber, Refusal> {
    BadgeNumber::new(number).ok_or(Refusal::NotFound(Reason::NoBadge))
}

fn records_of(texts: &Texts, words: &AdminTexts, known: &SculptureRecords) -> Markup {
    let SculptureRecords { sculpture, mails, prints, audit } = known;
    let id = SculptureId(sculpture.id);
    html! {
        section class="card" {
            h2 { a href={ "/staff/sculptures/" (id) } { (words.sculpture) " " (id.to_string()[..8]) } }
            p {
                (texts.headset) " " (sculpture.headset) br;
                (texts.received) " " (write_time(sculpture.received_at)) br;
                (words.kept_until) " " (write_day(sculpture.keep_day)) br;
                @if sculpture.has_trace { (words.has_trace) br; }
                @if let Some(at) = sculpture.withdrawn_at { (ListTexts::of(texts.language).withdrawn) " " (write_time(at)) br; }
            }
            ul {
                @for mail in mails { li { (mail_line(texts, mail)) } }
                @for print in prints { li { (words.print) " " (write_time(print.asked_at)) ": " (print.note) } }
                @for entry in audit {
                    li { (write_time(entry.at)) ": " (entry.action) " (" (entry.account.as_deref().unwrap_or(words.the_booth)) ")" }
                }
            }
        }
    }
}

fn mail_line(texts: &Texts, mail: &MailOrder) -> Markup {
    html! {
        (write_time(mail.asked_at)) ": " (texts.mail_state(mail.state))
        @if let Some(address) = &mail.address { ", " (address) }
    }
}
