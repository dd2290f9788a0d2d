//! The heartbeat of a headset, sent every two seconds, and the booth's answer.

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
    /// The parcel doesn't fit on the headset's disk or in its outbox. Making it is retried.
    Waiting = 1,
    /// *Kept here*: the parcel is on the headset's disk.
    Kept = 2,
    /// *Kept here*: the parcel is on the headset's disk, but the booth refused it. Staff must look at it.
    Refused = 3,
    /// The parcel was never made, or is damaged. It can't be sent.
    Lost = 4,
    /// *Kept at the booth*. In a heartbeat, this status asks the booth if it still has the sculpture. If not,
    /// the booth answers [`Kept`](UploadStatus::Kept), and the headset sends the parcel again.
    Sent = 5,
}

/// The announcement of a sculpture. The booth lists the sculpture as missing until its parcel arrives.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Announcement {
    /// The id of the sculpture.
    pub id: SculptureId,
    /// The badge that the visitor was shown; `None` as long as no badge was shown.
    #[serde(with = "fields::badge")]
    pub badge: Option<BadgeNumber>,
    /// The status of the upload.
    pub status: UploadStatus,
}

/// The thermal state of a headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeatLevel {
    /// No throttling, and none expected soon.
    Normal,
    /// The device will throttle if it stays this hot.
    Warm,
    /// The device throttles, or will be switched off.
    Hot,
}

/// The state of a headset, without its outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeadsetStatus {
    /// Random bits of the visit under way; 0 for none.
    pub session_id: u64,
    /// `true` if the battery is being charged.
    pub is_charging: bool,
    /// `true` if the headset is on a head.
    pub is_worn: bool,
    /// `true` if the headset glows and beeps, so that staff can find it.
    pub is_glowing: bool,
    /// The charge of the battery in percent, 0 to 100; `None` if unknown.
    pub battery_percent: Option<u8>,
    /// The thermal state.
    pub heat: HeatLevel,
    /// The visit's phase.
    #[serde(with = "fields::phase")]
    pub phase: VisitPhase,
    /// Seconds since this visitor put the headset on; 0 if it isn't worn.
    pub worn_seconds: u32,
    /// The program's version: major, minor, patch.
    pub app_version: [u16; 3],
}

/// A heartbeat: the report of a headset to the booth.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Heartbeat {
    /// Number of the headset, from 1.
    pub headset: u32,
    /// Random bits that identify this start of the program, not 0.
    pub boot_id: u64,
    /// The sequence number of the heartbeat within the program start, from 1. The answer repeats it.
    pub number: u32,
    /// The state of the headset.
    #[serde(flatten)]
    pub status: HeadsetStatus,
    /// `true` if the outbox folder was empty at the start: the program is new here, or its data was wiped.
    /// Repeated until the booth answers a heartbeat with this flag.
    pub was_wiped: bool,
    /// Number of sculptures that the booth doesn't have.
    pub outbox_depth: u16,
    /// Share of the outbox that is filled with files that can't be deleted, in percent.
    pub outbox_full_percent: u8,
    /// The program's [`CORE_VERSION`].
    pub core_version: u16,
    /// The blocks of badge numbers that the headset holds.
    pub badges: BadgeReport,
    /// The last command that the headset received since its start, and its outcome.
    pub last_command: Option<CommandReport>,
    /// Up to 64 distinct sculptures. First those that the booth doesn't have, led by those whose status it
    /// hasn't acknowledged. Then sent ones, to check that the booth still has them.
    pub announcements: Vec<Announcement>,
}

/// The booth's answer to a heartbeat. A headset accepts only the answer to its last heartbeat.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeartbeatAnswer {
    /// The booth's site.
    pub site: SiteId,
    /// The headset number of the heartbeat.
    pub headset: u32,
    /// The program start of the heartbeat.
    pub boot_id: u64,
    /// The sequence number of the heartbeat.
    pub number: u32,
    /// Seconds since 1970 by the booth's clock.
    pub booth_time: u64,
    /// Changes when the booth is restored from a backup, which may lack sculptures. The headset then asks
    /// about all that it sent.
    pub store_epoch: u64,
    /// The blocks of badge numbers that the headset holds from now on, in the order of their use. Other
    /// blocks of its report are used up or belong to it no longer.
    pub badges: Vec<HeldBlock>,
    /// A command that waits for this headset.
    pub command: Option<BoothCommand>,
    /// The announcements that the booth acknowledges. A sent sculpture that the booth doesn't have is listed
    /// as [`Kept`](UploadStatus::Kept).
    pub noted: Vec<Announcement>,
}

impl UploadStatus {
    /// All statuses, in the order of their numbers.
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
    /// Returns the status of an unworn headset without a visit.
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
    /// Returns the first heartbeat of a program start with an empty outbox.
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
