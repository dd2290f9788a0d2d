//! The staff's pages: rendered by the booth, with a small script and no content from other hosts.

mod account;
mod admin;
mod admin_texts;
mod done;
mod find;
mod forms;
mod frame;
mod hash_queue;
mod headsets;
mod import;
mod list;
mod list_texts;
mod live;
mod login;
mod login_gate;
mod mails;
mod notices;
mod origin;
mod page;
mod passwords;
mod print_texts;
mod prints;
mod privacy;
mod refusal_texts;
mod sculptures;
mod slip;
mod svg;
mod texts;

use std::sync::Arc;

use axum::Router;
use axum::extract::Path;
use axum::http::header;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Redirect, Response};
use axum::routing::{MethodRouter, any, get, post, put};

pub(crate) use frame::keep_frame;
pub(crate) use import::IMPORT_PATH;
pub(crate) use list::read_query;
pub(crate) use login_gate::LoginGate;
pub(crate) use page::Fields;
pub(crate) use passwords::{draw_password, make_hash};
pub(crate) use prints::read_size;
pub(crate) use svg::draw_badge;

use paros_booth_rules::{Reason, Refusal};

use self::page::{StaffAnswer, StaffView};
use crate::models::model::ModelFormat;
use crate::server::app::BoothApp;
use crate::server::page_guard::guard;
use crate::viewer;

/// Makes the routes of the staff's pages.
pub(crate) fn router(app: &Arc<BoothApp>) -> Router<Arc<BoothApp>> {
    let for_admins = Router::new()
        .route("/staff/admin", get(admin::show_admin))
        .route("/staff/admin/accounts", post(admin::add_account))
        .route("/staff/admin/accounts/{name}/password", post(admin::reset_password))
        .route("/staff/admin/accounts/{name}/{action}", post(admin::change_account))
        .route("/staff/admin/tokens", post(admin::add_token))
        .route("/staff/admin/tokens/{hash}/revoke", post(admin::revoke_token))
        .route("/staff/admin/clock", post(notices::confirm_clock))
        .route("/staff/audit", get(admin::show_audit))
        .route("/staff/import", get(import::show_import))
        .route(&format!("{IMPORT_PATH}{{headset}}/{{name}}"), put(import::import_parcel))
        .route("/staff/badges/{number}", get(privacy::show_known))
        .route("/staff/badges/{number}/export.zip", get(privacy::send_export))
        .route("/staff/badges/{number}/delete", post(privacy::delete_known))
        .route_layer(from_fn(admin::require_admin));
    let for_staff = Router::new()
        .merge(for_admins)
        .route("/staff/account", get(account::show_account))
        .route("/staff/account/password", post(account::change_password))
        .route("/staff", get(list::show_list))
        .route(live::CHANGES_PATH, get(live::stream_changes))
        .route("/staff/find", get(find::find))
        .route("/staff/sculptures/{id}", get(sculptures::show))
        .route("/staff/sculptures/{id}/picture.png", get(sculptures::send_picture))
        .route("/staff/sculptures/{id}/model.stl", send_model(ModelFormat::Stl))
        .route("/staff/sculptures/{id}/model.3mf", send_model(ModelFormat::Mf))
        .route("/staff/sculptures/{id}/model.glb", send_model(ModelFormat::Glb))
        .route("/staff/sculptures/{id}/mail", post(mails::ask_mail))
        .route("/staff/sculptures/{id}/print", post(prints::ask_print))
        .route("/staff/sculptures/{id}/slip", get(slip::show_slip))
        .route("/staff/sculptures/{id}/{action}", post(sculptures::change))
        .route("/staff/prints", get(prints::show_queue))
        .route("/staff/prints/{order}/slip", get(slip::show_order_slip))
        .route("/staff/prints/{order}/{step}", post(prints::step_print))
        .route("/staff/prints/{order}/send/{printer}", post(prints::send_print))
        .route("/staff/headsets", get(headsets::show_headsets))
        .route("/staff/headsets/{number}/{command}", post(headsets::ask_command))
        .route("/staff/{*rest}", any(no_page))
        .route_layer(from_fn(keep_frame))
        .route_layer(from_fn_with_state(app.clone(), login::require_login));
    Router::new()
        .merge(for_staff)
        .route("/", get(|| async { Redirect::to("/staff") }))
        .route("/privacy", get(privacy::show_privacy))
        .route("/staff/login", get(login::show_login).post(login::log_in))
        .route("/staff/first", get(login::show_first).post(login::add_first))
        .route("/staff/logout", post(login::log_out))
        .route("/staff/language/{code}", get(choose_language))
        .route("/staff/style.css", get(|| async { asset("text/css", include_str!("style.css")) }))
        .route(
            "/staff/page.js",
            get(|| async { asset("text/javascript", include_str!("page.js")) }),
        )
        .route_layer(from_fn(origin::check_origin))
        .route_layer(from_fn(guard))
        .merge(viewer::router())
}

fn send_model(format: ModelFormat) -> MethodRouter<Arc<BoothApp>> {
    get(move |app, view, id| sculptures::send_model(app, view, id, format))
}

fn asset(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind)], text).into_response()
}

/// Responds to unknown addresses.
async fn no_page(StaffView { texts, .. }: StaffView) -> StaffAnswer {
    StaffAnswer(texts, Refusal::NotFound(Reason::NoPage))
}

/// `GET /staff/language/{code}`: sets this browser's language.
async fn choose_language(Path(code): Path<String>) -> Response {
    let code = if code == "el" { "el" } else { "en" };
    let cookie =
        format!("language={code}; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=31536000");
    page::with_cookie(Redirect::to("/staff").into_response(), &cookie)
}
