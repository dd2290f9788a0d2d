//! Prints: ordered from a sculpture's page, and the queue of all.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::limits::{
    MAX_FILAMENT_CHARS, MAX_NOTE_CHARS, PRINT_MINUTES, PRINT_TENTHS_MM,
};
use paros_booth_rules::records::{EstimateState, PrintOrder, PrintState, Sculpture};
use paros_booth_rules::{LoggedIn, PrintJob, PrintSize, PrintStep, PrintWish, Refusal};
use paros_core::outbox::messages::{SculptureId, UploadFacts};

use super::page::{StaffAnswer, StaffForm, StaffView, action_button, form_token, page};
use super::print_texts::PrintTexts;
use super::sculptures::{badge_of, parse_id, utc};
use super::texts::Texts;
use crate::app::App;
use crate::clock::booth_time;
use crate::printing::{Printer, PrinterView};
use crate::random::random_number;

/// The steps that staff take by hand, and how a form's address has them.
const STEPS: [(PrintStep, &str); 5] = [
    (PrintStep::Start, "start"),
    (PrintStep::Finish, "finish"),
    (PrintStep::Fail, "fail"),
    (PrintStep::Cancel, "cancel"),
    (PrintStep::Retry, "retry"),
];

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff/prints`: all that is open, then what is over.
pub(crate) async fn show_queue(
    State(app): State<Arc<App>>,
    StaffView { login, texts }: StaffView,
) -> Answer {
    let jobs = app.run(|app| app.booth.list_print_queue()).await;
    let jobs = jobs.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let printers: Vec<PrinterView> = app.printers.iter().map(Printer::view).collect();
    let body = html! {
        (printers_of(texts, &printers))
        @if jobs.is_empty() { p { (texts.nothing) } }
        ul class="cards" {
            @for PrintJob { order, sculpture } in &jobs {
                li class="card" {
                    a href={ "/staff/sculptures/" (SculptureId(sculpture.id)) } {
                        (badge_of(texts, sculpture.badge))
                    }
                    (order_facts(texts, order))
                    (order_actions(texts, &login, order))
                    (send_actions(texts, &login, order, &printers))
                }
            }
        }
    };
    Ok(page(texts, Some(&login), PrintTexts::of(texts.language).prints, &body))
}

/// `POST /staff/sculptures/{id}/print`.
pub(crate) async fn ask_print(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    StaffForm { login, texts, fields }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let id = parse_id(&id).map_err(fail)?;
    let size = read_size(&fields.get("height"), &fields.get("minutes")).map_err(fail)?;
    let wish = PrintWish { size, filament: fields.get("filament"), note: fields.get("note") };
    let order = random_number().map_err(|error| fail(error.into()))?;
    let order = (order, app.wakers.slices.is_some());
    let asked = app
        .run(move |app| app.booth.ask_print(&id, &wish, order, &login.account, booth_time()))
        .await;
    asked.map_err(fail)?;
    wake_slicer(&app);
    Ok(Redirect::to(&format!("/staff/sculptures/{id}")).into_response())
}

/// `POST /staff/prints/{order}/{step}`.
pub(crate) async fn step_print(
    State(app): State<Arc<App>>,
    Path((order, step)): Path<(u64, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let step = STEPS.into_iter().find(|(_, name)| *name == step);
    let (step, _) = step.ok_or(fail(Refusal::NotFound("no such action")))?;
    let step = (step, app.wakers.slices.is_some());
    let done =
        app.run(move |app| app.booth.step_print(order, step, &login.account, booth_time())).await;
    done.map_err(fail)?;
    wake_slicer(&app);
    // One may have to be stopped.
    app.printers.iter().for_each(Printer::wake);
    Ok(Redirect::to("/staff/prints").into_response())
}

/// `POST /staff/prints/{order}/send/{printer}`, by the printer's place in the list.
pub(crate) async fn send_print(
    State(app): State<Arc<App>>,
    Path((order, printer)): Path<(u64, usize)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let done = app.run(move |app| {
        let printer = app.printers.get(printer).ok_or(Refusal::NotFound("no such printer"))?;
        app.booth.send_print(order, printer.name(), &login.account, booth_time())?;
        printer.wake();
        Ok(())
    });
    done.await.map_err(fail)?;
    Ok(Redirect::to("/staff/prints").into_response())
}

/// The prints of a sculpture; and a form for one more, where it isn't withdrawn.
pub(crate) fn prints_of(
    texts: &Texts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    prints: &[PrintOrder],
    can_slice: bool,
) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        @if sculpture.withdrawn_at.is_none() {
            details {
                summary { (of_prints.order) }
                (order_form(of_prints, login, sculpture, can_slice))
            }
        }
        @for order in prints {
            section class="card" {
                (order_facts(texts, order))
                (order_actions(texts, login, order))
            }
        }
    }
}

fn order_form(
    of_prints: &PrintTexts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    can_slice: bool,
) -> Markup {
    let action = format!("/staff/sculptures/{}/print", SculptureId(sculpture.id));
    let facts = UploadFacts::from_bytes(&sculpture.facts);
    let height = facts.map_or(120, |facts| facts.height_mm_tenths / 10);
    let (least, most) = (PRINT_TENTHS_MM.start() / 10, PRINT_TENTHS_MM.end() / 10);
    html! {
        form class="narrow" method="post" action=(action) {
            input type="hidden" name="form" value=(form_token(login));
            label {
                (of_prints.height_mm)
                input name="height" type="number" min=(least) max=(most) value=(height);
            }
            @if can_slice {
                label {
                    (of_prints.or_minutes)
                    input name="minutes" type="number"
                        min=(PRINT_MINUTES.start()) max=(PRINT_MINUTES.end());
                }
            }
            label {
                (of_prints.filament)
                input name="filament" maxlength=(MAX_FILAMENT_CHARS) autocomplete="off";
            }
            label {
                (of_prints.note)
                input name="note" maxlength=(MAX_NOTE_CHARS) autocomplete="off";
            }
            button { (of_prints.order) }
        }
    }
}

/// What is known of an order.
pub(crate) fn order_facts(texts: &Texts, order: &PrintOrder) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        p {
            strong { (of_prints.state(order.state)) } " " (utc(order.changed_at))
            @if let Some(printer) = &order.printer { ", " (printer) }
            @if !order.why.is_empty() { span class="note" { " (" (order.why) ")" } }
        }
        p {
            @if order.height_tenths_mm > 0 { (tenths(order.height_tenths_mm)) " mm" br; }
            @if let Some(most) = order.most_minutes {
                (of_prints.at_most) " " (most) " " (texts.minutes) br;
            }
            @if !order.filament.is_empty() { (of_prints.filament) ": " (order.filament) br; }
            @if !order.note.is_empty() { (of_prints.note) ": " (order.note) br; }
            @match (order.estimate, order.minutes, order.tenths_gram) {
                (EstimateState::Known, Some(minutes), Some(tenths_gram)) => {
                    (minutes / 60) " h " (minutes % 60) " " (texts.minutes) ", "
                    (tenths(tenths_gram)) " g"
                },
                (EstimateState::Waiting, ..) => { (of_prints.estimate_waits) },
                _ => { (of_prints.estimate_unknown) },
            }
        }
    }
}

fn order_actions(texts: &Texts, login: &LoggedIn, order: &PrintOrder) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    let at = format!("/staff/prints/{}", order.order);
    let slip = format!("{at}/slip");
    let can = STEPS.into_iter().filter(|(step, _)| order.state.after(*step).is_some());
    html! {
        div class="actions" {
            @if order.state.is_open() { a class="button" href=(slip) { (of_prints.slip) } }
            @for (step, name) in can {
                @let class = if step == PrintStep::Cancel { "danger" } else { "" };
                (action_button(login, &format!("{at}/{name}"), of_prints.step(step), class))
            }
        }
    }
}

/// Buttons that send a print to a printer.
fn send_actions(
    texts: &Texts,
    login: &LoggedIn,
    order: &PrintOrder,
    printers: &[PrinterView],
) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    let is_ready = order.state == PrintState::Sliced && order.printer.is_none();
    html! {
        @if is_ready && !printers.is_empty() {
            p { (of_prints.bed_is_empty) }
            div class="actions" {
                @for (k, printer) in printers.iter().enumerate() {
                    @let at = format!("/staff/prints/{}/send/{k}", order.order);
                    (action_button(login, &at, &format!("{} {}", of_prints.send_to, printer.name), ""))
                }
            }
        }
    }
}

/// Printers and how they are.
fn printers_of(texts: &Texts, printers: &[PrinterView]) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        @if !printers.is_empty() {
            ul {
                @for PrinterView { name, status } in printers {
                    li {
                        (name) ": "
                        @match status {
                            None => { (of_prints.printer_silent) },
                            Some(status) => {
                                (of_prints.activity(status.activity))
                                @if let Some(percent) = status.percent { " " (percent) " %" }
                            },
                        }
                    }
                }
            }
        }
    }
}

/// A number of tenths, with one digit behind the point where it isn't whole.
fn tenths(count: u32) -> String {
    if count.is_multiple_of(10) {
        (count / 10).to_string()
    } else {
        format!("{}.{}", count / 10, count % 10)
    }
}

/// A size of a form's fields: minutes, or where there are none a height in millimetres.
fn read_size(height: &str, minutes: &str) -> Result<PrintSize, Refusal> {
    let (height, minutes) = (height.trim(), minutes.trim());
    let bad = |expected: &str| Refusal::BadRequest(format!("expected {expected}"));
    if !minutes.is_empty() {
        let minutes = minutes.parse().map_err(|_| bad("a time in whole minutes"))?;
        return Ok(PrintSize::Minutes(minutes));
    }
    let (whole, tenth) = height.split_once(['.', ',']).unwrap_or((height, "0"));
    let whole: Option<u32> = whole.parse().ok();
    let tenth = tenth.parse().ok().filter(|digit: &u32| *digit < 10 && tenth.len() == 1);
    let tenths =
        whole.zip(tenth).and_then(|(whole, tenth)| whole.checked_mul(10)?.checked_add(tenth));
    tenths.map(PrintSize::Height).ok_or_else(|| bad("a height in millimetres"))
}

fn wake_slicer(app: &App) {
    if let Some(waker) = &app.wakers.slices {
        waker.wake();
    }
}

#[cfg(test)]
mod tests {
    use paros_booth_rules::PrintSize;

    use super::{read_size, tenths};

    #[test]
    fn sizes_are_read() {
        for (height, minutes, size) in [
            ("120", "", PrintSize::Height(1200)),
            (" 80,5 ", "", PrintSize::Height(805)),
            ("80.0", " ", PrintSize::Height(800)),
            ("120", "90", PrintSize::Minutes(90)),
        ] {
            assert_eq!(read_size(height, minutes).ok(), Some(size), "{height} {minutes}");
        }
        for (height, minutes) in [
            ("", ""),
            ("-1", ""),
            ("1.25", ""),
            ("1.", ""),
            ("4294967296", ""),
            ("429496730", ""),
            ("120", "1.5"),
        ] {
            assert!(read_size(height, minutes).is_err(), "{height} {minutes}");
        }
        assert_eq!((tenths(1200), tenths(805)), ("120".into(), "80.5".into()));
    }
}
