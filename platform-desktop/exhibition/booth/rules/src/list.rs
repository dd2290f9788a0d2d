//! Lists of sculptures: filtered, in pages, the newest first.

use std::ops::Range;

use paros_core::badge::{BadgeNumber, NUMBERS_OF_COLOUR};
use paros_core::session::SessionMode;

use crate::booth::{Booth, Tx};
use crate::limits::MAX_LISTED;
use crate::records::{Announcement, Sculpture};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;
use crate::value::{ToValue, Value};
use crate::words::{HeardBadge, picture_bits};

/// A filter of a list: a sculpture must meet all conditions.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct ListFilter {
    /// `true` lists the withdrawn sculptures, in the order of their withdrawal; `false` the others, in the order of arrival.
    pub is_withdrawn: bool,
    /// The time of arrival at the booth.
    pub received: Option<Range<BoothTime>>,
    /// The headset that sent it.
    pub headset: Option<u32>,
    /// The visit's language, two small letters of ISO 639-1.
    pub language: Option<[u8; 2]>,
    /// Accepted starts of the session; empty for any start.
    pub starts: Vec<SessionMode>,
    /// The badge has this colour and all of these pictures, in any order.
    pub badge: Option<HeardBadge>,
}

/// A position in a list, given by a sculpture. It stays valid after the sculpture was deleted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ListPlace {
    /// The time that orders the list: the arrival or the withdrawal.
    pub at: BoothTime,
    /// The sculpture's id.
    pub id: [u8; 16],
}

/// The requested page of a list.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum PageStart {
    /// The first page.
    #[default]
    Newest,
    /// The page after a position.
    OlderThan(ListPlace),
    /// The page before a position; the first page if there is less than a page before it.
    NewerThan(ListPlace),
}

/// A page of a list.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct ListPage {
    /// The sculptures of the page.
    pub sculptures: Vec<Sculpture>,
    /// The number of sculptures on the pages before this page.
    pub newer: u64,
    /// The number of sculptures on all pages.
    pub count: u64,
}

/// Conditions in SQL, and the values of their parameters.
#[derive(Clone)]
struct Conditions {
    terms: Vec<String>,
    values: Vec<Value>,
}

impl Booth {
    /// Returns a page of at most `most` sculptures that meet a filter. Returns the first page if the
    /// requested page is empty.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_page(
        &self,
        filter: &ListFilter,
        start: PageStart,
        most: usize,
    ) -> Result<ListPage, Refusal> {
        let (all, most) = (filter.conditions(), most.min(MAX_LISTED));
        self.view(|tx| {
            let mut sculptures = filter.find(tx, &all, start, most)?;
            let is_cut = matches!(start, PageStart::NewerThan(_)) && sculptures.len() < most;
            if is_cut || sculptures.is_empty() {
                sculptures = filter.find(tx, &all, PageStart::Newest, most)?;
            }
            let newer = match sculptures.first() {
                Some(first) => all.clone().beyond(filter, ">", ListPlace::of(first)).count(tx)?,
                None => 0,
            };
            Ok(ListPage { sculptures, newer, count: all.count(tx)? })
        })
    }
}

impl ListPage {
    /// Returns the start of the page after this page; `None` on the last page.
    #[must_use]
    pub fn older(&self) -> Option<PageStart> {
        let shown = self.newer + self.sculptures.len() as u64;
        let last = self.sculptures.last().filter(|_| shown < self.count)?;
        Some(PageStart::OlderThan(ListPlace::of(last)))
    }

    /// Returns the start of the page before this page; `None` on the first page.
    #[must_use]
    pub fn newer(&self) -> Option<PageStart> {
        let first = self.sculptures.first().filter(|_| self.newer > 0)?;
        Some(PageStart::NewerThan(ListPlace::of(first)))
    }
}

impl ListPlace {
    fn of(sculpture: &Sculpture) -> Self {
        let at = sculpture.withdrawn_at.unwrap_or(sculpture.received_at);
        ListPlace { at, id: sculpture.id }
    }
}

impl ListFilter {
    /// Returns `true` if an announced sculpture meets the conditions. Conditions on the language and the
    /// start are ignored, as an announcement lacks them.
    #[must_use]
    pub fn admits(&self, announcement: &Announcement) -> bool {
        let badge = announcement.badge.and_then(BadgeNumber::new).map(|number| number.badge());
        self.received.as_ref().is_none_or(|received| received.contains(&announcement.heard_at))
            && self.headset.is_none_or(|headset| headset == announcement.headset)
            && self
                .badge
                .as_ref()
                .is_none_or(|said| badge.is_some_and(|badge| said.is_part_of(&badge)))
    }

    fn conditions(&self) -> Conditions {
        let withdrawn = if self.is_withdrawn { "IS NOT NULL" } else { "IS NULL" };
        let terms = vec![format!("withdrawn_at {withdrawn}")];
        let mut all = Conditions { terms, values: Vec::new() };
        if let Some(Range { start, end }) = &self.received {
            all.add("received_at >= {} AND received_at < {}", &[start, end]);
        }
        if let Some(headset) = &self.headset {
            all.add("headset = {}", &[headset]);
        }
        if let Some(language) = &self.language {
            all.add("language = {}", &[language]);
        }
        if !self.starts.is_empty() {
            let places = vec!["{}"; self.starts.len()].join(", ");
            let starts: Vec<&dyn ToValue> = self.starts.iter().map(|start| start as _).collect();
            all.add(&format!("mode IN ({places})"), &starts);
        }
        if let Some(badge) = &self.badge {
            let pictures = picture_bits(badge.pictograms());
            all.add("(pictures & {}) = {}", &[&pictures, &pictures]);
            if let Some(colour) = badge.colour() {
                let first = colour as u32 * NUMBERS_OF_COLOUR;
                let last = first + NUMBERS_OF_COLOUR - 1;
                all.add("+badge BETWEEN {} AND {}", &[&first, &last]);
            }
        }
        all
    }

    fn find(
        &self,
        tx: &mut Tx<'_>,
        all: &Conditions,
        start: PageStart,
        most: usize,
    ) -> Result<Vec<Sculpture>, StoreError> {
        let (mut all, order) = match start {
            PageStart::Newest => (all.clone(), "DESC"),
            PageStart::OlderThan(place) => (all.clone().beyond(self, "<", place), "DESC"),
            PageStart::NewerThan(place) => (all.clone().beyond(self, ">", place), "ASC"),
        };
        all.values.push(most.to_value());
        let (at, limit) = (self.order(), all.values.len());
        let query = format!("{} ORDER BY {at} {order}, id {order} LIMIT ?{limit}", all.sql());
        let mut found = tx.find(&query, &all.parameters())?;
        if order == "ASC" {
            found.reverse();
        }
        Ok(found)
    }

    /// Returns the column that orders the list.
    const fn order(&self) -> &'static str {
        if self.is_withdrawn { "withdrawn_at" } else { "received_at" }
    }
}

impl Conditions {
    /// Adds a condition. Each `{}` in it is replaced by the parameter of the next value.
    fn add(&mut self, condition: &str, values: &[&dyn ToValue]) {
        let mut term = condition.to_owned();
        for value in values {
            self.values.push(value.to_value());
            term = term.replacen("{}", &format!("?{}", self.values.len()), 1);
        }
        self.terms.push(term);
    }

    /// Adds the condition that a sculpture comes before (`>`) or after (`<`) a position in the list.
    fn beyond(mut self, filter: &ListFilter, side: &str, place: ListPlace) -> Self {
        let term = format!("({}, id) {side} ({{}}, {{}})", filter.order());
        self.add(&term, &[&place.at, &place.id]);
        self
    }

    fn sql(&self) -> String {
        format!("WHERE {}", self.terms.join(" AND "))
    }

    fn parameters(&self) -> Vec<&dyn ToValue> {
        self.values.iter().map(|value| value as _).collect()
    }

    fn count(&self, tx: &mut Tx<'_>) -> Result<u64, StoreError> {
        tx.count::<Sculpture>(&self.sql(), &self.parameters())
    }
}
