//! The ticks of a frame, each with the poses of its own time.

use std::time::Instant;

use openxr as xr;
use paros_core::TickInput;
use paros_core::internals::RoomPose;
use paros_core::limits::INTERVALS;
use paros_core::session::{PointerCommand, RawPose, SessionMode};
use paros_core::volume::{Grid, Size};
use paros_shell::headset::hand_reader::{HandProfile, HandReader};
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::statics::Resident;
use paros_shell::tick_runner::TickClock;

use super::{DROP_LOG_INTERVAL, HeadsetShell};
use crate::error::Error;
use crate::platform::Platform;
use crate::session_resources::SessionResources;
use crate::xr::HeadsetSession;

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Runs the ticks up to a frame's display time, and applies their haptics.
    pub(super) fn run_ticks(
        &mut self,
        resources: &mut SessionResources<N>,
        display_time: xr::Time,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        let due = self.pacer.take_due_ticks_until(display_time.as_nanos());
        self.tick_fraction = due.fraction;
        self.record_dropped_ticks(due.dropped, platform);
        let (session, has_focus) = (&resources.session, self.phase.has_focus());
        let (mut menu_down, mut profiles) = (false, [HandProfile::default(); 2]);
        if has_focus {
            session.actions.sync_actions(&session.raw)?;
            menu_down = session.actions.is_menu_down(&session.raw)?;
            profiles = session.actions.current_profiles(&session.raw)?;
        }
        let (now, mut room, mut has_recentred) = (platform.since_boot(), None, false);
        for tick_time in due.tick_times_ns() {
            // The room is moved only after these ticks: until then, hand poses would refer to its old place.
            has_recentred |= self.recentering.take_change_due_at(tick_time);
            let has_jumped = core::mem::take(&mut self.has_room_moved) || has_recentred;
            let profiles = (has_focus && !has_jumped).then_some(profiles);
            let tick_time = xr::Time::from_nanos(tick_time);
            let head = session.locate_head(tick_time)?;
            let readers = &mut self.hand_readers;
            let (mut input, hands) = read_tick_input(session, head, tick_time, profiles, readers)?;
            if has_jumped {
                self.visit.forget_poses();
            }
            self.observe_visitor(&input, menu_down, now, platform);
            self.stick_presses.replace_in_input(&mut input);
            room = self.observe_head(head).or(room);
            self.add_session_and_string(menu_down, &mut input);
            self.fill_visit_input((now, head, &hands, menu_down), &mut input);
            self.studio.run_tick_wrapped(&input, |step| platform.run_world_step(step));
            self.follow_visit_tick();
            self.follow_booth(true, platform);
            let world = self.studio.world();
            resources.show.note_tick(world);
            if let Some(speaker) = &mut self.speaker {
                speaker.play_tick(world, &input);
            }
            self.haptics.add_tick(self.felt_of_last_tick());
        }
        for (hand, change) in self.haptics.take_changes().into_iter().enumerate() {
            // Without focus the runtime has stopped all vibrations.
            if has_focus {
                session.actions.change_haptics(&session.raw, hand, change)?;
            }
        }
        self.move_room(&mut resources.session, room, has_recentred, platform)
    }

    /// Adds the hands' string to a tick's input, and, if no visits are held, the session's start and finish.
    fn add_session_and_string(&mut self, is_menu_down: bool, input: &mut TickInput) {
        if self.host.is_none() {
            self.visit.add_session_start_or_finish(
                self.studio.world().session_state(),
                self.studio.has_unfinished_sculpture(),
                is_menu_down,
                input,
            );
            if core::mem::take(&mut self.start_anew) {
                input.start = self.options.mode;
            }
        }
        // Each start of a session resets the string.
        let string_mm = self.options.string_mm;
        if input.start == SessionMode::None && self.studio.world().string_mm() != string_mm {
            input.pointer = PointerCommand::Steady { string_mm };
        }
    }

    /// Counts dropped ticks, and logs them from time to time.
    fn record_dropped_ticks(&mut self, count: u32, platform: &mut dyn Platform) {
        let dropped = &mut self.dropped;
        dropped.count += u64::from(count);
        let log_due = dropped.logged_at.is_none_or(|at| at.elapsed() > DROP_LOG_INTERVAL);
        if dropped.count > dropped.logged && log_due {
            let (all, most) = (dropped.count, TickClock::MAX_TICKS_PER_FRAME);
            platform.log(format_args!(
                "{all} ticks dropped so far: a frame makes up {most} at the most"
            ));
            (dropped.logged, dropped.logged_at) = (all, Some(Instant::now()));
        }
    }
}

/// Reads head and hands at a time. Returns the core's input and the hand samples. Without interaction
/// profiles, as without input focus, hands are left out.
fn read_tick_input(
    session: &HeadsetSession,
    head: Option<RoomPose>,
    tick_time: xr::Time,
    profiles: Option<[HandProfile; 2]>,
    readers: &mut [HandReader; 2],
) -> Result<(TickInput, [HandSample; 2]), Error> {
    let head = head
        .map_or(RawPose::default(), |(position, rotation)| RawPose::quantise(position, rotation));
    let mut input = TickInput { head, ..TickInput::default() };
    let mut hands = [HandSample::default(); 2];
    for (hand, reader) in readers.iter_mut().enumerate() {
        let Some(profiles) = profiles else {
            reader.skip_tick();
            continue;
        };
        let report = session.report_hand(hand, profiles[hand], tick_time)?;
        hands[hand] = reader.read_tick(&report);
        input.hands[hand] = hands[hand].to_hand_input();
    }
    Ok((input, hands))
}
