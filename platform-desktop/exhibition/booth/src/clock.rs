//! The booth's clock, and its times as text in the local time zone: the machine's, or that of the environment
//! variable `TZ`.

use std::ops::Range;
use std::time::SystemTime;

use chrono::{DateTime, Days, Local, NaiveDate, NaiveDateTime, TimeDelta, TimeZone as _};
use paros_booth_rules::BoothTime;

/// Returns the current time.
#[must_use]
pub(crate) fn booth_time() -> BoothTime {
    booth_time_of(SystemTime::now())
}

/// Converts a system time to a booth time. Returns 0 for a time before 1970.
#[must_use]
pub(crate) fn booth_time_of(time: SystemTime) -> BoothTime {
    let age = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    BoothTime(u64::try_from(age.as_millis()).unwrap_or(u64::MAX))
}

/// Writes a local date and time of day, such as `2026-11-27 15:58`.
#[must_use]
pub(crate) fn write_time(time: BoothTime) -> String {
    local(time).format("%Y-%m-%d %H:%M").to_string()
}

/// Writes a local date, such as `2026-11-27`.
#[must_use]
pub(crate) fn write_date(time: BoothTime) -> String {
    local(time).format("%Y-%m-%d").to_string()
}

/// Writes the local date of a UTC day, as the rules count days. Uses the date at noon UTC.
#[must_use]
pub(crate) fn write_day(day: u32) -> String {
    write_date(BoothTime(BoothTime::of_day(day).0 + 12 * HOUR_MS))
}

/// Returns the time range of one hour of a local day, or of the whole day if `hour` is `None`. Returns `None`
/// if the date is out of the calendar's range. When clocks change, a repeated hour includes both passes, and
/// a skipped hour is empty.
#[must_use]
pub(crate) fn time_of_day(date: NaiveDate, hour: Option<u8>) -> Option<Range<BoothTime>> {
    let start = date.and_hms_opt(u32::from(hour.unwrap_or(0)), 0, 0)?;
    let end = match hour {
        Some(_) => start.checked_add_signed(TimeDelta::hours(1))?,
        None => date.checked_add_days(Days::new(1))?.and_hms_opt(0, 0, 0)?,
    };
    Some(instant(start)?..instant(end)?)
}

/// Returns the local date at a time.
#[must_use]
pub(crate) fn today(now: BoothTime) -> NaiveDate {
    local(now).date_naive()
}

const HOUR_MS: u64 = 3_600_000;

/// Returns the first instant with this local time. If clocks skip the time, uses the local time an hour
/// later.
fn instant(shown: NaiveDateTime) -> Option<BoothTime> {
    let hour_later = || shown.checked_add_signed(TimeDelta::hours(1));
    let found = Local.from_local_datetime(&shown).earliest();
    let found = found.or_else(|| Local.from_local_datetime(&hour_later()?).earliest());
    // The booth counts from 1970: earlier times become 0.
    found.map(|time| BoothTime(time.timestamp_millis().try_into().unwrap_or(0)))
}

/// Converts to local time. Times after the year 9999 are clamped, as they can't be formatted.
fn local(time: BoothTime) -> DateTime<Local> {
    const LAST: i64 = 253_402_214_400_000;
    let millis = i64::try_from(time.0).unwrap_or(LAST).min(LAST);
    DateTime::from_timestamp_millis(millis).unwrap_or_default().with_timezone(&Local)
}
