//! Headsets: how they are, what they are asked to do, and those that want to be let in.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::records::{Command, Device};
use paros_booth_rules::{AttemptView, BoothTime, LoggedIn, Reason, Refusal, device_status};
use paros_core::badge::Pictogram;
use paros_core::outbox::messages::{CommandKind, Heartbeat};

use super::done::Done;
use super::page::{StaffAnswer, StaffForm, StaffView, action_button};
use super::svg::draw_pictogram;
use super::texts::Texts;
use crate::app::BoothApp;
use crate::clock::booth_time;

/// Commands of a headset that are shown.
const LISTED_COMMANDS: usize = 3;

type Answer = Result<Response, StaffAnswer>;

/// A headset, as it is shown.
struct HeadsetView {
    device: Device,
    status: Option<Heartbeat>,
    commands: Vec<Command>,
}

/// `GET /staff/headsets`.
pub(crate) async fn show_headsets(State(app): State<Arc<BoothApp>>, view: StaffView) -> Answer {
    let (login, texts) = (&view.login, view.texts);
    let now = booth_time();
    let found = app.run(move |app| {
        let mut views = Vec::new();
        for device in app.booth.list_devices()? {
            let status = device_status(&device)?;
            let commands = app.booth.list_commands(device.headset, LISTED_COMMANDS, now)?;
            views.push(HeadsetView { device, status, commands });
        }
        Ok((views, app.booth.list_attempts(now)?))
    });
    let (views, attempts) = found.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let is_admin = login.check_admin().is_ok();
    let body = html! {
        @if is_admin && !attempts.is_empty() {
            h2 { (texts.new_headsets) }
            @for attempt in &attempts { (attempt_card(texts, login, attempt)) }
        }
        @if views.is_empty() { p { (texts.nothing) } }
        @for view in &views { (headset_card(texts, login, view, now)) }
    };
    Ok(view.page(texts.headsets, &body))
}

/// `POST /staff/headsets/{number}/{command}`.
pub(crate) async fn ask_command(
    State(app): State<Arc<BoothApp>>,
    Path((headset, kind)): Path<(u32, u8)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let kind = CommandKind::ALL.get(usize::from(kind)).copied();
    let kind = kind.ok_or(fail(Refusal::NotFound(Reason::NoPage)))?;
    let done =
        app.run(move |app| app.booth.ask_command(headset, kind, &login.account, booth_time()));
    done.await.map_err(fail)?;
    Ok(Done::CommandAsked.lead_to("/staff/headsets"))
}

/// `POST /staff/attempts/{number}/{action}`: `accept`, `decline`, or the number of the headset that it is.
pub(crate) async fn decide_attempt(
    State(app): State<Arc<BoothApp>>,
    Path((attempt, action)): Path<(u64, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    login.check_admin().map_err(fail)?;
    let is_declined = action == "decline";
    let done = app.run(move |app| {
        let (booth, by, now) = (&app.booth, login.account.as_str(), booth_time());
        match (action.as_str(), action.parse()) {
            ("accept", _) => booth.accept_attempt(attempt, None, by, now).map(drop),
            ("decline", _) => booth.decline_attempt(attempt, by, now),
            (_, Ok(headset)) => booth.accept_attempt(attempt, Some(headset), by, now).map(drop),
            _ => Err(Refusal::NotFound(Reason::NoPage)),
        }
    });
    done.await.map_err(fail)?;
    let told = if is_declined { Done::HeadsetDeclined } else { Done::HeadsetAccepted };
    Ok(told.lead_to("/staff/headsets"))
}

fn attempt_card(texts: &Texts, login: &LoggedIn, attempt: &AttemptView) -> Markup {
    let at = format!("/staff/attempts/{}", attempt.attempt);
    let shown: Vec<Pictogram> = attempt.pictograms.into_iter().filter_map(Pictogram::new).collect();
    html! {
        section class="card" {
            h3 { (attempt.name) }
            p { (texts.same_pictures) }
            div class="keys" role="img"
                aria-label={ @for pictogram in &shown { (pictogram.name(texts.language)) " " } } {
                @for pictogram in &shown { (draw_pictogram(*pictogram)) }
            }
            div class="actions" {
                @if let Some(headset) = attempt.maybe_headset {
                    (action_button(login, &format!("{at}/{headset}"), &format!("{} {headset}", texts.accept_as), ""))
                }
                (action_button(login, &format!("{at}/accept"), texts.accept, ""))
                (action_button(login, &format!("{at}/decline"), texts.decline, "danger"))
            }
        }
    }
}

fn headset_card(texts: &Texts, login: &LoggedIn, view: &HeadsetView, now: BoothTime) -> Markup {
    let HeadsetView { device, status, commands } = view;
    let at = format!("/staff/headsets/{}", device.headset);
    html! {
        section class="card" {
            h2 { (texts.headset) " " (device.headset) " " small { (device.name) } }
            p {
                (texts.last_seen) ": "
                @match device.seen_at {
                    Some(seen_at) => { (ago(texts, now.since(seen_at))) },
                    None => { "–" },
                }
                @if let Some(wiped_at) = device.wiped_at {
                    span class="note" { " " (texts.wiped) " " (super::sculptures::utc(wiped_at)) }
                }
            }
            @if let Some(status) = status {
                p {
                    @if let Some(percent) = status.battery_percent {
                        (texts.battery) " " (percent) " %" @if status.is_charging { " ⚡" } br;
                    }
                    @if status.is_worn {
                        (texts.worn) " " (status.worn_seconds / 60) " " (texts.minutes) br;
                    }
                    (texts.waiting) ": " (status.outbox_depth)
                }
            }
            div class="actions" {
                @for kind in CommandKind::ALL {
                    (action_button(login, &format!("{at}/{}", kind as u8), texts.command(kind), ""))
                }
            }
            @if !commands.is_empty() {
                ul {
                    @for command in commands {
                        @if let Some(kind) = CommandKind::ALL.get(usize::from(command.kind)) {
                            li { (texts.command(*kind)) ": " (texts.command_state(command.state)) }
                        }
                    }
                }
            }
        }
    }
}

fn ago(texts: &Texts, duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..60 => format!("{seconds} s"),
        seconds => format!("{} {}", seconds / 60, texts.minutes),
    }
}
