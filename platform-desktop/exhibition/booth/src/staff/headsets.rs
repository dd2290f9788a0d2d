//! The page of headsets: their state, and the commands for them.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::records::{Command, Device};
use paros_booth_rules::{BoothTime, LoggedIn, Reason, Refusal, device_status};
use paros_protocol::{CommandKind, Heartbeat};

use super::done::Done;
use super::live::live;
use super::page::{StaffAnswer, StaffForm, StaffView, action_button};
use super::texts::Texts;
use crate::clock::{booth_time, write_time};
use crate::server::app::BoothApp;

/// The most commands of a headset that are shown.
const LISTED_COMMANDS: usize = 3;

type Answer = Result<Response, StaffAnswer>;

/// A headset as the page shows it.
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
        Ok((views, app.booth.count_badges()?))
    });
    let (views, badges) = found.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let body = html! {
        @if badges.are_scarce() { p class="note" { (texts.badges_scarce) ": " (badges.free) } }
        @if views.is_empty() { p { (texts.nothing) } }
        @for view in &views { (headset_card(texts, login, view, now)) }
    };
    Ok(view.page(texts.headsets, &live("headsets", &body)))
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
                    span class="note" { " " (texts.wiped) " " (write_time(wiped_at)) }
                }
            }
            @if let Some(Heartbeat { status, outbox_depth, .. }) = status {
                p {
                    @if let Some(percent) = status.battery_percent {
                        (texts.battery) " " (percent) " %" @if status.is_charging { " ⚡" } br;
                    }
                    @if status.is_worn {
                        (texts.worn) " " (status.worn_seconds / 60) " " (texts.minutes) br;
                    }
                    (texts.waiting) ": " (outbox_depth)
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
