//! The search for a sculpture by its badge, by words or tapped pictures. A search for one or two pictures
//! redirects to the list of matching sculptures.

use std::sync::Arc;

use axum::extract::{Query, State};
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::{BadgeComparison, BadgeMatches, FoundByBadge, HeardBadge, WordsFault};
use paros_core::badge::{Badge, BadgeColour, Pictogram};

use super::admin_texts::AdminTexts;
use super::list::{link_to_badge, unknown_words};
use super::page::{Fields, StaffAnswer, StaffView};
use super::refusal_texts::tell_words_fault;
use super::sculptures::{cards, missing_card};
use super::svg::{draw_badge, draw_colour, draw_pictogram};
use super::texts::Texts;
use crate::server::app::BoothApp;

/// `GET /staff/find`: searches by words, or by the numbers of a colour and up to four pictograms.
pub(crate) async fn find(
    State(app): State<Arc<BoothApp>>,
    view: StaffView,
    Query(fields): Query<Fields>,
) -> Result<Response, StaffAnswer> {
    let texts = view.texts;
    let (words, colour) = (fields.get("words"), fields.get("colour"));
    let pictures = fields.get("pictures");
    let asked = if !words.is_empty() {
        Some(HeardBadge::parse(&words))
    } else if !colour.is_empty() || !pictures.is_empty() {
        Some(read_tapped(&colour, &pictures).ok_or(WordsFault::Pictograms(0)))
    } else {
        None
    };
    if let Some(Ok(heard)) = &asked
        && !heard.is_nearly_whole()
    {
        let words = if words.is_empty() { name_parts(texts, heard) } else { words };
        return Ok(Redirect::to(&link_to_badge(words)).into_response());
    }
    let result = match asked {
        None => html! {},
        Some(Err(fault)) => {
            html! { p class="note" role="alert" { (tell_words_fault(texts.language, &fault)) } }
        }
        Some(Ok(heard)) => {
            let asked = heard.clone();
            let found = app.run(move |app| app.booth.find_by_badge(&asked)).await;
            found_by_badge(texts, &heard, &found.map_err(|refusal| StaffAnswer(texts, refusal))?)
        }
    };
    let body = html! {
        (result)
        form method="get" action="/staff/find" {
            label { (texts.words) input name="words" value=(words) lang=(texts.code) autocomplete="off"; }
            button { (texts.find) }
        }
        h2 { (texts.tap_badge) }
        p { (texts.how_to_tap) }
        div class="chosen" {
            div id="chosen" aria-live="polite" {}
            button id="search" type="button" disabled { (texts.find) }
            button id="back" type="button" aria-label=(AdminTexts::of(texts).take_back) { "⌫" }
        }
        div class="keys" {
            @for colour in BadgeColour::ALL {
                button type="button" data-colour=(colour as u8) aria-label=(colour.name(texts.language)) {
                    (draw_colour(colour))
                }
            }
        }
        div class="keys" {
            @for pictogram in Pictogram::all() {
                button type="button" data-picture=(pictogram.number()) aria-label=(pictogram.name(texts.language)) {
                    (draw_pictogram(pictogram))
                }
            }
        }
    };
    Ok(view.page(texts.find, &body))
}

/// Parses a tapped badge: the number of a colour, and those of up to four pictograms, separated by dashes.
fn read_tapped(colour: &str, pictures: &str) -> Option<HeardBadge> {
    let colour = match colour {
        "" => None,
        number => Some(*BadgeColour::ALL.get(number.parse::<usize>().ok()?)?),
    };
    let numbers = pictures.split('-').filter(|number| !number.is_empty());
    let pictograms = numbers.map(|number| number.parse().ok().and_then(Pictogram::new));
    let pictograms: Vec<Pictogram> = pictograms.collect::<Option<_>>()?;
    (pictograms.len() <= 4).then(|| HeardBadge::new(colour, pictograms))
}

/// Writes the names of a colour and pictograms, as a person would type them.
fn name_parts(texts: &Texts, heard: &HeardBadge) -> String {
    let colour = heard.colour().map(|colour| colour.name(texts.language));
    let pictograms = heard.pictograms().iter().map(|pictogram| pictogram.name(texts.language));
    colour.into_iter().chain(pictograms).collect::<Vec<_>>().join(" ")
}

fn found_by_badge(texts: &Texts, heard: &HeardBadge, found: &FoundByBadge) -> Markup {
    html! {
        @if let Some(badge) = heard.badge() { (draw_badge(&badge, texts.language)) }
        (unknown_words(texts, heard))
        @match found {
            FoundByBadge::Exact(matches) => { (matches_of(texts, matches)) },
            FoundByBadge::Nearest(nearest) => {
                p class="note" role="status" { (texts.nearest) }
                @if nearest.is_empty() { p { (texts.nothing) } }
                @for (badge, matches) in nearest {
                    (compared(texts, heard, badge))
                    (matches_of(texts, matches))
                }
            },
        }
    }
}

/// Draws which of the searched pictures a badge has.
fn compared(texts: &Texts, heard: &HeardBadge, badge: &Badge) -> Markup {
    let BadgeComparison { right, wrong, is_in_order, is_colour_right } = heard.compare(badge);
    let names = |pictograms: &[Pictogram]| {
        let names = pictograms.iter().map(|pictogram| pictogram.name(texts.language));
        names.collect::<Vec<_>>().join(", ")
    };
    html! {
        p class="compared" {
            span class="right" { "✓ " (texts.right) ": " (names(&right)) } " "
            @if !wrong.is_empty() { span class="wrong" { "✗ " (texts.wrong) ": " (names(&wrong)) } " " }
            @if !is_in_order { span class="wrong" { "✗ " (texts.other_order) } " " }
            @if !is_colour_right {
                span class="wrong" { "✗ " (texts.its_colour) ": " (badge.colour.name(texts.language)) }
            }
        }
    }
}

fn matches_of(texts: &Texts, matches: &BadgeMatches) -> Markup {
    html! {
        @if matches.is_empty() { p { (texts.nothing) } }
        @if !matches.kept.is_empty() { (cards(texts, &matches.kept)) }
        ul class="cards" {
            @for announcement in &matches.missing {
                li class="card" { (missing_card(texts, announcement, false)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::read_tapped;

    #[test]
    fn a_badge_is_tapped_whole_or_in_part() {
        let whole = read_tapped("7", "0-1-2-63").expect("a badge");
        assert!(whole.badge().is_some());
        for (colour, pictures) in [("", "5"), ("0", ""), ("0", "0-1-2"), ("", "0-1-2-3")] {
            let part = read_tapped(colour, pictures).expect("a part of one");
            assert_eq!(part.badge(), None, "{colour} {pictures}");
        }
        for (colour, pictures) in
            [("8", "0-1-2-3"), ("-1", "0-1-2-3"), ("0", "0-1-2-64"), ("0", "0-1-2-3-4"), ("", "x")]
        {
            assert_eq!(read_tapped(colour, pictures), None, "{colour} {pictures}");
        }
    }
}
