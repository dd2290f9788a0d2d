//! Which key does what.

use winit::event::KeyEvent;
use winit::keyboard::{Key as Logical, KeyCode, ModifiersState, NamedKey, PhysicalKey};

use super::hands::Key;

/// What a key is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Command {
    /// Something that the hands do.
    Hands(Key),
    /// Ends the session, when asked twice.
    Finish,
    /// Shows or hides the help.
    Help,
    /// Shows or hides the frame times.
    Graph,
    /// Goes from one path to the other.
    Path,
    /// Writes a trace of the session.
    Record,
    /// Closes what is open, or shows the start.
    Back,
}

/// The help's table: keys, and what they do.
pub(super) const HELP: [(&str, &str); 14] = [
    ("left button", "run the tool on the surface under the cursor"),
    ("wheel", "how deep it goes"),
    ("right drag", "look from another side"),
    ("Ctrl + wheel, W, S", "nearer, farther"),
    ("middle drag, A, D", "turn the stool"),
    ("1 to 4", "tools, or click them on the bench"),
    ("Shift + 1 to 5, [ ]", "bits of the tool"),
    ("Z, Y", "undo, redo"),
    ("M", "mirror"),
    ("Enter, Space", "finish: print and picture"),
    ("R", "write a trace of the session"),
    ("F2", "frame times"),
    ("F3", "the paper's path, or the fast one"),
    ("Esc", "the start panel: another mode, open a file"),
];

/// What a key that went down or up does.
#[must_use]
pub(super) fn command(event: &KeyEvent, modifiers: ModifiersState) -> Option<Command> {
    let physical = match event.physical_key {
        PhysicalKey::Code(code) => code_name(code),
        PhysicalKey::Unidentified(_) => None,
    };
    if let Some(name) = physical {
        return named(name, modifiers.shift_key());
    }
    match &event.logical_key {
        Logical::Named(NamedKey::Space) => named("space", false),
        Logical::Named(NamedKey::Enter) => named("enter", false),
        Logical::Named(NamedKey::Escape) => named("escape", false),
        Logical::Named(NamedKey::F1) => named("f1", false),
        Logical::Named(NamedKey::F2) => named("f2", false),
        Logical::Named(NamedKey::F3) => named("f3", false),
        Logical::Character(text) => {
            named(&text.to_lowercase(), modifiers.shift_key() && modifiers.control_key())
        }
        _ => None,
    }
}

/// What the key of a name does: a letter, a digit, a bracket, "enter", "space", "escape" or "f1" to
/// "f3".
#[must_use]
pub(super) fn named(name: &str, shift: bool) -> Option<Command> {
    let digit = name.parse::<u8>().ok().filter(|digit| (1..=9).contains(digit));
    let hands = match (name, digit) {
        (_, Some(digit)) if shift => Key::Bit(digit - 1),
        (_, Some(digit @ 1..=4)) => Key::Tool(digit - 1),
        ("[", _) => Key::PreviousBit,
        ("]", _) => Key::NextBit,
        ("z", _) if shift => Key::Redo,
        ("z", _) => Key::Undo,
        ("y", _) => Key::Redo,
        ("m", _) => Key::Mirror,
        ("a", _) => Key::Turn { left: true },
        ("d", _) => Key::Turn { left: false },
        ("w", _) => Key::Nearer,
        ("s", _) => Key::Farther,
        ("enter" | "space", _) => return Some(Command::Finish),
        ("h" | "f1", _) => return Some(Command::Help),
        ("f2", _) => return Some(Command::Graph),
        ("f3", _) => return Some(Command::Path),
        ("r", _) => return Some(Command::Record),
        ("escape", _) => return Some(Command::Back),
        _ => return None,
    };
    Some(Command::Hands(hands))
}

/// Digits and brackets go by their place: with Shift they give other signs.
const fn code_name(code: KeyCode) -> Option<&'static str> {
    Some(match code {
        KeyCode::Digit1 => "1",
        KeyCode::Digit2 => "2",
        KeyCode::Digit3 => "3",
        KeyCode::Digit4 => "4",
        KeyCode::Digit5 => "5",
        KeyCode::BracketLeft => "[",
        KeyCode::BracketRight => "]",
        KeyCode::NumpadEnter => "enter",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{Command, Key, named};

    #[test]
    fn keys_do_what_the_help_says() {
        assert_eq!(named("3", false), Some(Command::Hands(Key::Tool(2))));
        assert_eq!(named("3", true), Some(Command::Hands(Key::Bit(2))));
        assert_eq!(named("5", false), None);
        assert_eq!(named("z", false), Some(Command::Hands(Key::Undo)));
        assert_eq!(named("z", true), Some(Command::Hands(Key::Redo)));
        assert_eq!(named("enter", false), Some(Command::Finish));
        assert_eq!(named("q", false), None);
    }
}
