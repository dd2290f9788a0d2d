//! What is to sound in a tick.

use paros_core::limits::MAX_EVENTS;

/// What a hand's tool sounds like as long as it runs.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum VoiceKind {
    /// Not at all.
    #[default]
    Silent,
    /// An electric motor.
    Motor,
    /// Teeth or a blade drawn over stone.
    Scrape,
    /// Paste pressed through a nozzle.
    Hiss,
}

/// How a hand's tool sounds in a tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct VoicePlan {
    /// What it sounds like.
    pub kind: VoiceKind,
    /// How loud, 0 to 1.
    pub level: f32,
    /// What the stone does against it, 0 to 1.
    pub load: f32,
    /// Of a motor without load, in hertz.
    pub pitch_hz: f32,
    /// -1 left, 1 right.
    pub pan: f32,
}

/// What sounds once and ends by itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShotKind {
    /// A chisel's blow on stone.
    Blow,
    /// A blow into the air.
    Puff,
    /// What a blow chips off.
    Chip,
    /// A flake that is split off.
    Flake,
    /// A piece that comes loose and falls.
    Fall,
    /// Another tenth of the hidden figure is bared: it rings, the higher the more of it is bared.
    Bared {
        /// 1 to 10.
        tenths: u8,
    },
    /// The hidden figure is found.
    Found,
    /// The clock warns.
    Clock {
        /// How many strokes, 1 to 3.
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
    /// A tool is let go of.
    PutBack,
}

impl ShotKind {
    /// Whether it is one of many: it gives way where too much sounds at once.
    #[must_use]
    pub const fn is_one_of_many(self) -> bool {
        matches!(self, ShotKind::Blow | ShotKind::Puff | ShotKind::Chip | ShotKind::Flake)
    }
}

/// A sound that begins in a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shot {
    /// What sounds.
    pub kind: ShotKind,
    /// How strongly, 0 to 1.
    pub strength: f32,
    /// -1 left, 1 right.
    pub pan: f32,
}

/// Sounds that begin in a tick, at most: one of each event, and a blow of each hand.
pub const MAX_SHOTS: usize = MAX_EVENTS + 2;

/// What is to sound in a tick. All of it: of what it doesn't name, voices end.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct SoundPlan {
    /// Left and right hand.
    pub voices: [VoicePlan; 2],
    shots: [Option<Shot>; MAX_SHOTS],
}

impl SoundPlan {
    /// Adds a sound. One beyond [`MAX_SHOTS`] is left out.
    pub fn push(&mut self, shot: Shot) {
        if let Some(free) = self.shots.iter_mut().find(|place| place.is_none()) {
            *free = Some(shot);
        }
    }

    /// The sounds that begin.
    pub fn shots(&self) -> impl Iterator<Item = &Shot> {
        self.shots.iter().flatten()
    }
}
