//! How JSON has the core's types: badges and places in lists as numbers, short codes as text.

use paros_core::badge::{BadgeNumber, LeaseAnswer, LeaseReport, LeasedBlock, LeasedBlocks};
use paros_core::limits::BLOCK_NUMBERS;
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A badge's number, or null.
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

/// What a session starts from.
#[derive(Serialize, Deserialize)]
#[serde(remote = "SessionMode", rename_all = "snake_case")]
pub(crate) enum Mode {
    None,
    FreeForm,
    Constrained { figure: u8 },
    Creative,
    Own,
}

/// A language by its two small letters of ISO 639-1.
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

/// A report of a lease.
#[derive(Serialize, Deserialize)]
#[serde(remote = "LeaseReport")]
struct ReportFields {
    headset: u32,
    epoch: u64,
    report: u32,
    taken: u32,
}

pub(crate) mod lease_report {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Wrapped(#[serde(with = "ReportFields")] LeaseReport);

    pub(crate) fn serialize<S: Serializer>(
        report: &Option<LeaseReport>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        report.map(Wrapped).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<LeaseReport>, D::Error> {
        Ok(Option::<Wrapped>::deserialize(from)?.map(|wrapped| wrapped.0))
    }
}

/// The answer to a report of a lease; its blocks by number and first place.
#[derive(Serialize, Deserialize)]
struct AnswerFields {
    headset: u32,
    epoch: u64,
    report: u32,
    taken: u32,
    is_void: bool,
    blocks: Vec<(u16, u8)>,
}

pub(crate) mod lease_answer {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(
        answer: &Option<LeaseAnswer>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let fields = answer.as_ref().map(|answer| {
            let first = |block: &LeasedBlock| (BLOCK_NUMBERS as u32 - block.count()) as u8;
            let blocks = answer.blocks.iter().map(|block| (block.block(), first(block)));
            let LeaseAnswer { headset, epoch, report, taken, is_void, .. } = *answer;
            AnswerFields { headset, epoch, report, taken, is_void, blocks: blocks.collect() }
        });
        fields.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<LeaseAnswer>, D::Error> {
        let Some(fields) = Option::<AnswerFields>::deserialize(from)? else { return Ok(None) };
        let AnswerFields { headset, epoch, report, taken, is_void, blocks } = fields;
        let blocks = read_blocks(&blocks).filter(|blocks| !is_void || blocks.is_empty());
        let expected = "expected up to 6 different blocks, none of a lease that is void";
        let blocks = blocks.ok_or_else(|| D::Error::custom(expected))?;
        Ok(Some(LeaseAnswer { headset, epoch, report, taken, is_void, blocks }))
    }

    fn read_blocks(fields: &[(u16, u8)]) -> Option<LeasedBlocks> {
        let mut blocks = LeasedBlocks::new();
        for (number, first) in fields {
            let is_new = blocks.iter().all(|block| block.block() != *number);
            let block = LeasedBlock::new(*number, *first).filter(|_| is_new)?;
            blocks.push(block).ok()?;
        }
        Some(blocks)
    }
}
