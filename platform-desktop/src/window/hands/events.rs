//! Mouse and keyboard events, as input of the hands.

/// Buttons of the mouse.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::window) enum HandButton {
    /// Runs the tool.
    Left,
    /// Turns the stool.
    Middle,
    /// Orbits the view.
    Right,
}

/// Actions of the hands that keys are bound to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::window) enum HandAction {
    /// Takes a tool, by number.
    Tool(u8),
    /// Mounts the held tool's bit with this number, from 0.
    Bit(u8),
    /// Mounts the bit before the mounted one.
    PreviousBit,
    /// Mounts the bit after the mounted one.
    NextBit,
    /// Makes the mounted bit a step smaller.
    Smaller,
    /// Makes the mounted bit a step larger.
    Larger,
    /// Undoes a stroke.
    Undo,
    /// Redoes a stroke.
    Redo,
    /// Switches the mirror on or off.
    Mirror,
    /// Switches the steadied hand on or off.
    Steady,
    /// Turns the stool to the left or right while the key is down.
    Turn {
        /// `true` for clockwise as seen from above.
        left: bool,
    },
    /// Zooms in.
    Nearer,
    /// Zooms out.
    Farther,
}

impl HandAction {
    /// Returns `true` for actions that only move the eye. They also work on a finished sculpture, whose stool
    /// doesn't turn.
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
    /// The cursor has left the picture.
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
    /// Shift went down, or up: with Shift the left button runs the tool lightly.
    Lightly(bool),
    /// All buttons and keys count as released: the window lost the keyboard focus.
    LetGo,
}
