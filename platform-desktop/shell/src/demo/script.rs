//! The sessions that are scripted, and their chapters.

/// A scripted session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DemoScript {
    /// The owl comes out of the lump that hides it, roughed, worked finer and decorated.
    Owl,
    /// A lantern is cut through the lump: six twisted slots round a post. One interval a column can't
    /// hold it.
    Lantern,
}

/// A stage of a session, for pictures and the report.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Chapter {
    /// The lump as it came.
    Stone,
    /// Its corners have been sawn off and fell.
    Sawn,
    /// The roughing ball is done.
    Rough,
    /// The large ball has bared most of the figure.
    Bared,
    /// The chisel and the smaller balls are done.
    Fine,
    /// Paste went where it shouldn't.
    Mishap,
    /// That was undone.
    Undone,
    /// A cord of paste lies round the neck.
    Cord,
    /// It is rasped smooth; finished.
    Finished,
    /// Half of the lantern's slots are cut.
    HalfSlotted,
    /// All of them are, and the lantern is finished.
    Slotted,
}

impl DemoScript {
    /// Its chapters, in order.
    #[must_use]
    pub const fn chapters(self) -> &'static [Chapter] {
        match self {
            DemoScript::Owl => &Chapter::OWL,
            DemoScript::Lantern => &Chapter::LANTERN,
        }
    }

    /// What comes out of the stone, for the report.
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

    /// What has just been done, for the report.
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
