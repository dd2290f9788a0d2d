//! Contradictions between settings that are each valid, whichever layers set them.

use super::table::{SETTINGS, Setting};
use super::value::SettingValue;
use super::{FilePlace, SettingOrigin, Settings, SettingsFault, store_default};

/// The reason why a setting conflicts with another.
#[derive(Clone, Debug)]
pub struct Contradiction {
    /// The source of the reported setting.
    pub source: String,
    /// The fault.
    pub fault: SettingsFault,
    /// The value that is used instead.
    pub holds: String,
}

impl Contradiction {
    /// Returns a line with the place, the fault and the value that is used instead.
    #[must_use]
    pub fn describe(&self) -> String {
        format!("{}; {}", self.fault.describe(&self.source), self.holds)
    }
}

/// Finds contradictions, and replaces the affected settings and their origins by the values that are used
/// instead.
pub(super) fn settle(settings: &mut Settings, origins: &mut [SettingOrigin]) -> Vec<Contradiction> {
    if settings.visits.is_none() {
        return Vec::new();
    }
    let replaced = [
        ("handover_seconds", "off_before_cut_seconds, off_sculpting_seconds and off_after_seconds"),
        ("kiosk_seconds", "session_seconds, idle_seconds and off_sculpting_seconds"),
    ];
    let replaced = replaced.map(|(name, by)| find_replaced(origins, name, by));
    let badge = settle_badge(settings, origins);
    let start = settle_start(settings, origins);
    replaced.into_iter().chain([badge, start]).flatten().collect()
}

/// Finds a timeout for sessions outside visit mode: it has no effect if `visits` is on.
fn find_replaced(origins: &[SettingOrigin], name: &str, by: &str) -> Option<Contradiction> {
    let (_, visits) = find(origins, "visits")?;
    let (setting, origin) = find(origins, name)?;
    let expected = format!("none beside visits = true ({visits}), but {by}");
    tell(setting, origin, &expected, "it has no effect".into())
}

/// Checks that a badge's least time is at most its greatest time; otherwise both become the defaults.
fn settle_badge(settings: &mut Settings, origins: &mut [SettingOrigin]) -> Option<Contradiction> {
    use paros_core::visit::PlanSetting::{BadgeLeast, BadgeMost};
    let plan = &settings.visits.as_ref()?.plan;
    if plan.value(BadgeLeast) <= plan.value(BadgeMost) {
        return None;
    }
    let (least, least_origin) = find(origins, "badge_least_seconds")?;
    let (most, most_origin) = find(origins, "badge_most_seconds")?;
    let expected = format!("at most {} = {} ({most_origin})", most.name, most_origin.value);
    let holds = format!("{} and {} hold (default)", least.default, most.default);
    let told = tell(least, least_origin, &expected, holds);
    for setting in [least, most] {
        let origin = store_default(setting, settings);
        *find_mut(origins, setting.name)? = origin;
    }
    told
}

/// Sets the start of a visit in which nothing is chosen: `mode` if `starts` contains it, or else the first of
/// `starts`.
fn settle_start(settings: &mut Settings, origins: &mut [SettingOrigin]) -> Option<Contradiction> {
    let visits = settings.visits.as_mut()?;
    let is_offered = visits.starts.iter().any(|start| start.mode == settings.mode);
    let (setting, origin) = find(origins, "mode")?;
    if origin.source.is_some() && is_offered {
        visits.plan.set_start(settings.mode);
        return None;
    }
    let first = visits.starts.first()?;
    (settings.mode, _) = (first.mode, visits.plan.set_start(first.mode));
    let first = SettingValue::Mode(first.name.clone(), first.mode).to_string();
    let (_, starts) = find(origins, "starts")?;
    let expected = format!("one of starts = {} ({starts})", starts.value);
    let told = tell(setting, origin, &expected, format!("{first} holds, the first of them"));
    let first = SettingOrigin { value: first, ..starts.clone() };
    *find_mut(origins, setting.name)? = first;
    told
}

/// Returns the contradiction of a setting; `None` if its value is the default.
fn tell(
    setting: &'static Setting,
    origin: &SettingOrigin,
    expected: &str,
    holds: String,
) -> Option<Contradiction> {
    let source = origin.source.clone()?;
    let why = format!("{} = {}, expected {expected}", setting.name, origin.value);
    let place: Option<FilePlace> = origin.place;
    let fault = SettingsFault { setting: Some(setting), place, why, costs_layer: false };
    Some(Contradiction { source, fault, holds })
}

fn find<'a>(
    origins: &'a [SettingOrigin],
    name: &str,
) -> Option<(&'static Setting, &'a SettingOrigin)> {
    SETTINGS.iter().zip(origins).find(|(setting, _)| setting.name == name)
}

fn find_mut<'a>(origins: &'a mut [SettingOrigin], name: &str) -> Option<&'a mut SettingOrigin> {
    let mut pairs = SETTINGS.iter().zip(origins);
    pairs.find(|(setting, _)| setting.name == name).map(|(_, origin)| origin)
}
