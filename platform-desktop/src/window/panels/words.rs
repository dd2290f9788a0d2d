//! Texts of the window's own panels, in the visitor's language, from the table of the panels' texts.

use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_shaders::panel::{Filling, FillingValue, Language, Message};
use paros_visit::name_of_start;

/// Returns a text with its placeholders filled in.
pub(super) fn say(language: Language, message: Message, fillings: &[Filling<'_>]) -> String {
    let mut text = String::new();
    // Writing to a string can't fail.
    let _ = message.write_filled(&mut text, language, fillings);
    text
}

/// Returns the text that the hidden figure of a session was found.
pub(super) fn say_found(language: Language, mode: SessionMode) -> String {
    let figure = FillingValue::Text(name_of_start(mode).text(language));
    say(language, Message::BarYouFound, &[("figure", figure)])
}

/// Returns the name of an item on the bench.
pub(super) const fn item_name(item: BenchItem) -> Message {
    match item {
        BenchItem::Tool(tool) => tool_name(tool),
        BenchItem::Bit(bit) => bit_name(bit),
    }
}

/// Returns a tool's name.
pub(super) const fn tool_name(tool: Tool) -> Message {
    match tool {
        Tool::Rotary => Message::ToolRotary,
        Tool::Impact => Message::ToolChisel,
        Tool::FillGun => Message::ToolPaste,
        Tool::Rasp => Message::ToolRasp,
    }
}

/// Returns a bit's name.
pub(super) const fn bit_name(bit: ToolBit) -> Message {
    match bit {
        ToolBit::SmallBall => Message::BitSmallBall,
        ToolBit::MediumBall => Message::BitMediumBall,
        ToolBit::LargeBall => Message::BitLargeBall,
        ToolBit::Cylinder => Message::BitCylinder,
        ToolBit::Grinder => Message::BitGrinder,
        ToolBit::PointChisel => Message::BitPointChisel,
        ToolBit::FlatChisel => Message::BitFlatChisel,
        ToolBit::RoughingBall => Message::BitRoughingBall,
        ToolBit::DiscSaw => Message::BitDiscSaw,
        ToolBit::Nozzle => Message::BitNozzle,
        ToolBit::File => Message::BitFile,
        ToolBit::Float => Message::BitFloat,
        ToolBit::PitchingChisel => Message::BitPitchingChisel,
    }
}

#[cfg(test)]
mod tests {
    use egui::{Context, FontId, RawInput};
    use paros_core::session::ToolBit;
    use paros_shaders::panel::{Language, Message};

    use super::bit_name;

    #[test]
    fn a_bit_is_named_as_the_core_names_it() {
        for bit in ToolBit::ALL {
            assert_eq!(bit_name(bit).text(Language::English), bit.spec().name);
        }
    }

    /// Checks the fonts of `egui`: one of them has Greek with accents.
    #[test]
    fn the_window_has_a_glyph_for_every_letter() {
        let context = Context::default();
        let _ = context.run(RawInput::default(), |_| {});
        let font = FontId::proportional(15.0);
        for message in Message::ALL {
            for language in Language::ALL {
                let text = message.text(language);
                let mut letters = text.chars().filter(|letter| *letter != ' ');
                let lacks = context
                    .fonts_mut(|fonts| letters.find(|letter| !fonts.has_glyph(&font, *letter)));
                assert_eq!(lacks, None, "{message:?}: {text}");
            }
        }
    }
}
