//! Height steps of the room for visitors who sit, stand or are tall, so that bench and stool are at about
//! elbow height. There are only a few fixed steps, none in between.

/// A step of the room's floor above or below the real floor.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum HeightStep {
    /// Lower, for people who sit and for children.
    Low,
    /// On the real floor, for people who stand.
    #[default]
    Middle,
    /// Higher, for tall people.
    High,
}

/// The eye height, in metres above the floor, below which people count as seated or as children. It lies
/// between the 1.27 m of tall people seated and the 1.41 m of small women standing (95th and 5th percentile:
/// Pheasant and Haslegrave, "Bodyspace").
const LOW_BELOW: f32 = 1.34;

/// The eye height, in metres above the floor, from which people count as tall: half of all men's eyes are
/// above 1.63 m, a twentieth above 1.75 m.
const HIGH_FROM: f32 = 1.68;

impl HeightStep {
    /// All steps, the lowest first.
    pub const ALL: [HeightStep; 3] = [HeightStep::Low, HeightStep::Middle, HeightStep::High];

    /// Returns the step for an eye height in metres above the floor.
    #[must_use]
    pub fn for_eyes(height: f32) -> Self {
        match height {
            height if height < LOW_BELOW => HeightStep::Low,
            height if height >= HIGH_FROM => HeightStep::High,
            _ => HeightStep::Middle,
        }
    }

    /// Returns the height of the room's floor above the real floor, in metres. A seated person's elbows are
    /// 30 cm lower than a standing person's; a step of only 20 cm keeps the stool's top above the knees.
    #[must_use]
    pub const fn offset_metres(self) -> f32 {
        match self {
            HeightStep::Low => -0.2,
            HeightStep::Middle => 0.0,
            HeightStep::High => 0.1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::HeightStep;

    #[test]
    fn eyes_have_the_step_of_those_whose_they_are() {
        for (eyes, step) in [
            (0.9, HeightStep::Low),
            (1.10, HeightStep::Low),
            (1.27, HeightStep::Low),
            (1.41, HeightStep::Middle),
            (1.63, HeightStep::Middle),
            (1.75, HeightStep::High),
            (2.2, HeightStep::High),
            (f32::NAN, HeightStep::Middle),
        ] {
            assert_eq!(HeightStep::for_eyes(eyes), step, "{eyes}");
        }
        let offsets = HeightStep::ALL.map(HeightStep::offset_metres);
        assert!(offsets.is_sorted() && HeightStep::default().offset_metres() == 0.0);
    }
}
