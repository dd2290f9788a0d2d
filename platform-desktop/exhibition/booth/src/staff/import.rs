//! The page where admins import parcels that were copied from a headset's disk. Its script sends each file in
//! a separate request.

use std::sync::Arc;

use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use maud::html;
use paros_booth_rules::{ImportOutcome, LoggedIn, Refusal};
use tracing::info;

use super::admin_texts::AdminTexts;
use super::page::{StaffAnswer, StaffView, check_form, form_token};
use crate::clock::booth_time;
use crate::commands::spool_import::read_parcel_name;
use crate::models::parcel_decode::check_parcel;
use crate::server::app::BoothApp;
use crate::server::routes::{read_length, read_parcel, refuse_after_body};

/// The path of imported parcels, before the headset's number and the file's name.
pub(crate) const IMPORT_PATH: &str = "/staff/import/";

/// The header with the form's token, as the body is the file.
const FORM_HEADER: &str = "form";

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff/import`.
pub(crate) async fn show_import(State(app): State<Arc<BoothApp>>, view: StaffView) -> Answer {
    let texts = view.texts;
    let words = AdminTexts::of(texts);
    let devices = app.run(|app| app.booth.list_devices()).await;
    let devices = devices.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let body = html! {
        p { (words.import_about) }
        noscript { p class="note" { (words.import_needs_script) } }
        form class="narrow" id="import" {
            input type="hidden" name="form" value=(form_token(&view.login));
            label {
                (texts.headset)
                select name="headset" {
                    @for device in &devices {
                        option value=(device.headset) { (device.headset) " " (device.name) }
                    }
                }
            }
            label {
                (words.import_files)
                input name="files" type="file" multiple required accept=".parcel,.sent,.refused";
            }
            button { (words.import) }
        }
        ul id="imported" role="status" data-failed=(texts.not_done) {}
    };
    Ok(view.page(words.import, &body))
}

/// `PUT /staff/import/{headset}/{name}`: a file of the headset's outbox. Responds with a sentence about the
/// outcome.
pub(crate) async fn import_parcel(
    State(app): State<Arc<BoothApp>>,
    Path((headset, name)): Path<(u32, String)>,
    StaffView { login, texts, .. }: StaffView,
    request: Request,
) -> Answer {
    let outcome = take_file(&app, &login, headset, &name, request).await;
    let outcome = outcome.map_err(|refusal| StaffAnswer(texts, refusal))?;
    if outcome == ImportOutcome::Taken {
        app.metrics.parcels.add(1);
        app.wakers.exports.wake();
    }
    info!(headset, name, ?outcome, "parcel imported");
    let told = AdminTexts::of(texts).import_outcome(outcome);
    Ok(([(header::CONTENT_TYPE, "text/plain; charset=utf-8")], told).into_response())
}

async fn take_file(
    app: &Arc<BoothApp>,
    login: &LoggedIn,
    headset: u32,
    name: &str,
    request: Request,
) -> Result<ImportOutcome, Refusal> {
    let head = check_head(login, name, request.headers());
    let (id, length) = match head {
        Ok(head) => head,
        Err(refusal) => return Err(refuse_after_body(request, refusal).await),
    };
    let (file, place) = read_parcel(app, headset, length, request).await?;
    let account = login.account.clone();
    app.run_decode(move |app| {
        let _place = place;
        app.booth.import_parcel(headset, (id, &file), &check_parcel, &account, booth_time())
    })
    .await
}

/// Checks that this login's own page sent a file. Returns its sculpture and length.
fn check_head(
    login: &LoggedIn,
    name: &str,
    headers: &HeaderMap,
) -> Result<(paros_protocol::SculptureId, u64), Refusal> {
    let token = headers.get(FORM_HEADER).and_then(|token| token.to_str().ok());
    check_form(login, token.unwrap_or_default())?;
    Ok((read_parcel_name(name)?, read_length(headers)?))
}
