//! What admins alone see: accounts, the tokens of fleets, settings, and who did what.

use std::sync::Arc;

use axum::extract::{Extension, Path, Query, Request, State};
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{Account, AuditEntry, EnrolToken, StaffRole};
use paros_booth_rules::{BoothTime, LoggedIn, Refusal};
use paros_core::outbox::messages::{ContentHash, SculptureId};

use super::admin_texts::AdminTexts;
use super::login::{MIN_PASSWORD_CHARS, hash_password};
use super::page::{Fields, StaffAnswer, StaffForm, StaffView, action_button, form_token, page};
use super::sculptures::utc;
use super::texts::Texts;
use crate::app::App;
use crate::clock::booth_time;
use crate::fleet_file::{FleetToken, make_fleet_file};

/// Entries of the audit on a page.
const LISTED_ENTRIES: usize = 100;

/// Headsets that a token lets in at most, and days that it is valid.
const MAX_USES: u32 = 1000;
const MAX_DAYS: u16 = 365;

type Answer = Result<Response, StaffAnswer>;

/// Lets admins on; attendants are told that they aren't.
pub(crate) async fn require_admin(
    Extension(login): Extension<LoggedIn>,
    request: Request,
    next: Next,
) -> Answer {
    let texts = Texts::of_request(request.headers());
    login.check_admin().map_err(|refusal| StaffAnswer(texts, refusal))?;
    Ok(next.run(request).await)
}

/// `GET /staff/admin`.
pub(crate) async fn show_admin(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
    headers: HeaderMap,
) -> Answer {
    let words = AdminTexts::of(texts);
    let found = app.run(|app| Ok((app.booth.list_accounts()?, app.booth.list_enrol_tokens()?)));
    let (accounts, tokens) = found.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    let body = html! {
        p { a href="/staff/audit" { (words.audit) } }
        h2 { (words.accounts) }
        div class="wide" tabindex="0" role="region" aria-label=(words.accounts) { (accounts_table(texts, words, &login, &accounts)) }
        (new_account_form(texts, words, &login))
        h2 { (words.fleet_tokens) }
        @if !tokens.is_empty() {
            div class="wide" tabindex="0" role="region" aria-label=(words.fleet_tokens) { (tokens_table(words, &login, &tokens)) }
        }
        (new_token_form(words, &login, host))
        h2 { (words.settings) }
        div class="wide" tabindex="0" role="region" aria-label=(words.settings) {
            table {
                @for (name, value) in &app.facts.settings {
                    tr { th scope="row" { (name) } td { (value) } }
                }
            }
        }
    };
    Ok(page(texts, Some(&login), words.admin, &body))
}

/// `POST /staff/admin/accounts`.
pub(crate) async fn add_account(
    State(app): State<Arc<App>>,
    StaffForm { login, texts, fields }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let role = match fields.get("role").as_str() {
        "attendant" => StaffRole::Attendant,
        "admin" => StaffRole::Admin,
        _ => return Err(fail(Refusal::BadRequest("expected attendant or admin".into()))),
    };
    let hash = hash_password(&app, fields.get("password")).await.map_err(fail)?;
    let name = fields.get("name");
    let added = app.run(move |app| {
        app.booth.add_account(name.trim(), &hash, role, &login.account, booth_time())
    });
    added.await.map_err(fail)?;
    Ok(Redirect::to("/staff/admin").into_response())
}

/// `POST /staff/admin/accounts/{name}/{action}`: `disable` or `enable`.
pub(crate) async fn change_account(
    State(app): State<Arc<App>>,
    Path((name, action)): Path<(String, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let is_disabled = match action.as_str() {
        "disable" => true,
        "enable" => false,
        _ => return Err(fail(Refusal::NotFound("no such action"))),
    };
    let done = app.run(move |app| {
        app.booth.set_account_disabled(&name, is_disabled, &login.account, booth_time())
    });
    done.await.map_err(fail)?;
    Ok(Redirect::to("/staff/admin").into_response())
}

/// `POST /staff/admin/tokens`: makes one, and sends the fleet's file, which is all that ever shows it.
pub(crate) async fn add_token(
    State(app): State<Arc<App>>,
    StaffForm { login, texts, fields }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let (uses, days) = (fields.get("uses").parse().ok(), fields.get("days").parse().ok());
    let uses = uses.filter(|uses| (1..=MAX_USES).contains(uses));
    let days = days.filter(|days| (1..=MAX_DAYS).contains(days));
    let (Some(uses), Some(days)) = (uses, days) else {
        let why = format!("expected 1 to {MAX_USES} headsets and 1 to {MAX_DAYS} days");
        return Err(fail(Refusal::BadRequest(why)));
    };
    let made = app.run(move |app| {
        let (address, note) = (fields.get("address"), fields.get("note"));
        let note: String = note.trim().chars().take(80).collect();
        let token = FleetToken { address: address.trim(), uses, days, note: &note };
        make_fleet_file(&app.booth, &app.facts.ca_pem, &token, &login.account, booth_time())
    });
    let file = made.await.map_err(fail)?;
    let head = [
        (header::CONTENT_TYPE, "application/toml"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"paros-fleet.toml\""),
    ];
    Ok((head, file).into_response())
}

/// `POST /staff/admin/tokens/{hash}/revoke`.
pub(crate) async fn revoke_token(
    State(app): State<Arc<App>>,
    Path(hash): Path<String>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let hash = ContentHash::parse_hex(&hash);
    let hash = hash.ok_or(fail(Refusal::NotFound("no such enrolment token")))?;
    let done = app
        .run(move |app| app.booth.revoke_enrol_token(&hash.0, &login.account, booth_time()))
        .await;
    done.map_err(fail)?;
    Ok(Redirect::to("/staff/admin").into_response())
}

/// `GET /staff/audit?before=MILLISECONDS`.
pub(crate) async fn show_audit(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
    Query(fields): Query<Fields>,
) -> Answer {
    let words = AdminTexts::of(texts);
    let before = fields.get("before").parse().map_or(BoothTime(u64::MAX), BoothTime);
    let found = app.run(move |app| app.booth.list_audit_before(before, LISTED_ENTRIES)).await;
    let found = found.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let older = found.last().filter(|_| found.len() == LISTED_ENTRIES).map(|last| last.at.0);
    let body = html! {
        @if found.is_empty() { p { (texts.nothing) } }
        div class="wide" tabindex="0" role="region" aria-label=(words.audit) { (audit_table(texts, words, &found)) }
        @if let Some(older) = older {
            p { a class="button" href={ "/staff/audit?before=" (older) } { (words.older) } }
        }
    };
    Ok(page(texts, Some(&login), words.audit, &body))
}

fn accounts_table(
    texts: &Texts,
    words: &AdminTexts,
    login: &LoggedIn,
    accounts: &[Account],
) -> Markup {
    html! {
        table {
            tr { th scope="col" { (texts.name) } th scope="col" { (words.role) } th scope="col" { (words.state) } }
            @for Account { name, role, is_disabled, .. } in accounts {
                tr {
                    th scope="row" { (name) }
                    td { (words.role_name(*role)) }
                    td {
                        @if *is_disabled {
                            (words.disabled) " "
                            (action_button(login, &format!("/staff/admin/accounts/{name}/enable"), words.enable, ""))
                        } @else if *name != login.account {
                            (action_button(login, &format!("/staff/admin/accounts/{name}/disable"), words.disable, "danger"))
                        }
                    }
                }
            }
        }
    }
}

fn new_account_form(texts: &Texts, words: &AdminTexts, login: &LoggedIn) -> Markup {
    html! {
        details {
            summary { (words.new_account) }
            form class="narrow" method="post" action="/staff/admin/accounts" {
                input type="hidden" name="form" value=(form_token(login));
                label { (texts.name) input name="name" autocomplete="off" required maxlength="64"; }
                label { (words.first_password) input name="password" type="password" autocomplete="new-password" required minlength=(MIN_PASSWORD_CHARS); }
                label {
                    (words.role)
                    select name="role" {
                        option value="attendant" { (words.role_name(StaffRole::Attendant)) }
                        option value="admin" { (words.role_name(StaffRole::Admin)) }
                    }
                }
                button { (words.new_account) }
            }
        }
    }
}

fn tokens_table(words: &AdminTexts, login: &LoggedIn, tokens: &[EnrolToken]) -> Markup {
    let now = booth_time();
    html! {
        table {
            tr {
                th scope="col" { (words.note) } th scope="col" { (words.uses_left) }
                th scope="col" { (words.expires) } th scope="col" { (words.state) }
            }
            @for token in tokens {
                tr {
                    th scope="row" { (token.note) }
                    td { (token.uses_left) }
                    td { (utc(token.expires_at)) }
                    td {
                        @if token.is_revoked {
                            (words.revoked)
                        } @else if now >= token.expires_at || token.uses_left == 0 {
                            (words.over)
                        } @else {
                            (action_button(login, &format!("/staff/admin/tokens/{}/revoke", ContentHash(token.token_hash)), words.revoke, "danger"))
                        }
                    }
                }
            }
        }
    }
}

fn new_token_form(words: &AdminTexts, login: &LoggedIn, host: &str) -> Markup {
    html! {
        details {
            summary { (words.new_token) }
            form class="narrow" method="post" action="/staff/admin/tokens" {
                input type="hidden" name="form" value=(form_token(login));
                label { (words.note) input name="note" autocomplete="off" maxlength="80"; }
                label { (words.booth_address) input name="address" type="url" required maxlength="200" value={ "https://" (host) }; }
                label { (words.uses) input name="uses" type="number" min="1" max=(MAX_USES) value="50" required; }
                label { (words.days) input name="days" type="number" min="1" max=(MAX_DAYS) value="30" required; }
                p { (words.keep_file_secret) }
                button { (words.new_token) }
            }
        }
    }
}

fn audit_table(texts: &Texts, words: &AdminTexts, entries: &[AuditEntry]) -> Markup {
    html! {
        table {
            tr {
                th scope="col" { (words.what) } th scope="col" { (words.who) } th scope="col" { (words.when) }
                th scope="col" { (texts.headset) } th scope="col" { (words.sculpture) }
            }
            @for entry in entries {
                tr {
                    td { (entry.action) }
                    td { (entry.account.as_deref().unwrap_or(words.the_booth)) }
                    td { (utc(entry.at)) }
                    td { @if let Some(headset) = entry.headset { (headset) } }
                    td {
                        @if let Some(id) = entry.sculpture {
                            a href={ "/staff/sculptures/" (SculptureId(id)) } { (SculptureId(id).to_string()[..8]) }
                        }
                    }
                }
            }
        }
    }
}
