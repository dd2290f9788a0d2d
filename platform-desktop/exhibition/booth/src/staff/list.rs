//! The list of sculptures: thumbnails in pages, with filters. The filters are in the address.

use std::sync::Arc;

use axum::extract::{Query, State};
use axum::response::Response;
use chrono::{Datelike as _, NaiveDate};
use maud::{Markup, html};
use paros_booth_rules::limits::MAX_LISTED;
use paros_booth_rules::records::Sculpture;
use paros_booth_rules::{
    BoothTime, HeardBadge, ListFilter, ListPage, ListPlace, MissingSculpture, PageStart, WordsFault,
};
use paros_core::badge::Language;
use paros_core::session::SessionMode;
use paros_protocol::SculptureId;
use paros_shaders::panel::Message;
use paros_shell::figures::{HiddenStart, MAX_OWN_FIGURES, own_figure_mode};

use super::admin_texts::AdminTexts;
use super::list_texts::ListTexts;
use super::live::live;
use super::notices::AdminNotices;
use super::page::{Fields, StaffAnswer, StaffView};
use super::refusal_texts::tell_words_fault;
use super::sculptures::{LISTED, badge_note, badge_of, missing_card};
use super::texts::Texts;
use crate::clock::{booth_time, time_of_day, today, write_time};
use crate::models::picture::draw_picture;
use crate::server::app::BoothApp;

/// The values of the field `state` for withdrawn sculptures, and for announced ones that haven't arrived.
const WITHDRAWN: &str = "withdrawn";
const MISSING: &str = "missing";

/// Visitors' languages: the code, and the name in the language itself.
const LANGUAGES: [(&str, &str); Language::ALL.len()] = [("en", "English"), ("el", "Ελληνικά")];

/// Starts of sessions: the value of the field `start`, and the name on the visitors' cards.
const STARTS: [(&str, Message); 8] = [
    ("stone", Message::ChoiceFree),
    ("owl", Message::FigureOwl),
    ("cat", Message::FigureCat),
    ("dolphin", Message::FigureDolphin),
    ("amphora", Message::FigureAmphora),
    ("surprise", Message::FigureSurprise),
    ("shape", Message::ChoiceShape),
    ("guest", Message::FigureOwn),
];

/// The fields of the list's form. An empty field filters nothing.
#[derive(Default)]
struct ListForm {
    words: String,
    day: String,
    hour: String,
    headset: String,
    language: String,
    start: String,
    state: String,
}

/// `GET /staff`: a page of the sculptures that the form asks for.
pub(crate) async fn show_list(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Query(fields): Query<Fields>,
) -> Result<Response, StaffAnswer> {
    let (texts, now) = (view.texts, booth_time());
    let form = ListForm::read(&fields, now);
    let start = read_start(&fields);
    let filter = form.filter();
    let asked = filter.as_ref().ok().cloned();
    let is_admin = view.login.check_admin().is_ok();
    let is_missing = form.state == MISSING;
    let found = app.run(move |app| {
        let notices = AdminNotices::find(app, is_admin, now)?;
        let (mut page, mut missing) = (ListPage::default(), Vec::new());
        match asked {
            Some(filter) if is_missing => {
                missing = app.booth.list_missing(MAX_LISTED)?;
                missing.retain(|found| filter.admits(&found.announcement));
            }
            Some(filter) => page = app.booth.list_page(&filter, start, LISTED)?,
            None => {}
        }
        Ok((page, missing, notices))
    });
    let (page, missing, notices) = found.await.map_err(|refusal| StaffAnswer(texts, refusal))?;
    let body = html! {
        (notices.draw(&app, AdminTexts::of(texts), &view.login, now))
        (draw_form(texts, &form))
        @match &filter {
            Err(fault) => p class="note" role="alert" { (tell_words_fault(texts.language, fault)) },
            Ok(filter) => {
                @if let Some(heard) = &filter.badge { (unknown_words(texts, heard)) }
                (live("list", &match is_missing {
                    true => draw_missing(texts, &missing),
                    false => draw_page(texts, &form, &page),
                }))
            },
        }
    };
    Ok(view.page(ListTexts::of(texts.language).sculptures, &body))
}

impl ListForm {
    /// Reads the fields. An hour without a day means today's, and a value that the form doesn't offer counts
    /// as empty.
    fn read(fields: &Fields, now: BoothTime) -> Self {
        let get = |name| fields.get(name).trim().to_owned();
        let hour = get("hour").parse::<u8>().ok().filter(|hour| *hour < 24);
        let day = parse_date(&get("day")).or(hour.map(|_| today(now)));
        let state = get("state");
        let is_missing = state == MISSING;
        let is_start = |start: &String| STARTS.iter().any(|(known, _)| known == start);
        let is_language = |code: &String| LANGUAGES.iter().any(|(known, _)| known == code);
        ListForm {
            words: get("words"),
            day: day.map(|date| date.to_string()).unwrap_or_default(),
            hour: hour.map(|hour| hour.to_string()).unwrap_or_default(),
            headset: get("headset"),
            // The language and the start of a sculpture that hasn't arrived are unknown.
            language: Some(get("language"))
                .filter(|code| !is_missing && is_language(code))
                .unwrap_or_default(),
            start: Some(get("start"))
                .filter(|start| !is_missing && is_start(start))
                .unwrap_or_default(),
            state: Some(state).filter(|state| is_missing || state == WITHDRAWN).unwrap_or_default(),
        }
    }

    /// Makes the filter.
    ///
    /// # Errors
    /// The words don't name pictures and a colour of one badge.
    fn filter(&self) -> Result<ListFilter, WordsFault> {
        let badge = match self.words.is_empty() {
            true => None,
            false => Some(HeardBadge::parse(&self.words)?),
        };
        let received =
            parse_date(&self.day).and_then(|date| time_of_day(date, self.hour.parse().ok()));
        Ok(ListFilter {
            is_withdrawn: self.state == WITHDRAWN,
            received,
            // An invalid number becomes one that no headset has.
            headset: (!self.headset.is_empty()).then(|| self.headset.parse().unwrap_or(u32::MAX)),
            language: self.language.as_bytes().try_into().ok(),
            starts: modes_of(&self.start),
            badge,
        })
    }

    /// Returns the address of a page of the filtered list.
    fn link(&self, start: PageStart) -> String {
        let place = |ListPlace { at, id }| format!("{}-{}", at.0, SculptureId(id));
        let (name, place) = match start {
            PageStart::Newest => ("", String::new()),
            PageStart::OlderThan(last) => ("older", place(last)),
            PageStart::NewerThan(first) => ("newer", place(first)),
        };
        let fields = [
            ("words", self.words.as_str()),
            ("day", &self.day),
            ("hour", &self.hour),
            ("headset", &self.headset),
            ("language", &self.language),
            ("start", &self.start),
            ("state", &self.state),
            (name, &place),
        ];
        let set: Vec<_> = fields.into_iter().filter(|(_, value)| !value.is_empty()).collect();
        // Encoding pairs of text doesn't fail.
        format!("/staff?{}", serde_urlencoded::to_string(set).unwrap_or_default())
    }
}

/// Reads the query of the list's address. Returns the normalised address and the filter.
pub(crate) fn read_query(
    fields: &Fields,
    now: BoothTime,
) -> (String, Result<ListFilter, WordsFault>) {
    let form = ListForm::read(fields, now);
    (form.link(read_start(fields)), form.filter())
}

/// Returns the address of the list, filtered by words that name parts of a badge.
pub(super) fn link_to_badge(words: String) -> String {
    ListForm { words, ..ListForm::default() }.link(PageStart::Newest)
}

/// Returns the session modes of a start in [`STARTS`]; none for another name.
fn modes_of(start: &str) -> Vec<SessionMode> {
    match start {
        "stone" => vec![SessionMode::FreeForm],
        "shape" => vec![SessionMode::Creative],
        "guest" => vec![SessionMode::Own],
        "surprise" => (0..MAX_OWN_FIGURES).map(own_figure_mode).collect(),
        figure => {
            let hidden = HiddenStart::ALL.into_iter();
            hidden.filter(|hidden| hidden.figure.name() == figure).map(HiddenStart::mode).collect()
        }
    }
}

/// Reads the page that an address asks for.
fn read_start(fields: &Fields) -> PageStart {
    let place = |name| {
        let text = fields.get(name);
        let (at, id) = text.split_once('-')?;
        let id = SculptureId::parse_hex(id)?.0;
        Some(ListPlace { at: BoothTime(at.parse().ok()?), id })
    };
    let older = place("older").map(PageStart::OlderThan);
    older.or_else(|| place("newer").map(PageStart::NewerThan)).unwrap_or_default()
}

/// Reads a date as browsers send it, `2026-11-27`.
fn parse_date(text: &str) -> Option<NaiveDate> {
    NaiveDate::parse_from_str(text, "%Y-%m-%d")
        .ok()
        .filter(|date| (1970..=9999).contains(&date.year()))
}

fn draw_form(texts: &Texts, form: &ListForm) -> Markup {
    let words = ListTexts::of(texts.language);
    let hours = (0..24).map(|hour| (hour.to_string(), format!("{hour:02}:00–{:02}:00", hour + 1)));
    let languages = LANGUAGES.map(|(code, name)| (code.to_owned(), name.to_owned()));
    let starts =
        STARTS.map(|(start, name)| (start.to_owned(), name.text(texts.language).to_owned()));
    let states = [(WITHDRAWN, words.withdrawn), (MISSING, words.missing)]
        .map(|(state, name)| (state.to_owned(), name.to_owned()));
    let select =
        |label: &str, name: &str, chosen: &str, first: &str, options: &[(String, String)]| {
            html! {
                label {
                    (label)
                    select name=(name) {
                        option value="" { (first) }
                        @for (value, text) in options {
                            option value=(value) selected[value == chosen] { (text) }
                        }
                    }
                }
            }
        };
    html! {
        form class="filter" method="get" action="/staff" {
            label class="words" {
                (words.badge)
                input name="words" value=(form.words) lang=(texts.code) autocomplete="off";
            }
            label { (words.day) input type="date" name="day" value=(form.day); }
            (select(words.hour, "hour", &form.hour, words.any, &hours.collect::<Vec<_>>()))
            label {
                (texts.headset)
                input type="number" name="headset" min="0" max=(u32::MAX) value=(form.headset);
            }
            @if form.state != MISSING {
                (select(words.language, "language", &form.language, words.any, &languages))
                (select(words.start, "start", &form.start, words.any_start, &starts))
            }
            (select(words.state, "state", &form.state, words.kept, &states))
            div class="actions" {
                button class="main" { (words.show) }
                a class="button" href="/staff" { (words.clear) }
            }
        }
    }
}

/// Draws a note with the words that were not recognised, if there are any.
pub(super) fn unknown_words(texts: &Texts, heard: &HeardBadge) -> Markup {
    html! {
        @if !heard.unknown.is_empty() {
            p class="note" { (texts.not_understood) " " (heard.unknown.join(", ")) }
        }
    }
}

fn draw_page(texts: &Texts, form: &ListForm, page: &ListPage) -> Markup {
    let words = ListTexts::of(texts.language);
    let last = page.newer + page.sculptures.len() as u64;
    let pager = html! {
        div class="pager" {
            span { (page.newer + 1) "–" (last) " " (words.of) " " (page.count) }
            @if let Some(newer) = page.newer() {
                a class="button" rel="prev" href=(form.link(newer)) { "← " (words.newer) }
            }
            @if let Some(older) = page.older() {
                a class="button" rel="next" href=(form.link(older)) { (AdminTexts::of(texts).older) " →" }
            }
        }
    };
    html! {
        @if page.sculptures.is_empty() {
            p { (words.none) }
        } @else {
            (pager)
            ul class="thumbs" {
                @for sculpture in &page.sculptures { li { (thumbnail(texts, sculpture)) } }
            }
            @if page.count > page.sculptures.len() as u64 { (pager) }
        }
    }
}

fn draw_missing(texts: &Texts, missing: &[MissingSculpture]) -> Markup {
    html! {
        @if missing.is_empty() { p { (ListTexts::of(texts.language).none) } }
        ul class="cards" {
            @for MissingSculpture { announcement, is_lost } in missing {
                li class="card" { (missing_card(texts, announcement, *is_lost)) }
            }
        }
    }
}

fn thumbnail(texts: &Texts, sculpture: &Sculpture) -> Markup {
    let at = format!("/staff/sculptures/{}", SculptureId(sculpture.id));
    let note = badge_note(texts, sculpture);
    html! {
        a href=(at) {
            (draw_picture(&at, sculpture, texts.picture))
            (badge_of(texts, sculpture.badge))
            p { (write_time(sculpture.received_at)) br; (texts.headset) " " (sculpture.headset) }
            @if !note.is_empty() { p class="note" { (note) } }
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_shell::modes::named_modes;

    use super::{LANGUAGES, Language, STARTS, modes_of, parse_date};

    #[test]
    fn dates_are_read_as_they_are_written() {
        for text in ["1970-01-01", "2028-02-29", "9999-12-31"] {
            assert_eq!(parse_date(text).expect("a date").to_string(), text);
        }
        for text in ["", "2026", "2026-11", "1969-12-31", "2026-02-29", "2026-13-01", "-1-1-1", "x"]
        {
            assert_eq!(parse_date(text), None, "{text}");
        }
    }

    #[test]
    fn every_start_and_language_is_offered() {
        let offered: Vec<_> = STARTS.iter().flat_map(|(start, _)| modes_of(start)).collect();
        assert!(named_modes().all(|(_, mode)| offered.contains(&mode)));
        assert!(STARTS.iter().all(|(start, _)| !modes_of(start).is_empty()));
        assert!(Language::ALL.len() == LANGUAGES.len());
    }
}
