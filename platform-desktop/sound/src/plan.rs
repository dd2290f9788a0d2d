//! The sounds of a tick.

use paros_core::limits::MAX_EVENTS;

/// The kind of continuous sound of a hand's tool.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum VoiceKind {
    /// No sound.
    #[default]
    Silent,
    /// An electric motor.
    Motor,
    /// Teeth or a blade drawn over stone.
    Scrape,
    /// Paste pressed through a nozzle.
    Hiss,
}

/// The sound of a hand's tool in a tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct VoicePlan {
    /// The kind of sound.
    pub kind: VoiceKind,
    /// The loudness, 0 to 1.
    pub level: f32,
    /// The load by the stone, 0 to 1.
    pub load: f32,
    /// The pitch of a motor without load, in hertz.
    pub pitch_hz: f32,
    /// The pan, -1 (left) to 1 (right).
    pub pan: f32,
}

/// A kind of sound that begins once and ends by itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShotKind {
    /// A chisel's blow on stone.
    Blow,
    /// A blow into the air.
    Puff,
    /// A chip that a blow removes.
    Chip,
    /// A flake that is split off.
    Flake,
    /// A piece that comes loose and falls.
    Fall,
    /// Another tenth of the hidden figure is bared: a bell, higher for each tenth.
    Bared {
        /// The bared tenths, 1 to 10.
        tenths: u8,
    },
    /// The hidden figure is found.
    Found,
    /// The clock's warning.
    Clock {
        /// The number of strokes, 1 to 3.
        strokes: u8,
    },
    /// The session's or the visit's end.
    End,
    /// A stroke is undone.
    Undo,
    /// A stroke is redone.
    Redo,
    /// A tool or a bit is taken.
    Take,
    /// A tool is released.
    PutBack,
}

impl ShotKind {
    /// Returns `true` for frequent sounds, which are dropped if too many sound at once.
    #[must_use]
    pub const fn is_one_of_many(self) -> bool {
        matches!(self, ShotKind::Blow | ShotKind::Puff | ShotKind::Chip | ShotKind::Flake)
    }
}

/// A sound that begins in a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shot {
    /// The kind of sound.
    pub kind: ShotKind,
    /// The strength, 0 to 1.
    pub strength: f32,
    /// The pan, -1 (left) to 1 (right).
    pub pan: f32,
}

/// The most sounds that begin in a tick: one for each event, and one blow for each hand.
pub const MAX_SHOTS: usize = MAX_EVENTS + 2;

/// The complete set of sounds of a tick. A voice that the plan doesn't contain ends.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct SoundPlan {
    /// The voices of the left and the right hand.
    pub voices: [VoicePlan; 2],
    shots: [Option<Shot>; MAX_SHOTS],
}

impl SoundPlan {
    /// Adds a sound. A sound beyond [`MAX_SHOTS`] is dropped.
    pub fn push(&mut self, shot: Shot) {
        if let Some(free) = self.shots.iter_mut().find(|place| place.is_none()) {
            *free = Some(shot);
        }
    }

    /// Returns the sounds that begin.
    pub fn shots(&self) -> impl Iterator<Item = &Shot> {
        self.shots.iter().flatten()
    }
}
