//! What the booth answers to a heartbeat.

use crate::badge::LeaseAnswer;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::outbox::messages::fields::{
    fixed_bytes, read_flags, read_headset, read_version, read_zeros, write_version, write_zeros,
};
use crate::outbox::messages::heartbeat::{
    ANNOUNCEMENTS_BYTES, Announcements, read_announcements, read_start, write_announcements,
};
use crate::outbox::messages::{BoothCommand, SiteId};

/// What the booth answers. A headset takes it for the heartbeat that it sent last, and ignores any other.
#[derive(Clone, PartialEq, Eq, Debug)]
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
    /// The answer to the report of a lease. It names the same headset.
    pub lease: Option<LeaseAnswer>,
    /// A command that waits for this headset.
    pub command: Option<BoothCommand>,
    /// The heartbeat's announcements that the booth has noted. A sent sculpture that the booth doesn't have stands here as
    /// [`Kept`](super::UploadStatus::Kept).
    pub noted: Announcements,
}

/// The bits of the flags, from the lowest.
const HAS_LEASE: u8 = 1;
const HAS_COMMAND: u8 = 2;
const ALL_FLAGS: u8 = 3;

fixed_bytes! { HeartbeatAnswer }

impl HeartbeatAnswer {
    /// Length of a written answer in bytes.
    pub const BYTES: usize =
        1 + SiteId::BYTES + 25 + LeaseAnswer::BYTES + BoothCommand::BYTES + ANNOUNCEMENTS_BYTES;

    fn write(&self, to: &mut ByteWriter<'_>) {
        write_version(to);
        self.site.write(to);
        to.u32(self.headset);
        to.u64(self.boot_id);
        to.u32(self.number);
        to.u64(self.booth_time);
        let has_lease = if self.lease.is_some() { HAS_LEASE } else { 0 };
        to.u8(has_lease | if self.command.is_some() { HAS_COMMAND } else { 0 });
        match &self.lease {
            Some(answer) => answer.write(to),
            None => write_zeros(to, LeaseAnswer::BYTES),
        }
        match &self.command {
            Some(command) => command.write(to),
            None => write_zeros(to, BoothCommand::BYTES),
        }
        write_announcements(to, &self.noted);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_version(from)?;
        let (site, headset) = (SiteId::read(from)?, read_headset(from)?);
        let (boot_id, number) = read_start(from)?;
        let booth_time = from.u64()?;
        let flags = read_flags(from, ALL_FLAGS, "flags of an answer, 0 to 3")?;
        let lease = read_lease_answer(from, flags & HAS_LEASE != 0, headset)?;
        let command = if flags & HAS_COMMAND != 0 {
            Some(BoothCommand::read(from)?)
        } else {
            read_zeros(from, BoothCommand::BYTES, "zeros where there is no command")?;
            None
        };
        let noted = read_announcements(from)?;
        Ok(HeartbeatAnswer { site, headset, boot_id, number, booth_time, lease, command, noted })
    }
}

fn read_lease_answer(
    from: &mut ByteReader<'_>,
    is_there: bool,
    headset: u32,
) -> Result<Option<LeaseAnswer>, BadBytes> {
    if !is_there {
        read_zeros(from, LeaseAnswer::BYTES, "zeros where no lease is answered")?;
        return Ok(None);
    }
    let bad = from.error_here("the lease of the same headset");
    let answer = LeaseAnswer::read(from)?;
    if answer.headset == headset { Ok(Some(answer)) } else { Err(bad) }
}
