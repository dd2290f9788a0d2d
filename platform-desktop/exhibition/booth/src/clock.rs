//! The booth's clock, and its times as people read them: in the zone of the machine, or of the environment variable `TZ`.

use std::ops::Range;
use std::time::SystemTime;

use chrono::{DateTime, Days, Local, NaiveDate, NaiveDateTime, TimeDelta, TimeZone as _};
use paros_booth_rules::BoothTime;

/// The time now.
#[must_use]
pub(crate) fn booth_time() -> BoothTime {
    booth_time_of(SystemTime::now())
}

/// Returns a time of the system's clock as the booth counts it; 0 for a time before 1970.
#[must_use]
pub(crate) fn booth_time_of(time: SystemTime) -> BoothTime {
    let age = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    BoothTime(u64::try_from(age.as_millis()).unwrap_or(u64::MAX))
}

/// Writes a date and a time of day, as `2026-11-27 15:58`.
#[must_use]
pub(crate) fn write_time(time: BoothTime) -> String {
    local(time).format("%Y-%m-%d %H:%M").to_string()
}

/// Writes a date, as `2026-11-27`.
#[must_use]
pub(crate) fn write_date(time: BoothTime) -> String {
    local(time).format("%Y-%m-%d").to_string()
}

/// Writes the date of a day as the rules count them, which begin at midnight UTC: that of its noon.
#[must_use]
pub(crate) fn write_day(day: u32) -> String {
    write_date(BoothTime(BoothTime::of_day(day).0 + 12 * HOUR_MS))
}

/// Returns the time from the beginning of a day's hour to its end, or of the whole day; `None` for a date beyond all
/// calendars. An hour that clocks pass twice counts twice, one that they skip is empty.
#[must_use]
pub(crate) fn time_of_day(date: NaiveDate, hour: Option<u8>) -> Option<Range<BoothTime>> {
    let start = date.and_hms_opt(u32::from(hour.unwrap_or(0)), 0, 0)?;
    let end = match hour {
        Some(_) => start.checked_add_signed(TimeDelta::hours(1))?,
        None => date.checked_add_days(Days::new(1))?.and_hms_opt(0, 0, 0)?,
    };
    Some(instant(start)?..instant(end)?)
}

/// Returns today's date.
#[must_use]
pub(crate) fn today(now: BoothTime) -> NaiveDate {
    local(now).date_naive()
}

const HOUR_MS: u64 = 3_600_000;

/// Returns the first instant at which clocks show a time or, if they skip it, a later one.
fn instant(shown: NaiveDateTime) -> Option<BoothTime> {
    let hour_later = || shown.checked_add_signed(TimeDelta::hours(1));
    let found = Local.from_local_datetime(&shown).earliest();
    let found = found.or_else(|| Local.from_local_datetime(&hour_later()?).earliest());
    // A time before 1970 is none of the booth's.
    found.map(|time| BoothTime(time.timestamp_millis().try_into().unwrap_or(0)))
}

/// The last time that can be written is one of the year 9999.
fn local(time: BoothTime) -> DateTime<Local> {
    const LAST: i64 = 253_402_214_400_000;
    let millis = i64::try_from(time.0).unwrap_or(LAST).min(LAST);
    DateTime::from_timestamp_millis(millis).unwrap_or_default().with_timezone(&Local)
}
