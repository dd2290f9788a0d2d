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
    /// An edge has been sawn off and fell.
    Edge,
    /// The front has been roughed out.
    Front,
    /// The large burr is done.
    Rough,
    /// The medium burr is done.
    Fine,
    /// The rasp took the ridges.
    Smooth,
    /// Paste went where it shouldn't.
    Mishap,
    /// That was undone.
    Undone,
    /// Beads of paste lie round the neck; finished.
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
        Chapter::Edge,
        Chapter::Front,
        Chapter::Rough,
        Chapter::Fine,
        Chapter::Smooth,
        Chapter::Mishap,
        Chapter::Undone,
        Chapter::Finished,
    ];

    const LANTERN: [Chapter; 3] = [Chapter::Stone, Chapter::HalfSlotted, Chapter::Slotted];

    /// What has just been done, for the report.
    #[must_use]
    pub const fn completion_announcement(self) -> &'static str {
        match self {
            Chapter::Stone => "the stone",
            Chapter::Edge => "an edge sawn off",
            Chapter::Front => "the front roughed out",
            Chapter::Rough => "roughed out",
            Chapter::Fine => "worked finer",
            Chapter::Smooth => "rasped smooth",
            Chapter::Mishap => "paste on the head",
            Chapter::Undone => "undone",
            Chapter::Finished => "a string of beads round the neck",
            Chapter::HalfSlotted => "three slots cut to the post",
            Chapter::Slotted => "six slots cut",
        }
    }
}
