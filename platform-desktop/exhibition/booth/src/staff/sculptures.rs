//! The page of a sculpture: facts, downloads, withdrawal and deletion.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, State};
use axum::response::{IntoResponse, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{Announcement, Sculpture};
use paros_booth_rules::{Reason, Refusal};
use paros_core::badge::{BadgeNumber, Language};
use paros_protocol::SculptureId;

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::forms::{FormView, Refused};
use super::live::live;
use super::mails::{MAIL_FORM, mails_of};
use super::page::{StaffAnswer, StaffForm, StaffView, action_button};
use super::print_texts::PrintTexts;
use super::prints::{PRINT_FORM, prints_of};
use super::slip::link_actions;
use super::svg::draw_badge;
use super::texts::Texts;
use crate::clock::{booth_time, write_date, write_time};
use crate::models::model::ModelFormat;
use crate::models::picture::{self, draw_picture};
use crate::server::app::BoothApp;
use crate::viewer::{draw_downloads, draw_viewer};

/// The sculptures on a page of the list: rows of two to six thumbnails are complete.
pub(super) const LISTED: usize = 60;

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff/sculptures/{id}`.
pub(crate) async fn show(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Path(id): Path<String>,
) -> Answer {
    show_sculpture(&app, &view, &id, None).await
}

/// Responds with the sculpture's page, where a refused form shows the reason.
pub(super) async fn refuse_form(
    app: &Arc<BoothApp>,
    id: &str,
    form: StaffForm,
    (name, refusal): (&'static str, Refusal),
) -> Answer {
    let (view, refused) = form.refuse(name, &refusal);
    Ok(refused.answer(show_sculpture(app, &view, id, Some(&refused)).await?))
}

/// Makes a sculpture's page. `refused` is a form on it that was refused.
async fn show_sculpture(
    app: &Arc<BoothApp>,
    view: &StaffView,
    id: &str,
    refused: Option<&Refused>,
) -> Answer {
    let (login, texts) = (&view.login, view.texts);
    let found = find_sculpture(app, id).await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let id = SculptureId(found.id);
    let orders = app.run(move |app| Ok((app.booth.list_mails(&id)?, app.booth.list_prints(&id)?)));
    let (mails, prints) = orders.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let at = format!("/staff/sculptures/{id}");
    let mail_form = app.wakers.mails.as_ref().map(|_| FormView::of(refused, MAIL_FORM));
    let print_form = FormView::of(refused, PRINT_FORM);
    let body = html! {
        div class="sculpture" {
            section class="card" {
                (live("facts", &html! {
                    @if let Some(until) = app.booth.withdrawn_until(&found) {
                        p class="note" { (texts.withdrawn_until) " " (write_time(until)) "." }
                    }
                    (sculpture_facts(texts, &found))
                }))
                (draw_downloads(&at, texts.language))
                p class="actions" {
                    a class="button" href={ (at) "/slip" } { (PrintTexts::of(texts.language).slip) }
                }
                (actions_of(app, view, &found))
            }
            div {
                (draw_viewer(&format!("{at}/model.glb"), texts.language))
                (mails_of(texts, login, &found, &mails, mail_form))
                (prints_of(texts, login, &found, &prints, (print_form, app.wakers.slices.is_some())))
            }
        }
    };
    Ok(view.page(&heading_of(texts, &found), &body))
}

/// Draws the other actions for a sculpture.
fn actions_of(app: &BoothApp, view: &StaffView, sculpture: &Sculpture) -> Markup {
    let (login, texts) = (&view.login, view.texts);
    let at = format!("/staff/sculptures/{}", SculptureId(sculpture.id));
    html! {
        div class="actions" {
            @if sculpture.withdrawn_at.is_none() {
                (action_button(login, &format!("{at}/withdraw"), texts.withdraw, ""))
            } @else {
                (action_button(login, &format!("{at}/bring-back"), texts.bring_back, ""))
            }
            @if app.public_address.is_some() { (link_actions(texts, login, sculpture)) }
        }
        @if login.check_admin().is_ok() {
            @if let Some(number) = sculpture.badge {
                p { a href={ "/staff/badges/" (number) } { (AdminTexts::of(texts).known) } }
            }
            details {
                summary { (texts.delete) }
                (action_button(login, &format!("{at}/delete"), texts.delete_for_good, "danger"))
            }
        }
    }
}

fn heading_of(texts: &Texts, sculpture: &Sculpture) -> String {
    let mut heading = String::new();
    if let Some(badge) = sculpture.badge.and_then(BadgeNumber::new) {
        // Writing to a String doesn't fail.
        let _ = paros_core::badge::write_words(&mut heading, &badge.badge(), texts.language);
    } else {
        heading.push_str(texts.no_badge);
    }
    heading
}

/// `GET /staff/sculptures/{id}/picture.png`.
pub(crate) async fn send_picture(
    State(app): State<Arc<BoothApp>>,
    StaffView { texts, .. }: StaffView,
    Path(id): Path<String>,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let found = find_sculpture(&app, &id).await.map_err(fail)?;
    let png = app.run(move |app| app.booth.read_picture(&found)).await.map_err(fail)?;
    Ok(picture::send_picture(png))
}

/// `GET /staff/sculptures/{id}/model.stl`, `.3mf` and `.glb`.
pub(crate) async fn send_model(
    State(app): State<Arc<BoothApp>>,
    StaffView { texts, .. }: StaffView,
    Path(id): Path<String>,
    format: ModelFormat,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let found = find_sculpture(&app, &id).await.map_err(fail)?;
    let head = format.headers(&file_name(&found));
    let model = app.run_model(move |app| format.make(&app.booth, &found)).await.map_err(fail)?;
    Ok((head, Body::from(model)).into_response())
}

/// `POST /staff/sculptures/{id}/{action}`.
pub(crate) async fn change(
    State(app): State<Arc<BoothApp>>,
    Path((id, action)): Path<(String, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let id = parse_id(&id).map_err(fail)?;
    let done = match action.as_str() {
        "withdraw" => Done::Withdrawn,
        "bring-back" => Done::BroughtBack,
        "revoke-link" => Done::LinkRevoked,
        "renew-link" => Done::LinkRenewed,
        "delete" => Done::Deleted,
        _ => return Err(fail(Refusal::NotFound(Reason::NoPage))),
    };
    let at = format!("/staff/sculptures/{id}");
    let to = if done == Done::Deleted { "/staff" } else { at.as_str() };
    let changed = app.run(move |app| {
        let (booth, by, now) = (&app.booth, login.account.as_str(), booth_time());
        match done {
            Done::Withdrawn => booth.withdraw(&id, by, now),
            Done::BroughtBack => booth.bring_back(&id, by, now),
            Done::LinkRevoked => booth.revoke_link(&id, by, now),
            Done::LinkRenewed => booth.renew_link(&id, by, now).map(drop),
            _ => login.check_admin().and_then(|()| booth.delete(&id, by, now)),
        }
    });
    changed.await.map_err(fail)?;
    Ok(done.lead_to(to))
}

/// Parses the id in a page's address.
pub(super) fn parse_id(id: &str) -> Result<SculptureId, Refusal> {
    SculptureId::parse_hex(id).ok_or(Refusal::NotFound(Reason::NoSculpture))
}

async fn find_sculpture(app: &Arc<BoothApp>, id: &str) -> Result<Sculpture, Refusal> {
    let id = parse_id(id)?;
    app.run(move |app| app.booth.find_sculpture(&id)).await
}

pub(super) fn cards(texts: &Texts, sculptures: &[Sculpture]) -> Markup {
    html! {
        @if sculptures.is_empty() { p { (texts.nothing) } }
        ul class="cards" {
            @for sculpture in sculptures {
                li class="card" {
                    a href={ "/staff/sculptures/" (SculptureId(sculpture.id)) } {
                        (sculpture_facts(texts, sculpture))
                    }
                }
            }
        }
    }
}

fn sculpture_facts(texts: &Texts, sculpture: &Sculpture) -> Markup {
    let at = format!("/staff/sculptures/{}", SculptureId(sculpture.id));
    let note = badge_note(texts, sculpture);
    html! {
        (draw_picture(&at, sculpture, texts.picture))
        (badge_of(texts, sculpture.badge))
        @if !note.is_empty() { p class="note" { (note) } }
        p {
            (texts.headset) " " (sculpture.headset) br;
            (texts.received) " " (write_time(sculpture.received_at)) br;
            (texts.export(sculpture.export))
        }
    }
}

/// Returns a note if a badge may belong to another sculpture too; otherwise an empty text.
pub(super) fn badge_note(texts: &Texts, sculpture: &Sculpture) -> &'static str {
    match sculpture.claimed_badge {
        None if sculpture.is_badge_lapsed() => texts.badge_lapsed,
        None if sculpture.badge.is_some() => texts.badge_shared,
        _ => "",
    }
}

/// Draws the card of a sculpture that was announced and hasn't arrived.
pub(super) fn missing_card(texts: &Texts, announcement: &Announcement, is_lost: bool) -> Markup {
    html! {
        (badge_of(texts, announcement.badge))
        p class="note" { (if is_lost { texts.lost } else { texts.not_here_yet }) }
        p { (texts.headset) " " (announcement.headset) ", " (write_time(announcement.heard_at)) }
    }
}

pub(super) fn badge_of(texts: &Texts, badge: Option<u32>) -> Markup {
    match badge.and_then(BadgeNumber::new) {
        Some(number) => draw_badge(&number.badge(), texts.language),
        None => html! { p { (texts.no_badge) } },
    }
}

/// Returns the base name of a sculpture's files: the badge's pictures and the date of arrival.
fn file_name(sculpture: &Sculpture) -> String {
    let date = write_date(sculpture.received_at);
    match sculpture.badge.and_then(BadgeNumber::new) {
        Some(number) => {
            let badge = number.badge();
            let pictures = badge.pictograms.map(|picture| picture.name(Language::English));
            format!("paros-{}-{date}", pictures.join("-").replace(' ', "-"))
        }
        None => format!("paros-{}-{date}", SculptureId(sculpture.id)),
    }
}
