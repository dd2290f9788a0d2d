//! Prints: orders on a sculpture's page, and the queue of all orders.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::limits::{
    MAX_FILAMENT_CHARS, MAX_NOTE_CHARS, PRINT_MINUTES, PRINT_TENTHS_MM,
};
use paros_booth_rules::records::{EstimateState, PrintOrder, PrintState, Sculpture};
use paros_booth_rules::{
    Expected, LoggedIn, PrintJob, PrintSize, PrintStep, PrintWish, Reason, Refusal,
};
use paros_protocol::{SculptureId, UploadFacts};

use super::done::Done;
use super::forms::FormView;
use super::live::live;
use super::page::{StaffAnswer, StaffForm, StaffView, action_button, form_token};
use super::print_texts::PrintTexts;
use super::refusal_texts::tell_cause;
use super::sculptures::{badge_of, parse_id, refuse_form};
use super::texts::Texts;
use crate::clock::{booth_time, write_time};
use crate::models::picture::draw_picture;
use crate::printing::{Printer, PrinterView};
use crate::random::random_number;
use crate::server::app::BoothApp;

/// The steps that staff take by hand, and their names in the address.
const STEPS: [(PrintStep, &str); 5] = [
    (PrintStep::Start, "start"),
    (PrintStep::Finish, "finish"),
    (PrintStep::Fail, "fail"),
    (PrintStep::Cancel, "cancel"),
    (PrintStep::Retry, "retry"),
];

type Answer = Result<Response, StaffAnswer>;

/// `GET /staff/prints`: open orders first, then finished ones.
pub(crate) async fn show_queue(State(app): State<Arc<BoothApp>>, view: StaffView) -> Answer {
    let (login, texts) = (&view.login, view.texts);
    let jobs = app.run(|app| app.booth.list_print_queue()).await;
    let jobs = jobs.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let printers: Vec<PrinterView> = app.printers.iter().map(Printer::view).collect();
    let body = html! {
        (printers_of(texts, &printers))
        @if jobs.is_empty() { p { (texts.nothing) } }
        ul class="cards queue" {
            @for PrintJob { order, sculpture } in &jobs {
                @let at = format!("/staff/sculptures/{}", SculptureId(sculpture.id));
                li class="card" {
                    a href=(at) {
                        (draw_picture(&at, sculpture, texts.picture))
                        (badge_of(texts, sculpture.badge))
                    }
                    div {
                        (order_facts(texts, order))
                        (order_actions(texts, login, order))
                        (send_actions(texts, login, order, &printers))
                    }
                }
            }
        }
    };
    Ok(view.page(PrintTexts::of(texts.language).prints, &live("queue", &body)))
}

/// The name of the form on the sculpture's page.
pub(super) const PRINT_FORM: &str = "print";

/// `POST /staff/sculptures/{id}/print`.
pub(crate) async fn ask_print(
    State(app): State<Arc<BoothApp>>,
    Path(id): Path<String>,
    form: StaffForm,
) -> Answer {
    match order_print(&app, &id, &form).await {
        Ok(()) => Ok(Done::PrintOrdered.lead_to(&format!("/staff/sculptures/{id}"))),
        Err(refusal) => refuse_form(&app, &id, form, (PRINT_FORM, refusal)).await,
    }
}

async fn order_print(app: &Arc<BoothApp>, id: &str, form: &StaffForm) -> Result<(), Refusal> {
    let (id, fields) = (parse_id(id)?, &form.fields);
    let size = read_size(&fields.get("height"), &fields.get("minutes"))?;
    let wish = PrintWish { size, filament: fields.get("filament"), note: fields.get("note") };
    let order = (random_number()?, app.wakers.slices.is_some());
    let account = form.login.account.clone();
    app.run(move |app| app.booth.ask_print(&id, &wish, order, &account, booth_time())).await?;
    wake_slicer(app);
    Ok(())
}

/// `POST /staff/prints/{order}/{step}`.
pub(crate) async fn step_print(
    State(app): State<Arc<BoothApp>>,
    Path((order, step)): Path<(u64, String)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let step = STEPS.into_iter().find(|(_, name)| *name == step);
    let (step, _) = step.ok_or(fail(Refusal::NotFound(Reason::NoPage)))?;
    let told = Done::of_step(step);
    let step = (step, app.wakers.slices.is_some());
    let done =
        app.run(move |app| app.booth.step_print(order, step, &login.account, booth_time())).await;
    done.map_err(fail)?;
    wake_slicer(&app);
    // Wakes the printers' threads: a cancelled print may have to be stopped.
    app.printers.iter().for_each(Printer::wake);
    Ok(told.map_or_else(
        || Redirect::to("/staff/prints").into_response(),
        |told| told.lead_to("/staff/prints"),
    ))
}

/// `POST /staff/prints/{order}/send/{printer}`: the printer is given by its index in the list.
pub(crate) async fn send_print(
    State(app): State<Arc<BoothApp>>,
    Path((order, printer)): Path<(u64, usize)>,
    StaffForm { login, texts, .. }: StaffForm,
) -> Answer {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let done = app.run(move |app| {
        let printer = app.printers.get(printer).ok_or(Refusal::NotFound(Reason::NoPrinter))?;
        app.booth.send_print(order, printer.name(), &login.account, booth_time())?;
        printer.wake();
        Ok(())
    });
    done.await.map_err(fail)?;
    Ok(Done::PrintSent.lead_to("/staff/prints"))
}

/// Draws the prints of a sculpture. Adds a form for another one if the sculpture isn't withdrawn.
pub(crate) fn prints_of(
    texts: &Texts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    prints: &[PrintOrder],
    (form, can_slice): (FormView<'_>, bool),
) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        @if sculpture.withdrawn_at.is_none() {
            details open[form.is_refused()] {
                summary { (of_prints.order) }
                (order_form(of_prints, login, sculpture, (form, can_slice)))
            }
        }
        (live("prints", &html! {
            @for order in prints {
                section class="card" {
                    (order_facts(texts, order))
                    (order_actions(texts, login, order))
                }
            }
        }))
    }
}

fn order_form(
    of_prints: &PrintTexts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    (form, can_slice): (FormView<'_>, bool),
) -> Markup {
    let action = format!("/staff/sculptures/{}/print", SculptureId(sculpture.id));
    let facts = UploadFacts::from_json(&sculpture.facts);
    let height = facts.map_or(120, |facts| facts.height_mm_tenths / 10);
    let (least, most) = (PRINT_TENTHS_MM.start() / 10, PRINT_TENTHS_MM.end() / 10);
    html! {
        form class="narrow" method="post" action=(action) {
            (form.why(""))
            input type="hidden" name="form" value=(form_token(login));
            label {
                (of_prints.height_mm)
                input name="height" type="number" min=(least) max=(most)
                    value=(form.value("height", &height.to_string()))
                    aria-invalid=[form.invalid("height")] aria-describedby=[form.described("height")];
            }
            (form.why("height"))
            @if can_slice {
                label {
                    (of_prints.or_minutes)
                    input name="minutes" type="number"
                        min=(PRINT_MINUTES.start()) max=(PRINT_MINUTES.end())
                        value=(form.value("minutes", ""))
                        aria-invalid=[form.invalid("minutes")] aria-describedby=[form.described("minutes")];
                }
            }
            (form.why("minutes"))
            label {
                (of_prints.filament)
                input name="filament" maxlength=(MAX_FILAMENT_CHARS) autocomplete="off"
                    value=(form.value("filament", ""))
                    aria-invalid=[form.invalid("filament")] aria-describedby=[form.described("filament")];
            }
            (form.why("filament"))
            label {
                (of_prints.note)
                input name="note" maxlength=(MAX_NOTE_CHARS) autocomplete="off"
                    value=(form.value("note", ""))
                    aria-invalid=[form.invalid("note")] aria-describedby=[form.described("note")];
            }
            (form.why("note"))
            button { (of_prints.order) }
        }
    }
}

/// Draws the facts of an order that only staff see.
pub(crate) fn order_facts(texts: &Texts, order: &PrintOrder) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        p {
            strong { (of_prints.state(order.state)) } " " (write_time(order.changed_at))
            @if let Some(printer) = &order.printer { ", " (printer) }
            @if !order.why.is_empty() { span class="note" { " (" (tell_cause(texts.language, &order.why)) ")" } }
        }
        (order_wish(texts, order))
        // The note is for staff only.
        @if !order.note.is_empty() { p { (of_prints.note) ": " (order.note) } }
    }
}

/// Draws what the visitor ordered.
pub(crate) fn order_wish(texts: &Texts, order: &PrintOrder) -> Markup {
    let of_prints = PrintTexts::of(texts.language);
    html! {
        p {
            @if order.height_tenths_mm > 0 { (tenths(order.height_tenths_mm)) " mm" br; }
            @if let Some(most) = order.most_minutes {
                (of_prints.at_most) " " (most) " " (texts.minutes) br;
            }
            @if !order.filament.is_empty() { (of_prints.filament) ": " (order.filament) br; }
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

/// Draws buttons that send a print to a printer.
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

/// Draws the list of printers and their states.
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

/// Writes a number of tenths, with a decimal digit if it isn't whole.
fn tenths(count: u32) -> String {
    if count.is_multiple_of(10) {
        (count / 10).to_string()
    } else {
        format!("{}.{}", count / 10, count % 10)
    }
}

/// Parses the size in a form's fields: minutes, or otherwise a height in millimetres.
pub(crate) fn read_size(height: &str, minutes: &str) -> Result<PrintSize, Refusal> {
    let (height, minutes) = (height.trim(), minutes.trim());
    if !minutes.is_empty() {
        let minutes = minutes.parse().map_err(|_| Refusal::Unfit(Expected::Minutes))?;
        return Ok(PrintSize::Minutes(minutes));
    }
    let (whole, tenth) = height.split_once(['.', ',']).unwrap_or((height, "0"));
    let whole: Option<u32> = whole.parse().ok();
    let tenth = tenth.parse().ok().filter(|digit: &u32| *digit < 10 && tenth.len() == 1);
    let tenths =
        whole.zip(tenth).and_then(|(whole, tenth)| whole.checked_mul(10)?.checked_add(tenth));
    tenths.map(PrintSize::Height).ok_or(Refusal::Unfit(Expected::Height))
}

fn wake_slicer(app: &BoothApp) {
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
