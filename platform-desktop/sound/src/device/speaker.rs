//! The speaker, which plays the sounds of ticks on a thread of its own.

use std::fmt;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, World};

use super::{DeviceError, SoundDevice, WriteFrames};
use crate::mixer::{Mixer, SAMPLE_RATE};
use crate::plan::{Shot, ShotKind, SoundPlan};
use crate::planner::SoundPlanner;

/// The frames per write: 5 ms, for which a plan may have to wait.
const BLOCK_FRAMES: usize = SAMPLE_RATE as usize / 200;

/// The most plans in the queue, almost a second of them. If the device is late, the newest plans are dropped;
/// each plan is complete, so the next one corrects the sound.
const WAITING_PLANS: usize = 64;

/// Frames without a plan, one second of them, after which a silent device is closed. The next plan opens it
/// again.
const IDLE_FRAMES: u32 = SAMPLE_RATE;

/// The retry interval after a device has failed.
const RETRY_PAUSE: Duration = Duration::from_secs(3);

/// The sound of a device that somebody is looking for.
const RING: Shot = Shot { kind: ShotKind::Clock { strokes: 3 }, strength: 1.0, pan: 0.0 };

/// Plays ticks. Without a library or a device it is silent, and logs that once.
#[derive(Debug)]
pub struct Speaker {
    planner: SoundPlanner,
    plans: SyncSender<SoundPlan>,
    rings: bool,
}

impl Speaker {
    /// Starts the playback thread at a volume of 1 to 100. Returns `None` for 0. `log` receives a line for
    /// each fault. Dropping a speaker ends all sounds without waiting.
    #[must_use]
    pub fn spawn(
        device: SoundDevice,
        percent: u32,
        log: impl Fn(fmt::Arguments<'_>) + Send + 'static,
    ) -> Option<Self> {
        if percent == 0 {
            return None;
        }
        let (plans, waiting) = sync_channel(WAITING_PLANS);
        let player = Player { plans: waiting, mixer: Mixer::new(percent), told: None, log };
        let thread = thread::Builder::new().name("sound".into());
        let spawned = thread.spawn(move || player.play_on(&device));
        spawned.is_ok().then(|| Speaker { planner: SoundPlanner::default(), plans, rings: false })
    }

    /// Rings the clock's bell with the next tick: somebody is looking for the device.
    pub const fn ring(&mut self) {
        self.rings = true;
    }

    /// Plays the sounds of a tick, from the world after it and its input. Never blocks.
    pub fn play_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        input: &TickInput,
    ) where
        Grid<N>: Size,
    {
        let mut plan = self.planner.plan_tick(world, input);
        if core::mem::take(&mut self.rings) {
            plan.push(RING);
        }
        // Without a device the thread has ended.
        let _ = self.plans.try_send(plan);
    }
}

/// The state of a speaker's thread.
struct Player<L> {
    plans: Receiver<SoundPlan>,
    mixer: Mixer,
    /// The last fault that was logged; a repeated fault is logged once.
    told: Option<String>,
    log: L,
}

/// The speaker has been dropped.
struct SpeakerGone;

impl<L: Fn(fmt::Arguments<'_>)> Player<L> {
    /// Plays until the speaker has been dropped.
    fn play_on(mut self, device: &SoundDevice) {
        let library = match device.load() {
            Ok(library) => library,
            Err(why) => return self.tell(&why),
        };
        while let Ok(plan) = self.plans.recv() {
            self.mixer.follow(&plan);
            let played = library.open().and_then(|output| self.play_until_idle(output));
            if let Err(why) = played {
                self.tell(&why);
                if let Err(SpeakerGone) = self.drop_plans_for(RETRY_PAUSE) {
                    return;
                }
            }
        }
    }

    /// Plays until nothing sounds and no plan has come for a while.
    fn play_until_idle(
        &mut self,
        mut output: Box<dyn WriteFrames + '_>,
    ) -> Result<(), DeviceError> {
        let mut frames = [[0.0; 2]; BLOCK_FRAMES];
        let mut idle_frames = 0;
        loop {
            let is_gone = loop {
                match self.plans.try_recv() {
                    Ok(plan) => {
                        self.mixer.follow(&plan);
                        idle_frames = 0;
                    }
                    Err(why) => break why == TryRecvError::Disconnected,
                }
            };
            self.mixer.render(&mut frames);
            output.write(&frames)?;
            idle_frames += BLOCK_FRAMES as u32;
            let is_silent = self.mixer.is_silent();
            let is_idle = idle_frames > IDLE_FRAMES;
            if is_silent && (is_idle || is_gone) || is_idle && is_gone {
                return Ok(());
            }
        }
    }

    fn drop_plans_for(&mut self, pause: Duration) -> Result<(), SpeakerGone> {
        let until = Instant::now() + pause;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.plans.recv_timeout(left) {
                Ok(_) if !left.is_zero() => {}
                Err(RecvTimeoutError::Disconnected) => return Err(SpeakerGone),
                Ok(_) | Err(RecvTimeoutError::Timeout) => return Ok(()),
            }
        }
    }

    fn tell(&mut self, why: &DeviceError) {
        let why = why.to_string();
        if self.told.as_ref() != Some(&why) {
            (self.log)(format_args!("no sound: {why}"));
            self.told = Some(why);
        }
    }
}
