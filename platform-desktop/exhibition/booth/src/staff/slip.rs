//! A printed slip for the visitor: the badge and its words, the ordered print, and a QR code with the
//! sculpture's link if visitors have pages. Notes for staff are left out.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::records::{PrintOrder, Sculpture};
use paros_booth_rules::{LoggedIn, PrintJob};
use paros_core::badge::BadgeNumber;
use paros_protocol::SculptureId;

use super::page::{StaffAnswer, StaffView, action_button};
use super::print_texts::PrintTexts;
use super::prints::order_wish;
use super::sculptures::parse_id;
use super::svg::draw_badge;
use super::texts::Texts;
use crate::clock::write_time;
use crate::public::draw_qr;
use crate::server::app::BoothApp;

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff/sculptures/{id}/slip`.
pub(crate) async fn show_slip(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Path(id): Path<String>,
) -> Answer {
    let found = app.run(move |app| {
        let sculpture = app.booth.find_sculpture(&parse_id(&id)?)?;
        Ok(slip(app, &sculpture, None))
    });
    let slip = found.await.map_err(|refusal| StaffAnswer(view.texts, refusal))?;
    Ok(view.page(PrintTexts::of(view.texts.language).slip, &slip))
}

/// `GET /staff/prints/{order}/slip`.
pub(crate) async fn show_order_slip(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Path(order): Path<u64>,
) -> Answer {
    let found = app.run(move |app| {
        let PrintJob { order, sculpture } = app.booth.find_print(order)?;
        Ok(slip(app, &sculpture, Some(&order)))
    });
    let slip = found.await.map_err(|refusal| StaffAnswer(view.texts, refusal))?;
    Ok(view.page(PrintTexts::of(view.texts.language).slip, &slip))
}

/// Draws the slip, in the language of the visit.
fn slip(app: &BoothApp, sculpture: &Sculpture, order: Option<&PrintOrder>) -> Markup {
    let texts = Texts::of_visit(sculpture);
    let of_prints = PrintTexts::of(texts.language);
    html! {
        section class="slip" lang=(texts.code) {
            @match sculpture.badge.and_then(BadgeNumber::new) {
                Some(number) => { (draw_badge(&number.badge(), texts.language)) },
                None => { p { (texts.no_badge) } },
            }
            p { (texts.headset) " " (sculpture.headset) ", " (write_time(sculpture.received_at)) }
            @if let Some(order) = order {
                p { strong { (of_prints.state(order.state)) } }
                (order_wish(texts, order))
            }
            @if let Some(hours) = &app.facts.museum.opening_hours { p { (of_prints.open) ": " (hours) } }
            @if let Some(link) = link_of(app, sculpture) {
                p { (of_prints.scan) }
                (draw_qr(&link, of_prints.scan))
            }
        }
        p class="actions no-print" {
            button type="button" id="print-slip" { (of_prints.print_slip) }
        }
    }
}

/// Returns the visitor's link, if visitors have pages, the sculpture isn't withdrawn and the link isn't
/// revoked.
fn link_of(app: &BoothApp, sculpture: &Sculpture) -> Option<String> {
    let id = SculptureId(sculpture.id);
    let address = app.public_address.as_ref()?;
    let is_shown = sculpture.withdrawn_at.is_none();
    let token = app.booth.link_token(&id).ok().filter(|_| is_shown)?;
    Some(address.link(&id, &token))
}

/// Draws buttons that revoke a visitor's link, or make a new one.
pub(crate) fn link_actions(texts: &Texts, login: &LoggedIn, sculpture: &Sculpture) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    let at = format!("/staff/sculptures/{}", SculptureId(sculpture.id));
    html! {
        @if sculpture.is_link_revoked {
            span class="note" { (of_prints.link_revoked) }
        } @else {
            (action_button(login, &format!("{at}/revoke-link"), of_prints.revoke_link, "danger"))
        }
        (action_button(login, &format!("{at}/renew-link"), of_prints.renew_link, ""))
    }
}
