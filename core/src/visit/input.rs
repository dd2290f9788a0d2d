//! The input of a visit in a tick: presence and use of the headset, and a command.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::session::input::SessionMode;
use crate::visit::plan::PlanSetting;

/// User presence, as reported by the runtime.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
#[repr(u8)]
pub enum Presence {
    /// The runtime doesn't report presence: then use counts as wearing.
    #[default]
    Unknown = 0,
    /// The headset is on a head.
    Worn = 1,
    /// The headset is off the head.
    Off = 2,
}

/// An action that a visitor presses on a panel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PanelAction {
    /// Continues with the current selection.
    Confirm,
    /// Selects the language with this number.
    Language(u8),
    /// Selects the working hand: 0 left, 1 right.
    WorkingHand(u8),
    /// Selects seated (`true`) or standing (`false`).
    Seated(bool),
    /// Selects the mode of the session.
    Start(SessionMode),
    /// Skips the current step of the guided first cut, or all remaining steps.
    Skip {
        /// `true` to skip all remaining steps.
        all: bool,
    },
    /// Finishes the sculpture.
    Finish,
    /// Puts all tools back on the bench.
    PutBack,
}

/// A command of the staff, given after entering its PIN or at the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum StaffCommand {
    /// Adds a minute to the clock.
    Extend = 0,
    /// Ends sculpting now.
    End = 1,
    /// Ends the visit of a visitor who has gone: the sculpture is kept, and the next visitor can start.
    Reset = 2,
}

/// A command to the visit, at most one a tick: shells queue them.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum VisitCommand {
    /// No command.
    #[default]
    None,
    /// Opens visits, starting in the attract phase with the default plan.
    Open,
    /// Closes visits. A running session continues.
    Close,
    /// Sets a value of the plan.
    Set {
        /// The setting.
        setting: PlanSetting,
        /// Seconds, or 0 or 1.
        value: u16,
    },
    /// Sets the default session mode, for visitors who choose nothing.
    SetStart(SessionMode),
    /// A panel was pressed by a mouse or a finger.
    Press(PanelAction),
    /// A command of the staff.
    Staff(StaffCommand),
    /// The program slept or didn't run for this many seconds, in which the headset wasn't used.
    Away {
        /// Seconds, saturated.
        seconds: u16,
    },
    /// The finished sculpture has been stored.
    Exported,
    /// Sets the badge to show.
    Badge {
        /// The [`BadgeNumber`](crate::badge::BadgeNumber) as 27 bits.
        number: u32,
    },
}

/// The input of a visit in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct VisitInput {
    /// User presence.
    pub presence: Presence,
    /// `true` if the headset was moved or its controls were used.
    pub is_used: bool,
    /// A command.
    pub command: VisitCommand,
}

impl PanelAction {
    fn to_bytes(self) -> [u8; 3] {
        match self {
            PanelAction::Confirm => [0, 0, 0],
            PanelAction::Language(number) => [1, number, 0],
            PanelAction::WorkingHand(hand) => [2, hand, 0],
            PanelAction::Seated(is_seated) => [3, u8::from(is_seated), 0],
            PanelAction::Start(mode) => {
                let [kind, figure] = mode.to_bytes();
                [4, kind, figure]
            }
            PanelAction::Skip { all } => [5, u8::from(all), 0],
            PanelAction::Finish => [6, 0, 0],
            PanelAction::PutBack => [7, 0, 0],
        }
    }

    fn from_bytes(bytes: [u8; 3]) -> Option<Self> {
        Some(match bytes {
            [0, 0, 0] => PanelAction::Confirm,
            [1, number, 0] => PanelAction::Language(number),
            [2, hand @ 0..2, 0] => PanelAction::WorkingHand(hand),
            [3, is_seated @ 0..2, 0] => PanelAction::Seated(is_seated == 1),
            [4, kind, figure] => PanelAction::Start(SessionMode::from_bytes([kind, figure])?),
            [5, all @ 0..2, 0] => PanelAction::Skip { all: all == 1 },
            [6, 0, 0] => PanelAction::Finish,
            [7, 0, 0] => PanelAction::PutBack,
            _ => return None,
        })
    }
}

impl VisitCommand {
    const BYTES: usize = 5;

    fn to_bytes(self) -> [u8; Self::BYTES] {
        match self {
            VisitCommand::None => [0; 5],
            VisitCommand::Open => [1, 0, 0, 0, 0],
            VisitCommand::Close => [2, 0, 0, 0, 0],
            VisitCommand::Set { setting, value } => {
                let [low, high] = value.to_le_bytes();
                [3, setting as u8, low, high, 0]
            }
            VisitCommand::SetStart(mode) => {
                let [kind, figure] = mode.to_bytes();
                [4, kind, figure, 0, 0]
            }
            VisitCommand::Press(action) => {
                let [a, b, c] = action.to_bytes();
                [5, a, b, c, 0]
            }
            VisitCommand::Staff(command) => [6, command as u8, 0, 0, 0],
            VisitCommand::Away { seconds } => {
                let [low, high] = seconds.to_le_bytes();
                [7, low, high, 0, 0]
            }
            VisitCommand::Exported => [8, 0, 0, 0, 0],
            VisitCommand::Badge { number } => {
                let [a, b, c, d] = number.to_le_bytes();
                [9, a, b, c, d]
            }
        }
    }

    fn from_bytes(bytes: [u8; Self::BYTES]) -> Option<Self> {
        Some(match bytes {
            [0, 0, 0, 0, 0] => VisitCommand::None,
            [1, 0, 0, 0, 0] => VisitCommand::Open,
            [2, 0, 0, 0, 0] => VisitCommand::Close,
            [3, setting, low, high, 0] => VisitCommand::Set {
                setting: PlanSetting::from_number(setting)?,
                value: u16::from_le_bytes([low, high]),
            },
            [4, kind, figure, 0, 0] => {
                VisitCommand::SetStart(SessionMode::from_bytes([kind, figure])?)
            }
            [5, a, b, c, 0] => VisitCommand::Press(PanelAction::from_bytes([a, b, c])?),
            [6, 0, 0, 0, 0] => VisitCommand::Staff(StaffCommand::Extend),
            [6, 1, 0, 0, 0] => VisitCommand::Staff(StaffCommand::End),
            [6, 2, 0, 0, 0] => VisitCommand::Staff(StaffCommand::Reset),
            [7, low, high, 0, 0] => VisitCommand::Away { seconds: u16::from_le_bytes([low, high]) },
            [8, 0, 0, 0, 0] => VisitCommand::Exported,
            [9, a, b, c, d @ 0..8] => {
                VisitCommand::Badge { number: u32::from_le_bytes([a, b, c, d]) }
            }
            _ => return None,
        })
    }
}

impl VisitInput {
    /// Length of a serialised input in bytes.
    pub(crate) const BYTES: usize = 1 + VisitCommand::BYTES;

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u8(self.presence as u8 | u8::from(self.is_used) << 2);
        to.bytes(&self.command.to_bytes());
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("presence, 0 to 2, and use");
        let flags = from.u8()?;
        let presence = match flags & 3 {
            0 => Presence::Unknown,
            1 => Presence::Worn,
            2 => Presence::Off,
            _ => return Err(bad),
        };
        if flags >> 3 != 0 {
            return Err(bad);
        }
        let bad = from.error_here("a visit's command, 0 to 9, and zeros for what it doesn't take");
        let mut bytes = [0; VisitCommand::BYTES];
        for byte in &mut bytes {
            *byte = from.u8()?;
        }
        let command = VisitCommand::from_bytes(bytes).ok_or(bad)?;
        Ok(VisitInput { presence, is_used: flags & 4 != 0, command })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_come_back_from_their_bytes_and_nothing_else_does() {
        let figure = SessionMode::Constrained { figure: 7 };
        let actions = [
            PanelAction::Confirm,
            PanelAction::Language(3),
            PanelAction::WorkingHand(1),
            PanelAction::Seated(true),
            PanelAction::Start(figure),
            PanelAction::Skip { all: true },
            PanelAction::Finish,
            PanelAction::PutBack,
        ];
        let others = [
            VisitCommand::None,
            VisitCommand::Open,
            VisitCommand::Close,
            VisitCommand::Set { setting: PlanSetting::Badges, value: 0x1234 },
            VisitCommand::SetStart(SessionMode::Creative),
            VisitCommand::Staff(StaffCommand::Extend),
            VisitCommand::Staff(StaffCommand::End),
            VisitCommand::Staff(StaffCommand::Reset),
            VisitCommand::Away { seconds: 0x4321 },
            VisitCommand::Exported,
            VisitCommand::Badge { number: (1 << 27) - 1 },
        ];
        for command in actions.map(VisitCommand::Press).into_iter().chain(others) {
            let input = VisitInput { presence: Presence::Off, is_used: true, command };
            let mut bytes = [0; VisitInput::BYTES];
            input.write(&mut ByteWriter::new(&mut bytes));
            assert_eq!(VisitInput::read(&mut ByteReader::new(&bytes)), Ok(input));
        }
        // Every input that can be read is written back unchanged.
        for kind in 0..=255 {
            for rest in [[0, 0, 0, 0], [1, 0, 0, 0], [2, 3, 0, 0], [0, 0, 0, 1], [255; 4]] {
                let [a, b, c, d] = rest;
                let bytes = [4, kind, a, b, c, d];
                if let Ok(input) = VisitInput::read(&mut ByteReader::new(&bytes)) {
                    let mut again = [0; VisitInput::BYTES];
                    input.write(&mut ByteWriter::new(&mut again));
                    assert_eq!(again, bytes);
                }
            }
        }
        assert!(VisitInput::read(&mut ByteReader::new(&[3, 0, 0, 0, 0, 0])).is_err());
        assert!(VisitInput::read(&mut ByteReader::new(&[8, 0, 0, 0, 0, 0])).is_err());
        assert!(VisitInput::read(&mut ByteReader::new(&[0, 9, 0, 0, 0, 8])).is_err());
    }
}
