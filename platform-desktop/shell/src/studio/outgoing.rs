//! What goes to a booth: each finished sculpture gets an id, which is announced, and a parcel once its print is made.

use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use paros_core::badge::{BadgeNumber, Language};
use paros_core::codec::trace::CORE_VERSION;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState, TICK_RATE};
use paros_core::visit::{PlanSetting, VisitPhase};
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};
use paros_protocol::{AgeGroup, ContentHash, FinishCause, SculptureId, UploadFacts, UploadStatus};
use sha2::{Digest as _, Sha256};

use super::Studio;
use super::sculpture_files::SentSculpture;
use crate::outbox::Parcel;
use crate::outbox::courier::{Courier, CourierSummary, ParcelDraft};
use crate::rmap;
use crate::statics::Resident;

/// How long a save waits for a parcel to be kept that it would take the place of. A disk that is full isn't waited for.
const PARCEL_TIMEOUT: Duration = Duration::from_secs(2);

/// What is sent.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SendPlan {
    /// Whether traces are sent.
    pub sends_traces: bool,
    /// The visits' languages, by their numbers; a session that is no visit's has the first.
    pub languages: Vec<Language>,
}

/// Where the last finished sculpture stands on its way to the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BoothState {
    /// The sculpture's id; `None` before there is one.
    pub id: Option<SculptureId>,
    /// The badge that it is to have, once that may be shown.
    pub badge: Option<BadgeNumber>,
    /// The status of its upload; `None` before there is one.
    pub status: Option<UploadStatus>,
    /// The whole outbox.
    pub outbox: CourierSummary,
}

/// A studio's way to a booth.
#[derive(Debug)]
pub(super) struct Outgoing {
    courier: Courier,
    plan: SendPlan,
    /// The sculpture that was finished last.
    sculpture: Option<SculptureId>,
    /// The sculpture whose parcel is being made.
    making: Option<SculptureId>,
    /// The badge that was told of it.
    told_badge: Option<u32>,
    /// Ticks in which the session could be sculpted in.
    sculpting_ticks: u32,
    /// Visitors that the recording under way is of.
    recorded_visitors: u32,
}

impl Outgoing {
    /// Notes that a recording begins.
    pub(super) const fn note_recording_begun(&mut self) {
        self.recorded_visitors = 0;
    }

    /// A new sculpture's id; `None` where the system has no random bits, and nothing can be sent.
    fn begin(&mut self, id: Option<SculptureId>) -> Option<SculptureId> {
        let drawn = || {
            let mut bytes = [0; SculptureId::BYTES];
            getrandom::fill(&mut bytes).ok()?;
            Some(SculptureId(bytes))
        };
        let id = id.or_else(drawn)?;
        (self.sculpture, self.making, self.told_badge) = (Some(id), Some(id), None);
        Some(id)
    }

    fn facts<const N: usize>(
        &self,
        world: &World<N, INTERVALS>,
        (id, cause): (SculptureId, FinishCause),
        height_mm: f32,
    ) -> UploadFacts
    where
        Grid<N>: Size,
    {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let language = self.plan.languages.get(usize::from(world.visit().language()));
        let language = language.or(self.plan.languages.first()).copied().unwrap_or_default();
        UploadFacts {
            id,
            badge: None,
            badge_serial: None,
            core_version: CORE_VERSION,
            side: N as u16,
            cause,
            language: code_of(language),
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
        }
    }

    /// The finished sculpture in a save of the run before: its id, and whether its parcel was kept. `None` for a sculpture
    /// that wasn't finished with a courier.
    fn find_finished(&self, volume: &[u8]) -> Option<(SculptureId, bool)> {
        let hash = ContentHash(Sha256::digest(volume).into());
        let last = self.courier.last_finished().filter(|last| last.volume_hash == hash)?;
        let is_spooled = self.courier.found().iter().any(|(id, _)| *id == last.id);
        Some((last.id, last.is_kept || is_spooled))
    }
}

/// A language's letters by ISO 639-1.
const fn code_of(language: Language) -> [u8; 2] {
    match language {
        Language::English => *b"en",
        Language::Greek => *b"el",
    }
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Has what is finished from now on brought to a booth. A sculpture that the run before finished, and whose parcel
    /// it didn't come to make, is sent too. To be called before the first tick.
    pub fn set_courier(&mut self, courier: Courier, plan: SendPlan) {
        self.outgoing = Some(Outgoing {
            courier,
            plan,
            sculpture: None,
            making: None,
            told_badge: None,
            sculpting_ticks: 0,
            // What is recorded of a session that goes on isn't whole.
            recorded_visitors: 0,
        });
        let is_finished = self.world().session_state() == SessionState::Finished;
        let found = match &self.outgoing {
            Some(outgoing) if is_finished => {
                outgoing.find_finished(&rmap::encode(self.world().volume().maps()))
            }
            _ => None,
        };
        match (found, &mut self.outgoing) {
            (Some((id, true)), Some(outgoing)) => outgoing.sculpture = Some(id),
            (Some((id, false)), _) => {
                let is_written = !self.export.is_making_files();
                if is_written {
                    self.export.begin_anew(self.session.world);
                }
                self.send(Some(id), FinishCause::CutOff, is_written);
            }
            _ if self.export.is_making_files() => self.send(None, FinishCause::CutOff, false),
            _ => {}
        }
    }

    /// Ends what brings sculptures to a booth, once it has done what it was told: another one may open the outbox then, and
    /// is to keep the parcels that had no room.
    #[must_use]
    pub fn leave_courier(&mut self) -> Vec<Parcel> {
        self.outgoing.take().map(|outgoing| outgoing.courier.close()).unwrap_or_default()
    }

    /// What brings sculptures to a booth.
    #[must_use]
    pub fn courier(&self) -> Option<&Courier> {
        self.outgoing.as_ref().map(|outgoing| &outgoing.courier)
    }

    /// Where the last finished sculpture stands on its way to the booth; `None` where the device isn't enrolled at one.
    #[must_use]
    pub fn booth_state(&self) -> Option<BoothState> {
        let Outgoing { courier, sculpture, .. } = self.outgoing.as_ref()?;
        Some(BoothState {
            id: *sculpture,
            badge: sculpture.and_then(|id| courier.badge_of(id)),
            status: sculpture.and_then(|id| courier.upload_status(id)),
            outbox: courier.summary(),
        })
    }

    /// Has a sculpture sent that the last tick finished, whose files are being made.
    pub(super) fn send_finished(&mut self) {
        let is_left = self.world().visit().is_left();
        let cause = if is_left { FinishCause::Left } else { FinishCause::Finished };
        self.send(None, cause, false);
    }

    fn send(&mut self, id: Option<SculptureId>, cause: FinishCause, is_written: bool) {
        let Some(outgoing) = &mut self.outgoing else { return };
        let (Some(id), Some(volume)) = (outgoing.begin(id), self.export.volume()) else { return };
        outgoing.courier.announce(id, volume.to_vec());
        let world = &*self.session.world;
        let visit = world.visit();
        if visit.phase() != VisitPhase::Closed && visit.plan().value(PlanSetting::Badges) != 0 {
            outgoing.courier.ask_badge(id);
        }
        let is_visitors_own = outgoing.recorded_visitors <= 1 && !self.recorder.has_reached_limit();
        let is_trace_sent = outgoing.plan.sends_traces && is_visitors_own;
        let trace = is_trace_sent.then(|| self.recorder.trace_bytes()).flatten();
        let facts = outgoing.facts(world, (id, cause), self.export.model_height_mm());
        self.export.send(SentSculpture { facts, trace, is_written });
    }

    /// Counts a tick, and tells the badge that the visitor is shown.
    pub(super) fn follow_outgoing_tick(&mut self) {
        let Some(outgoing) = &mut self.outgoing else { return };
        let world = &*self.session.world;
        let (visit, events) = (world.visit(), world.events());
        let comes = |event: &WorldEvent| *event == WorldEvent::Visit(VisitPhase::Welcome);
        outgoing.recorded_visitors += u32::from(events.iter().any(comes));
        if events.iter().any(|event| matches!(event, WorldEvent::Started(_))) {
            outgoing.sculpting_ticks = 0;
        }
        let works = visit.phase().lets_hands_work() && visit.phase() != VisitPhase::Attract;
        if works && world.session_state() == SessionState::Sculpting {
            outgoing.sculpting_ticks = outgoing.sculpting_ticks.saturating_add(1);
        }
        if let (Some(id), Some(badge)) = (outgoing.making, visit.badge())
            && outgoing.told_badge != Some(badge)
        {
            outgoing.told_badge = Some(badge);
            if let Some(badge) = BadgeNumber::new(badge) {
                outgoing.courier.note_badge(id, badge);
            }
        }
    }

    /// Whether the files of a visit's sculpture wait for the badge that stands in them.
    pub(super) fn is_badge_awaited(&self) -> bool {
        let visit = self.world().visit();
        self.outgoing.is_some()
            && visit.phase() == VisitPhase::Export
            && visit.plan().value(PlanSetting::Badges) != 0
            && visit.badge().is_none()
    }

    /// Has the parcel kept of a sculpture whose files are made; with `None` there is none.
    pub(super) fn send_or_abandon(&mut self, draft: Option<ParcelDraft>) {
        let Some(outgoing) = &mut self.outgoing else { return };
        match (draft, outgoing.making.take()) {
            (Some(draft), _) => outgoing.courier.keep(draft),
            (None, Some(id)) => outgoing.courier.abandon(id),
            (None, None) => {}
        }
    }

    /// Whether a parcel is still being packed and written.
    pub(super) fn is_parcel_under_way(&self) -> bool {
        self.booth_state().is_some_and(|state| state.status == Some(UploadStatus::Making))
    }

    /// Waits until the last parcel is kept, for a short while.
    pub(super) fn wait_for_parcel(&self) {
        let begun = Instant::now();
        while self.is_parcel_under_way() && begun.elapsed() < PARCEL_TIMEOUT {
            thread::sleep(Duration::from_millis(5));
        }
    }
}

#[cfg(test)]
mod tests;
