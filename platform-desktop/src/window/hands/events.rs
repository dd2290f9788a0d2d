//! Events of mouse and keyboard, as the hands understand them.

/// Buttons of the mouse.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::window) enum HandButton {
    /// Runs the tool.
    Left,
    /// Turns the stool.
    Middle,
    /// Orbits.
    Right,
}

/// Actions of the hands that keys are bound to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::window) enum HandAction {
    /// Takes a tool, by number.
    Tool(u8),
    /// Mounts the held tool's bit of a number, from 0.
    Bit(u8),
    /// Mounts the bit before the mounted one.
    PreviousBit,
    /// Mounts the bit after it.
    NextBit,
    /// Makes the mounted bit a step smaller.
    Smaller,
    /// Makes it a step larger.
    Larger,
    /// Takes a stroke back.
    Undo,
    /// Brings it back again.
    Redo,
    /// Switches the mirror.
    Mirror,
    /// Steadies the hand, or lets it be.
    Steady,
    /// Turns the stool while it is down: to the left, or to the right.
    Turn {
        /// Clockwise as seen from above.
        left: bool,
    },
    /// Goes nearer.
    Nearer,
    /// Goes farther.
    Farther,
}

impl HandAction {
    /// Whether it moves the eye alone: of use for what is finished too, where the stool stands still.
    #[must_use]
    pub(in crate::window) const fn is_for_looking(self) -> bool {
        matches!(self, HandAction::Nearer | HandAction::Farther)
    }
}

/// An event of mouse or keyboard over the picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::window) enum InputEvent {
    /// The cursor is at a pixel, counted from the upper left.
    Moved([f32; 2]),
    /// The cursor is nowhere in the picture.
    Gone,
    /// A button went down over the picture.
    Pressed(HandButton),
    /// A button went up.
    Released(HandButton),
    /// The wheel turned by notches; away from the visitor is positive.
    Wheel(f32),
    /// The wheel turned with Ctrl down.
    Zoom(f32),
    /// A key went down, or up.
    Key(HandAction, bool),
    /// Shift went down, or up: what the left button runs works lightly.
    Lightly(bool),
    /// Nothing is down any more: the window lost its keyboard.
    LetGo,
}
