//! The reasons why a person's request is refused. They are an enum, so that pages can translate each of them.

use std::fmt;

macro_rules! reasons {
    ($($name:ident: $text:literal,)*) => {
        /// The reason why a request is refused.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub enum Reason {
            $(#[doc = $text] $name,)*
        }

        impl Reason {
            /// All reasons.
            pub const ALL: &'static [Reason] = &[$(Reason::$name,)*];

            /// Returns the English text, which headsets and the command line show.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {
                    $(Reason::$name => $text,)*
                }
            }
        }
    };
}

reasons! {
    ForeignHeartbeat: "the heartbeat is another headset's",
    ShutOut: "this headset was shut out",
    ForeignPage: "the form is of another site's page",
    ForeignForm: "the form is of another login",
    AdminsOnly: "only an admin may do this",
    WrongLogin: "name or password is wrong",
    WrongPassword: "the password of now is another",
    OwnPassword: "your own password is changed on your account's page",
    WrongFirstCode: "the code is another, or was used",
    NoPage: "there is no such page",
    NoHeadset: "no headset of this number",
    NoSculpture: "no such sculpture",
    NoEnrolToken: "no such enrolment token",
    NoAccount: "no such account",
    NoPrint: "no such order of a print",
    NoBadge: "no such badge",
    NoPrinter: "no such printer",
    NoMailServer: "no mail server was set",
    LinkRevoked: "the visitor's link was taken back",
    NeverCame: "the headset never came",
    NotWorn: "nobody wears the headset",
    OtherParcel: "another parcel of this sculpture was taken before",
    FileMissing: "a sculpture's file is missing in the copy",
    MailsFull: "as many mails of this sculpture as may be",
    PrintsFull: "as many prints of this sculpture as may be",
    HeadsetsFull: "as many headsets are enrolled as there may be",
    NumbersFull: "no number is left for a headset",
    PrintMovedOn: "the print is not at a state for that any more",
    NotSliced: "a print is sent once it is sliced",
    PrinterTaken: "the printer has another print",
    FirstAccountThere: "there is an account",
    NameTaken: "the name is taken, or looks like another account's",
    LastAdmin: "somebody has to be an admin",
}

/// The expected value of a form's field.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Expected {
    /// An e-mail address.
    MailAddress,
    /// The name of an account.
    AccountName,
    /// A password with at least this many characters.
    Password(usize),
    /// The role of an account.
    Role,
    /// A number of headsets and a number of days, each from 1 to these limits.
    FleetBounds {
        /// The largest number of headsets.
        uses: u32,
        /// The largest number of days.
        days: u16,
    },
    /// The address at which headsets reach the booth.
    BoothAddress,
    /// A number of millimetres.
    Height,
    /// A height within these bounds, in millimetres.
    HeightWithin(u32, u32),
    /// A height instead of a duration: without a slicer, no size can be found for a duration.
    HeightAlone,
    /// A number of whole minutes.
    Minutes,
    /// A duration within these bounds, in minutes.
    MinutesWithin(u32, u32),
    /// The name of a filament's colour, with at most this many characters.
    Filament(usize),
    /// A note with at most this many characters.
    Note(usize),
    /// The form of the page, unmodified.
    Form,
    /// The name of a parcel's file in an outbox.
    ParcelName,
    /// The confirmation of an action that can't be undone.
    Confirmation,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected ")?;
        match self {
            Expected::MailAddress => f.write_str("an e-mail address, as ana@example.org"),
            Expected::AccountName => f.write_str("a name of letters, digits, dots and dashes"),
            Expected::Password(least) => write!(f, "a password of {least} characters or more"),
            Expected::Role => f.write_str("attendant or admin"),
            Expected::FleetBounds { uses, days } => {
                write!(f, "1 to {uses} headsets and 1 to {days} days")
            }
            Expected::BoothAddress => f.write_str("https:// and the address that headsets reach"),
            Expected::Height => f.write_str("a height in millimetres"),
            Expected::HeightWithin(least, most) => write!(f, "a height of {least} to {most} mm"),
            Expected::HeightAlone => {
                f.write_str("a height: the booth has no slicer, which finds a size for a time")
            }
            Expected::Minutes => f.write_str("a time in whole minutes"),
            Expected::MinutesWithin(least, most) => {
                write!(f, "a time of {least} to {most} minutes")
            }
            Expected::Filament(most) => write!(f, "a filament of up to {most} letters"),
            Expected::Note(most) => write!(f, "a note of up to {most} letters"),
            Expected::Form => f.write_str("a form as the page has it"),
            Expected::ParcelName => f.write_str(
                "a file of an outbox: 32 hexadecimal digits, and .parcel, .sent or .refused",
            ),
            Expected::Confirmation => f.write_str("that it is confirmed"),
        }
    }
}
