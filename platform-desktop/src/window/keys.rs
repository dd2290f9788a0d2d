//! Key bindings.

use paros_shaders::panel::Message;
use winit::event::KeyEvent;
use winit::keyboard::{Key as Logical, KeyCode, ModifiersState, NamedKey, PhysicalKey};

use super::hands::HandAction;

/// A command that a key is bound to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum KeyCommand {
    /// An action of the hands.
    Hands(HandAction),
    /// Finishes the session. The first press asks, the second confirms.
    Finish,
    /// Shows or hides the help.
    Help,
    /// Shows or hides the frame times.
    Graph,
    /// Switches the render path.
    Path,
    /// Writes a trace of the session.
    Record,
    /// Closes the topmost panel, or shows the start panel.
    Back,
    /// Shows or hides the staff's PIN panel.
    Staff,
}

/// The text that names keys in the help.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum HelpKeys {
    /// The label on the keys, the same in all languages.
    Named(&'static str),
    /// A description that is translated.
    Told(Message),
}

/// The help's table for visitors: keys and their functions.
pub(super) const HELP: [(HelpKeys, Message); 15] = [
    (HelpKeys::Told(Message::KeysLeft), Message::HelpRun),
    (HelpKeys::Told(Message::KeysShiftLeft), Message::HelpLightly),
    (HelpKeys::Told(Message::KeysWheel), Message::HelpDepth),
    (HelpKeys::Told(Message::KeysRight), Message::HelpLook),
    (HelpKeys::Told(Message::KeysCtrlWheel), Message::HelpZoom),
    (HelpKeys::Told(Message::KeysMiddle), Message::HelpTurn),
    (HelpKeys::Told(Message::KeysDigits), Message::HelpTools),
    (HelpKeys::Named(", ."), Message::HelpBits),
    (HelpKeys::Named("[ ]"), Message::HelpSize),
    (HelpKeys::Named("Z, Y"), Message::HelpUndo),
    (HelpKeys::Named("M"), Message::HelpMirror),
    (HelpKeys::Named("T"), Message::HelpSteady),
    (HelpKeys::Told(Message::KeysEnter), Message::HelpFinish),
    (HelpKeys::Named("Esc"), Message::HelpBack),
    (HelpKeys::Named("F1, H"), Message::HelpHelp),
];

/// The help's table for developers.
pub(super) const DEVELOPER_HELP: [(&str, &str); 3] = [
    ("R", "write a trace of the session, for paros play"),
    ("F2", "frame times"),
    ("F3", "the paper's path, or the fast one"),
];

/// Returns the command of a key event. Digits, brackets, comma and period are matched by position, the other
/// keys by character; letters of another script by position too.
#[must_use]
pub(super) fn command_of_pressed_key(
    event: &KeyEvent,
    modifiers: ModifiersState,
) -> Option<KeyCommand> {
    let code = match event.physical_key {
        PhysicalKey::Code(code) => Some(code),
        PhysicalKey::Unidentified(_) => None,
    };
    if let Some(name) = code.and_then(code_name) {
        return command_named(name, modifiers.shift_key());
    }
    match &event.logical_key {
        Logical::Named(NamedKey::Space) => command_named("space", false),
        Logical::Named(NamedKey::Enter) => command_named("enter", false),
        Logical::Named(NamedKey::Escape) => command_named("escape", false),
        Logical::Named(NamedKey::F1) => command_named("f1", false),
        Logical::Named(NamedKey::F2) => command_named("f2", false),
        Logical::Named(NamedKey::F3) => command_named("f3", false),
        Logical::Named(NamedKey::F4) => command_named("f4", false),
        Logical::Character(text) => {
            let shift = modifiers.shift_key() && modifiers.control_key();
            command_named(&letter_meant(text, code), shift)
        }
        _ => None,
    }
}

/// Returns the letter that a key stands for. Letters of other scripts are matched by position: a Greek
/// keyboard has an alpha in place of the A.
fn letter_meant(text: &str, code: Option<KeyCode>) -> String {
    let in_place = if text.is_ascii() { None } else { code.and_then(latin_letter) };
    in_place.map_or_else(|| text.to_lowercase(), str::to_owned)
}

/// Returns the command of a key by name: a letter, a digit, a bracket, a comma, a period, "enter", "space",
/// "escape" or "f1" to "f4".
#[must_use]
pub(super) fn command_named(name: &str, shift: bool) -> Option<KeyCommand> {
    let digit = name.parse::<u8>().ok().filter(|digit| (1..=9).contains(digit));
    let hands = match (name, digit) {
        (_, Some(digit)) if shift => HandAction::Bit(digit - 1),
        (_, Some(digit @ 1..=4)) => HandAction::Tool(digit - 1),
        ("[", _) => HandAction::Smaller,
        ("]", _) => HandAction::Larger,
        (",", _) => HandAction::PreviousBit,
        (".", _) => HandAction::NextBit,
        ("z", _) if shift => HandAction::Redo,
        ("z", _) => HandAction::Undo,
        ("y", _) => HandAction::Redo,
        ("m", _) => HandAction::Mirror,
        ("t", _) => HandAction::Steady,
        ("a", _) => HandAction::Turn { left: true },
        ("d", _) => HandAction::Turn { left: false },
        ("w", _) => HandAction::Nearer,
        ("s", _) => HandAction::Farther,
        ("enter" | "space", _) => return Some(KeyCommand::Finish),
        ("h" | "f1", _) => return Some(KeyCommand::Help),
        ("f2", _) => return Some(KeyCommand::Graph),
        ("f3", _) => return Some(KeyCommand::Path),
        ("f4", _) => return Some(KeyCommand::Staff),
        ("r", _) => return Some(KeyCommand::Record),
        ("escape", _) => return Some(KeyCommand::Back),
        _ => return None,
    };
    Some(KeyCommand::Hands(hands))
}

/// Returns the name of a key that is bound by its position, as Shift changes its character.
const fn code_name(code: KeyCode) -> Option<&'static str> {
    Some(match code {
        KeyCode::Digit1 => "1",
        KeyCode::Digit2 => "2",
        KeyCode::Digit3 => "3",
        KeyCode::Digit4 => "4",
        KeyCode::Digit5 => "5",
        KeyCode::Digit6 => "6",
        KeyCode::Digit7 => "7",
        KeyCode::BracketLeft => "[",
        KeyCode::BracketRight => "]",
        KeyCode::Comma => ",",
        KeyCode::Period => ".",
        KeyCode::NumpadEnter => "enter",
        _ => return None,
    })
}

/// Returns the letter at this position on a Latin keyboard, if the letter is bound.
const fn latin_letter(code: KeyCode) -> Option<&'static str> {
    Some(match code {
        KeyCode::KeyA => "a",
        KeyCode::KeyD => "d",
        KeyCode::KeyH => "h",
        KeyCode::KeyM => "m",
        KeyCode::KeyR => "r",
        KeyCode::KeyS => "s",
        KeyCode::KeyT => "t",
        KeyCode::KeyW => "w",
        KeyCode::KeyY => "y",
        KeyCode::KeyZ => "z",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{HandAction, KeyCode, KeyCommand, command_named, letter_meant};

    #[test]
    fn a_greek_keyboard_has_the_letters_that_the_help_names() {
        let greek = ["ζ", "Ζ", "α", "δ", "ς", "σ"];
        let codes = [
            KeyCode::KeyZ,
            KeyCode::KeyZ,
            KeyCode::KeyA,
            KeyCode::KeyD,
            KeyCode::KeyW,
            KeyCode::KeyS,
        ];
        let meant = |k: usize| letter_meant(greek[k], Some(codes[k]));
        assert_eq!([0, 1, 2, 3, 4, 5].map(meant), ["z", "z", "a", "d", "w", "s"]);
        // On a French keyboard the Z lies in the position of W: the character counts.
        assert_eq!(letter_meant("Z", Some(KeyCode::KeyW)), "z");
        assert_eq!(letter_meant("ø", Some(KeyCode::Semicolon)), "ø");
    }

    #[test]
    fn keys_do_what_the_help_says() {
        assert_eq!(command_named("3", false), Some(KeyCommand::Hands(HandAction::Tool(2))));
        assert_eq!(command_named("3", true), Some(KeyCommand::Hands(HandAction::Bit(2))));
        assert_eq!(command_named("5", false), None);
        assert_eq!(command_named("z", false), Some(KeyCommand::Hands(HandAction::Undo)));
        assert_eq!(command_named("z", true), Some(KeyCommand::Hands(HandAction::Redo)));
        assert_eq!(command_named("enter", false), Some(KeyCommand::Finish));
        assert_eq!(command_named("]", false), Some(KeyCommand::Hands(HandAction::Larger)));
        assert_eq!(command_named(",", false), Some(KeyCommand::Hands(HandAction::PreviousBit)));
        assert_eq!(command_named("q", false), None);
    }
}
