//! Lists of sculptures: filters and pages, compared with a naive model that scans all rows.

use super::common::*;
use paros_booth_rules::records::{ExportState, Sculpture};
use paros_booth_rules::{BoothTime, HeardBadge, ListFilter, PageStart, update};
use paros_core::badge::Pictogram;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Returns a time at which some sculptures are past their last day.
fn now() -> BoothTime {
    days(10)
}

fn put(rig: &Rig, sculpture: &Sculpture) {
    update(rig.store.as_ref(), |tx| tx.put(sculpture)).expect("memory");
}

/// Makes a sculpture that arrived at a second and is kept for long.
fn sculpture(id: u8, second: u64, badge: Option<BadgeNumber>) -> Sculpture {
    Sculpture {
        id: [id; 16],
        headset: 1,
        hash: [7; 32],
        badge: badge.map(BadgeNumber::get),
        claimed_badge: None,
        pictures: badge.map_or(0, |badge| {
            let pictograms = badge.badge().pictograms;
            pictograms.iter().fold(0, |bits, pictogram| bits | 1 << pictogram.number())
        }),
        language: *b"el",
        mode: SessionMode::FreeForm,
        facts: Vec::new(),
        received_at: seconds(second),
        keep_day: 30_000,
        withdrawn_at: None,
        has_trace: false,
        export: ExportState::Made,
        link_generation: 0,
        is_link_revoked: false,
    }
}

fn any_mode() -> impl Strategy<Value = SessionMode> {
    select(vec![
        SessionMode::FreeForm,
        SessionMode::Own,
        SessionMode::Constrained { figure: 0 },
        SessionMode::Constrained { figure: 255 },
    ])
}

fn any_language() -> impl Strategy<Value = [u8; 2]> {
    select(vec![*b"el", *b"en", *b"de"])
}

/// Generates sculptures, many of the same second, and many with badges that share pictures.
fn any_sculpture() -> impl Strategy<Value = Sculpture> {
    let when = (any::<u8>(), 0..6u64, select(vec![None, Some(0), Some(1), Some(2)]));
    let badge = proptest::option::weighted(0.9, 0..BadgeNumber::COUNT);
    (when, badge, 1..4u32, any_language(), any_mode()).prop_map(
        |((id, second, withdrawn), badge, headset, language, mode)| Sculpture {
            headset,
            language,
            mode,
            withdrawn_at: withdrawn.map(|second| seconds(100 + second)),
            ..sculpture(id, second, badge.and_then(BadgeNumber::new))
        },
    )
}

/// Generates a filter, and the choice of a sculpture whose badge's colour and pictures it may ask for.
fn any_filter() -> impl Strategy<Value = (ListFilter, Option<(Index, bool, usize)>)> {
    let received = proptest::option::of((0..6u64, 0..4u64));
    let rest = (
        proptest::option::weighted(0.3, 1..4u32),
        proptest::option::weighted(0.3, any_language()),
        proptest::collection::vec(any_mode(), 0..3),
    );
    let badge = proptest::option::weighted(0.4, (any::<Index>(), any::<bool>(), 0..=4usize));
    (proptest::bool::weighted(0.2), received, rest, badge).prop_map(
        |(is_withdrawn, received, (headset, language, starts), badge)| {
            let received = received.map(|(start, length)| seconds(start)..seconds(start + length));
            let filter =
                ListFilter { is_withdrawn, received, headset, language, starts, badge: None };
            (filter, badge)
        },
    )
}

/// Returns the filtered list by scanning all rows.
fn list_naively(all: &[Sculpture], filter: &ListFilter) -> Vec<Sculpture> {
    let meets = |kept: &&Sculpture| {
        let badge = kept.badge.and_then(BadgeNumber::new).map(|number| number.badge());
        let has = |heard: &HeardBadge| {
            badge.is_some_and(|badge| heard.colour().is_none_or(|colour| colour == badge.colour))
                && heard.pictograms().iter().all(|shown| badge.unwrap().pictograms.contains(shown))
        };
        kept.withdrawn_at.is_some() == filter.is_withdrawn
            && filter.received.as_ref().is_none_or(|hour| hour.contains(&kept.received_at))
            && filter.headset.is_none_or(|headset| headset == kept.headset)
            && filter.language.is_none_or(|language| language == kept.language)
            && (filter.starts.is_empty() || filter.starts.contains(&kept.mode))
            && filter.badge.as_ref().is_none_or(has)
    };
    let mut list: Vec<Sculpture> = all.iter().filter(meets).cloned().collect();
    let place = |kept: &Sculpture| (kept.withdrawn_at.unwrap_or(kept.received_at), kept.id);
    list.sort_by_key(|kept| std::cmp::Reverse(place(kept)));
    list
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(crate::PLAYS))]

    /// Compares all pages, from the newest to the oldest and back.
    #[test]
    fn pages_of_a_filter_are_those_of_a_look_at_all_rows(
        mut all in proptest::collection::vec(any_sculpture(), 1..60),
        (mut filter, asked) in any_filter(),
        most in 1..9usize,
    ) {
        all.sort_by_key(|kept| kept.id);
        all.dedup_by_key(|kept| kept.id);
        if let Some((whose, has_colour, pictures)) = asked {
            let badge = whose.get(&all).badge.and_then(BadgeNumber::new).map(|number| number.badge());
            filter.badge = badge.map(|badge| {
                let mut pictograms = badge.pictograms[4 - pictures..].to_vec();
                pictograms.reverse();
                HeardBadge::new(Some(badge.colour).filter(|_| has_colour), pictograms)
            });
        }
        if filter.badge.as_ref().is_some_and(|heard| heard.colour().is_none() && heard.pictograms().is_empty()) {
            filter.badge = None;
        }
        let rig = Rig::new();
        all.iter().for_each(|kept| put(&rig, kept));
        let list = list_naively(&all, &filter);
        let (mut start, mut seen) = (PageStart::Newest, 0);
        loop {
            let page = rig.booth.list_page(&filter, start, most).unwrap();
            prop_assert_eq!((page.newer, page.count), (seen as u64, list.len() as u64));
            let end = list.len().min(seen + most);
            prop_assert_eq!(&page.sculptures[..], &list[seen..end]);
            let Some(older) = page.older() else { break };
            (start, seen) = (older, end);
        }
        while seen > 0 {
            let page = rig.booth.list_page(&filter, start, most).unwrap();
            start = page.newer().expect("a page before it");
            seen -= most;
            let page = rig.booth.list_page(&filter, start, most).unwrap();
            prop_assert_eq!((&page.sculptures[..], page.newer), (&list[seen..seen + most], seen as u64));
        }
    }
}

fn ids(page: &paros_booth_rules::ListPage) -> Vec<u8> {
    page.sculptures.iter().map(|kept| kept.id[0]).collect()
}

#[test]
fn pages_stay_as_they_are_while_sculptures_come_and_go() {
    let rig = Rig::new();
    (1..=7).for_each(|id| put(&rig, &sculpture(id, id.into(), None)));
    let list = |start| rig.booth.list_page(&ListFilter::default(), start, 3).unwrap();
    let first = list(PageStart::Newest);
    assert_eq!((ids(&first), first.newer(), first.count), (vec![7, 6, 5], None, 7));
    (8..=9).for_each(|id| put(&rig, &sculpture(id, id.into(), None)));
    let second = list(first.older().expect("more"));
    assert_eq!((ids(&second), second.newer, second.count), (vec![4, 3, 2], 5, 9));
    // There are three sculptures on the page before, and two before that. They are shown as whole pages.
    let before = list(second.newer().expect("more"));
    assert_eq!((ids(&before), before.newer), (vec![7, 6, 5], 2));
    assert_eq!(ids(&list(before.newer().expect("more"))), [9, 8, 7]);
    // The sculpture at which the next page begins is deleted.
    rig.booth.delete(&SculptureId([2; 16]), "ana", now()).unwrap();
    let last = list(second.older().expect("more"));
    assert_eq!((ids(&last), last.older()), (vec![1], None));
    // The requested page has become empty.
    rig.booth.delete(&SculptureId([1; 16]), "ana", now()).unwrap();
    let empty = list(second.older().expect("it was asked before"));
    assert_eq!((ids(&empty), empty.newer), (vec![9, 8, 7], 0));
}

#[test]
fn what_is_filtered_is_what_a_parcel_brought() {
    let rig = Rig::new();
    let (first, second) = (rig.enrol(1), rig.enrol(2));
    let greek = Parcel::new(1, leased(9));
    let english = UploadFacts {
        language: *b"en",
        mode: SessionMode::Constrained { figure: 3 },
        ..Parcel::new(2, leased(10)).facts
    };
    rig.upload(&first, &greek, START).unwrap();
    rig.upload(&second, &Parcel::of_facts(english), seconds(3600)).unwrap();
    let picture = |number: Option<BadgeNumber>, place: usize| -> Vec<Pictogram> {
        vec![number.expect("a number").badge().pictograms[place]]
    };
    let heard = |number, place| Some(HeardBadge::new(None, picture(number, place)));
    let all = ListFilter::default();
    for (filter, expected) in [
        (all.clone(), vec![2, 1]),
        (ListFilter { headset: Some(first.headset), ..all.clone() }, vec![1]),
        (ListFilter { language: Some(*b"en"), ..all.clone() }, vec![2]),
        (ListFilter { starts: vec![SessionMode::Creative], ..all.clone() }, vec![1]),
        (ListFilter { starts: vec![english.mode], ..all.clone() }, vec![2]),
        (ListFilter { received: Some(START..seconds(3600)), ..all.clone() }, vec![1]),
        (ListFilter { badge: heard(leased(9), 0), ..all.clone() }, vec![1]),
        (ListFilter { badge: heard(leased(10), 3), ..all.clone() }, vec![2]),
        (ListFilter { is_withdrawn: true, ..all.clone() }, vec![]),
    ] {
        let page = rig.booth.list_page(&filter, PageStart::Newest, 9).unwrap();
        assert_eq!(ids(&page), expected, "{filter:?}");
    }
}
