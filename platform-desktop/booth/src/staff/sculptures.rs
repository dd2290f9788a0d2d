//! Sculptures: listed, found, shown, downloaded, withdrawn and deleted.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{Announcement, Sculpture};
use paros_booth_rules::{
    BadgeMatches, BoothTime, FoundByBadge, MissingSculpture, Refusal, parse_badge_words,
};
use paros_core::badge::{Badge, BadgeColour, BadgeNumber, Pictogram};
use paros_core::outbox::messages::SculptureId;

use super::admin_texts::AdminTexts;
use super::mails::mails_of;
use super::page::{Fields, StaffAnswer, StaffForm, StaffView, action_button, page};
use super::print_texts::PrintTexts;
use super::prints::prints_of;
use super::slip::link_actions;
use super::svg::{draw_badge, draw_colour, draw_pictogram};
use super::texts::Texts;
use crate::app::App;
use crate::clock::booth_time;
use crate::model::ModelFormat;
use crate::viewer::draw_viewer;

/// Sculptures of a list.
const LISTED: usize = 60;

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff`: the newest.
pub(crate) async fn show_newest(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
) -> Answer {
    let found = app.run(|app| app.booth.list_newest(LISTED, booth_time())).await;
    let found = found.map_err(|refusal| StaffAnswer(texts, refusal))?;
    Ok(page(texts, Some(&login), texts.newest, &cards(texts, &found)))
}

/// `GET /staff/withdrawn`.
pub(crate) async fn show_withdrawn(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
) -> Answer {
    let found = app.run(|app| app.booth.list_withdrawn(LISTED, booth_time())).await;
    let found = found.map_err(|refusal| StaffAnswer(texts, refusal))?;
    Ok(page(texts, Some(&login), texts.withdrawn, &cards(texts, &found)))
}

/// `GET /staff/missing`: what was announced and hasn't come.
pub(crate) async fn show_missing(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
) -> Answer {
    let found = app.run(|app| app.booth.list_missing(LISTED)).await;
    let found = found.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let body = html! {
        @if found.is_empty() { p { (texts.nothing) } }
        ul class="cards" {
            @for MissingSculpture { announcement, is_lost } in &found {
                li class="card" { (missing_card(texts, announcement, *is_lost)) }
            }
        }
    };
    Ok(page(texts, Some(&login), texts.missing, &body))
}

/// `GET /staff/find`: by words, or by the numbers of a colour and four pictograms.
pub(crate) async fn find(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
    Query(fields): Query<Fields>,
) -> Answer {
    let (words, colour) = (fields.get("words"), fields.get("colour"));
    let asked = if !words.is_empty() {
        Some(parse_badge_words(&words).map_err(|fault| fault.to_string()))
    } else if !colour.is_empty() {
        let badge = read_tapped(&colour, &fields.get("pictures"));
        Some(badge.ok_or_else(|| "expected a colour and four pictures".to_owned()))
    } else {
        None
    };
    let result = match asked {
        None => html! {},
        Some(Err(why)) => html! { p class="note" role="alert" { (why) } },
        Some(Ok(badge)) => {
            let found = app.run(move |app| app.booth.find_by_badge(&badge, booth_time())).await;
            found_by_badge(texts, &badge, &found.map_err(|refusal| StaffAnswer(texts, refusal))?)
        }
    };
    let body = html! {
        (result)
        form method="get" action="/staff/find" {
            label { (texts.words) input name="words" value=(words) lang=(texts.code) autocomplete="off"; }
            button { (texts.find) }
        }
        h2 { (texts.tap_badge) }
        div class="chosen" {
            div id="chosen" aria-live="polite" {}
            button id="back" type="button" aria-label=(AdminTexts::of(texts).take_back) { "⌫" }
        }
        div class="keys" {
            @for colour in BadgeColour::ALL {
                button type="button" data-colour=(colour as u8) aria-label=(colour.name(texts.language)) {
                    (draw_colour(colour))
                }
            }
        }
        div class="keys" {
            @for pictogram in Pictogram::all() {
                button type="button" data-picture=(pictogram.number()) aria-label=(pictogram.name(texts.language)) {
                    (draw_pictogram(pictogram))
                }
            }
        }
    };
    Ok(page(texts, Some(&login), texts.find, &body))
}

/// `GET /staff/sculptures/{id}`.
pub(crate) async fn show(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
    Path(id): Path<String>,
) -> Answer {
    let found = find_sculpture(&app, &id).await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let id = SculptureId(found.id);
    let orders = app.run(move |app| Ok((app.booth.list_mails(&id)?, app.booth.list_prints(&id)?)));
    let (mails, prints) = orders.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let at = format!("/staff/sculptures/{id}");
    let is_admin = login.check_admin().is_ok();
    let body = html! {
        div class="card" { (sculpture_facts(texts, &found)) }
        (draw_viewer(&format!("{at}/model.glb"), texts.language))
        p class="actions" {
            @for format in ModelFormat::ALL {
                a class="button" href={ (at) "/model." (format.ending()) } {
                    (texts.download) " " (format.name())
                } " "
            }
            a class="button" href={ (at) "/slip" } { (PrintTexts::of(texts.language).slip) }
        }
        (mails_of(texts, &login, &found, &mails, app.wakers.mails.is_some()))
        (prints_of(texts, &login, &found, &prints, app.wakers.slices.is_some()))
        div class="actions" {
            @if found.withdrawn_at.is_none() {
                (action_button(&login, &format!("{at}/withdraw"), texts.withdraw, ""))
            } @else {
                (action_button(&login, &format!("{at}/bring-back"), texts.bring_back, ""))
            }
            @if app.public_address.is_some() { (link_actions(texts, &login, &found)) }
        }
        @if is_admin {
            @if let Some(number) = found.badge {
                p { a href={ "/staff/badges/" (number) } { (AdminTexts::of(texts).known) } }
            }
            details {
                summary { (texts.delete) }
                (action_button(&login, &format!("{at}/delete"), texts.delete_for_good, "danger"))
            }
        }
    };
    let badge = found.badge.and_then(BadgeNumber::new);
    let mut heading = String::new();
    if let Some(badge) = badge {
        // Writing to a String doesn't fail.
        let _ = paros_core::badge::write_words(&mut heading, &badge.badge(), texts.language);
    } else {
        heading.push_str(texts.no_badge);
    }
    Ok(page(texts, Some(&login), &heading, &body))
}

/// `GET /staff/sculptures/{id}/picture.png`.
pub(crate) async fn send_picture(
    State(app): State<Arc<App>>,
    StaffView { texts, .. }: StaffView,
    Path(id): Path<String>,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let found = find_sculpture(&app, &id).await.map_err(fail)?;
    match app.run(move |app| app.booth.read_picture(&found)).await.map_err(fail)? {
        Some(png) => Ok(([(header::CONTENT_TYPE, "image/png")], Body::from(png)).into_response()),
        None => Ok(StatusCode::NOT_FOUND.into_response()),
    }
}

/// `GET /staff/sculptures/{id}/model.stl`, `.3mf` and `.glb`.
pub(crate) async fn send_model(
    State(app): State<Arc<App>>,
    StaffView { texts, .. }: StaffView,
    Path(id): Path<String>,
    format: ModelFormat,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let found = find_sculpture(&app, &id).await.map_err(fail)?;
    let head = format.headers(&format!("paros-{}", SculptureId(found.id)));
    let model = app.run_model(move |app| format.make(&app.booth, &found)).await.map_err(fail)?;
    Ok((head, Body::from(model)).into_response())
}

/// `POST /staff/sculptures/{id}/{action}`.
pub(crate) async fn change(
    State(app): State<Arc<App>>,
    Path((id, action)): Path<(String, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let id = parse_id(&id).map_err(fail)?;
    let to =
        if action == "delete" { "/staff".to_owned() } else { format!("/staff/sculptures/{id}") };
    let done = app.run(move |app| {
        let (booth, by, now) = (&app.booth, login.account.as_str(), booth_time());
        match action.as_str() {
            "withdraw" => booth.withdraw(&id, by, now),
            "bring-back" => booth.bring_back(&id, by, now),
            "revoke-link" => booth.revoke_link(&id, by, now),
            "renew-link" => booth.renew_link(&id, by, now).map(drop),
            "delete" => login.check_admin().and_then(|()| booth.delete(&id, by, now)),
            _ => Err(Refusal::NotFound("no such action")),
        }
    });
    done.await.map_err(fail)?;
    Ok(Redirect::to(&to).into_response())
}

/// The id in a page's address.
pub(super) fn parse_id(id: &str) -> Result<SculptureId, Refusal> {
    SculptureId::parse_hex(id).ok_or(Refusal::NotFound("no such sculpture"))
}

async fn find_sculpture(app: &Arc<App>, id: &str) -> Result<Sculpture, Refusal> {
    let id = parse_id(id)?;
    app.run(move |app| app.booth.find_sculpture(&id, booth_time())).await
}

/// A badge of the numbers of a colour and of four pictograms with dashes between them.
fn read_tapped(colour: &str, pictures: &str) -> Option<Badge> {
    let colour = *BadgeColour::ALL.get(colour.parse::<usize>().ok()?)?;
    let numbers = pictures.split('-').map(|number| number.parse().ok().and_then(Pictogram::new));
    let pictograms: Vec<Pictogram> = numbers.collect::<Option<_>>()?;
    Some(Badge { colour, pictograms: pictograms.try_into().ok()? })
}

fn found_by_badge(texts: &Texts, badge: &Badge, found: &FoundByBadge) -> Markup {
    match found {
        FoundByBadge::Exact(matches) => html! {
            (draw_badge(badge, texts.language))
            (matches_of(texts, matches))
        },
        FoundByBadge::Nearest(nearest) => html! {
            (draw_badge(badge, texts.language))
            p class="note" { (texts.nearest) }
            @if nearest.is_empty() { p { (texts.nothing) } }
            @for (_, matches) in nearest { (matches_of(texts, matches)) }
        },
    }
}

fn matches_of(texts: &Texts, matches: &BadgeMatches) -> Markup {
    html! {
        @if matches.is_empty() { p { (texts.nothing) } }
        @if !matches.kept.is_empty() { (cards(texts, &matches.kept)) }
        ul class="cards" {
            @for announcement in &matches.missing {
                li class="card" { (missing_card(texts, announcement, false)) }
            }
        }
    }
}

fn cards(texts: &Texts, sculptures: &[Sculpture]) -> Markup {
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
    let at = format!("/staff/sculptures/{}/picture.png", SculptureId(sculpture.id));
    let claim = texts.claim(sculpture.claim);
    html! {
        img src=(at) alt=(texts.no_picture) width="192" height="192" loading="lazy";
        (badge_of(texts, sculpture.badge))
        @if !claim.is_empty() { p class="note" { (claim) } }
        p {
            (texts.headset) " " (sculpture.headset) br;
            (texts.received) " " (utc(sculpture.received_at)) br;
            (texts.export(sculpture.export))
        }
    }
}

fn missing_card(texts: &Texts, announcement: &Announcement, is_lost: bool) -> Markup {
    html! {
        (badge_of(texts, announcement.badge))
        p class="note" { (if is_lost { texts.lost } else { texts.not_here_yet }) }
        p { (texts.headset) " " (announcement.headset) ", " (utc(announcement.heard_at)) }
    }
}

pub(super) fn badge_of(texts: &Texts, badge: Option<u32>) -> Markup {
    match badge.and_then(BadgeNumber::new) {
        Some(number) => draw_badge(&number.badge(), texts.language),
        None => html! { p { (texts.no_badge) } },
    }
}

/// Date and time in UTC. The page of a tablet may know better; the booth's zone isn't known to it.
pub(crate) fn utc(time: BoothTime) -> String {
    let (day, second) = (u64::from(time.day()), time.seconds() % 86_400);
    // Days since the first of March of the year 0, by eras of 400 years (Hinnant's civil_from_days).
    let day = day + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let (date, month) = (of_year - (153 * month + 2) / 5 + 1, (month + 2) % 12 + 1);
    let year = era * 400 + year + u64::from(month <= 2);
    let (hour, minute) = (second / 3600, second / 60 % 60);
    format!("{year}-{month:02}-{date:02} {hour:02}:{minute:02} UTC")
}

#[cfg(test)]
mod tests {
    use paros_booth_rules::BoothTime;

    use super::{read_tapped, utc};

    #[test]
    fn times_are_dates() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_399, "2000-02-28 23:59 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (951_868_800, "2000-03-01 00:00 UTC"),
            (1_790_000_000, "2026-09-21 14:13 UTC"),
            (4_102_444_799, "2099-12-31 23:59 UTC"),
        ] {
            assert_eq!(utc(BoothTime(seconds * 1000)), text);
        }
    }

    #[test]
    fn a_badge_is_tapped_whole() {
        assert!(read_tapped("7", "0-1-2-63").is_some());
        for (colour, pictures) in [
            ("8", "0-1-2-3"),
            ("-1", "0-1-2-3"),
            ("0", "0-1-2-64"),
            ("0", "0-1-2"),
            ("0", "0-1-2-3-4"),
            ("0", ""),
        ] {
            assert_eq!(read_tapped(colour, pictures), None, "{colour} {pictures}");
        }
    }
}
