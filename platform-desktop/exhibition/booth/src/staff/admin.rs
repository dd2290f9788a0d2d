//! The pages for admins only: accounts, enrolment tokens, settings, and the audit log.

use std::sync::Arc;

use axum::extract::{Extension, Path, Query, Request, State};
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{Account, AuditEntry, EnrolToken, StaffRole};
use paros_booth_rules::{BoothTime, Expected, LoggedIn, Reason, Refusal};
use paros_protocol::{ContentHash, SculptureId};

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::forms::{FormView, Refused};
use super::login_gate::Asker;
use super::notices::AdminNotices;
use super::page::{Fields, StaffAnswer, StaffForm, StaffView, action_button, form_token};
use super::passwords::hash_password;
use super::texts::Texts;
use crate::clock::{booth_time, write_time};
use crate::commands::fleet_file::{FleetToken, make_fleet_file};
use crate::server::app::BoothApp;

/// Entries of the audit log on one page.
const LISTED_ENTRIES: usize = 100;

/// The most headsets that a token can enrol, and the longest validity in days.
const MAX_USES: u32 = 1000;
const MAX_DAYS: u16 = 365;

/// The names of the forms on the page.
const ACCOUNT_FORM: &str = "account";
const TOKEN_FORM: &str = "token";
const RESET_FORM: &str = "reset";

type Answer = Result<Response, StaffAnswer>;

/// Lets admins through, and refuses attendants.
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
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    headers: HeaderMap,
) -> Answer {
    admin_page(&app, &view, &headers, None).await
}

/// Makes the admins' page. `refused` is a form on it that was refused.
async fn admin_page(
    app: &Arc<BoothApp>,
    view: &StaffView,
    headers: &HeaderMap,
    refused: Option<&Refused>,
) -> Answer {
    let (login, texts) = (&view.login, view.texts);
    let words = AdminTexts::of(texts);
    let now = booth_time();
    let found = app.run(move |app| {
        let notices = AdminNotices::find(app, true, now)?;
        Ok((app.booth.list_accounts()?, app.booth.list_enrol_tokens()?, notices))
    });
    let (accounts, tokens, notices) = found.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    let body = html! {
        (notices.draw(app, words, login, now))
        p { a href="/staff/audit" { (words.audit) } }
        p { a href="/staff/import" { (words.import) } }
        h2 { (words.accounts) }
        div class="wide" tabindex="0" role="region" aria-label=(words.accounts) { (accounts_table(texts, words, login, &accounts, FormView::of(refused, RESET_FORM))) }
        (new_account_form(texts, words, login, FormView::of(refused, ACCOUNT_FORM)))
        h2 { (words.fleet_tokens) }
        @if !tokens.is_empty() {
            div class="wide" tabindex="0" role="region" aria-label=(words.fleet_tokens) { (tokens_table(words, login, &tokens)) }
        }
        (new_token_form(words, login, host, FormView::of(refused, TOKEN_FORM)))
        h2 { (words.settings) }
        div class="wide" tabindex="0" role="region" aria-label=(words.settings) {
            table {
                @for (name, value) in &app.facts.settings {
                    tr { th scope="row" { (name) } td { (value) } }
                }
            }
        }
    };
    Ok(view.page(words.admin, &body))
}

/// Responds with the admins' page, where a refused form shows the reason.
async fn refuse_form(
    app: &Arc<BoothApp>,
    headers: &HeaderMap,
    form: StaffForm,
    (name, refusal): (&'static str, Refusal),
) -> Answer {
    let (view, refused) = form.refuse(name, &refusal);
    Ok(refused.answer(admin_page(app, &view, headers, Some(&refused)).await?))
}

/// `POST /staff/admin/accounts`.
pub(crate) async fn add_account(
    State(app): State<Arc<BoothApp>>,
    headers: HeaderMap,
    form: StaffForm,
) -> Answer {
    match make_account(&app, &form).await {
        Ok(()) => Ok(Done::AccountAdded.lead_to("/staff/admin")),
        Err(refusal) => refuse_form(&app, &headers, form, (ACCOUNT_FORM, refusal)).await,
    }
}

async fn make_account(
    app: &Arc<BoothApp>,
    StaffForm { login, fields, .. }: &StaffForm,
) -> Result<(), Refusal> {
    let role = match fields.get("role").as_str() {
        "attendant" => StaffRole::Attendant,
        "admin" => StaffRole::Admin,
        _ => return Err(Refusal::Unfit(Expected::Role)),
    };
    let asker = Asker::Account(login.account.clone());
    let hash = hash_password(app, asker, fields.get("password")).await?;
    let (name, by) = (fields.get("name"), login.account.clone());
    app.run(move |app| app.booth.add_account(name.trim(), &hash, role, &by, booth_time())).await
}

/// `POST /staff/admin/accounts/{name}/password`: sets a new password for another account.
pub(crate) async fn reset_password(
    State(app): State<Arc<BoothApp>>,
    Path(name): Path<String>,
    headers: HeaderMap,
    form: StaffForm,
) -> Answer {
    match set_password_of(&app, name, &form).await {
        Ok(()) => Ok(Done::PasswordReset.lead_to("/staff/admin")),
        Err(refusal) => refuse_form(&app, &headers, form, (RESET_FORM, refusal)).await,
    }
}

async fn set_password_of(
    app: &Arc<BoothApp>,
    name: String,
    StaffForm { login, fields, .. }: &StaffForm,
) -> Result<(), Refusal> {
    // The form for one's own password asks for the current one, as a tablet may be left unattended.
    if name == login.account {
        return Err(Refusal::Forbidden(Reason::OwnPassword));
    }
    let asker = Asker::Account(login.account.clone());
    let hash = hash_password(app, asker, fields.get("password")).await?;
    let by = login.account.clone();
    app.run(move |app| app.booth.reset_password(&name, &hash, &by, booth_time())).await.map(drop)
}

/// `POST /staff/admin/accounts/{name}/{action}`: `disable` or `enable`.
pub(crate) async fn change_account(
    State(app): State<Arc<BoothApp>>,
    Path((name, action)): Path<(String, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let is_disabled = match action.as_str() {
        "disable" => true,
        "enable" => false,
        _ => return Err(fail(Refusal::NotFound(Reason::NoPage))),
    };
    let done = app.run(move |app| {
        app.booth.set_account_disabled(&name, is_disabled, &login.account, booth_time())
    });
    done.await.map_err(fail)?;
    let told = if is_disabled { Done::AccountDisabled } else { Done::AccountEnabled };
    Ok(told.lead_to("/staff/admin"))
}

/// `POST /staff/admin/tokens`: makes a token, and sends the fleet file. The token isn't shown anywhere else.
pub(crate) async fn add_token(
    State(app): State<Arc<BoothApp>>,
    headers: HeaderMap,
    form: StaffForm,
) -> Answer {
    match make_token(&app, &form).await {
        Ok(file) => {
            let head = [
                (header::CONTENT_TYPE, "application/toml"),
                (header::CONTENT_DISPOSITION, "attachment; filename=\"paros-fleet.toml\""),
            ];
            Ok(Done::TokenMade.tell_on_next_page((head, file).into_response()))
        }
        Err(refusal) => refuse_form(&app, &headers, form, (TOKEN_FORM, refusal)).await,
    }
}

async fn make_token(
    app: &Arc<BoothApp>,
    StaffForm { login, fields, .. }: &StaffForm,
) -> Result<String, Refusal> {
    let (uses, days) = (fields.get("uses").parse().ok(), fields.get("days").parse().ok());
    let uses = uses.filter(|uses| (1..=MAX_USES).contains(uses));
    let days = days.filter(|days| (1..=MAX_DAYS).contains(days));
    let (Some(uses), Some(days)) = (uses, days) else {
        return Err(Refusal::Unfit(Expected::FleetBounds { uses: MAX_USES, days: MAX_DAYS }));
    };
    let (address, note, by) = (fields.get("address"), fields.get("note"), login.account.clone());
    app.run(move |app| {
        let note: String = note.trim().chars().take(80).collect();
        let token = FleetToken { address: address.trim(), uses, days, note: &note };
        make_fleet_file(&app.booth, &app.facts.ca_pem, &token, &by, booth_time())
    })
    .await
}

/// `POST /staff/admin/tokens/{hash}/revoke`.
pub(crate) async fn revoke_token(
    State(app): State<Arc<BoothApp>>,
    Path(hash): Path<String>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let hash = ContentHash::parse_hex(&hash);
    let hash = hash.ok_or(fail(Refusal::NotFound(Reason::NoEnrolToken)))?;
    let done = app
        .run(move |app| app.booth.revoke_enrol_token(&hash.0, &login.account, booth_time()))
        .await;
    done.map_err(fail)?;
    Ok(Done::TokenRevoked.lead_to("/staff/admin"))
}

/// `GET /staff/audit?before=MILLISECONDS`.
pub(crate) async fn show_audit(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Query(fields): Query<Fields>,
) -> Answer {
    let texts = view.texts;
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
    Ok(view.page(words.audit, &body))
}

fn accounts_table(
    texts: &Texts,
    words: &AdminTexts,
    login: &LoggedIn,
    accounts: &[Account],
    form: FormView<'_>,
) -> Markup {
    html! {
        (form.why(""))
        table {
            tr {
                th scope="col" { (texts.name) } th scope="col" { (words.role) }
                th scope="col" { (words.state) } th scope="col" { (texts.password) }
            }
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
                    td {
                        @if *name != login.account { (reset_form(words, login, name, form)) }
                    }
                }
            }
        }
    }
}

/// Draws the form that sets a new password for another account.
fn reset_form(words: &AdminTexts, login: &LoggedIn, name: &str, form: FormView<'_>) -> Markup {
    let form = form.only_if("name", name);
    html! {
        details open[form.is_refused()] {
            summary { (words.new_password) }
            form class="narrow" method="post" action={ "/staff/admin/accounts/" (name) "/password" } {
                input type="hidden" name="form" value=(form_token(login));
                input type="hidden" name="name" value=(name) autocomplete="username";
                (form.new_password_field(words.first_password, "password"))
                p { (words.all_logins_end) }
                button { (words.change_password) }
            }
        }
    }
}

fn new_account_form(
    texts: &Texts,
    words: &AdminTexts,
    login: &LoggedIn,
    form: FormView<'_>,
) -> Markup {
    let is_admin = form.value("role", "") == "admin";
    html! {
        details open[form.is_refused()] {
            summary { (words.new_account) }
            form class="narrow" method="post" action="/staff/admin/accounts" {
                (form.why(""))
                input type="hidden" name="form" value=(form_token(login));
                label {
                    (texts.name)
                    input name="name" autocomplete="off" required maxlength="64" value=(form.value("name", ""))
                        aria-invalid=[form.invalid("name")] aria-describedby=[form.described("name")];
                }
                (form.why("name"))
                (form.new_password_field(words.first_password, "password"))
                label {
                    (words.role)
                    select name="role" {
                        option value="attendant" { (words.role_name(StaffRole::Attendant)) }
                        option value="admin" selected[is_admin] { (words.role_name(StaffRole::Admin)) }
                    }
                }
                (form.why("role"))
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
                    td { (write_time(token.expires_at)) }
                    td {
                        @if token.is_revoked {
                            (words.revoked)
                        } @else if !token.has_uses_left(now) {
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

fn new_token_form(words: &AdminTexts, login: &LoggedIn, host: &str, form: FormView<'_>) -> Markup {
    let address = form.value("address", &format!("https://{host}"));
    html! {
        details open[form.is_refused()] {
            summary { (words.new_token) }
            form class="narrow" method="post" action="/staff/admin/tokens" {
                (form.why(""))
                input type="hidden" name="form" value=(form_token(login));
                label { (words.note) input name="note" autocomplete="off" maxlength="80" value=(form.value("note", "")); }
                label {
                    (words.booth_address)
                    input name="address" type="url" required maxlength="200" value=(address)
                        aria-invalid=[form.invalid("address")] aria-describedby=[form.described("address")];
                }
                (form.why("address"))
                label {
                    (words.uses)
                    input name="uses" type="number" min="1" max=(MAX_USES) value=(form.value("uses", "50")) required
                        aria-invalid=[form.invalid("uses")] aria-describedby=[form.described("uses")];
                }
                label {
                    (words.days)
                    input name="days" type="number" min="1" max=(MAX_DAYS) value=(form.value("days", "365")) required
                        aria-invalid=[form.invalid("uses")] aria-describedby=[form.described("uses")];
                }
                (form.why("uses"))
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
                    td { (write_time(entry.at)) }
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
