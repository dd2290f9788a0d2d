//! Tests of a booth with the largest number of sculptures: filters, counts and paging of the list, and the
//! time of each page.

use std::fs;
use std::time::{Duration, Instant};

use paros_booth_rules::records::{ExportState, Sculpture};
use paros_booth_rules::{BoothTime, update};
use paros_booth_sqlite::SqliteStore;
use paros_core::badge::{Badge, BadgeNumber, LEASED_NUMBERS, Language, Pictogram};
use paros_core::session::SessionMode;
use paros_protocol::{ContentHash, SculptureId};

use crate::rig::BoothFolder;
use crate::staff::Browser;

/// The sculptures of three months of a large exhibition.
const COUNT: u32 = 20_000;

/// Yesterday's hour in which the newest sculptures arrived.
const LAST_HOUR: u64 = 22;

/// The owl behind a newcomer's thickness of stone.
const OWL: SessionMode = SessionMode::Constrained { figure: 8 };

/// A text that occurs once for each thumbnail of a page.
const THUMBNAIL: &str = "loading=\"lazy\"";

/// The longest time of a page by a debug build, on a busy machine.
const LONGEST: Duration = Duration::from_secs(1);

/// Makes a sculpture. Sculptures differ in everything that the list filters by.
pub(crate) fn sculpture(k: u32, received_at: BoothTime) -> Sculpture {
    let ContentHash(hash) = ContentHash::of(&k.to_le_bytes());
    let badge = BadgeNumber::new((k * 7919 + 100_000) % LEASED_NUMBERS).expect("a number");
    let pictograms = badge.badge().pictograms;
    Sculpture {
        id: hash[..16].try_into().expect("16 bytes"),
        headset: 1 + k % 40,
        hash,
        badge: Some(badge.get()),
        claimed_badge: Some(badge.get()),
        pictures: pictograms.iter().fold(0, |bits, shown| bits | 1 << shown.number()),
        language: if k.is_multiple_of(3) { *b"en" } else { *b"el" },
        mode: match k % 4 {
            0 => SessionMode::Creative,
            1 => SessionMode::Constrained { figure: 8 },
            _ => SessionMode::FreeForm,
        },
        facts: vec![b' '; 400],
        received_at,
        keep_day: received_at.day() + 90,
        withdrawn_at: k.is_multiple_of(1000).then_some(received_at),
        has_trace: false,
        export: ExportState::Made,
        link_generation: 0,
        is_link_revoked: false,
    }
}

/// Adds sculptures to a booth's database, with copies of the existing pictures.
pub(crate) fn add_sculptures(folder: &BoothFolder, sculptures: &[Sculpture]) {
    let kept = folder.path().join("sculptures");
    let files = fs::read_dir(&kept).expect("a folder").map(|entry| entry.expect("a file").path());
    let mut pictures: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|part| part == "png")).collect();
    pictures.sort();
    for (sculpture, picture) in sculptures.iter().zip(pictures.iter().cycle()) {
        let (id, hash) = (SculptureId(sculpture.id), ContentHash(sculpture.hash));
        fs::copy(picture, kept.join(format!("{id}-{hash}.png"))).expect("room on the disk");
    }
    let store = SqliteStore::open(&folder.path().join("booth.sqlite")).expect("a database");
    let add = |tx: &mut (dyn paros_booth_rules::Transaction + '_)| {
        sculptures.iter().try_for_each(|sculpture| tx.put(sculpture))
    };
    update(&store, add).expect("room on the disk");
}

pub(crate) fn now() -> BoothTime {
    let now = std::time::SystemTime::UNIX_EPOCH.elapsed().expect("after 1970");
    BoothTime(u64::try_from(now.as_millis()).expect("a time"))
}

/// Writes a day as the value of a date field.
pub(crate) fn write_day(folder: &BoothFolder, day: u32) -> String {
    let database =
        rusqlite::Connection::open(folder.path().join("booth.sqlite")).expect("it is there");
    let query = "SELECT date(?1, 'unixepoch')";
    database.query_row(query, [i64::from(day) * 86_400], |row| row.get(0)).expect("a date")
}

/// Returns the address of the link with these words.
fn link(page: &str, words: &str) -> Option<String> {
    let before = &page[..page.find(words)?];
    let address = before.rsplit("href=\"").next()?.split('"').next()?;
    Some(address.replace("&amp;", "&"))
}

/// A browser that checks the time of each page.
struct TimedBrowser<'a>(Browser<'a>);

impl TimedBrowser<'_> {
    fn get(&self, path: &str) -> String {
        let start = Instant::now();
        let page = self.0.get(path);
        let time = start.elapsed();
        println!("{:>5} ms {path}", time.as_millis());
        assert!(time < LONGEST, "{path}: {time:?}");
        assert_eq!(page.status, 200, "{path}");
        page.text().to_owned()
    }
}

fn badge_of(kept: &Sculpture) -> Badge {
    BadgeNumber::new(kept.badge.expect("each has one")).expect("a number").badge()
}

fn has(kept: &Sculpture, pictogram: Pictogram) -> bool {
    badge_of(kept).pictograms.contains(&pictogram)
}

/// Counts the sculptures that are not withdrawn and meet a condition.
fn count(all: &[Sculpture], meets: impl Fn(&Sculpture) -> bool) -> usize {
    all.iter().filter(|kept| kept.withdrawn_at.is_none() && meets(kept)).count()
}

#[test]
fn every_page_of_a_large_list_is_right_and_comes_soon() {
    let folder = BoothFolder::new("long-list");
    let booth = folder.start();
    let yesterday = now().day() - 1;
    let last = BoothTime::of_day(yesterday).0 + LAST_HOUR * 3_600_000 + 1_800_000;
    let all: Vec<Sculpture> =
        (0..COUNT).map(|k| sculpture(k, BoothTime(last - u64::from(k) * 173_000))).collect();
    add_sculptures(&folder, &all);
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let browser = TimedBrowser(browser);
    check_filters(&browser, &all, &write_day(&folder, yesterday));
    check_paging(&browser, &all);
    check_finding(&browser.0);
}

/// Checks that each filter's count and page match a search through all sculptures.
fn check_filters(browser: &TimedBrowser<'_>, all: &[Sculpture], day: &str) {
    let last = all[0].received_at;
    let [first, second] = [0, 3].map(|place| badge_of(&all[7777]).pictograms[place]);
    let colour = badge_of(&all[7777]).colour;
    let [one, two] = [first, second].map(|shown| shown.name(Language::English));
    let of_colour = colour.name(Language::Greek);
    let is_of_hour = |kept: &Sculpture| kept.received_at.0 / 3_600_000 == last.0 / 3_600_000;
    let is_of_all = |kept: &Sculpture| {
        let is_asked = &kept.language == b"el" && kept.mode == SessionMode::FreeForm;
        is_asked && has(kept, first) && badge_of(kept).colour == colour
    };
    for (asked, matching) in [
        (String::new(), count(all, |_| true)),
        (format!("?day={day}"), count(all, |kept| kept.received_at.day() == last.day())),
        (format!("?day={day}&hour={LAST_HOUR}"), count(all, is_of_hour)),
        ("?headset=17&words=&hour=&start=".into(), count(all, |kept| kept.headset == 17)),
        ("?language=en".into(), count(all, |kept| &kept.language == b"en")),
        ("?start=owl".into(), count(all, |kept| kept.mode == OWL)),
        ("?state=withdrawn".into(), all.len() - count(all, |_| true)),
        (format!("?words={one}"), count(all, |kept| has(kept, first))),
        (format!("?words={one}+{two}"), count(all, |kept| has(kept, first) && has(kept, second))),
        (format!("?words={one}+{of_colour}&language=el&start=stone"), count(all, is_of_all)),
    ] {
        let page = browser.get(&format!("/staff{asked}"));
        let whole = matching.min(60);
        let range = format!("1–{whole} of {matching}");
        assert!(matching > 0 && page.contains(&range), "{asked}: {range}");
        assert_eq!(page.matches(THUMBNAIL).count(), whole, "{asked}");
        assert_eq!(link(&page, "Older →").is_some(), matching > 60, "{asked}");
        assert_eq!(link(&page, "← Newer"), None, "{asked}");
    }
}

/// Checks that the filter is kept from page to page, and in the form.
fn check_paging(browser: &TimedBrowser<'_>, all: &[Sculpture]) {
    let shown = badge_of(&all[7777]).pictograms[0];
    let word = shown.name(Language::English);
    let matching = count(all, |kept| has(kept, shown) && &kept.language == b"el");
    let (mut path, mut seen) = (format!("/staff?words={word}&language=el"), 0);
    loop {
        let page = browser.get(&path);
        let range = format!("{}–{} of {matching}", seen + 1, matching.min(seen + 60));
        for text in [&range, &format!("value=\"{word}\""), "<option value=\"el\" selected>"] {
            assert!(page.contains(text), "{path}: {text}");
        }
        seen += page.matches(THUMBNAIL).count();
        let Some(older) = link(&page, "Older →") else { break };
        path = older;
    }
    assert_eq!(seen, matching);
    let newer = browser.get(&link(&browser.get(&path), "← Newer").expect("more"));
    let before = matching - 1 - (matching - 1) % 60;
    assert!(newer.contains(&format!("{}–{before} of {matching}", before - 59)));
    // The oldest page of all.
    let last = all.iter().rfind(|kept| kept.withdrawn_at.is_none()).expect("one");
    let place = format!("{}-{}", last.received_at.0 + 1, "0".repeat(32));
    let page = browser.get(&format!("/staff?older={place}"));
    assert!(page.contains(&SculptureId(last.id).to_string()));
}

/// Checks that one or two pictures lead to the list, three to the nearest badges, and that unknown words are
/// named.
fn check_finding(browser: &Browser<'_>) {
    for asked in ["words=owl", "words=owl+%CE%B3%CE%AC%CF%84%CE%B1", "pictures=0", "colour=0"] {
        let answer = browser.get(&format!("/staff/find?{asked}"));
        assert_eq!(answer.status, 303, "{asked}");
        assert!(answer.head.contains("location: /staff?words="), "{asked}: {}", answer.head);
    }
    assert_eq!(browser.get("/staff/find?words=owl+kite+bell").status, 200);
    for (asked, text) in [
        ("words=owl+dragon", "Not understood: dragon"),
        ("words=red+blue", "2 colours; expected one"),
        ("headset=x", "No sculpture matches."),
        ("day=x&hour=77&start=q&language=q&state=q&older=1-2&newer=x", "1–60 of "),
        ("words=%3Cb%3E", "value=\"&lt;b&gt;\""),
    ] {
        let page = browser.get(&format!("/staff?{asked}"));
        assert!(page.status == 200 && page.text().contains(text), "{asked}: {}", page.text());
    }
}
