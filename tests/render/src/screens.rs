//! Every screen of a visit, as laid out on the panels.

use paros_core::badge::BadgeNumber;
use paros_shaders::Image;
use paros_shaders::limits::{PANEL_CELL_TEXELS, PANEL_CELLS};
use paros_shaders::panel::layout::{
    self, Clock, Guide, HandoverTold, PanelNotice, PinEntry, palette,
};
use paros_shaders::panel::{
    ButtonState, FillingValue, Icon, Language, Message, Panel, PanelButton, PanelPictures,
};

/// A screen's name and its panel.
pub type Screen = (&'static str, Panel);

/// Returns all screens in a language.
#[must_use]
pub fn all_screens(language: Language) -> Vec<Screen> {
    let mut all = visit_screens(language);
    all.extend(notice_screens(language));
    all.extend(staff_screens(language));
    all
}

/// Returns pictures for cells: bands of a different colour for each; the last cells have no picture.
#[must_use]
pub fn pictures_of_cells() -> PanelPictures {
    let side = PANEL_CELL_TEXELS;
    let mut pictures = PanelPictures::default();
    for cell in 0..PANEL_CELLS / 2 {
        let mut picture = Image::filled(side, side, [0; 3]);
        for (at, pixel) in picture.pixels.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let (x, y) = (at % side, at / side);
            *pixel = [60 * cell as u8, (x / 16 * 16) as u8, (y / 24 * 24) as u8];
        }
        pictures.set(cell as u8, &picture);
    }
    pictures
}

fn drawn(name: &'static str, draw: impl FnOnce(&mut Panel)) -> Screen {
    let mut panel = Panel::default();
    draw(&mut panel);
    (name, panel)
}

/// Returns cards with pictures: two with a picture, and one whose picture isn't loaded yet.
fn pictured_cards<'a>(cards: &[PanelButton<'a>]) -> Vec<PanelButton<'a>> {
    let cells = [0, PANEL_CELLS as u8 - 1, 2];
    let mut cards: Vec<_> =
        cards.iter().zip(cells).map(|(card, cell)| card.with_cell(cell)).collect();
    cards[2].state = ButtonState::Hot;
    cards
}

fn choice_screens(language: Language) -> Vec<Screen> {
    let starts = layout::choice_buttons(
        0,
        &[
            (Message::ChoiceFree, Icon::Stone),
            (Message::ChoiceFigure, Icon::Figure),
            (Message::ChoiceShape, Icon::Shape),
        ],
    );
    let mut figures = layout::choice_buttons(
        0,
        &[
            (Message::FigureOwl, Icon::Owl),
            (Message::FigureCat, Icon::Cat),
            (Message::FigureDolphin, Icon::Dolphin),
            (Message::FigureAmphora, Icon::Amphora),
            (Message::FigureSurprise, Icon::Surprise),
        ],
    );
    figures[1].state = ButtonState::Hot;
    figures[4].state = ButtonState::Off;
    vec![
        drawn("starts", |panel| {
            layout::draw_choice(panel, language, Message::ChoiceTitle, &starts);
        }),
        drawn("starts-pictured", |panel| {
            layout::draw_choice(panel, language, Message::ChoiceTitle, &pictured_cards(&starts));
        }),
        drawn("figures", |panel| {
            layout::draw_choice(panel, language, Message::ChoiceFigureTitle, &figures);
        }),
    ]
}

fn visit_screens(language: Language) -> Vec<Screen> {
    let mut welcome = layout::welcome_buttons(0, 3);
    welcome[language as usize].state = ButtonState::Chosen;
    welcome[2].state = ButtonState::Chosen;
    welcome[5].state = ButtonState::Hot;
    let badge = BadgeNumber::new(3 << 18 | 777).expect("a number").badge();
    let mut all = vec![
        drawn("attract", |panel| layout::draw_attract(panel, Icon::Headset, Message::AttractBody)),
        drawn("attract-mouse", |panel| {
            layout::draw_attract(panel, Icon::Stone, Message::AttractBodyMouse);
        }),
        drawn("welcome", |panel| layout::draw_welcome(panel, language, 3, &welcome)),
        drawn("welcome-mouse", |panel| {
            let mut buttons = layout::welcome_buttons(0, 1);
            buttons[language as usize].state = ButtonState::Chosen;
            let of_use = [0, 1, 6].map(|k| buttons[k]);
            layout::draw_welcome(panel, language, 1, &of_use);
        }),
    ];
    all.extend(choice_screens(language));
    all.extend(guide_screens(language));
    for (seconds, warning) in [
        (452, None),
        (120, Some(Message::WarningTwoMinutes)),
        (30, Some(Message::WarningThirtySeconds)),
        (9, Some(Message::WarningTenSeconds)),
    ] {
        all.push(drawn("clock", |panel| {
            let clock = Clock { seconds: Some([seconds, 600]), warning };
            let buttons = clock.buttons(0, CLOCK_BUTTONS);
            let buttons = if seconds == 452 || seconds == 30 { &buttons[..] } else { &[] };
            layout::draw_clock(panel, language, &clock, buttons);
        }));
    }
    let next = layout::badge_buttons(0).map(PanelButton::primary);
    for (name, told, buttons) in [
        ("badge", Message::BadgeBody, &[][..]),
        ("badge-seen", Message::BadgeBody, &next),
        ("badge-kept-here", Message::BadgeKeptHere, &[]),
        ("badge-on-its-way", Message::BadgeOnItsWay, &next),
        ("badge-lost", Message::BadgeLost, &next),
        ("badge-kept-at-booth", Message::BadgeKeptAtBooth, &next),
    ] {
        all.push(drawn(name, |panel| layout::draw_badge(panel, language, (&badge, told), buttons)));
    }
    all.extend(window_thanks_screens(language));
    all
}

/// Returns the window's thank-you screens, before and during the countdown.
fn window_thanks_screens(language: Language) -> [Screen; 2] {
    [Message::ThanksBodyMouse, Message::ThanksNextMouse].map(|body| {
        let notice = PanelNotice {
            icon: Icon::Badge,
            color: palette::CLAY,
            title: Message::ThanksTitle,
            body,
            fillings: &[("seconds", FillingValue::Number(9))],
            progress: None,
        };
        let button = layout::notice_button(0, Message::NewVisit, 0, 1).primary();
        drawn("thanks-mouse", |panel| layout::draw_notice(panel, language, &notice, &[button]))
    })
}

const CLOCK_BUTTONS: [(Message, Icon); 4] = [
    (Message::UndoStroke, Icon::Undo),
    (Message::TurnStone, Icon::Turn),
    (Message::PutBack, Icon::PutBack),
    (Message::Ready, Icon::Tick),
];

fn guide_screens(language: Language) -> Vec<Screen> {
    let instructions = [
        (Message::GuideTake, Icon::Tool),
        (Message::GuideTakeBare, Icon::Tool),
        (Message::GuideTakeMouse, Icon::Tool),
        (Message::GuideTouch, Icon::Stone),
        (Message::GuideCut, Icon::Trigger),
        (Message::GuideCutBare, Icon::RightHand),
        (Message::GuideCutMouse, Icon::RightHand),
        (Message::GuideSmooth, Icon::Smooth),
        (Message::GuideUndo, Icon::Undo),
        (Message::GuideUndoButton, Icon::Undo),
        (Message::GuideTurn, Icon::Turn),
        (Message::GuideTurnBare, Icon::Turn),
        (Message::GuideTurnMouse, Icon::Turn),
    ];
    let mut step = 0;
    let steps = instructions.into_iter().map(|(instruction, icon)| {
        step += 1;
        let guide = Guide { instruction, icon, step: step.min(9), steps: 9, progress: 0.4 };
        let buttons = layout::guide_buttons(0);
        drawn("guide", |panel| layout::draw_guide(panel, language, &guide, &buttons))
    });
    let done = (Message::GuideDone, Icon::Tick, 9, 1.0);
    let over = (Message::GuideOver, Icon::Stone, 5, 0.0);
    let ends = [done, over].map(|(instruction, icon, step, progress)| {
        let guide = Guide { instruction, icon, step, steps: 9, progress };
        drawn("guide-end", |panel| layout::draw_guide(panel, language, &guide, &[]))
    });
    steps.chain(ends).collect()
}

fn notice_screens(language: Language) -> Vec<Screen> {
    let percent = [("percent", FillingValue::Number(64))];
    let notice = |icon, color, title, body| PanelNotice {
        icon,
        color,
        title,
        body,
        fillings: &percent,
        progress: None,
    };
    use Message as M;
    let exporting = PanelNotice {
        progress: Some(0.64),
        ..notice(Icon::Printer, palette::CLAY, M::ExportingTitle, M::ExportingBody)
    };
    let error = |body| ("error", notice(Icon::Warning, palette::RED, M::ErrorTitle, body));
    [
        ("hands-off", notice(Icon::HandsOff, palette::CLAY, M::HandsOffTitle, M::HandsOffBody)),
        ("exporting", exporting),
        ("thanks", notice(Icon::Badge, palette::OLIVE, M::ThanksTitle, M::ThanksBody)),
        ("put-back", notice(Icon::PutBack, palette::CLAY, M::PutBackTitle, M::PutBackBody)),
        ("charger", notice(Icon::Battery, palette::AMBER, M::ChargerTitle, M::ChargerBody)),
        error(M::ErrorSave),
        error(M::ErrorBooth),
        error(M::ErrorSettings),
        error(M::ErrorTracking),
        error(M::ErrorController),
    ]
    .into_iter()
    .map(|(name, notice)| drawn(name, |panel| layout::draw_notice(panel, language, &notice, &[])))
    .collect()
}

fn staff_screens(language: Language) -> Vec<Screen> {
    let cleaned = [layout::notice_button(0, Message::HandoverCleaned, 0, 1).primary()];
    let mut keys = layout::pin_buttons(0);
    keys[4].state = ButtonState::Pressed;
    let staff = layout::staff_buttons(0);
    let alone = [0, 1, 12].map(|pending| HandoverTold { pending, ..HandoverTold::default() });
    let at_booth = [0, 1, 12].map(|owed| HandoverTold { owed: Some(owed), ..alone[0] });
    let full = HandoverTold { owed: Some(240), is_nearly_full: true, ..alone[0] };
    let mut all: Vec<Screen> = alone
        .into_iter()
        .chain(at_booth)
        .chain([full])
        .map(|told| {
            drawn("handover", |panel| layout::draw_handover(panel, language, told, &cleaned))
        })
        .collect();
    for entry in [PinEntry::Entered(2), PinEntry::Wrong, PinEntry::Locked] {
        all.push(drawn("pin", |panel| layout::draw_staff_pin(panel, language, entry, &keys)));
    }
    all.push(drawn("staff", |panel| layout::draw_staff(panel, language, &staff)));
    all
}
