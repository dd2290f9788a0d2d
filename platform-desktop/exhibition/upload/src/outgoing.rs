//! The connection of a studio to a booth. Each finished sculpture gets an id, is announced, and is sent as a
//! parcel once its print is made.

use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use paros_core::badge::{BadgeNumber, Language};
use paros_core::codec::trace::CORE_VERSION;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState, TICK_RATE};
use paros_core::visit::{PlanSetting, VisitPhase};
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};
use paros_protocol::{AgeGroup, ContentHash, FinishCause, SculptureId, UploadFacts, UploadStatus};
use paros_shell::rmap;
use paros_shell::statics::Resident;
use paros_shell::studio::{SculptureReceiver, Studio};

use crate::courier::{Courier, ParcelDraft};

/// The settings of what is sent with a sculpture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SendPlan {
    /// `true` if traces are sent.
    pub sends_traces: bool,
    /// The languages of visits, by their numbers. A session without a visit has the first one.
    pub languages: Vec<Language>,
}

/// The receiver that passes a studio's sculptures to a courier.
#[derive(Debug)]
struct Outgoing {
    courier: Arc<Courier>,
    plan: SendPlan,
    /// The id that an earlier start gave to the next sculpture, if it had begun to send it.
    found: Option<SculptureId>,
    /// The draft of the sculpture whose files are being made, without its badge.
    making: Option<ParcelDraft>,
    /// The badge of this sculpture that the courier already knows.
    told_badge: Option<u32>,
    /// The number of ticks of the session in which its visitor could sculpt.
    sculpting_ticks: u32,
}

/// Passes the sculptures that a studio finishes from now on to a courier, and the sculpture of an earlier
/// start whose parcel wasn't stored. Call this before the first tick. The studio and the caller share the
/// courier until [`Studio::set_receiver`].
pub fn connect<const N: usize>(
    studio: &mut Studio<'_, N>,
    courier: Courier,
    plan: SendPlan,
) -> Arc<Courier>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let courier = Arc::new(courier);
    let world = studio.world();
    let is_finished = world.session_state() == SessionState::Finished;
    let volume = is_finished.then(|| rmap::encode(world.volume().maps()));
    let earlier = volume.and_then(|volume| find_finished(&courier, &volume));
    let found = earlier.filter(|(_, is_kept)| !is_kept).map(|(id, _)| id);
    studio.set_receiver(Some(Box::new(Outgoing {
        courier: courier.clone(),
        plan,
        found,
        making: None,
        told_badge: None,
        sculpting_ticks: 0,
    })));
    match earlier {
        Some((id, true)) => courier.set_last_sculpture(id),
        _ => studio.begin_cut_off(found.is_some()),
    }
    courier
}

/// Finds the finished sculpture of an earlier start's save. Returns its id, and `true` if its parcel was
/// stored; `None` if no courier announced it.
fn find_finished(courier: &Courier, volume: &[u8]) -> Option<(SculptureId, bool)> {
    let hash = ContentHash::of(volume);
    let last = courier.last_finished().filter(|last| last.volume_hash == hash)?;
    let is_spooled = courier.found().iter().any(|(id, _)| *id == last.id);
    Some((last.id, last.is_kept || is_spooled))
}

/// Draws the id of a new sculpture; `None` if the system has no random bits: then it can't be sent.
fn draw_id() -> Option<SculptureId> {
    let mut bytes = [0; SculptureId::BYTES];
    getrandom::fill(&mut bytes).ok()?;
    Some(SculptureId(bytes))
}

impl<const N: usize> SculptureReceiver<N> for Outgoing
where
    Grid<N>: Size,
{
    fn begin(
        &mut self,
        world: &World<N, INTERVALS>,
        volume: &[u8],
        height_mm: f32,
        is_cut_off: bool,
        encode_trace: &dyn Fn() -> Option<Vec<u8>>,
    ) {
        let Some(id) = self.found.take().or_else(draw_id) else { return };
        self.courier.announce(id, volume.to_vec());
        let visit = world.visit();
        if visit.phase() != VisitPhase::Closed && visit.plan().value(PlanSetting::Badges) != 0 {
            self.courier.ask_badge(id);
        }
        let trace = self.plan.sends_traces.then(encode_trace).flatten();
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let languages = &self.plan.languages;
        let language = languages.get(usize::from(visit.language())).or(languages.first());
        let facts = UploadFacts {
            id,
            badge: None,
            badge_serial: None,
            core_version: CORE_VERSION,
            side: N as u16,
            cause: match (is_cut_off, visit.is_left()) {
                (true, _) => FinishCause::CutOff,
                (false, true) => FinishCause::Left,
                (false, false) => FinishCause::Finished,
            },
            language: code_of(language.copied().unwrap_or_default()),
            mode: match world.mode() {
                SessionMode::None => SessionMode::FreeForm,
                mode => mode,
            },
            age_group: AgeGroup::Unknown,
            sculpting_seconds: self.sculpting_ticks / TICK_RATE,
            finished_at: now.as_secs(),
            height_mm_tenths: ((height_mm * 10.0).round() as u16).max(1),
            volume_bytes: 0,
            volume_raw_bytes: 0,
            trace_bytes: 0,
            trace_raw_bytes: 0,
        };
        let draft = ParcelDraft { facts, volume: volume.to_vec(), trace };
        (self.making, self.told_badge) = (Some(draft), None);
    }

    fn keep(&mut self, badge: Option<BadgeNumber>) {
        if let Some(mut draft) = self.making.take() {
            draft.facts.badge = badge;
            self.courier.keep(draft);
        }
    }

    fn abandon(&mut self) {
        if let Some(draft) = self.making.take() {
            self.courier.abandon(draft.facts.id);
        }
    }

    fn is_keeping(&self) -> bool {
        self.courier.booth_state().status == Some(UploadStatus::Making)
    }

    /// Counts a tick in which the visitor could sculpt, and passes the badge that is shown to the courier.
    fn follow_tick(&mut self, world: &World<N, INTERVALS>) {
        let (visit, events) = (world.visit(), world.events());
        if events.iter().any(|event| matches!(event, WorldEvent::Started(_))) {
            self.sculpting_ticks = 0;
        }
        let works = visit.phase().lets_hands_work() && visit.phase() != VisitPhase::Attract;
        if works && world.session_state() == SessionState::Sculpting {
            self.sculpting_ticks = self.sculpting_ticks.saturating_add(1);
        }
        if let (Some(draft), Some(badge)) = (&self.making, visit.badge())
            && self.told_badge != Some(badge)
        {
            self.told_badge = Some(badge);
            if let Some(badge) = BadgeNumber::new(badge) {
                self.courier.note_badge(draft.facts.id, badge);
            }
        }
    }
}

/// Returns the ISO 639-1 code of a language.
const fn code_of(language: Language) -> [u8; 2] {
    match language {
        Language::English => *b"en",
        Language::Greek => *b"el",
    }
}

#[cfg(test)]
mod tests;
