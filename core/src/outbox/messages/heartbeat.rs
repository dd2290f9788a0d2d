//! What a headset tells the booth every two seconds.

use heapless::Vec;

use crate::badge::{BadgeNumber, LeaseReport};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::limits::MAX_ANNOUNCEMENTS;
use crate::outbox::messages::fields::{
    fixed_bytes, read_badge, read_flags, read_headset, read_numbered, read_version, read_zeros,
    write_badge, write_version, write_zeros,
};
use crate::outbox::messages::{CommandReport, SculptureId};
use crate::visit::VisitPhase;

/// Announcements of a heartbeat, or those of it that the booth has noted. No id is there twice.
pub type Announcements = Vec<Announcement, MAX_ANNOUNCEMENTS>;

/// The status of a sculpture's upload.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
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

/// That there is a sculpture. The booth lists one that it doesn't know as missing until it comes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Announcement {
    /// The sculpture's.
    pub id: SculptureId,
    /// The badge that the visitor was shown; `None` also as long as none was.
    pub badge: Option<BadgeNumber>,
    /// The status of its upload.
    pub status: UploadStatus,
}

/// How hot a headset is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum HeatLevel {
    /// No throttling, and none near.
    Normal = 0,
    /// The device will throttle if this goes on.
    Warm = 1,
    /// The device throttles, or will be switched off.
    Hot = 2,
}

/// What a headset tells the booth.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Heartbeat {
    /// Number of the headset, from 1.
    pub headset: u32,
    /// Random bits of this start of the program, not 0.
    pub boot_id: u64,
    /// The heartbeat's own number within the start, from 1: the answer repeats it.
    pub number: u32,
    /// Random bits of the visit under way; 0 for none.
    pub session_id: u64,
    /// Whether the battery is being charged.
    pub is_charging: bool,
    /// Whether the headset is on a head.
    pub is_worn: bool,
    /// Whether it glows and beeps, so that it is found.
    pub is_glowing: bool,
    /// `true` if the outbox's folder was empty at the start, as the program is new here or its data was wiped; until a
    /// heartbeat that says so is answered.
    pub was_wiped: bool,
    /// The battery's charge in percent, where it is known.
    pub battery_percent: Option<u8>,
    /// How hot it is.
    pub heat: HeatLevel,
    /// Where the visit stands.
    pub phase: VisitPhase,
    /// Seconds since this visitor put it on; 0 where nobody wears it.
    pub worn_seconds: u32,
    /// Sculptures that the booth doesn't have.
    pub outbox_depth: u16,
    /// How full the outbox is with what can't be deleted, in percent.
    pub outbox_full_percent: u8,
    /// The program's version: major, minor, patch.
    pub app_version: [u16; 3],
    /// [`CORE_VERSION`](crate::codec::trace::CORE_VERSION) of the program.
    pub core_version: u16,
    /// What was taken of the badges' lease, where a report is due. It names the same headset.
    pub lease: Option<LeaseReport>,
    /// The last command that was taken, and what became of it; `None` if none was taken in this start.
    pub last_command: Option<CommandReport>,
    /// Sculptures that the booth doesn't have: first those whose status it hasn't noted. Then sent ones, to hear whether
    /// the booth still has them.
    pub announcements: Announcements,
}

/// What stands for a charge that isn't known.
const UNKNOWN_CHARGE: u8 = 255;

/// The bits of the flags, from the lowest.
const CHARGING: u8 = 1;
const WORN: u8 = 2;
const GLOWING: u8 = 4;
const WIPED: u8 = 8;
const HAS_LEASE: u8 = 16;
const HAS_COMMAND: u8 = 32;
const ALL_FLAGS: u8 = 63;

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

impl HeatLevel {
    /// By number.
    pub const ALL: [HeatLevel; 3] = [HeatLevel::Normal, HeatLevel::Warm, HeatLevel::Hot];
}

impl Announcement {
    /// Length of a written announcement in bytes.
    const BYTES: usize = 21;

    fn write(&self, to: &mut ByteWriter<'_>) {
        self.id.write(to);
        write_badge(to, self.badge);
        to.u8(self.status as u8);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let (id, badge) = (SculptureId::read(from)?, read_badge(from)?);
        let expected = "an upload's status, 0 to 5";
        let status = read_numbered(from, &UploadStatus::ALL, expected)?;
        Ok(Announcement { id, badge, status })
    }
}

/// Length of written announcements in bytes.
pub(super) const ANNOUNCEMENTS_BYTES: usize = 1 + MAX_ANNOUNCEMENTS * Announcement::BYTES;

/// Writes how many there are, and as many as there may be: zeros after the last one.
pub(super) fn write_announcements(to: &mut ByteWriter<'_>, announcements: &Announcements) {
    to.u8(announcements.len() as u8);
    announcements.iter().for_each(|announcement| announcement.write(to));
    write_zeros(to, (MAX_ANNOUNCEMENTS - announcements.len()) * Announcement::BYTES);
}

/// Reads what [`write_announcements`] wrote.
pub(super) fn read_announcements(from: &mut ByteReader<'_>) -> Result<Announcements, BadBytes> {
    let bad = from.error_here("up to 32 announcements");
    let count = usize::from(from.u8()?);
    if count > MAX_ANNOUNCEMENTS {
        return Err(bad);
    }
    let mut announcements = Announcements::new();
    for _ in 0..count {
        let bad = from.error_here("another sculpture's id");
        let announcement = Announcement::read(from)?;
        let is_new = announcements.iter().all(|other| other.id != announcement.id);
        if !is_new || announcements.push(announcement).is_err() {
            return Err(bad);
        }
    }
    let unused = (MAX_ANNOUNCEMENTS - count) * Announcement::BYTES;
    read_zeros(from, unused, "zeros after the last announcement")?;
    Ok(announcements)
}

fixed_bytes! { Heartbeat }

impl Heartbeat {
    /// Length of a written heartbeat in bytes.
    pub const BYTES: usize = 44 + LeaseReport::BYTES + CommandReport::BYTES + ANNOUNCEMENTS_BYTES;

    fn write(&self, to: &mut ByteWriter<'_>) {
        write_version(to);
        to.u32(self.headset);
        to.u64(self.boot_id);
        to.u32(self.number);
        to.u64(self.session_id);
        to.u8(self.flags());
        to.u8(self.battery_percent.unwrap_or(UNKNOWN_CHARGE));
        to.u8(self.heat as u8);
        to.u8(self.phase as u8);
        to.u32(self.worn_seconds);
        to.u16(self.outbox_depth);
        to.u8(self.outbox_full_percent);
        self.app_version.iter().for_each(|part| to.u16(*part));
        to.u16(self.core_version);
        match &self.lease {
            Some(lease) => lease.write(to),
            None => write_zeros(to, LeaseReport::BYTES),
        }
        match &self.last_command {
            Some(report) => report.write(to),
            None => write_zeros(to, CommandReport::BYTES),
        }
        write_announcements(to, &self.announcements);
    }

    fn flags(&self) -> u8 {
        let flag = |is_set: bool, bit: u8| if is_set { bit } else { 0 };
        flag(self.is_charging, CHARGING)
            | flag(self.is_worn, WORN)
            | flag(self.is_glowing, GLOWING)
            | flag(self.was_wiped, WIPED)
            | flag(self.lease.is_some(), HAS_LEASE)
            | flag(self.last_command.is_some(), HAS_COMMAND)
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_version(from)?;
        let headset = read_headset(from)?;
        let (boot_id, number) = read_start(from)?;
        let session_id = from.u64()?;
        let flags = read_flags(from, ALL_FLAGS, "flags of a headset, 0 to 63")?;
        let battery_percent = read_charge(from)?;
        let heat = read_numbered(from, &HeatLevel::ALL, "a level of heat, 0 to 2")?;
        let phase = read_numbered(from, &VisitPhase::ALL, "a visit's phase, 0 to 10")?;
        let (worn_seconds, outbox_depth) = (from.u32()?, from.u16()?);
        let bad = from.error_here("how full an outbox is, 0 to 100");
        let outbox_full_percent = Some(from.u8()?).filter(|&part| part <= 100).ok_or(bad)?;
        let app_version = [from.u16()?, from.u16()?, from.u16()?];
        let core_version = from.u16()?;
        let lease = read_lease_report(from, flags & HAS_LEASE != 0, headset)?;
        let last_command = if flags & HAS_COMMAND != 0 {
            Some(CommandReport::read(from)?)
        } else {
            read_zeros(from, CommandReport::BYTES, "zeros where no command was taken")?;
            None
        };
        Ok(Heartbeat {
            headset,
            boot_id,
            number,
            session_id,
            is_charging: flags & CHARGING != 0,
            is_worn: flags & WORN != 0,
            is_glowing: flags & GLOWING != 0,
            was_wiped: flags & WIPED != 0,
            battery_percent,
            heat,
            phase,
            worn_seconds,
            outbox_depth,
            outbox_full_percent,
            app_version,
            core_version,
            lease,
            last_command,
            announcements: read_announcements(from)?,
        })
    }
}

/// Reads the random bits of a start, and the number of a heartbeat within it.
pub(super) fn read_start(from: &mut ByteReader<'_>) -> Result<(u64, u32), BadBytes> {
    let bad = from.error_here("the bits of a start, not 0");
    let boot_id = Some(from.u64()?).filter(|&bits| bits != 0).ok_or(bad)?;
    let bad = from.error_here("a heartbeat's number, from 1");
    let number = Some(from.u32()?).filter(|&number| number != 0).ok_or(bad)?;
    Ok((boot_id, number))
}

fn read_charge(from: &mut ByteReader<'_>) -> Result<Option<u8>, BadBytes> {
    let bad = from.error_here("a charge of 0 to 100, or 255");
    match from.u8()? {
        percent @ 0..=100 => Ok(Some(percent)),
        UNKNOWN_CHARGE => Ok(None),
        _ => Err(bad),
    }
}

fn read_lease_report(
    from: &mut ByteReader<'_>,
    is_there: bool,
    headset: u32,
) -> Result<Option<LeaseReport>, BadBytes> {
    if !is_there {
        read_zeros(from, LeaseReport::BYTES, "zeros where no lease is reported")?;
        return Ok(None);
    }
    let bad = from.error_here("the lease of the same headset");
    let report = LeaseReport::read(from)?;
    if report.headset == headset { Ok(Some(report)) } else { Err(bad) }
}
