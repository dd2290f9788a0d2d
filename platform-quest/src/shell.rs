//! The loop: what the runtime tells, the ticks that are due, and a frame of them.

mod draw;
mod hear;
mod ticks;

use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use paros_core::size::{Grid, Size};
use paros_core::world::Session;
use paros_shaders::{gpu, portrait};
use paros_shell::places::Places;
use paros_shell::print::{HEIGHT_MM, Printer};
use paros_shell::statics::Resident;
use paros_shell::studio::{Note, Studio};

use crate::beat::Beat;
use crate::error::Error;
use crate::foveation::Foveation;
use crate::host::Host;
use crate::life::Life;
use crate::options::Options;
use crate::pulse::Pulses;
use crate::recentre::Recentre;
use crate::rig::Rig;
use crate::script::{Command, Script};
use crate::strain::{Heat, Strain};
use crate::visitor::Visitor;
use crate::xr::NO_PROFILE;

/// How often the runtime is asked while no frames are made.
const WAITING: Duration = Duration::from_millis(10);

/// Losses one after the other before the runtime is given up, and the pause between them.
const LOSSES: u32 = 5;
const AGAIN: Duration = Duration::from_secs(1);

/// A session that has lasted for this long was no failed attempt.
const STEADY: Duration = Duration::from_secs(10);

/// How long the runtime may take to end a session that is asked to end: Android kills a program that
/// takes five seconds.
const PATIENCE: Duration = Duration::from_secs(3);

/// How often it is told at the most that ticks are dropped.
const TELLING: Duration = Duration::from_secs(5);

/// What goes on from session to session.
struct Shell<'a, const N: usize>
where
    Grid<N>: Size,
{
    studio: Studio<'a, N>,
    options: &'a Options,
    script: Option<Script>,
    visitor: Visitor,
    life: Life,
    beat: Beat,
    recentre: Recentre,
    pulses: Pulses,
    /// What the runtime tells of heat; the system may tell more.
    heat: Heat,
    strain: Strain,
    /// How far the frame is from the last tick to the next.
    fraction: f32,
    /// A session is to start anew.
    fresh: bool,
    began: Instant,
    frames: u64,
    dropped: Dropped,
    /// Where pictures of the next frame go.
    shot: Option<PathBuf>,
    last_note: String,
    messages: Vec<String>,
}

/// Ticks that were not made up.
#[derive(Clone, Copy, Default, Debug)]
struct Dropped {
    ticks: u64,
    told: u64,
    told_at: Option<Instant>,
}

/// How a session ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Ended {
    /// By the visitor's wish, or the runtime's.
    Over,
    /// It was lost, and may be made anew.
    Lost,
}

/// Runs sessions until the visitor, the system or the runtime wants no more; with where the last
/// print is, if there is one.
///
/// # Errors
/// [`Error::Unavailable`] where there is nothing to run on, or what went wrong later. What was
/// sculpted has been saved in any case.
pub fn run<const N: usize>(host: &mut dyn Host, options: &Options) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let mut volumes = Grid::<N>::start_volumes();
    volumes.make(&mut Grid::<N>::plane(), |_| {});
    let (mut world, mut press) = (Grid::<N>::world(), Grid::<N>::press());
    let printer = Printer::new(&mut press, HEIGHT_MM);
    let printer = printer.map_err(|height| Error::Input(format!("{height:?}")))?;
    let folder = options.folder.as_deref();
    let places = folder.map_or_else(|| Places::of_user(None), Places::within);
    let mut studio = Studio::new(&mut world, &mut volumes, printer, places, portrait);
    match &options.record {
        Some(_) => studio.record_to(options.record.clone()),
        None => studio.record_nothing(),
    }
    if studio.world().session() != Session::Waiting {
        let (tick, digest) = (studio.world().tick(), studio.world().digest());
        host.log(format_args!("a session goes on from tick {tick}, digest {digest:016x}"));
    }
    let mut shell = Shell::new(studio, options);
    let done = shell.live(host);
    let saved = shell.studio.close();
    shell.tell_notes(host);
    if let (Err(_), Err(error)) = (&done, &saved) {
        host.log(format_args!("{error}"));
    }
    shell.messages.sort();
    shell.messages.dedup();
    let complaints = shell.messages.join("\n");
    if done.is_err() && !complaints.is_empty() {
        host.log(format_args!("validation: {complaints}"));
    }
    done?;
    saved?;
    if !complaints.is_empty() {
        return Err(Error::Unavailable(format!("validation: {complaints}")));
    }
    let printed = shell.studio.printed();
    Ok(printed.map_or(String::new(), |path| format!("{}\n", path.display())))
}

impl<'a, const N: usize> Shell<'a, N>
where
    Grid<N>: Size + Resident<N>,
{
    fn new(studio: Studio<'a, N>, options: &'a Options) -> Self {
        Shell {
            studio,
            options,
            script: options.script.then(Script::new),
            visitor: Visitor::new(options.mode, options.handover),
            life: Life::default(),
            beat: Beat::default(),
            recentre: Recentre::default(),
            pulses: Pulses::default(),
            heat: Heat::default(),
            strain: Strain::default(),
            fraction: 0.0,
            fresh: options.record.is_some(),
            began: Instant::now(),
            frames: 0,
            dropped: Dropped::default(),
            shot: None,
            last_note: String::new(),
            messages: Vec::new(),
        }
    }

    /// Session after session: one that is lost is made anew, and the sculpture is kept.
    fn live(&mut self, host: &mut dyn Host) -> Result<(), Error> {
        let (mut losses, mut has_run) = (0, false);
        loop {
            let begun = Instant::now();
            let why = match self.session(host) {
                Ok(Ended::Over) => return Ok(()),
                Ok(Ended::Lost) => None,
                Err(error) if error.is_loss() || has_run || self.frames > 0 => Some(error),
                Err(error) => return Err(error),
            };
            self.studio.pause();
            has_run = true;
            losses = if begun.elapsed() > STEADY { 1 } else { losses + 1 };
            let text = why.as_ref().map_or("the session is lost".into(), ToString::to_string);
            if losses > LOSSES {
                return Err(why.unwrap_or(Error::Unavailable(text)));
            }
            host.log(format_args!("{text}; the sculpture is kept, and a new session is made"));
            thread::sleep(AGAIN);
        }
    }

    /// One session, from its making to its end.
    fn session(&mut self, host: &mut dyn Host) -> Result<Ended, Error> {
        let mut vulkan = None;
        let ended = self.session_by(host, &mut vulkan);
        self.messages.extend(vulkan.map(|vulkan| vulkan.messages()).unwrap_or_default());
        ended
    }

    fn session_by(
        &mut self,
        host: &mut dyn Host,
        vulkan: &mut Option<Arc<gpu::Instance>>,
    ) -> Result<Ended, Error> {
        let mut rig =
            Rig::new(host, self.options, self.studio.world(), self.studio.places(), vulkan)?;
        if rig.session.actions.profiles == 0 {
            host.log(format_args!("{NO_PROFILE}: bare hands sculpt"));
        }
        let (runtime, device) = (&rig.runtime.name, &rig.gpu.name);
        host.log(format_args!("{runtime}, drawn by {device}"));
        self.life = Life::default();
        self.beat.rest();
        // Whatever ends it, the next start has the programs.
        self.keep_cache(&mut rig);
        let ended = self.go(&mut rig, host);
        self.keep_cache(&mut rig);
        ended
    }

    fn keep_cache(&mut self, rig: &mut Rig<N>) {
        let places = self.studio.places().clone();
        rig.keep_cache(&places, self.studio.keeper());
    }

    fn go(&mut self, rig: &mut Rig<N>, host: &mut dyn Host) -> Result<Ended, Error> {
        let mut leaving: Option<Instant> = None;
        loop {
            self.hear(rig, host)?;
            match self.life {
                Life::Over => return Ok(Ended::Over),
                Life::Lost if leaving.is_some() => return Ok(Ended::Over),
                Life::Lost => return Ok(Ended::Lost),
                life if life.runs() => self.frame(rig, host)?,
                _ => thread::sleep(WAITING),
            }
            let told = host.told();
            self.heed(told.strain, host);
            self.foveate(rig, host)?;
            let leave = self.obey(rig, host)? || told.leave;
            if leave && leaving.is_none() {
                leaving = Some(Instant::now());
                self.save();
                if rig.session.raw.request_exit().is_err() {
                    // It has not begun, or was ended already.
                    return Ok(Ended::Over);
                }
            }
            if leaving.is_some_and(|since| since.elapsed() > PATIENCE) {
                return Ok(Ended::Over);
            }
            self.studio.poll();
            self.tell_notes(host);
        }
    }

    fn tell_notes(&mut self, host: &mut dyn Host) {
        for note in self.studio.notes() {
            let (Note::Good(text) | Note::Bad(text)) = note;
            host.log(format_args!("{text}"));
            self.last_note = text;
        }
    }

    /// Heat and battery: told once.
    fn heed(&mut self, strain: Strain, host: &mut dyn Host) {
        let heat = strain.heat.max(self.heat);
        let before = core::mem::replace(&mut self.strain, Strain { heat, ..strain });
        if let Some(warning) = self.strain.warning(before) {
            host.log(format_args!("{warning}"));
        }
    }

    /// Shades the pictures as coarsely as the strain wants it; not in the middle of a stroke. Where
    /// that fails, the pictures are the same and the frames go on.
    fn foveate(&self, rig: &mut Rig<N>, host: &mut dyn Host) -> Result<(), Error> {
        let wanted = Foveation::under(self.strain, self.options.foveation);
        let world = self.studio.world();
        let strokes = (0..2).any(|hand| world.hand(hand).trigger);
        if strokes || rig.eyes.foveation().is_none_or(|level| level == wanted) {
            return Ok(());
        }
        match rig.eyes.foveate(&rig.session.raw, wanted) {
            Err(error) if error.is_loss() => return Err(error),
            Err(error) => host.log(format_args!("{error}")),
            Ok(()) => host.log(format_args!("foveation {wanted}")),
        }
        Ok(())
    }

    /// Does what a test asks for. Whether the session is to end.
    fn obey(&mut self, rig: &Rig<N>, host: &mut dyn Host) -> Result<bool, Error> {
        let Some(script) = &self.script else { return Ok(false) };
        match script.next() {
            None => Ok(false),
            Some(Command::Say) => {
                self.say(rig);
                Ok(false)
            }
            Some(Command::Shot(prefix)) => {
                self.shot = Some(prefix);
                Ok(false)
            }
            Some(Command::Quit) => {
                host.log(format_args!("leaving"));
                Ok(true)
            }
        }
    }
}
