//! What a headset tells the booth every two seconds, and what the booth answers.

use paros_core::badge::BadgeNumber;
use paros_core::codec::trace::CORE_VERSION;
use paros_core::visit::VisitPhase;
use serde::{Deserialize, Serialize};

use crate::badges::check_blocks;
use crate::limits::MAX_ANNOUNCEMENTS;
use crate::{
    BadgeReport, BoothCommand, CommandReport, HeldBlock, ProtocolError, SculptureId, SiteId,
    expect, fields,
};

/// The status of a sculpture's upload.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum UploadStatus {
    /// The sculpture is finished; its parcel is being made.
    Making = 0,
    /// The parcel has no room on the headset's disk or in its outbox. It is tried again.
    Waiting = 1,
    /// *Kept here*: the parcel is on the headset's disk.
    Kept = 2,
    /// *Kept here*, and the booth can't take it: staff must look.
    Refused = 3,
    /// The parcel was never made, or is damaged. It won't come.
    Lost = 4,
    /// *Kept at the booth*. A heartbeat asks by it whether the booth still has the sculpture: one that doesn't notes
    /// [`Kept`](UploadStatus::Kept), and the headset sends the parcel again.
    Sent = 5,
}

/// That there is a sculpture. The booth lists one that it doesn't have as missing until it comes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Announcement {
    /// The sculpture's.
    pub id: SculptureId,
    /// The badge that the visitor was shown; `None` also as long as none was.
    #[serde(with = "fields::badge")]
    pub badge: Option<BadgeNumber>,
    /// The status of its upload.
    pub status: UploadStatus,
}

/// How hot a headset is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeatLevel {
    /// No throttling, and none near.
    Normal,
    /// The device will throttle if this goes on.
    Warm,
    /// The device throttles, or will be switched off.
    Hot,
}

/// How a headset is, beside its outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeadsetStatus {
    /// Random bits of the visit under way; 0 for none.
    pub session_id: u64,
    /// `true` if the battery is being charged.
    pub is_charging: bool,
    /// `true` if the headset is on a head.
    pub is_worn: bool,
    /// `true` if it glows and beeps, so that staff find it.
    pub is_glowing: bool,
    /// The battery's charge in percent, where it is known: 0 to 100.
    pub battery_percent: Option<u8>,
    /// How hot it is.
    pub heat: HeatLevel,
    /// The visit's phase.
    #[serde(with = "fields::phase")]
    pub phase: VisitPhase,
    /// Seconds since this visitor put it on; 0 where nobody wears it.
    pub worn_seconds: u32,
    /// The program's version: major, minor, patch.
    pub app_version: [u16; 3],
}

/// What a headset tells the booth.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Heartbeat {
    /// Number of the headset, from 1.
    pub headset: u32,
    /// Random bits of this start of the program, not 0.
    pub boot_id: u64,
    /// The heartbeat's own number within the start, from 1: the answer repeats it.
    pub number: u32,
    /// How the headset is.
    #[serde(flatten)]
    pub status: HeadsetStatus,
    /// `true` if the outbox's folder was empty at the start, as the program is new here or its data was wiped; until a
    /// heartbeat that says so is answered.
    pub was_wiped: bool,
    /// Sculptures that the booth doesn't have.
    pub outbox_depth: u16,
    /// How full the outbox is with what can't be deleted, in percent.
    pub outbox_full_percent: u8,
    /// [`CORE_VERSION`] of the program.
    pub core_version: u16,
    /// The blocks of badges' numbers that the headset holds.
    pub badges: BadgeReport,
    /// The last command that was taken, and its outcome; `None` if none was taken in this start.
    pub last_command: Option<CommandReport>,
    /// Up to 64 sculptures that the booth doesn't have: first those whose status it hasn't noted. Then sent ones, to hear
    /// whether the booth still has them. No id is there twice.
    pub announcements: Vec<Announcement>,
}

/// What the booth answers. A headset takes it for the heartbeat that it sent last, and ignores any other.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeartbeatAnswer {
    /// The booth's site.
    pub site: SiteId,
    /// Of the heartbeat.
    pub headset: u32,
    /// Of the heartbeat.
    pub boot_id: u64,
    /// Of the heartbeat.
    pub number: u32,
    /// Seconds since 1970 by the booth's clock.
    pub booth_time: u64,
    /// Changes when the booth comes back from a backup, which may lack sculptures: the headset asks for all that it sent.
    pub store_epoch: u64,
    /// The blocks of badges' numbers that the headset holds from now on, in the order of their use. Others of its report are
    /// used up, or are no longer its own.
    pub badges: Vec<HeldBlock>,
    /// A command that waits for this headset.
    pub command: Option<BoothCommand>,
    /// The heartbeat's announcements that the booth has noted. A sent sculpture that the booth doesn't have stands here as
    /// [`Kept`](UploadStatus::Kept).
    pub noted: Vec<Announcement>,
}

impl UploadStatus {
    /// By number.
    pub const ALL: [UploadStatus; 6] = [
        UploadStatus::Making,
        UploadStatus::Waiting,
        UploadStatus::Kept,
        UploadStatus::Refused,
        UploadStatus::Lost,
        UploadStatus::Sent,
    ];
}

fn check_announcements(list: &[Announcement], field: &'static str) -> Result<(), ProtocolError> {
    let is_new = |at: usize| list[..at].iter().all(|other| other.id != list[at].id);
    let is_right = list.len() <= MAX_ANNOUNCEMENTS && (0..list.len()).all(is_new);
    expect(is_right, field, "up to 64 sculptures with different ids")
}

impl Default for HeadsetStatus {
    /// Makes the status of a headset without visits that nobody wears.
    fn default() -> Self {
        HeadsetStatus {
            session_id: 0,
            is_charging: false,
            is_worn: false,
            is_glowing: false,
            battery_percent: None,
            heat: HeatLevel::Normal,
            phase: VisitPhase::Closed,
            worn_seconds: 0,
            app_version: [0; 3],
        }
    }
}

impl Heartbeat {
    /// Makes the first heartbeat of a start whose outbox is empty.
    #[must_use]
    pub fn first(headset: u32, boot_id: u64, badges: BadgeReport) -> Self {
        Heartbeat {
            headset,
            boot_id,
            number: 1,
            status: HeadsetStatus::default(),
            was_wiped: false,
            outbox_depth: 0,
            outbox_full_percent: 0,
            core_version: CORE_VERSION,
            badges,
            last_command: None,
            announcements: Vec::new(),
        }
    }

    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.headset != 0, "headset", "a number from 1")?;
        expect(self.boot_id != 0, "boot_id", "random bits, not 0")?;
        expect(self.number != 0, "number", "a number from 1")?;
        let is_percent = |percent: u8| percent <= 100;
        expect(self.status.battery_percent.is_none_or(is_percent), "battery_percent", "0 to 100")?;
        expect(is_percent(self.outbox_full_percent), "outbox_full_percent", "0 to 100")?;
        self.badges.check()?;
        self.last_command.map_or(Ok(()), |report| report.check())?;
        check_announcements(&self.announcements, "announcements")
    }
}

impl HeartbeatAnswer {
    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.headset != 0, "headset", "a number from 1")?;
        check_blocks(&self.badges, "badges")?;
        self.command.map_or(Ok(()), |command| command.check())?;
        check_announcements(&self.noted, "noted")
    }
}
