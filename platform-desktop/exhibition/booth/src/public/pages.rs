//! The visitors' pages. Each is behind its link; all invalid links get the same response. An invalid link
//! costs one database query. There is no rate limit, as one of 2^128 tokens can't be guessed.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use axum::Router;
use axum::body::Body;
use axum::extract::{DefaultBodyLimit, Form, FromRequestParts, Path, Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use maud::{DOCTYPE, Markup, html};
use paros_booth_rules::records::Sculpture;
use paros_booth_rules::{Expected, LinkToken, Reason, Refusal};
use paros_core::badge::{BadgeNumber, Language};
use paros_protocol::SculptureId;
use tracing::warn;

use super::address::path_of;
use super::texts::PublicTexts;
use crate::clock::{booth_time, write_day};
use crate::models::model::ModelFormat;
use crate::models::picture::{self, draw_picture};
use crate::server::app::BoothApp;
use crate::server::connections::{Connection, Holder};
use crate::server::page_guard::guard;
use crate::server::routes::bound_and_count;
use crate::staff::draw_badge;
use crate::viewer::{self, draw_downloads, draw_viewer};

/// The most bytes of a form: it has one word.
const MAX_FORM_BYTES: usize = 4 << 10;

/// The sculpture of a valid link, and the language of its page.
pub(crate) struct PageVisit {
    sculpture: Sculpture,
    token: LinkToken,
    texts: &'static PublicTexts,
}

/// A refusal as a visitor's page.
pub(crate) struct PublicAnswer(&'static PublicTexts, Refusal);

type Answer = Result<Response, PublicAnswer>;

/// Makes the routes of the visitors' listener.
pub(crate) fn router(app: &Arc<BoothApp>) -> Router {
    let of_visit = Router::new()
        .route("/s/{id}/{token}", get(show))
        .route("/s/{id}/{token}/picture.png", get(send_picture))
        .route(
            "/s/{id}/{token}/model.stl",
            get(|app, visit| send_model(app, visit, ModelFormat::Stl)),
        )
        .route(
            "/s/{id}/{token}/model.3mf",
            get(|app, visit| send_model(app, visit, ModelFormat::Mf)),
        )
        .route(
            "/s/{id}/{token}/model.glb",
            get(|app, visit| send_model(app, visit, ModelFormat::Glb)),
        )
        .route("/s/{id}/{token}/delete", get(ask_delete).post(delete))
        .route("/public.css", get(send_style))
        .fallback(|headers: HeaderMap| async move {
            PublicAnswer(texts_of_browser(&headers), Refusal::NotFound(Reason::NoSculpture))
                .into_response()
        })
        .layer(from_fn(guard))
        .layer(from_fn(hide_address));
    Router::new()
        .merge(of_visit)
        .merge(viewer::router())
        .layer(DefaultBodyLimit::max(MAX_FORM_BYTES))
        .layer(from_fn_with_state(app.clone(), bound_and_count))
        .with_state(app.clone())
}

/// Keeps the address, which is secret, out of search engines and out of other sites' logs.
async fn hide_address(request: Request, next: Next) -> Response {
    let mut answer = next.run(request).await;
    let robots = HeaderName::from_static("x-robots-tag");
    answer.headers_mut().insert(robots, HeaderValue::from_static("noindex, nofollow"));
    let referrer = HeaderValue::from_static("no-referrer");
    answer.headers_mut().insert(header::REFERRER_POLICY, referrer);
    answer
}

impl FromRequestParts<Arc<BoothApp>> for PageVisit {
    type Rejection = PublicAnswer;

    async fn from_request_parts(
        parts: &mut Parts,
        app: &Arc<BoothApp>,
    ) -> Result<Self, PublicAnswer> {
        let texts = texts_of_browser(&parts.headers);
        let fail = |refusal| PublicAnswer(texts, refusal);
        let link = Path::<HashMap<String, String>>::from_request_parts(parts, app).await.ok();
        let hex = |name| SculptureId::parse_hex(link.as_ref()?.get(name)?);
        let found = match (hex("id"), hex("token")) {
            (Some(id), Some(token)) => {
                // A token has the same format as an id.
                let token = LinkToken(token.0);
                let found = app.run(move |app| app.booth.find_by_link(&id, &token));
                found.await.map(|sculpture| (sculpture, token))
            }
            _ => Err(Refusal::NotFound(Reason::NoSculpture)),
        };
        let (sculpture, token) = found.map_err(fail)?;
        if let Some(connection) = parts.extensions.get::<Arc<Connection>>() {
            connection.hold(Holder::Link(sculpture.id));
        }
        let texts = match parts.uri.query() {
            Some("language=el") => PublicTexts::of(Language::Greek),
            Some("language=en") => PublicTexts::of(Language::English),
            _ => PublicTexts::of(sculpture.visit_language()),
        };
        Ok(PageVisit { sculpture, token, texts })
    }
}

impl PageVisit {
    fn id(&self) -> SculptureId {
        SculptureId(self.sculpture.id)
    }

    fn path(&self) -> String {
        path_of(&self.id(), &self.token)
    }
}

/// `GET /s/{id}/{token}`.
async fn show(State(app): State<Arc<BoothApp>>, visit: PageVisit) -> Response {
    let PageVisit { texts, ref sculpture, .. } = visit;
    let at = visit.path();
    let last_day = write_day(app.booth.last_shown_day(sculpture));
    page(
        texts,
        Some(&at),
        &html! {
            (draw_picture(&at, sculpture, texts.picture))
            @if let Some(number) = sculpture.badge.and_then(BadgeNumber::new) {
                (draw_badge(&number.badge(), texts.language))
            }
            (draw_viewer(&format!("{at}/model.glb"), texts.language))
            (draw_downloads(&at, texts.language))
            p { (texts.kept_until) " " (last_day) "." }
            @if let Some(hours) = &app.facts.museum.opening_hours { p { (texts.open) ": " (hours) } }
            p { a href={ (at) "/delete?language=" (texts.code) } { (texts.delete) } }
        },
    )
}

/// `GET /s/{id}/{token}/picture.png`.
async fn send_picture(State(app): State<Arc<BoothApp>>, visit: PageVisit) -> Answer {
    let texts = visit.texts;
    let png = app.run(move |app| app.booth.read_picture(&visit.sculpture)).await;
    Ok(picture::send_picture(png.map_err(|refusal| PublicAnswer(texts, refusal))?))
}

/// `GET /s/{id}/{token}/model.*`.
async fn send_model(
    State(app): State<Arc<BoothApp>>,
    visit: PageVisit,
    format: ModelFormat,
) -> Answer {
    let PageVisit { sculpture, texts, .. } = visit;
    if !app.models_of_links.take(sculpture.id, Instant::now()) {
        let refusal = Refusal::Overloaded { retry_after: 20 };
        return Err(PublicAnswer(texts, refusal));
    }
    let head = format.headers("sculpture");
    let model = app.run_model(move |app| format.make(&app.booth, &sculpture)).await;
    let model = model.map_err(|refusal| PublicAnswer(texts, refusal))?;
    Ok((head, Body::from(model)).into_response())
}

/// `GET /s/{id}/{token}/delete`: asks for confirmation.
async fn ask_delete(visit: PageVisit) -> Response {
    let (texts, at) = (visit.texts, visit.path());
    page(
        texts,
        None,
        &html! {
            p { (texts.delete_really) }
            form method="post" action={ (at) "/delete?language=" (texts.code) } {
                input type="hidden" name="confirm" value="delete";
                button class="danger" { (texts.delete_for_good) }
            }
            p { a class="button" href={ (at) "?language=" (texts.code) } { (texts.back) } }
        },
    )
}

/// `POST /s/{id}/{token}/delete`.
async fn delete(
    State(app): State<Arc<BoothApp>>,
    visit: PageVisit,
    Form(fields): Form<HashMap<String, String>>,
) -> Answer {
    let texts = visit.texts;
    let fail = |refusal| PublicAnswer(texts, refusal);
    if fields.get("confirm").map(String::as_str) != Some("delete") {
        return Err(fail(Refusal::Unfit(Expected::Confirmation)));
    }
    let (id, token) = (visit.id(), visit.token);
    let done = app.run(move |app| app.booth.delete_by_link(&id, &token, booth_time()));
    done.await.map_err(fail)?;
    Ok(page(texts, None, &html! { p { (texts.deleted) } }))
}

async fn send_style() -> Response {
    ([(header::CONTENT_TYPE, "text/css")], include_str!("../staff/style.css")).into_response()
}

/// Makes a page. If `at` is its address, adds a link to the other language.
fn page(texts: &PublicTexts, at: Option<&str>, body: &Markup) -> Response {
    let markup = html! {
        (DOCTYPE)
        html lang=(texts.code) {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="referrer" content="no-referrer";
                title { (texts.title) }
                link rel="stylesheet" href="/public.css";
            }
            body {
                main class="visitor" {
                    @if let Some(at) = at {
                        p { a href={ (at) "?language=" (texts.other_code) } lang=(texts.other_code) { (texts.other_language) } }
                    }
                    h1 { (texts.title) }
                    (body)
                }
            }
        }
    };
    Html(markup.into_string()).into_response()
}

impl IntoResponse for PublicAnswer {
    fn into_response(self) -> Response {
        let PublicAnswer(texts, refusal) = self;
        let why = match &refusal {
            Refusal::NotFound(_) => texts.not_here,
            Refusal::Unfit(_) | Refusal::BadRequest(_) => texts.delete_really,
            _ => texts.busy,
        };
        if refusal.is_failure() {
            // Errors of the store and the disk contain no link.
            warn!(%refusal, "a visitor's page failed");
        }
        let mut answer = page(texts, None, &html! { p class="note" role="alert" { (why) } });
        let status = StatusCode::from_u16(refusal.status());
        *answer.status_mut() = status.unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        if let Some(seconds) = refusal.retry_after() {
            answer.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        answer
    }
}

/// Returns the texts in the browser's language, for pages without a sculpture.
fn texts_of_browser(headers: &HeaderMap) -> &'static PublicTexts {
    let wanted = headers.get(header::ACCEPT_LANGUAGE).and_then(|value| value.to_str().ok());
    let is_greek = wanted.is_some_and(|wanted| wanted.starts_with("el"));
    PublicTexts::of(if is_greek { Language::Greek } else { Language::English })
}
