//! The scripted sessions and their chapters.

/// A scripted session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DemoScript {
    /// The owl: carved out of the lump that hides it, roughed, worked finer and decorated.
    Owl,
    /// The lantern: six twisted slots cut through the lump round a post. One interval per column can't
    /// represent it.
    Lantern,
}

/// A stage of a session, for pictures and the report.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Chapter {
    /// The untouched lump.
    Stone,
    /// The lump's corners have been sawn off.
    Sawn,
    /// The roughing ball is done.
    Rough,
    /// The large ball has bared most of the figure.
    Bared,
    /// The chisel and the smaller balls are done.
    Fine,
    /// Paste was put in the wrong place.
    Mishap,
    /// The paste was undone.
    Undone,
    /// A cord of paste lies round the neck.
    Cord,
    /// The cord is rasped smooth; the owl is finished.
    Finished,
    /// Half of the lantern's slots are cut.
    HalfSlotted,
    /// All slots are cut; the lantern is finished.
    Slotted,
}

impl DemoScript {
    /// Returns its chapters, in order.
    #[must_use]
    pub const fn chapters(self) -> &'static [Chapter] {
        match self {
            DemoScript::Owl => &Chapter::OWL,
            DemoScript::Lantern => &Chapter::LANTERN,
        }
    }

    /// Returns the name of the figure, for the report.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            DemoScript::Owl => "owl",
            DemoScript::Lantern => "lantern",
        }
    }
}

impl Chapter {
    const OWL: [Chapter; 9] = [
        Chapter::Stone,
        Chapter::Sawn,
        Chapter::Rough,
        Chapter::Bared,
        Chapter::Fine,
        Chapter::Mishap,
        Chapter::Undone,
        Chapter::Cord,
        Chapter::Finished,
    ];

    const LANTERN: [Chapter; 3] = [Chapter::Stone, Chapter::HalfSlotted, Chapter::Slotted];

    /// Returns a text that says what has just been done, for the report.
    #[must_use]
    pub const fn completion_announcement(self) -> &'static str {
        match self {
            Chapter::Stone => "the stone",
            Chapter::Sawn => "corners sawn off",
            Chapter::Rough => "roughed out",
            Chapter::Bared => "taken down to the owl by the large ball",
            Chapter::Fine => "chiselled and worked finer",
            Chapter::Mishap => "paste on the head",
            Chapter::Undone => "undone",
            Chapter::Cord => "a cord round the neck",
            Chapter::Finished => "rasped smooth",
            Chapter::HalfSlotted => "three slots cut to the post",
            Chapter::Slotted => "six slots cut",
        }
    }
}
