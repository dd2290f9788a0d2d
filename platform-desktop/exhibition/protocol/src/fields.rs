//! The JSON forms of the core's types: badges and places in lists as numbers, short codes as text.

use paros_core::badge::BadgeNumber;
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A badge number, or null.
pub(crate) mod badge {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(
        badge: &Option<BadgeNumber>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        badge.map(BadgeNumber::get).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<BadgeNumber>, D::Error> {
        let number = Option::<u32>::deserialize(from)?;
        let badge = |number| BadgeNumber::new(number);
        number
            .map(|number| {
                badge(number).ok_or_else(|| D::Error::custom("expected the number of a badge"))
            })
            .transpose()
    }
}

/// A visit's phase by its number.
pub(crate) mod phase {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(phase: &VisitPhase, to: S) -> Result<S::Ok, S::Error> {
        (*phase as u8).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<VisitPhase, D::Error> {
        let number = usize::from(u8::deserialize(from)?);
        let phase = VisitPhase::ALL.get(number).copied();
        phase.ok_or_else(|| D::Error::custom("expected the number of a visit's phase"))
    }
}

/// The start of a session.
#[derive(Serialize, Deserialize)]
#[serde(remote = "SessionMode", rename_all = "snake_case")]
pub(crate) enum Mode {
    None,
    FreeForm,
    Constrained { figure: u8 },
    Creative,
    Own,
}

/// A language code, two small letters of ISO 639-1.
pub(crate) mod language {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(code: &[u8; 2], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(str::from_utf8(code).unwrap_or("en"))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[u8; 2], D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(from)?;
        let code: Option<[u8; 2]> = text.as_bytes().try_into().ok();
        let code = code.filter(|code| code.iter().all(u8::is_ascii_lowercase));
        code.ok_or_else(|| D::Error::custom("expected a language, two small letters"))
    }
}
